//! A robot's body: the hardware its controller works on, filled and read by the world around it.
//!
//! Within a tick a body is alone. The world puts in what the sensors read before the controller
//! ticks, and carries out what the controller has commanded afterwards.

use firmware::{adapters, hardware};
use iibt_core::grid::{Cell, Move};
use iibt_core::navigation::{Reading, Sighting};
use iibt_core::time::Instant;
use std::collections::VecDeque;

/// The hardware of one simulated robot.
pub(crate) type Body = adapters::Body<Antenna, Clock, Wheels, Localiser, Scanner, Battery>;

/// A body at the beginning of time.
pub(crate) fn body() -> Body {
    Body {
        link: Antenna::default(),
        clock: Clock::default(),
        drive: Wheels::default(),
        localiser: Localiser::default(),
        scanner: Scanner::default(),
        battery: Battery::default(),
    }
}

/// The robot's end of the radio.
#[derive(Debug, Default)]
pub struct Antenna {
    pub(crate) received: VecDeque<u8>,
    pub(crate) sent: Vec<Vec<u8>>,
    /// What was sent in the last tick of a flight.
    pub(crate) last: Vec<Vec<u8>>,
}

/// The wheels, the move they have been told to make, and whether they are still making one.
#[derive(Debug, Default)]
pub struct Wheels {
    pub(crate) command: Option<Move>,
    pub(crate) moving: bool,
}

/// The positioning, and what it reads in this tick.
#[derive(Debug, Default)]
pub struct Localiser {
    pub(crate) reading: Option<Cell>,
}

/// The obstacle sensor: what comes into view is reported first, what stays in view again and again.
#[derive(Debug, Default)]
pub struct Scanner {
    in_view: Vec<Cell>,
    unreported: VecDeque<Cell>,
    clear: Vec<Cell>,
    /// What is read of the unknowns of the mission in this tick.
    pub(crate) readings: VecDeque<Reading>,
    /// Where strangers are seen in this tick.
    pub(crate) sightings: VecDeque<Sighting>,
}

/// The battery and its charge in percent.
#[derive(Debug, Default)]
pub struct Battery {
    pub(crate) charge: u8,
}

/// The clock, which counts the simulator's ticks.
#[derive(Debug, Default)]
pub struct Clock {
    pub(crate) now: u32,
}

impl Scanner {
    /// Turns to the obstacles that are in view now, and to the cells that are empty.
    pub(crate) fn look(&mut self, in_view: Vec<Cell>, clear: Vec<Cell>) {
        self.clear = clear;
        self.unreported.retain(|cell| in_view.contains(cell));
        for &cell in in_view.iter().rev().filter(|cell| !self.in_view.contains(cell)) {
            self.unreported.push_front(cell);
        }
        if self.unreported.is_empty() {
            self.unreported.extend(&in_view);
        }
        self.in_view = in_view;
    }

    /// The obstacles that it has still to report, in order.
    pub(crate) fn to_report(&self) -> impl Iterator<Item = Cell> + '_ {
        self.unreported.iter().copied()
    }
}

impl hardware::Link for Antenna {
    fn receive(&mut self) -> Option<u8> {
        self.received.pop_front()
    }

    fn send(&mut self, frame: &[u8]) -> bool {
        self.sent.push(frame.to_vec());
        true
    }
}

impl hardware::Drive for Wheels {
    fn go(&mut self, step: Move) {
        self.command = Some(step);
    }

    fn is_moving(&mut self) -> bool {
        self.moving || self.command.is_some()
    }

    fn stop(&mut self) {
        self.command = None;
    }
}

impl hardware::Localiser for Localiser {
    fn locate(&mut self) -> Option<Cell> {
        self.reading
    }
}

impl hardware::Scanner for Scanner {
    fn scan(&mut self) -> Option<Cell> {
        self.unreported.pop_front()
    }

    fn is_clear(&mut self, cell: Cell) -> bool {
        self.clear.contains(&cell)
    }

    fn recognise(&mut self) -> Option<Reading> {
        self.readings.pop_front()
    }

    fn sight(&mut self) -> Option<Sighting> {
        self.sightings.pop_front()
    }
}

impl hardware::Battery for Battery {
    fn charge(&mut self) -> u8 {
        self.charge
    }
}

impl hardware::Clock for Clock {
    fn now(&mut self) -> Instant {
        Instant(self.now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hardware::Scanner as _;

    #[test]
    fn what_comes_into_view_is_reported_first_and_what_stays_again() {
        let mut scanner = Scanner::default();
        let mut reported = |in_view: &[u16]| {
            scanner.look(in_view.iter().copied().map(Cell).collect(), vec![]);
            scanner.scan().map(|cell| cell.0)
        };
        assert_eq!(reported(&[]), None);
        assert_eq!(reported(&[3, 5]), Some(3));
        assert_eq!(reported(&[3, 5]), Some(5));
        assert_eq!(reported(&[3, 5]), Some(3));
        assert_eq!(reported(&[3, 4, 5]), Some(4), "it is new");
        assert_eq!(reported(&[3, 4]), Some(3), "5 is out of view");
        assert_eq!(reported(&[]), None);
    }
}
