//! A robot's errands: way-points to visit before any goal.

use crate::grid::Cell;
use crate::team::rounds::View;
use heapless::Vec;

/// The most way-points that a robot keeps in mind.
pub const MAX_WAYPOINTS: usize = 4;

/// The ticks after which a way-point to which no way was found is tried again, for the first time.
const FIRST_REST: u16 = 20;

/// The most ticks between two tries; each rest is twice as long as the one before.
const LONGEST_REST: u16 = 1280;

/// Why a robot does not take a way-point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum VisitError {
    /// No robot can be there.
    #[error("the way-point p{} is outside the map or blocked", .0.0)]
    Blocked(Cell),
    /// No way of the map leads there from where the robot is.
    #[error("no way of the map leads to the way-point p{}", .0.0)]
    Unreachable(Cell),
    /// The robot has [no planner](super::Navigation) that would find a way there.
    #[error("a robot without a planner takes no way-points")]
    NoPlanner,
    /// It has as many as it can keep in mind.
    #[error("a robot has at most {MAX_WAYPOINTS} way-points")]
    TooMany,
}

/// Way-points to be visited in their order. Those to which no way was found are put off, and the
/// others come first.
#[derive(Clone, Debug, Default)]
pub(super) struct Waypoints {
    cells: Vec<Cell, MAX_WAYPOINTS>,
    /// One for each cell.
    states: Vec<State, MAX_WAYPOINTS>,
}

/// What became of a way-point so far.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// The ticks until it is tried again.
    rest: u16,
    /// How long it was put off the last time.
    last_rest: u16,
    /// The teammates that had errands too then: it is tried again as soon as one of them is done.
    rivals: View,
}

impl Waypoints {
    pub(super) const NONE: Self = Self { cells: Vec::new(), states: Vec::new() };

    /// Adds a way-point after the others.
    pub(super) fn push(&mut self, cell: Cell) -> Result<(), VisitError> {
        self.cells.push(cell).map_err(|_| VisitError::TooMany)?;
        // There is as much room as for cells.
        self.states.push(State::default()).map_err(|_| VisitError::TooMany)
    }

    /// Puts a way-point off, because no way to it was found while these teammates had errands too.
    pub(super) fn put_off(&mut self, cell: Cell, rivals: View) {
        if let Some((_, state)) = self.iter_mut().find(|(other, state)| *other == cell && state.rest == 0) {
            state.last_rest = state.last_rest.saturating_mul(2).clamp(FIRST_REST, LONGEST_REST);
            (state.rest, state.rivals) = (state.last_rest, rivals);
        }
    }

    /// Counts a tick in which these teammates have errands.
    pub(super) fn pass(&mut self, busy: View) {
        for state in &mut self.states {
            let is_free = !state.rivals.difference(busy).is_empty();
            state.rest = if is_free { 0 } else { state.rest.saturating_sub(1) };
            state.rivals = if state.rest > 0 { state.rivals } else { View::EMPTY };
        }
    }

    /// Returns the way-points, the next one first.
    pub(super) fn all(&self) -> &[Cell] {
        &self.cells
    }

    /// Returns the first way-point that is put off.
    pub(super) fn first_put_off(&self) -> Option<Cell> {
        self.iter().find(|(_, state)| state.rest > 0).map(|(cell, _)| cell)
    }

    /// Returns the first way-point that waits because it is blocked.
    pub(super) fn first_blocked(&self, is_blocked: impl Fn(Cell) -> bool) -> Option<Cell> {
        self.cells.iter().copied().find(|&cell| is_blocked(cell))
    }

    /// Returns the next way-point that is neither blocked nor put off.
    pub(super) fn next(&self, is_blocked: impl Fn(Cell) -> bool) -> Option<Cell> {
        self.iter().find(|&(cell, state)| state.rest == 0 && !is_blocked(cell)).map(|(cell, _)| cell)
    }

