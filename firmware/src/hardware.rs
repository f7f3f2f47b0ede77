//! What robots ask of their hardware: a handful of small traits.
//!
//! A [`Controller`](crate::Controller) needs a [`Link`] and a [`Clock`]. The other traits are asked for by the
//! robots that use them, so a robot without wheels names none. None of the calls waits. A board implements the
//! traits on a type of its own, or puts [`adapters`](crate::adapters) together in a
//! [`Body`](crate::adapters::Body); the simulator implements them on its world.

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

    /// Takes one whole encoded frame, delimiters included, of at most
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
    /// [`MAX_HAZARDS`](iibt_core::navigation::MAX_HAZARDS) times a tick; to name one again does no harm.
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
