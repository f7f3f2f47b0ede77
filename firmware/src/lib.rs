//! The robot controller: everything between the hardware's traits and the core's decisions.
//!
//! ```text
//! Link ─► frames ─► Roster ──► peers ┐                            ┌─► act ─► Drive, gripper ...
//! Localiser, Scanner ... ─► sense ───┼─► behavior tree ─► choice ─┤
//! Clock ─────────────────────────────┘   (one leaf may infer)     └─► message ─► frame ─► Link
//! ```
//!
//! [`Controller`] runs any [`Robot`] on any hardware: a board, the simulator or a test stands
//! behind it, and what is simulated is what is flashed. [`Navigator`] is the robot that goes to
//! goals on a grid with its team, [`TableRobot`] one whose task is written as tables.
#![no_std]

#[cfg(test)]
extern crate std;

pub mod adapters;
pub mod bench;
#[cfg(all(feature = "board", target_os = "none"))]
pub mod board;
mod boot_counter;
mod controller;
pub mod fail_safe;
pub mod hardware;
mod link_report;
pub mod missions;
mod navigator;
pub mod page;
pub mod prelude;
mod robot;
mod settings;
mod storage;
mod table_robot;
#[cfg(feature = "defmt")]
pub mod team_member;
mod tree_trace;

pub use boot_counter::{BootCounter, EpochError};
pub use controller::Controller;
pub use link_report::LinkReport;
pub use navigator::{Navigator, Thresholds};
pub use robot::Robot;
pub use settings::Settings;
pub use storage::Storage;
pub use table_robot::{Finished, Skills, TableRobot, TaskLeaf, Turn};