    /// Ticks off the way-points that a robot on `here` has come to, in their order; those that are
    /// blocked or put off wait.
    pub(super) fn tick_off(&mut self, here: Cell, is_blocked: impl Fn(Cell) -> bool) {
        let mut is_next = true;
        self.retain(|cell, state| {
            if state.rest > 0 {
                return cell != here;
            }
            let is_open = !is_blocked(cell);
            is_next &= !is_open || cell == here;
            !(is_open && is_next)
        });
    }

    /// Gives up the way-points that others visit.
    pub(super) fn give_up(&mut self, is_taken: impl Fn(Cell) -> bool) {
        self.retain(|cell, _| !is_taken(cell));
    }

    fn iter(&self) -> impl Iterator<Item = (Cell, &State)> {
        self.cells.iter().copied().zip(&self.states)
    }

    fn iter_mut(&mut self) -> impl Iterator<Item = (Cell, &mut State)> {
        self.cells.iter().copied().zip(&mut self.states)
    }

    fn retain(&mut self, mut keeps: impl FnMut(Cell, &State) -> bool) {
        let mut kept = Self::default();
        for (cell, state) in self.iter().filter(|&(cell, state)| keeps(cell, state)) {
            // There is room: they had it before.
            let _ = kept.cells.push(cell).and(kept.states.push(*state).map_err(|_| cell));
        }
        *self = kept;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waypoints(cells: &[u16]) -> Waypoints {
        let mut waypoints = Waypoints::default();
        cells.iter().for_each(|&cell| waypoints.push(Cell(cell)).unwrap());
        waypoints
    }

    #[test]
    fn way_points_are_visited_in_order_and_blocked_ones_wait() {
        let mut waypoints = waypoints(&[4, 5, 5, 6]);
        assert_eq!(waypoints.push(Cell(7)), Err(VisitError::TooMany));
        let is_blocked = |cell| cell == Cell(4);
        assert_eq!(
            (waypoints.next(is_blocked), waypoints.first_blocked(is_blocked)),
            (Some(Cell(5)), Some(Cell(4)))
        );
        waypoints.tick_off(Cell(6), is_blocked);
        assert_eq!(waypoints.all(), [4, 5, 5, 6].map(Cell), "6 is not the next one");
        waypoints.tick_off(Cell(5), is_blocked);
        assert_eq!(waypoints.all(), [4, 6].map(Cell));
        waypoints.tick_off(Cell(4), |_| false);
        waypoints.tick_off(Cell(6), |_| false);
        assert_eq!((waypoints.all(), waypoints.next(|_| false)), (&[][..], None));
    }

    #[test]
    fn one_that_is_put_off_is_tried_again_after_a_rest_that_grows() {
        let mut waypoints = waypoints(&[4, 5]);
        let rests = [0; 9].map(|_| {
            waypoints.put_off(Cell(4), View::EMPTY);
            assert_eq!(
                (waypoints.next(|_| false), waypoints.first_put_off()),
                (Some(Cell(5)), Some(Cell(4)))
            );
            let ticks = (1..2000).find(|_| {
                waypoints.pass(View::EMPTY);
                waypoints.next(|_| false) == Some(Cell(4))
            });
            ticks.unwrap()
        });
        assert_eq!(rests, [20, 40, 80, 160, 320, 640, 1280, 1280, 1280]);
        let (both, one) = (View::full(2), View::full(1));
        waypoints.put_off(Cell(4), both);
        waypoints.pass(both);
        assert_eq!(waypoints.next(|_| false), Some(Cell(5)));
        waypoints.pass(one);
        assert_eq!(waypoints.next(|_| false), Some(Cell(4)), "a teammate is done");
        waypoints.put_off(Cell(4), one);
        waypoints.tick_off(Cell(5), |_| false);
        assert_eq!(waypoints.all(), [Cell(4)], "the other one is not held up");
        waypoints.tick_off(Cell(4), |_| false);
        assert!(waypoints.all().is_empty(), "the robot has come by");
    }
}
