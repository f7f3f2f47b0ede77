//! The hardware traits over common drivers, so that a new board seldom needs code of its own.
//!
//! [`IoLink`] makes a link of two `embedded-io` streams, `AsyncLink` one of two asynchronous ones,
//! and [`PacketLink`] one of a radio for packets. [`DifferentialDrive`] makes a drive of two motors
//! behind `embedded-hal` outputs, [`DeadReckoning`] a localiser of nothing but the moves
//! that were made, and [`VoltageGauge`] a battery gauge of a converter. [`Body`] puts a robot's
//! parts together; [`Absent`] stands for a sensor that it does not have. [`Base`] is a robot whose
//! motors and sensors sit on another microcontroller. [`FrameQueue`] is the buffer between a sender
//! that must not wait and a slow port, [`ByteQueue`] that between a port and a receiver;
//! [`PacketQueue`] and [`FrameInbox`] keep noise out of the latter.

mod absent;
#[cfg(feature = "async")]
mod async_link;
pub mod base;
mod body;
mod byte_queue;
mod dead_reckoning;
mod differential_drive;
mod frame_queue;
mod io_link;
mod packet_error;
mod packet_link;
mod packet_queue;
#[cfg(feature = "embedded-io-06")]
mod stream_06;
#[cfg(feature = "embedded-hal-nb")]
mod stream_nb;
mod voltage_gauge;

pub use absent::Absent;
#[cfg(feature = "async")]
pub use async_link::AsyncLink;
pub use base::Base;
pub use body::Body;
pub use byte_queue::ByteQueue;
pub use dead_reckoning::{Counted, DeadReckoning, OutsideMap};
pub use differential_drive::{Chassis, DifferentialDrive, Motor, Wheel};
pub use frame_queue::FrameQueue;
pub use io_link::IoLink;
pub use packet_error::{PacketCounters, PacketError};
pub use packet_link::{PacketLink, PacketRadio};
pub use packet_queue::{FrameInbox, PacketQueue};
#[cfg(feature = "embedded-io-06")]
pub use stream_06::{Error06, Stream06};
#[cfg(feature = "embedded-hal-nb")]
pub use stream_nb::StreamNb;
pub use voltage_gauge::{Samples, VoltageGauge, VoltageRange};
