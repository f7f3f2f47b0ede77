//! The simulator: teams of robots that run the firmware's own controller, in worlds drawn in text files.
//!
//! ```text
//! Scenario ─► fly ─► Record             what is flown, the flight, what came of it
//!              │
//!              ├─ World                 the truth: where robots stand, what blocks their way
//!              ├─ team                  the controllers, each alone in a simulated body
//!              ├─ Radio                 the only way between them: encoded frames, lost and late
//!              └─ Collisions            the referee's count
//! ```
//!
//! Nothing depends on the time of day or on the machine: the same scenario, seed and loss give the same
//! [`Record`], byte for byte.
//!
//! ```
//! use host_sim::{Conditions, fly, library};
//!
//! let scenario = library::find("two-goals").expect("it is built in")?;
//! let record = fly(&scenario, Conditions::default(), &mut ())?;
//! assert!(record.outcome.is_success());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

mod battery;
pub mod beyond;
mod body;
pub mod campaign;
mod changes;
mod conventional;
mod faults;
mod flight;
mod fly;
mod learn;
pub mod library;
mod log;
pub mod manipulation;
mod news;
pub mod notebook;
mod phases;
mod progress;
mod radio;
mod random;
mod record;
mod referee;
pub mod reproduce;
mod robot;
mod scenario;
mod series;
pub mod show;
pub mod statistics;
pub mod task;
mod team;
mod testbed;
pub mod tree;
mod words;
mod workers;
mod world;

pub use faults::Faults;
pub use flight::{Flight, NavigatorFlight, Reading};
pub use fly::{Audience, Conditions, Scene, fly};
pub use learn::{Learned, MoveRatio, RobotRatios};
pub use log::{Attempt, ExecutionLog, LogError, Logbook};
pub use news::News;
pub use phases::{Chosen, Phase};
pub use radio::{KEY, Traffic};
pub use random::Random;
pub use record::{Activity, Dated, Outcome, Record, RobotRecord, TOGETHER};
pub use referee::Collisions;
pub use robot::AnyRobot;
pub use scenario::{
    Effect, Event, Floor, Inference, MAX_CELLS, MAX_PATHS, MAX_TICKS, Radio, Robot, Scenario, ScenarioError,
    Wear, When,
};
pub use series::{Mission, Series, fly_series};
pub use team::{Navigating, Pilot, TeamError};
pub use testbed::Testbed;

/// The code in the README and in the documents is compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
#[doc = include_str!("../../docs/inference.md")]
struct Documents;
