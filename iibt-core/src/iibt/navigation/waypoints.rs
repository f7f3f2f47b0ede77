//! Way-points: cells that a robot is told to visit on its way to a goal (π_points in the paper's table 2).
//!
//! A plan whose path leaves one out is not executed: IsArrived(points) does not hold for it. f_L then wants the
//! way-points above all goals, and the candidates are built anew so that they lead over what is wanted above all
//! goals, as they are built around what is disliked.

use super::Navigation;
use super::world::GOAL;
use crate::bounded::up_to;
use crate::grid::{Cell, Map, Path};
use heapless::Vec;

/// The most way-points a robot keeps in mind.
pub const MAX_WAYPOINTS: usize = 4;

/// Why a robot does not take a way-point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum VisitError {
    /// The cell is outside the map, blocked on it, or an obstacle in mind.
    Blocked(Cell),
    /// The robot has [`MAX_WAYPOINTS`] to visit already.
    TooMany,
}

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    /// Has the robot visit a cell before its goal, after the way-points it has already. One that is on its way calls
    /// its team to another decision.
    ///
    /// A way-point on which an obstacle is found later is left out for as long as the obstacle is in mind.
    ///
    /// # Errors
    /// [`VisitError`] when the cell cannot be visited or there are too many; nothing has changed then.
    pub fn visit(&mut self, cell: Cell) -> Result<(), VisitError> {
        if !self.mission.map.is_free(cell) || self.hazards.contains(&cell) {
            return Err(VisitError::Blocked(cell));
        }
        self.waypoints.push(cell).map_err(|_| VisitError::TooMany)
    }

    /// The way-points that are still to be visited, the next one first.
    #[must_use]
    pub fn waypoints(&self) -> &[Cell] {
        &self.waypoints
    }

    /// The way-points that no obstacle in mind stands on.
    pub(super) fn open_waypoints(&self) -> impl Iterator<Item = Cell> + Clone {
        self.waypoints.iter().copied().filter(|cell| !self.hazards.contains(cell))
    }

    /// Ticks the next way-point off if the robot is on it.
    pub(super) fn tick_off(&mut self, here: Cell) {
        let hazards = &self.hazards;
        let mut is_next = true;
        self.waypoints.retain(|cell| {
            let is_open = !hazards.contains(cell);
            is_next &= !is_open || *cell == here;
            !(is_open && is_next)
        });
    }

    /// Wants the open way-points, those not wanted yet, more by so much.
    pub(super) fn want_waypoints(&mut self, amount: f32) {
        let wanted = self.via();
        let missing: Vec<Cell, MAX_WAYPOINTS> =
            up_to(self.open_waypoints().filter(|cell| !wanted.contains(cell)));
        for (index, cell) in missing.iter().enumerate() {
            if !missing.iter().take(index).any(|before| before == cell) {
                self.preference.raise(cell.index(), amount);
            }
        }
    }

    /// The open way-points that are wanted above all goals: where candidates have to lead.
    pub(super) fn via(&self) -> Vec<Cell, MAX_WAYPOINTS> {
        up_to(self.open_waypoints().filter(|cell| self.preference.get(cell.index()) > GOAL))
    }

    /// Whether the rest of a path leads over all open way-points.
    pub(super) fn visits_all(&self, path: &Path, done: usize) -> bool {
        leads_over(&self.mission.map, path, done, self.open_waypoints())
    }
}

/// Whether the rest of a path, after so many moves, leads over these cells in their order.
pub(super) fn leads_over<const W: usize>(
    map: &Map<W>,
    path: &Path,
    done: usize,
    mut points: impl Iterator<Item = Cell>,
) -> bool {
    let mut cells = path.cells(map).skip(done).peekable();
    points.all(|point| {
        while cells.next_if(|&cell| cell != point).is_some() {}
        cells.peek().is_some()
    })
}

impl core::fmt::Display for VisitError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Blocked(cell) => {
                write!(f, "the way-point p{} is outside the map or blocked", cell.0)
            }
            Self::TooMany => write!(f, "a robot has at most {MAX_WAYPOINTS} way-points"),
        }
    }
}

impl core::error::Error for VisitError {}
