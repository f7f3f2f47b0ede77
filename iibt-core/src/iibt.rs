//! The interactive inference node, which runs a task inside a behavior tree.
//!
//! [`InferenceNode`] is Algorithm 1 of the paper, generic over a [`Task`].
//! [`Navigation`](crate::navigation::Navigation) is the task of reaching goals on a grid as a team,
//! and [`table`] makes tasks of tables. [`Logic`] holds what is true of the world as logic
//! variables, and [`rules`] has the size by which evidence for an unmet precondition is raised.
//! [`weigh`] weighs the joint policies of a team's rounds. Trees and probabilities meet here.

mod joint;
pub mod logic;
mod node;
pub mod rules;
pub mod table;
mod task;

pub use joint::{cheapest_policy, weigh};
pub use logic::{Condition, Literal, Logic};
pub use node::InferenceNode;
pub use task::Task;
