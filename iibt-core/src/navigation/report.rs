//! The state of a navigating robot, for displays and logs.

use super::{Cause, Navigation, Round, Stage};
use crate::grid::{Cell, Path};

/// A navigating robot's state after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Report {
    /// The stage, as announced to the teammates.
    pub stage: Stage,
    /// The number of the joint decision.
    pub round: Round,
    /// The chosen goal.
    pub goal: Option<Cell>,
    /// The chosen path, from where the robot stood when the round began; its
    /// [`cells`](crate::grid::Path::cells) need the map.
    pub path: Path,
    /// The number of moves of the path that are done.
    pub step: usize,
    /// The posterior probability of the joint policy that the choice belongs to.
    pub probability: f32,
    /// The most likely cell.
    pub cell: Cell,
    /// The probability of that cell.
    pub confidence: f32,
    /// The surprise of the last reading, -ln P(o); `None` when the reading was impossible.
    pub surprise: Option<f32>,
    /// The next way-point to visit.
    pub waypoint: Option<Cell>,
    /// The reason for which the robot opened the round, if it did.
    pub cause: Option<Cause>,
}

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    /// Returns the robot's state after the last tick.
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
