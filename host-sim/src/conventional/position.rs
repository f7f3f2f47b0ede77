//! The position of a robot without a belief: its last certain cell, the move under way, and the
//! readings it accepts.
//!
//! A reading of the cell where the last move leads is accepted at once. Any other reading is
//! accepted when it comes twice in a row: the drive has failed, or the robot was wrong. Until then
//! a moving robot counts as in either of two cells and stands still.

use iibt_core::grid::Cell;

/// The position of a robot, as far as it is known.
#[derive(Clone, Debug)]
pub(super) struct Position {
    cell: Cell,
    target: Option<Cell>,
    odd: Option<Cell>,
}

impl Position {
    pub(super) const fn at(cell: Cell) -> Self {
        Self { cell, target: None, odd: None }
    }

    /// The cell it stands in; `None` while a move is under way or not confirmed.
    pub(super) fn here(&self) -> Option<Cell> {
        self.target.is_none().then_some(self.cell)
    }

    /// The last cell it was certain of.
    pub(super) const fn last(&self) -> Cell {
        self.cell
    }

    /// Notes that a move to a neighbouring cell has begun.
    pub(super) const fn leave_for(&mut self, target: Cell) {
        self.target = Some(target);
    }

    /// Updates the position by a reading, which may be missing.
    pub(super) fn read(&mut self, reading: Option<Cell>) {
        let Some(reading) = reading else { return };
        let is_expected = reading == self.target.unwrap_or(self.cell);
        if is_expected || self.odd == Some(reading) {
            *self = Self::at(reading);
        } else {
            self.odd = Some(reading);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(start: u16, target: Option<u16>, readings: &[u16]) -> Option<u16> {
        let mut position = Position::at(Cell(start));
        if let Some(target) = target {
            position.leave_for(Cell(target));
        }
        readings.iter().for_each(|&reading| position.read(Some(Cell(reading))));
        position.here().map(|cell| cell.0)
    }

    #[test]
    fn a_reading_is_believed_where_the_move_should_have_led_or_when_it_comes_twice() {
        assert_eq!(after(1, Some(2), &[2]), Some(2));
        assert_eq!(after(1, Some(2), &[]), None, "nothing was read");
        assert_eq!(after(1, Some(2), &[1]), None, "once, the move may have failed");
        assert_eq!(after(1, Some(2), &[1, 1]), Some(1), "twice, it has");
        assert_eq!(after(1, Some(2), &[40, 2]), Some(2), "a wrong reading is passed over");
        assert_eq!(after(1, Some(2), &[40, 1, 40]), None, "not in a row");
        assert_eq!(after(1, Some(2), &[40, 40]), Some(40), "it was put elsewhere");
    }

    #[test]
    fn a_robot_that_stands_is_not_moved_by_one_wrong_reading() {
        assert_eq!(after(1, None, &[40]), Some(1));
        assert_eq!(after(1, None, &[40, 1, 40]), Some(1));
        assert_eq!(after(1, None, &[40, 40]), Some(40));
    }
}
