//! Tasks without code: tables that run as the task of an inference node.
//!
//! ```text
//! Percept ─► q(factors) ─► facts ─► preferences ─► operators of all robots ─► posterior ─► Command
//!   peers ─► announced ──────┴──────────┘ ▲ remedies                               └─► Announcement
//! ```
//!
//! [`Tables`] have a [`Role`] for each robot: the hidden factors that it tracks, its sensors (A), its
//! operators with preconditions and postconditions (B, the paper's table 5), facts (the logic variables),
//! remedies (f_L) and aims (C). [`TableTask`] is the [`Task`](crate::iibt::Task) that they describe.

mod announcement;
mod check;
mod definition;
mod error;
mod model;
mod task;

pub use announcement::Announcement;
pub use definition::{
    Accuracy, Aim, Effect, Fact, Given, HiddenFactor, Holds, JointOutcome, Labels, MAX_FACTORS, MAX_FACTS,
    MAX_OPERATORS, MAX_SENSORS, MAX_STATES, Operator, Postcondition, Reads, Remedy, Role, Sensor, Tables, To,
    Wish,
};
pub use error::TablesError;
pub use task::{Command, Decision, Percept, Plan, SenseError, TableTask, Wanted};
