//! A robot's errands: way-points to visit and a battery to charge, before any goal.

use crate::grid::Cell;
use heapless::Vec;

/// The most way-points that a robot keeps in mind.
pub const MAX_WAYPOINTS: usize = 4;

/// Why a robot does not take a way-point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum VisitError {
    /// No robot can be there.
    Blocked(Cell),
    /// It has as many as it can keep in mind.
    TooMany,
}

impl core::fmt::Display for VisitError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Blocked(cell) => write!(f, "the way-point p{} is outside the map or blocked", cell.0),
            Self::TooMany => write!(f, "a robot has at most {MAX_WAYPOINTS} way-points"),
        }
    }
}

impl core::error::Error for VisitError {}

/// Way-points to be visited in their order.
#[derive(Clone, Debug, Default)]
pub(super) struct Waypoints(Vec<Cell, MAX_WAYPOINTS>);

impl Waypoints {
    /// Adds a way-point after the others.
    pub(super) fn push(&mut self, cell: Cell) -> Result<(), VisitError> {
        self.0.push(cell).map_err(|_| VisitError::TooMany)
    }

    /// Returns the way-points, the next one first.
    pub(super) fn all(&self) -> &[Cell] {
        &self.0
    }

    /// Returns the next way-point that is not blocked.
    pub(super) fn next(&self, is_blocked: impl Fn(Cell) -> bool) -> Option<Cell> {
        self.0.iter().copied().find(|&cell| !is_blocked(cell))
    }

    /// Ticks off the way-points that a robot on `here` has come to, in their order; blocked ones
    /// wait.
    pub(super) fn tick_off(&mut self, here: Cell, is_blocked: impl Fn(Cell) -> bool) {
        let mut is_next = true;
        self.0.retain(|&cell| {
            let is_open = !is_blocked(cell);
            is_next &= !is_open || cell == here;
            !(is_open && is_next)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn way_points_are_visited_in_order_and_blocked_ones_wait() {
        let mut waypoints = Waypoints::default();
        for cell in [4, 5, 5, 6] {
            waypoints.push(Cell(cell)).unwrap();
        }
        assert_eq!(waypoints.push(Cell(7)), Err(VisitError::TooMany));
        let is_blocked = |cell| cell == Cell(4);
        assert_eq!(waypoints.next(is_blocked), Some(Cell(5)));
        waypoints.tick_off(Cell(6), is_blocked);
        assert_eq!(waypoints.all(), [4, 5, 5, 6].map(Cell), "6 is not the next one");
        waypoints.tick_off(Cell(5), is_blocked);
        assert_eq!(waypoints.all(), [4, 6].map(Cell));
        waypoints.tick_off(Cell(4), |_| false);
        waypoints.tick_off(Cell(6), |_| false);
        assert_eq!((waypoints.all(), waypoints.next(|_| false)), (&[][..], None));
    }
}
