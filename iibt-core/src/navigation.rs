//! Navigation: a team on a grid whose robots come to one joint plan in a few ticks, and follow it.
//!
//! | file | what it is |
//! |---|---|
//! | `mission` | what all robots of a team know from the beginning |
//! | `unknown` | cells that may be blocked, and look-outs from which a robot sees them |
//! | `localisation` | where a robot believes it is, and how reliable its drive is |
//! | `progress` | whether its readings follow its moves |
//! | `obstacles`, `errands` | what it has seen; what it is to do before it goes to a goal |
//! | `handover` | the way-points of lost teammates |
//! | `fact`, `claim`, `intention` | what it announces |
//! | `frame_size` | how much of it fits small frames |
//! | `policies` | the joint policies that all robots make from the same facts |
//! | `team_robot` | a tick: rounds, the list, the choice, the next move |
//! | `task` | the lines of Algorithm 1 |
//! | `report`, `cause` | what logs and displays show |
//! | `experience` | learned preferences for goals |

mod cause;
mod claim;
mod combinations;
mod errands;
mod experience;
mod fact;
mod frame_size;
mod handover;
mod intention;
mod localisation;
mod mission;
mod obstacles;
mod policies;
mod progress;
mod report;
mod task;
mod team_robot;
mod unknown;

pub use cause::Cause;
pub use claim::{Blocks, Cells};
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
pub use report::{Report, Stage};
pub use task::{BLOCKED, CHARGED, JointPolicy, ON_COURSE, PRECONDITION, PROGRESS, REACHED, SERVED, VISITED};
pub use team_robot::{GridPercept, MAX_HAZARDS, Navigation};
pub use unknown::{MAX_UNKNOWNS, Unknown};
