//! Joint plans: one path for each robot of a team, so that no two ever get in each other's way.
//!
//! | question | answer |
//! |---|---|
//! | what is to be planned | a [`Problem`]: where robots stand, what each is for, which cells are closed |
//! | what is the best plan | [`JointPlanner`] |
//! | what if a robot has to go by a cell first | its plan begins with a [`Prefix`] |
//! | what else could the team do | [`PolicyList`]: up to `K` plans, the best one first |
//! | why is there no plan | [`Failure`]; a plan for a part of the targets says [by how many it is short](JointPlan::short_by) |
//! | what if every robot owns its target | [`Prioritised`], and where that fails [`Lacam`]; of few joint states, all of them |
//! | when are the robots there | [`JointPlan::execute`], messages counted |
//! | do two robots plan alike | [`PolicyList::digest`] |
//!
//! All planners here are deterministic and use integers only, so that robots that plan from equal
//! [`Problem`]s have equal plans. Each works in an arena whose size is in its type and can stop
//! after any work unit and go on later; the plan does not depend on where it stopped. For eight
//! robots on 64 cells and 32 steps a list of 16 policies takes 7.8 KB, of which the plans are 4.7.
//!
//! Goals that no robot owns are planned for by a maximum flow in which robots take turns by the
//! colour of their cells; see `flow` and `network` for how. Where one or two robots own their
//! targets, their paths are fixed and the others flow around them.

mod assignment;
mod attempt;
mod distances;
mod execution;
mod exhaustive;
mod fixed_paths;
mod flow;
mod flow_planner;
mod lacam;
mod list;
mod network;
mod pibt;
mod plan;
mod planner;
mod prefix;
mod prioritised;
mod problem;
mod shorten;
mod states;
mod survey;
mod table;
#[cfg(test)]
mod teams;
#[cfg(test)]
mod trials;
mod walk;

pub use assignment::own_targets;
pub(crate) use attempt::LATER_TOGETHER;
pub use execution::Execution;
pub use lacam::Lacam;
pub use list::{PolicyList, VERSION};
pub use plan::{Arrival, Failure, JointConflict, JointConflictKind, JointPlan};
pub use planner::JointPlanner;
pub use prefix::Prefix;
pub use prioritised::Prioritised;
pub use problem::{Errand, Problem, ProblemError, Target};
