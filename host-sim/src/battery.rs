//! The battery of a robot, drained by moves and filled by its charger.

use crate::scenario::RobotSpec;
use iibt_core::grid::Cell;

/// The battery of one robot, in percent of its capacity.
#[derive(Clone, Debug)]
pub(crate) struct BatteryState {
    charge: f64,
    drain: f64,
    charging: f64,
    charger: Option<Cell>,
}

impl BatteryState {
    pub(crate) fn of(robot: &RobotSpec) -> Self {
        Self {
            charge: f64::from(robot.battery),
            drain: robot.drain,
            charging: robot.charging,
            charger: robot.charger,
        }
    }

    /// The reading of the gauge: whole percents, rounded down.
    pub(crate) fn percent(&self) -> u8 {
        self.charge as u8
    }

    /// Whether there is nothing left to move with.
    pub(crate) fn is_empty(&self) -> bool {
        self.charge <= 0.0
    }

    /// Falls to a charge if there is more in it; returns whether there was.
    pub(crate) fn fall_to(&mut self, percent: u8) -> bool {
        let falls = self.charge > f64::from(percent);
        if falls {
            self.charge = f64::from(percent);
        }
        falls
    }

    /// Sets the charge.
    pub(crate) fn set(&mut self, percent: u8) {
        self.charge = f64::from(percent.min(100));
    }

    /// Drains the battery by a move between two cells; charges it where the robot stays on its
    /// charger.
    pub(crate) fn tick(&mut self, from: Cell, to: Cell) {
        if from != to {
            self.charge = (self.charge - self.drain).max(0.0);
        } else if self.charger == Some(to) {
            self.charge = (self.charge + self.charging).min(100.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moves_drain_it_and_standing_on_the_charger_fills_it() {
        let mut battery = BatteryState { charge: 1.0, drain: 0.75, charging: 60.0, charger: Some(Cell(2)) };
        battery.tick(Cell(0), Cell(1));
        assert_eq!((battery.percent(), battery.is_empty()), (0, false));
        battery.tick(Cell(1), Cell(1));
        assert_eq!(battery.charge, 0.25, "this is no charger");
        battery.tick(Cell(1), Cell(2));
        assert!(battery.is_empty(), "there is no less than nothing");
        battery.tick(Cell(2), Cell(2));
        assert_eq!(battery.percent(), 60);
        battery.tick(Cell(2), Cell(2));
        assert_eq!(battery.percent(), 100);
        assert!(battery.fall_to(15) && !battery.fall_to(40));
        assert_eq!(battery.percent(), 15);
    }
}
