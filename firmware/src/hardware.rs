//! The hardware of a robot, as a handful of small traits.
//!
//! A [`Controller`](crate::Controller) needs a [`Link`] and a [`Clock`]. The other traits are asked
//! for by the robots that use them, so a robot without wheels names none. None of the calls waits.
//! A board implements the traits on a type of its own, or puts [`adapters`](crate::adapters)
//! together in a [`Body`](crate::adapters::Body); the simulator implements them on its world.

use iibt_core::grid::{Cell, Move};
use iibt_core::iibt::table::Command;
use iibt_core::navigation::{Reading, Sighting};
use iibt_core::time::Instant;

/// A broadcast link to and from all teammates, of bytes or of packets.
///
/// On a link of bytes the controller does the framing. On a link of packets, each packet is one
/// frame without its delimiters, and [`receive`](Self::receive) has no bytes:
/// [`PacketLink`](crate::adapters::PacketLink) makes such a link of a radio.
///
/// An echo of the robot's own frames is allowed: the controller recognises them. On a shared wire
/// or channel the link waits for its turn, and it may drop frames. Every frame is complete, so a
/// lost one costs time only.
#[doc(alias = "radio")]
#[doc(alias = "transport")]
pub trait Link {
    /// Returns the next received byte, if there is one.
    fn receive(&mut self) -> Option<u8>;

    /// Moves received bytes to the front of `bytes`, as many as there are and fit; returns how
    /// many.
    ///
    /// A link that can move many at once does better than byte by byte.
    fn receive_into(&mut self, bytes: &mut [u8]) -> usize {
        let received = bytes.iter_mut().map_while(|to| {
            *to = self.receive()?;
            Some(())
        });
        received.count()
    }

    /// Moves the next received packet to the front of `packet`, and returns its length; `None` if
    /// there is none, as on a link of bytes.
    ///
    /// A packet that is longer than `packet` counts as one that fills it, which is too long for a
    /// frame. One that the link has refused itself has no bytes: the controller goes on to the
    /// next.
    fn receive_packet(&mut self, packet: &mut [u8]) -> Option<usize> {
        let _ = packet;
        None
    }

    /// Takes one whole encoded frame, delimiters included, of at most
    /// [`MAX_FRAME`](iibt_core::team::MAX_FRAME) bytes; returns whether the link could take it.
    fn send(&mut self, frame: &[u8]) -> bool;
}

/// A drive that moves one cell at a time.
///
/// A move is made whole or not at all, and a robot that has begun one counts as in both cells until
/// it is done. [`Move::Up`] leads to the row before, towards cell zero.
#[doc(alias = "actuator")]
#[doc(alias = "motor")]
pub trait Drive {
    /// Begins one move. [`Move::Wait`] holds the robot where it is.
    fn go(&mut self, step: Move);

    /// Returns whether the last move is still going on: true from [`go`](Self::go) until the robot
    /// stands in the next cell. Asked once a tick; readings of the sensors during a move are not
    /// used.
    ///
    /// A robot that has restarted between two cells still moves, until its drive has brought it to
    /// the middle of one of them: meanwhile it is silent, and its teammates keep out of both. A
    /// drive that cannot tell needs a [`Localiser`] that can.
    fn is_moving(&mut self) -> bool;

    /// Stops where it is, for an emergency stop from outside: the controller itself finishes its
    /// moves.
    fn stop(&mut self);
}

/// A sensor of the robot's own cell.
#[doc(alias = "odometry")]
#[doc(alias = "positioning")]
#[doc(alias = "localizer")]
pub trait Localiser {
    /// Returns a reading of the robot's own cell, which may be missing or wrong; asked once a tick.
    ///
    /// `None` where it does not know: after a restart if it only counts moves, and between two
    /// cells while the drive says that it stands.
    fn locate(&mut self) -> Option<Cell>;
}

/// A sensor of obstacles.
#[doc(alias = "lidar")]
#[doc(alias = "obstacle sensor")]
pub trait Scanner {
    /// Returns a cell in view that no robot can enter, one at a time; `None` when there is no more.
    ///
    /// Asked up to [`MAX_HAZARDS`](iibt_core::navigation::MAX_HAZARDS) times a tick. A cell may be
    /// named again.
    ///
    /// The team avoids such a cell until it is told that it is clear. A teammate is no obstacle,
    /// but may be reported as one: the robots know where it can be.
    fn scan(&mut self) -> Option<Cell>;

    /// Returns what is read of the [unknowns](iibt_core::navigation::Unknown) of the mission from
    /// where the robot stands, one reading at a time; `None` when there is no more. A sensor that
    /// can read none leaves this out.
    ///
    /// Asked up to [`MAX_READINGS`](iibt_core::navigation::MAX_READINGS) times a tick, when the
    /// robot stands. Readings of different ticks count as independent: one that cannot be wrong in
    /// another way than the one before it is worth no second reading.
    fn recognise(&mut self) -> Option<Reading> {
        None
    }

    /// Returns where a robot is seen that is no member of the team, one at a time; `None` when
    /// there is no more. A sensor that can tell none leaves this out.
    ///
    /// Asked up to [`MAX_UNKNOWNS`](iibt_core::navigation::MAX_UNKNOWNS) times a tick, also while
    /// the robot moves. Each is to be seen at least two cells away, diagonals included, and in
    /// every tick in which it is so near: the robot keeps out of every cell to which it may move.
    fn sight(&mut self) -> Option<Sighting> {
        None
    }

    /// Returns whether a cell is in view and free: evidence that an obstacle is gone. Asked at
    /// every tick for the obstacles that the robot remembers. A sensor that cannot tell leaves this
    /// out.
    fn is_clear(&mut self, cell: Cell) -> bool {
        let _ = cell;
        false
    }
}

/// A battery gauge.
pub trait Battery {
    /// Returns the charge in percent, 0 to 100.
    fn charge(&mut self) -> u8;
}

/// The sensors and actuators of a robot whose task is written as tables, by the numbers that they
/// have there.
#[doc(alias = "gripper")]
#[doc(alias = "actuator")]
pub trait Equipment {
    /// Returns what a sensor reads, `None` while it is silent; asked once a tick.
    fn read(&mut self, sensor: usize) -> Option<u8>;

    /// Returns whether an operator is still under way; asked once a tick. What the sensors read
    /// meanwhile is not used.
    fn is_busy(&mut self) -> bool;

    /// Begins an operator.
    fn begin(&mut self, command: Command);
}

/// A monotonic clock, which may wrap.
pub trait Clock {
    /// Returns the time in the ticks of the controller's [`Settings`](crate::Settings).
    fn now(&mut self) -> Instant;
}
