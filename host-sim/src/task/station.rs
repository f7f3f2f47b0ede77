//! The hardware of a simulated robot: its end of the radio, its clock, its sensors and its actuators.

use crate::body::{Antenna, Clock};
use firmware::hardware;
use iibt_core::iibt::table::{Command, Percept};
use iibt_core::time::Instant;

/// What a robot's controller sees of the world, and what it does to it.
#[derive(Debug, Default)]
pub(crate) struct Station {
    pub(crate) link: Antenna,
    pub(crate) clock: Clock,
    /// What is sensed in this tick.
    pub(crate) percept: Percept,
    /// What is to be begun.
    pub(crate) command: Option<Command>,
}

impl hardware::Link for Station {
    fn receive(&mut self) -> Option<u8> {
        self.link.receive()
    }
    fn send(&mut self, frame: &[u8]) -> bool {
        self.link.send(frame)
    }
}

impl hardware::Clock for Station {
    fn now(&mut self) -> Instant {
        self.clock.now()
    }
}
