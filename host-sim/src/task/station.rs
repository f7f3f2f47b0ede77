//! The hardware of a robot that works on a table task.

use firmware::hardware::Equipment;
use iibt_core::iibt::table::{Command, MAX_SENSORS, Percept};
use iibt_core::time::Instant;

/// A robot's sensors and its actuators, as the world fills and reads them.
#[derive(Debug, Default)]
pub(crate) struct Station {
    /// The percept of this tick.
    pub(crate) percept: Percept,
    /// The command to begin.
    pub(crate) command: Option<Command>,
}

impl Station {
    /// The percept of a tick; a robot at work reads nothing.
    pub(super) fn sense(&mut self, tick: u32, busy: bool, readings: [Option<u8>; MAX_SENSORS]) {
        let readings = if busy { [None; MAX_SENSORS] } else { readings };
        *self = Self { percept: Percept { at: Instant(tick), readings, busy }, command: None };
    }
}

impl Equipment for Station {
    fn read(&mut self, sensor: usize) -> Option<u8> {
        self.percept.readings[sensor]
    }
    fn is_busy(&mut self) -> bool {
        self.percept.busy
    }
    fn begin(&mut self, command: Command) {
        self.command = Some(command);
    }
}
