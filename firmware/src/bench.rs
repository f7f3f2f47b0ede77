//! Models for measurements and comparisons of the engine, the same on the host and on the target.
//!
//! T1 and T2 are the field's: other tools take 154 thousand and 195 million instructions for one
//! belief update and policy posterior of them (cpp-AIF, x86-64).

mod benchmark;
pub mod joint_plans;
pub mod lockstep;
pub mod random_model;
pub mod self_test;
pub mod sign;
pub mod t1;
pub mod t2;

pub use benchmark::{Benchmark, POLICIES, Workspace};

/// The seed of the random models that images and the host are compared by.
pub const SEED: u64 = 2026;
