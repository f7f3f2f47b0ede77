//! Tasks written as tables, in simulation.
//!
//! ```text
//! TaskFile ─► tables and truth ─► fly ─► Outcome      the task, the flight, the result
//!                                  │
//!                                  ├─ TaskWorld       hidden states, readings, failures
//!                                  ├─ Controller      each robot in a simulated Station
//!                                  └─ Radio           the only way between them
//! ```

mod campaign;
mod export;
mod file;
mod flight;
mod mission;
mod names;
mod read;
mod robot;
mod room;
mod station;
mod tree;
mod waiting;
mod world;

pub use campaign::{LEVELS, Level, level_table};
pub use flight::{Flown, Operated};
pub(crate) use mission::{Beside, TaskShadow};
pub use mission::{TaskError, Trouble, outcome_line};
pub use read::TableMission;
pub use tree::{SKILLS, TaskTree};
pub use world::{Goal, Truth};

pub(crate) use flight::{TaskFlight, Worker};
pub(crate) use robot::{HostRobot, TIMEOUT};
pub(crate) use station::Station;

use iibt_core::iibt::table::{TableTask, Wanted};

/// The tasks that are built in.
pub const NAMES: [&str; 2] = ["bottle-and-plate", "valves"];

/// The text of a built-in task.
#[must_use]
pub fn built_in(name: &str) -> Option<&'static str> {
    match name {
        "bottle-and-plate" => Some(include_str!("../tasks/bottle-and-plate.toml")),
        "valves" => Some(include_str!("../tasks/valves.toml")),
        _ => None,
    }
}

/// Whether a text is a task file, sound or not: one of its robots has a factor.
#[must_use]
pub fn is_task(text: &str) -> bool {
    let robots = toml::from_str::<toml::Table>(text).ok().and_then(|table| table.get("robot").cloned());
    robots.is_some_and(|robots| {
        robots.as_array().is_some_and(|robots| robots.iter().any(|robot| robot.get("factor").is_some()))
    })
}

/// A table task with room for any task file.
pub(crate) type HostTask<'t> = TableTask<'t, { room::STATES }, { room::ROBOTS }, { room::POLICIES }>;

/// What such a task prefers.
pub(crate) type HostWanted = Wanted<{ room::STATES }, { room::ROBOTS }>;
