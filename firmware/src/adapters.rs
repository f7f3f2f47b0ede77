//! The hardware traits over common drivers, so that a new board seldom needs code of its own.
//!
//! [`IoLink`] makes a link of two `embedded-io` streams, [`DifferentialDrive`] a drive of two
//! motors behind `embedded-hal` outputs, [`DeadReckoning`] a localiser of nothing but the moves
//! that were made, and [`VoltageGauge`] a battery gauge of a converter. [`Body`] puts a robot's
//! parts together; [`Absent`] stands for a sensor that it does not have. [`Base`] is a robot whose
//! motors and sensors sit on another microcontroller. [`FrameQueue`] is the buffer between a sender
//! that must not wait and a slow port, [`ByteQueue`] that between a port and a receiver.

mod absent;
pub mod base;
mod body;
mod byte_queue;
mod dead_reckoning;
mod differential_drive;
mod frame_queue;
mod io_link;
mod voltage_gauge;

pub use absent::Absent;
pub use base::Base;
pub use body::Body;
pub use byte_queue::ByteQueue;
pub use dead_reckoning::{Counted, DeadReckoning};
pub use differential_drive::{Chassis, DifferentialDrive, Motor, Wheel};
pub use frame_queue::FrameQueue;
pub use io_link::IoLink;
pub use voltage_gauge::{Samples, VoltageGauge, VoltageRange};
