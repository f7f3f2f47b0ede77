//! The referee: counts collisions from the true positions.
//!
//! It has rules of its own and shares no code with the robots' check for conflicts.

use crate::scenario::Floor;
use iibt_core::grid::{Cell, Move};
use serde::Serialize;

/// The collisions so far, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Collisions {
    /// Pairs of robots in the same cell, strangers included, counted in every tick.
    pub shared: u32,
    /// Pairs of robots that went through each other.
    pub swapped: u32,
    /// Moves into an obstacle or the border.
    pub bumps: u32,
}

impl Collisions {
    /// Returns the number of all collisions.
    #[must_use]
    pub const fn total(&self) -> u32 {
        self.shared + self.swapped + self.bumps
    }

    /// Counts the collisions of one tick from the robots' cells before, their commands and their
    /// cells now. A robot between two cells is in both. Strangers come after the robots, without
    /// commands.
    pub(crate) fn judge(
        &mut self,
        floor: &Floor,
        (before, commands): (&[Cell], &[Move]),
        (after, entering): (&[Cell], &[Option<Cell>]),
    ) {
        let places = |robot: usize| [Some(after[robot]), entering[robot]].into_iter().flatten();
        for (&cell, &step) in before.iter().zip(commands) {
            self.bumps += u32::from(is_bump(floor, cell, step));
        }
        for second in 0..after.len() {
            for first in 0..second {
                let is_swap = before[first] == after[second] && before[second] == after[first];
                let is_shared = places(first).any(|cell| places(second).any(|other| other == cell));
                self.shared += u32::from(is_shared);
                self.swapped += u32::from(is_swap && !is_shared);
            }
        }
    }
}

fn is_bump(floor: &Floor, cell: Cell, step: Move) -> bool {
    let width = floor.width();
    let (row, column) = (cell.0 / width, cell.0 % width);
    let target = match step {
        Move::Wait => return false,
        Move::Up => row.checked_sub(1).map(|row| (row, column)),
        Move::Down => Some((row + 1, column)).filter(|&(row, _)| row < floor.height()),
        Move::Left => column.checked_sub(1).map(|column| (row, column)),
        Move::Right => Some((row, column + 1)).filter(|&(_, column)| column < width),
    };
    target.is_none_or(|(row, column)| !floor.is_free(Cell(row * width + column)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use Move::{Down, Left, Right, Up, Wait};

    /// A 3 x 2 floor with its last cell, 5, blocked.
    fn floor() -> Floor {
        let mut floor = Floor::new(3, 2).unwrap();
        floor.block(Cell(5));
        floor
    }

    fn judged(before: [u16; 2], commands: [Move; 2], after: [u16; 2]) -> (u32, u32, u32) {
        let mut collisions = Collisions::default();
        collisions.judge(&floor(), (&before.map(Cell), &commands), (&after.map(Cell), &[None; 2]));
        (collisions.shared, collisions.swapped, collisions.bumps)
    }

    #[test]
    fn a_robot_between_two_cells_shares_both() {
        let shared = |after: [u16; 2]| {
            let (mut collisions, after) = (Collisions::default(), after.map(Cell));
            collisions.judge(&floor(), (&after, &[Wait; 2]), (&after, &[Some(Cell(1)), None]));
            collisions.shared
        };
        assert_eq!([0, 1, 2].map(|other| shared([0, other])), [1, 1, 0]);
    }

    #[test]
    fn counts_shared_swapped_and_blocked_cells() {
        assert_eq!(judged([0, 2], [Right, Wait], [1, 2]), (0, 0, 0));
        assert_eq!(judged([0, 1], [Right, Right], [1, 2]), (0, 0, 0), "following is fine");
        assert_eq!(judged([0, 2], [Right, Left], [1, 1]), (1, 0, 0));
        assert_eq!(judged([0, 1], [Right, Left], [1, 0]), (0, 1, 0));
        assert_eq!(judged([1, 1], [Wait, Wait], [1, 1]), (1, 0, 0));
        assert_eq!(judged([2, 4], [Down, Right], [2, 4]), (0, 0, 2), "5 is blocked");
        assert_eq!(judged([2, 0], [Right, Up], [2, 0]), (0, 0, 2), "the border");
        assert_eq!(judged([3, 4], [Down, Down], [3, 4]), (0, 0, 2), "the border");
        assert_eq!(judged([0, 4], [Left, Wait], [0, 4]), (0, 0, 1), "the border");
    }
}
