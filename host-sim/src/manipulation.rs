//! Two robots bring a bottle and a plate together: the paper's section 6.2 in simulation.
//!
//! ```text
//! RunTerms ─► run ─► Run        seed, trees, disturbances; the mission; the record
//!              │
//!              ├─ World         the truth: places of robots and things, readings, failures
//!              ├─ Robot         a tree from a file with its skills, inferring or conventional
//!              └─ Radio         the only way between them
//! ```
//!
//! [`CampaignRuns`] runs the mission for many seeds and gives rates and means with their intervals,
//! [`compare`] does so for inference trees and conventional ones side by side. The trees are files
//! of [`tree::library`](crate::tree::library), bound to the robots' skills by the names of their
//! leaves; [`Trees::sizes`] counts them.

mod campaign;
mod comparison;
mod conventional;
mod narration;
mod record;
mod robot;
mod run;
mod sense;
mod skill;
pub mod tables;
mod terms;
mod trees;

pub use campaign::{CampaignRuns, Findings};
pub use comparison::{CONTENDERS, Compared, Contender, LEVELS, compare};
pub use narration::narrate;
pub use record::{ActionCounts, Decided, RobotTick, Run, Thought, TickRecord};
pub use run::{Detail, RunError, run};
pub use terms::{Disturbances, Order, Preset, RunTerms, Trees, Trust};
pub use trees::TreeSize;
