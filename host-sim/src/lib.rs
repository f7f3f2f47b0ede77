//! The simulator: teams of robots that run the firmware's own controller, in worlds drawn in text
//! files.
//!
//! ```text
//! Scenario ─► fly ─► Record             the mission, the flight, the result
//!              │
//!              ├─ World                 the truth: where robots stand, what blocks their way
//!              ├─ team                  the controllers, each alone in a simulated body
//!              ├─ Radio                 the only way between them: encoded frames, lost and late
//!              └─ Collisions            the referee's count
//! ```
//!
//! Nothing depends on the time of day or on the machine: the same scenario, seed and loss give the
//! same [`Record`], byte for byte.
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

mod awaited;
mod battery;
mod beliefs;
pub mod beyond;
mod body;
pub mod campaign;
mod changes;
mod conventional;
mod draws;
pub mod families;
mod faults;
mod firmware_log;
mod flight;
mod flight_event;
mod fly;
mod frames;
#[cfg(unix)]
pub mod hil;
mod input;
mod kept_output;
mod learn;
pub mod library;
mod log;
pub mod manipulation;
pub mod missions;
pub mod notebook;
mod parallel;
mod phases;
mod progress;
mod provision;
mod radio;
mod random;
mod record;
mod recording;
mod referee;
pub mod reproduce;
mod robot;
mod scenario;
mod series;
pub mod show;
pub mod statistics;
mod stranger;
pub mod task;
mod team;
mod testbed;
mod text;
pub mod tree;
mod tree_log;
mod verdict;
mod world;

pub use awaited::Awaited;
pub use faults::Faults;
pub use firmware_log::{FirmwareLog, LogItem, LogLine, Unreadable};
pub use flight::{Flight, NavigatorFlight, Reading};
pub use flight_event::FlightEvent;
pub use fly::{Conditions, Observer, Snapshot, fly};
pub use frames::{
    ChosenParts, ChosenPolicy, HeardFrames, HeardRound, RobotPart, TaskFrames, TeamFrames, ToldChoice, Way,
};
pub use input::FileError;
pub use learn::{Learned, MoveRatio, RobotRatios};
pub use log::{Attempt, ExecutionLog, Logbook};
pub use phases::{Chosen, Phase, WeighedPolicy};
pub use provision::{ANY_SKILL, AnyPage, AnyPageTree, Provision, ProvisionError};
pub use radio::{KEY, Traffic};
pub use random::Random;
pub use record::{Activity, Record, RobotRecord, TimedEvent};
pub use recording::FrameRecording;
pub use referee::Collisions;
pub use robot::AnyRobot;
pub use scenario::{
    Device, DriveFault, Event, EventEffect, Floor, InferenceSpec, MAX_CELLS, MAX_PATHS, MAX_TICKS, Radio,
    RobotSpec, Scenario, Trigger,
};
pub use series::{Series, SeriesMission, fly_series};
pub use team::{Navigating, Pilot, TeamError};
pub use testbed::{Testbed, settings};
pub use tree_log::TreeLog;
pub use verdict::{Outcome, TOGETHER};

/// The code in the README and in the documents is compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
#[doc = include_str!("../../docs/inference.md")]
struct Documents;
