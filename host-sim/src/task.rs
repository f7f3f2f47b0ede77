//! Tasks written as tables, in simulation.
//!
//! ```text
//! TaskFile ─► tables and truth ─► fly ─► Outcome      what is flown; the flight; what came of it
//!                                  │
//!                                  ├─ World           the hidden states, what sensors read, what fails
//!                                  ├─ Controller      each robot in a simulated Station
//!                                  └─ Radio           the only way between them
//! ```

mod flight;
mod station;
mod world;

pub use flight::{Flown, Operated};
pub use world::{Goal, Truth};

pub(crate) use flight::{Flight, Worker};
pub(crate) use station::Station;

use iibt_core::iibt::table::TableTask;

/// A table task with room for any task file: 64 states, 4 robots, 256 joint policies.
pub(crate) type HostTask<'t> = TableTask<'t, 64, 4, 256>;
