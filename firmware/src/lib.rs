//! The robot controller: everything between the hardware's traits and the core's decisions.
//!
//! ```text
//! Link ─► frames ─► Roster ┐                                  ┌─► Drive
//! Localiser, Scanner ──────┼─► behavior tree ─► Navigation ───┤
//! Battery, Clock ──────────┘   (one leaf infers)              └─► frame ─► Link
//! ```
//!
//! [`Controller`] is generic over [`hardware::Hardware`]: a board, the simulator or a test stands behind it, and
//! what is simulated is what is flashed.
#![no_std]

#[cfg(test)]
extern crate std;

pub mod adapters;
pub mod benchmarks;
#[cfg(all(feature = "stm32f405", target_os = "none"))]
pub mod board;
pub mod controller;
pub mod hardware;
pub mod missions;
mod pilot;
mod report;
mod settings;

pub use controller::{Controller, ControllerError};
pub use report::Report;
pub use settings::Settings;
