//! What a robot says about itself to whoever watches.

use iibt_core::grid::{Cell, Path};
use iibt_core::iibt::navigation::Cause;
use iibt_core::team::{Counters, Round, Status};

/// A robot's state after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Report {
    /// What it is doing, as its teammates are told.
    pub status: Status,
    /// The joint decision it is in.
    pub round: Round,
    /// The goal it has chosen.
    pub goal: Option<Cell>,
    /// The path it has chosen, from where it stood when the round began; its
    /// [`cells`](iibt_core::grid::Path::cells) need the map.
    pub path: Path,
    /// How many moves of the path are done.
    pub step: usize,
    /// The posterior probability of the joint policy that the choice belongs to.
    pub probability: f32,
    /// Where it takes itself to be.
    pub cell: Cell,
    /// How sure it is of that.
    pub confidence: f32,
    /// The surprise of the last reading, -ln P(o); `None` when the reading was impossible.
    pub surprise: Option<f32>,
    /// The way-point that it is to visit next.
    pub waypoint: Option<Cell>,
    /// Why it opened the round that it is in, if it did.
    pub cause: Option<Cause>,
    /// Frames sent.
    pub sent: u32,
    /// Frames that the link did not take.
    pub unsent: u32,
    /// Stretches of bytes that were too long for a frame.
    pub dropped: u32,
    /// What became of the frames received.
    pub received: Counters,
}
