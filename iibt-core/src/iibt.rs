//! Where behavior trees and inference meet: the interactive inference node and the tasks it serves.
//!
//! [`Node`] is Algorithm 1 of the paper, generic over a [`Task`]; [`Navigation`] is the task of reaching goals
//! on a grid as a team, [`Manipulation`] that of two robots that bring objects together. [`Logic`] holds what is true of the world as logic variables, and [`rules`] turn an
//! unmet precondition into a preference (the paper's f_L). This is the only room that knows both trees and
//! probabilities.

pub mod logic;
pub mod manipulation;
pub mod navigation;
pub mod node;
pub mod rules;

pub use logic::{Condition, Literal, Logic};
pub use manipulation::Manipulation;
pub use navigation::{Mission, Navigation};
pub use node::{Node, Task};
