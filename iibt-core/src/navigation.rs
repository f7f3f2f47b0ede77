//! Navigation: a team on a grid whose robots come to one joint plan in a few ticks, and follow it.
//!
//! | file | what it is |
//! |---|---|
//! | `mission` | what all robots of a team know from the beginning |
//! | `unknown`, `readings` | what the team does not know, and what a robot has read of it |
//! | `strangers` | robots that are no members: where they go, and where they may be next |
//! | `localisation` | where a robot believes it is, and how reliable its drive is |
//! | `progress` | whether its readings follow its moves |
//! | `obstacles`, `errands` | what it has seen; what it is to do before it goes to a goal |
//! | `handover` | the way-points of lost teammates |
//! | `fact`, `claim`, `intention` | what it announces |
//! | `frame_size` | how much of it fits small frames |
//! | `targets`, `alternatives`, `tours` | what the planner is asked for: by the facts, in worlds, and to look |
//! | `prospects`, `ways` | the worlds that are possible, and how long a team takes in each that cannot tell them apart |
//! | `outlook` | how long a plan is expected to take, and what is seen on the way |
//! | `policies` | the joint policies that all robots make from the same facts |
//! | `team_robot` | a tick: rounds, the list, the choice, the next move |
//! | `task` | the lines of Algorithm 1 |
//! | `decider` | what decides: inference, or a rule to compare it with |
//! | `report`, `cause` | what logs and displays show |
//! | `experience` | learned preferences for goals |

mod alternatives;
mod cause;
mod claim;
mod combinations;
mod decider;
mod errands;
mod experience;
mod fact;
mod frame_size;
mod handover;
mod intention;
mod localisation;
mod mission;
mod obstacles;
mod outlook;
mod policies;
mod progress;
mod prospects;
mod readings;
mod report;
mod strangers;
mod targets;
mod task;
mod team_robot;
mod tours;
mod unknown;
mod ways;

pub use cause::Cause;
pub use claim::{Blocks, Cells};
#[cfg(feature = "ablation")]
pub use decider::Decider;
pub use errands::{MAX_WAYPOINTS, VisitError};
pub use experience::Experience;
pub use fact::{Fact, Purpose};
pub use frame_size::{SMALL_FRAME_POLICIES, longest_packet};
pub use handover::PendingWaypoints;
pub use intention::Intention;
pub use localisation::{Localisation, MOVES};
pub use mission::{MAX_GOALS, MAX_PACE, Mission, MissionError};
pub use obstacles::{Announced, CellEvidence, MAX_EVIDENCE, MAX_OBSTACLES};
pub use policies::{Policies, TeamPlan};
pub use readings::AnnouncedReadings;
pub use report::{Report, Stage};
pub use strangers::Sighting;
pub use task::{
    BLOCKED, CHARGED, CURRENT, JointPolicy, ON_COURSE, PRECONDITION, PROGRESS, REACHED, SERVED, VISITED,
};
pub use team_robot::{GridPercept, MAX_HAZARDS, MAX_READINGS, Navigation};
pub use unknown::{
    Effect, MAX_UNKNOWNS, MAX_VALUES, MAX_WORLDS, Place, Reading, Says, Sight, Tells, Unknown,
};
