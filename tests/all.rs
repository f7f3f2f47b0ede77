//! What crosses crates, linked once: one file is one module.
//!
//! `cargo test -p tests --test all` runs everything, `cargo test -p tests --test all safety::` one
//! file.

mod algorithm_1;
mod benchmarks;
mod beyond;
mod boards;
mod budgets;
mod campaign;
mod choices;
mod documentation;
mod emulated;
mod fail_safe;
mod figures;
mod flash;
mod frames;
mod guards;
mod hil;
#[path = "inference/main.rs"]
mod inference;
mod joint_plans;
mod learning;
mod links;
mod lockstep;
mod logs;
mod manipulation;
mod navigation;
// The path makes the modules in it lie beside it, not in a folder of its name.
#[path = "notebook.rs"]
mod notebook;
mod owned_goals;
mod paper;
mod recordings;
mod rejected_models;
mod restarts;
// The path makes the modules in it lie in the folder.
#[path = "rounds/main.rs"]
mod rounds;
mod safety;
mod scenarios;
mod second_implementation;
mod self_test;
mod table_budget;
mod table_rounds;
#[path = "tasks.rs"]
mod tasks;
mod tree_files;
mod trees;
