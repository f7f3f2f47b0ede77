//! A bounded grid world: the map, paths on it, and planners that find several different paths.
//!
//! Cells are numbered row by row from the top left, from zero: `cell = width * row + column`, the
//! paper's p-numbers. Time on a grid runs in steps: a robot makes one [`Move`] per step, a wait
//! included. The room knows no probabilities and no robots; beside [`actions`](crate::actions) it
//! needs nothing.
//!
//! | question | answer |
//! |---|---|
//! | where can a robot stand | [`Map`], drawn in the source by [`Map::drawn`] |
//! | which cells are in a set | [`CellSet`] |
//! | what is the shortest way | [`Planner::shortest`] |
//! | how far is every cell | [`Planner::distances`] |
//! | how to arrive later | [`Path::with_waits`] |
//! | how to arrive at step T past moving teammates | [`TimedPlanner::sweep`] |
//! | do two paths get in each other's way | [`first_conflict`] |
//! | where does a whole team go | [`joint`] |
//!
//! Every planner works in an arena whose size is in its type, gives the same path for the same
//! input on every machine, and reports input that makes no sense as a typed error.

mod cell;
mod conflict;
mod drawing;
pub mod joint;
mod map;
mod open_list;
mod path;
#[cfg(test)]
mod pictures;
mod planner;
mod set;
mod spread;
mod timed;
mod waits;

pub use cell::{Cell, Move};
pub use conflict::{Conflict, ConflictKind, first_conflict};
pub use drawing::DrawingError;
pub use map::{Map, MapError, words};
pub use path::Path;
pub use planner::{Distances, PlanError, Planner};
pub use set::CellSet;
pub use timed::{Sweep, TimedPlanner};
pub use waits::WaitPlace;
