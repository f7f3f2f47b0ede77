//! What a navigating robot says of itself to whoever watches.

use super::{Cause, Navigation, Round, Stage};
use crate::grid::{Cell, Path};

/// A navigating robot's state after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Report {
    /// What it is doing, as its teammates are told.
    pub stage: Stage,
    /// The joint decision it is in.
    pub round: Round,
    /// The goal it has chosen.
    pub goal: Option<Cell>,
    /// The path it has chosen, from where it stood when the round began; its
    /// [`cells`](crate::grid::Path::cells) need the map.
    pub path: Path,
    /// How many moves of the path are done.
    pub step: usize,
    /// The posterior probability of the joint policy that the choice belongs to.
    pub probability: f32,
    /// The most likely cell.
    pub cell: Cell,
    /// The probability of that cell.
    pub confidence: f32,
    /// The surprise of the last reading, -ln P(o); `None` when the reading was impossible.
    pub surprise: Option<f32>,
    /// The way-point that it is to visit next.
    pub waypoint: Option<Cell>,
    /// Why it opened the round that it is in, if it did.
    pub cause: Option<Cause>,
}

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    /// The robot's state after the last tick.
    #[must_use]
    pub fn report(&self) -> Report {
        let agreement = self.agreement();
        let (cell, confidence) = self.position();
        Report {
            stage: self.stage(),
            round: agreement.round(),
            goal: agreement.goal(),
            path: *agreement.path(),
            step: agreement.step(),
            probability: agreement.probability(),
            cell,
            confidence,
            surprise: self.surprise().ok(),
            waypoint: self.waypoints().first().copied(),
            cause: self.cause(),
        }
    }
}
