//! Joint plans: one path for each robot of a team, so that no two ever get in each other's way.
//!
//! All planners here are deterministic and use integers only, so that robots that plan from equal
//! [`Problem`]s have equal plans. Each works in an arena whose size is in its type and can stop
//! after any work unit and go on later.

mod execution;
mod flow;
mod list;
mod network;
mod owners;
mod plan;
mod planner;
mod problem;
mod survey;
mod walk;

pub use execution::Execution;
pub use list::{PolicyList, VERSION};
pub use plan::{Arrival, Failure, JointConflict, JointConflictKind, JointPlan};
pub use planner::JointPlanner;
pub use problem::{Errand, Problem, ProblemError, Target};
