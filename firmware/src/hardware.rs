//! What a robot controller asks of its hardware: a handful of small traits, and [`Hardware`] to hold them together.
//!
//! None of the calls waits. A board implements them on its peripherals or takes the [`adapters`](crate::adapters);
//! the simulator implements them on its world.

use iibt_core::grid::{Cell, Move};
use iibt_core::time::Instant;

/// Bytes to and from all teammates at once; framing is the controller's business.
///
/// What a robot sends may come back to it: it knows its own frames. On a shared wire or channel it is the
/// link that waits for its turn, and it may drop frames: every frame is complete, so one that is lost costs
/// time only.
pub trait Link {
    /// The next byte that has arrived, if there is one.
    fn receive(&mut self) -> Option<u8>;

    /// Takes one whole encoded frame, delimiter included, of at most
    /// [`MAX_FRAME`](iibt_core::team::MAX_FRAME) bytes; returns whether the link could take it.
    fn send(&mut self, frame: &[u8]) -> bool;
}

/// Wheels, one cell at a time.
///
/// A move is made whole or not at all, and a robot that has begun one counts as in both cells until it is
/// done. [`Move::Up`] leads to the row before, towards cell zero.
pub trait Drive {
    /// Begins one move. [`Move::Wait`] holds the robot where it is.
    fn go(&mut self, step: Move);

    /// Whether the last move is still going on: true from [`go`](Self::go) until the robot stands in the next
    /// cell. Asked once a tick; what is sensed meanwhile is not used.
    fn is_moving(&mut self) -> bool;

    /// Stops where it is, for whoever watches over the robot: the controller itself finishes its moves.
    fn stop(&mut self);
}

/// Where the robot stands.
pub trait Localiser {
    /// A reading of the robot's own cell, which may be missing or wrong; asked once a tick.
    fn locate(&mut self) -> Option<Cell>;
}

/// What stands in the way.
pub trait Scanner {
    /// A cell in view that no robot can enter, one at a time; `None` when there is no more. Asked up to
    /// [`MAX_HAZARDS`](iibt_core::team::MAX_HAZARDS) times a tick; to name one again does no harm.
    ///
    /// For what stays: the team keeps off such a cell from then on. A teammate is no obstacle.
    fn scan(&mut self) -> Option<Cell>;
}

/// How much energy is left.
pub trait Battery {
    /// The charge in percent, 0 to 100.
    fn charge(&mut self) -> u8;
}

/// A clock that never goes back, but may wrap.
pub trait Clock {
    /// The present, in the ticks that the controller's [`Settings`](crate::Settings) are given in.
    fn now(&mut self) -> Instant;
}

/// A robot's hardware, part by part.
pub trait Hardware {
    /// The radio or wire to the teammates.
    type Link: Link;
    /// The wheels.
    type Drive: Drive;
    /// The positioning.
    type Localiser: Localiser;
    /// The obstacle sensor.
    type Scanner: Scanner;
    /// The battery gauge.
    type Battery: Battery;
    /// The clock.
    type Clock: Clock;

    /// The radio or wire to the teammates.
    fn link(&mut self) -> &mut Self::Link;
    /// The wheels.
    fn drive(&mut self) -> &mut Self::Drive;
    /// The positioning.
    fn localiser(&mut self) -> &mut Self::Localiser;
    /// The obstacle sensor.
    fn scanner(&mut self) -> &mut Self::Scanner;
    /// The battery gauge.
    fn battery(&mut self) -> &mut Self::Battery;
    /// The clock.
    fn clock(&mut self) -> &mut Self::Clock;
}
