//! Tasks without code: tables that run as the task of an inference node.
//!
//! ```text
//! Percept ─► q(factors) ─► facts ─► preferences ─► operators of all robots ─► posterior ─► Command
//!   peers ─► announced ──────┴──────────┘ ▲ remedies                              └─► Announcement
//! ```
//!
//! [`Tables`] have a [`Role`] for each robot, and [`TableTask`] is the [`Task`](super::Task) that
//! they describe.
//!
//! | the paper | table | what it says |
//! |---|---|---|
//! | s | [`HiddenFactor`], [`Labels`] | what is hidden, and the semantic states that follow |
//! | A | [`Sensor`] | what is read of them, and how well |
//! | U, B, table 5 | [`Operator`] | actions: preconditions, postconditions, effects, success |
//! | E | [`Operator::habit`] | which actions are likely beforehand |
//! | l | [`Fact`] | the logic variables: what a robot is sure of, what a teammate announced |
//! | f_L | [`Remedy`] | what to prefer while a precondition is missing |
//! | C, π_stop | [`Aim`], [`JointOutcome`] | what to prefer, and when to stop |
//!
//! A robot acts on what it is sure of, [`Tables::confidence`], and takes another reading until it
//! is. What it does in a tick is its part of the most probable joint policy in which its teammates
//! do what they announced. An action that has failed is chosen again, because its aim is not
//! reached.
//!
//! # A door that one robot opens
//!
//! ```
//! use iibt_core::iibt::InferenceNode;
//! use iibt_core::iibt::table::{
//!     Accuracy, Aim, Effect, Fact, Given, HiddenFactor, Labels, Operator, Percept, Postcondition,
//!     Reads, Remedy, Role, Sensor, TableTask, Tables,
//! };
//! use iibt_core::team::{Limits, Member, RobotId, Roster};
//! use iibt_core::time::{Duration, Instant};
//! use iibt_core::tree::Status;
//!
//! // Two hidden factors: where the robot is, and the door.
//! const FAR: u8 = 0;
//! const NEAR: u8 = 1;
//! const SHUT: u8 = 0;
//! const OPEN: u8 = 1;
//! // Facts, operators.
//! const IS_NEAR: u8 = 0;
//! const IS_OPEN: u8 = 1;
//! const GO: u8 = 0;
//! const PUSH: u8 = 1;
//!
//! static DOOR: Tables = Tables::new(&[Role {
//!     name: "porter",
//!     states: Labels {
//!         names: &["away", "at the door", "door open"],
//!         factors: &[0, 1],
//!         table: &[0, 2, 1, 2], // far and shut, far and open, near and shut, near and open
//!     },
//!     sensors: &[
//!         Sensor::even("odometer", Reads::Factor(0), 0.95),
//!         Sensor {
//!             name: "camera",
//!             reads: Reads::Factor(1),
//!             accuracy: Accuracy::Table(&[0.9, 0.2, 0.1, 0.8]), // it misses an open door oftener
//!         },
//!     ],
//!     operators: &[
//!         Operator {
//!             name: "go",
//!             forbids: &[IS_NEAR],
//!             brings: Postcondition::State(1, 0.9),
//!             effects: &[Effect::set(0, NEAR)],
//!             success: 0.9,
//!             ..Operator::IDLE
//!         },
//!         Operator {
//!             name: "push",
//!             requires: &[IS_NEAR],
//!             forbids: &[IS_OPEN],
//!             brings: Postcondition::State(2, 0.7),
//!             effects: &[Effect { given: &[Given::own(0, NEAR)], ..Effect::set(1, OPEN) }],
//!             success: 0.7,
//!             ..Operator::IDLE
//!         },
//!         Operator::IDLE,
//!     ],
//!     idle: 2,
//!     facts: &[Fact::sure("near", 0, &[NEAR]), Fact::sure("open", 1, &[OPEN])],
//!     remedies: &[Remedy::above_all(IS_NEAR, 1)],
//!     aims: &[Aim::new("open it", &[IS_OPEN], &[0.0, 0.0, 1.0])],
//!     ..Role::of(&[
//!         HiddenFactor::known("place", &["far", "near"]),
//!         HiddenFactor { name: "door", states: &["shut", "open"], prior: &[0.9, 0.1] },
//!     ])
//! }]);
//!
//! // The sizes of the task are those of its tables.
//! type Porter = TableTask<'static, { DOOR.states() }, { DOOR.robots() }, { DOOR.policies() }>;
//!
//! let mut task = Porter::new(&DOOR, RobotId(0), 1)?;
//! let mut node = InferenceNode::new(Duration(100));
//! let alone = Roster::new(Member::new(RobotId(0), 1)?, Limits::for_beacons(Duration(1))?);
//! let (mut place, mut door, mut begun) = (FAR, SHUT, vec![]);
//! for tick in 0..40 {
//!     let now = Instant(tick);
//!     let mut percept = Percept { at: now, ..Percept::default() };
//!     (percept.readings[0], percept.readings[1]) = (Some(place), Some(door));
//!     let status = node.tick(&mut task, &percept, alone.at(now), now);
//!     match task.command().map(|command| command.operator) {
//!         Some(GO) => (place, _) = (NEAR, begun.push("go")),
//!         // The door sticks at the first push.
//!         Some(PUSH) => {
//!             door = if begun.contains(&"push") { OPEN } else { SHUT };
//!             begun.push("push");
//!         }
//!         _ => {}
//!     }
//!     if status == Status::Success {
//!         break;
//!     }
//! }
//! assert_eq!(begun, ["go", "push", "push"]);
//! assert_eq!(task.sure(1), Some(usize::from(OPEN)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A mismatch fails the build
//!
//! This door has a fact about a third factor. The compiler says `roles[0].facts[0]: its factor does
//! not exist`.
//!
//! ```compile_fail,E0080
//! # use iibt_core::iibt::table::*;
//! static WRONG: Tables = Tables::new(&[Role {
//!     name: "porter",
//!     sensors: &[Sensor::even("camera", Reads::Factor(0), 0.9)],
//!     facts: &[Fact::sure("open", 2, &[1])],
//!     aims: &[Aim::new("open it", &[0], &[0.0, 1.0])],
//!     ..Role::of(&[HiddenFactor::unknown("door", &["shut", "open"])])
//! }]);
//! # let _ = &WRONG;
//! ```

mod announcement;
mod check;
mod definition;
mod error;
mod joint;
mod model;
mod own;
mod rounds;
mod tables;
mod task;

pub use announcement::{Announcement, TableMessage};
pub use definition::{
    Accuracy, Aim, Effect, Fact, Given, HiddenFactor, Holds, JointOutcome, Labels, MAX_FACTORS, MAX_FACTS,
    MAX_OPERATORS, MAX_SENSORS, MAX_STATES, Operator, Postcondition, Reads, Remedy, Role, Sensor, To, Wish,
};
pub use error::TablesError;
pub use joint::{MAX_POLICIES, joint_policies};
pub use rounds::TeamRounds;
pub use tables::Tables;
pub use task::{Command, JointDecision, Percept, Plan, TableTask, Wanted};
