//! Paths with added waits, so that teammates with paths of different lengths arrive together.

use super::{Move, Path};
use crate::actions::HORIZON;

/// The place on a path where a robot waits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum WaitPlace {
    /// One cell before the end: directly before the last move that is not itself a wait.
    #[default]
    BeforeLastMove,
    /// At the start of the path.
    AtStart,
    /// Directly before the move with this index; at the end of the path for an index past the last
    /// move.
    BeforeMove(u8),
}

impl Path {
    /// This path with as many waits added at `place` as give it `total` moves.
    ///
    /// Returns `None` when it has more moves than that already, or when `total` exceeds the
    /// [`HORIZON`].
    #[must_use]
    pub fn with_waits(&self, total: usize, place: WaitPlace) -> Option<Self> {
        let waits = total.checked_sub(self.len()).filter(|_| total <= HORIZON)?;
        let before = self.wait_index(place);
        let waiting = core::iter::repeat_n(Move::Wait, waits);
        let mut padded = Self::at(self.start);
        for step in self.moves().take(before).chain(waiting).chain(self.moves().skip(before)) {
            padded.push(step).ok()?;
        }
        Some(padded)
    }

    /// The index of the move before which the robot waits.
    fn wait_index(&self, place: WaitPlace) -> usize {
        match place {
            WaitPlace::AtStart => 0,
            WaitPlace::BeforeMove(index) => index.into(),
            WaitPlace::BeforeLastMove => {
                let moving = self.moves().enumerate().filter(|&(_, step)| step != Move::Wait);
                moving.last().map_or(self.len(), |(index, _)| index)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Cell;
    use super::super::pictures::paper;
    use super::*;
    use std::vec::Vec;

    fn path(cells: &[u16]) -> Path {
        let cells: Vec<Cell> = cells.iter().copied().map(Cell).collect();
        Path::through(&paper(&[]), &cells).unwrap()
    }

    #[test]
    fn waits_where_it_is_told() {
        let way = [9, 10, 17, 24];
        let table: [(WaitPlace, &[u16]); 5] = [
            (WaitPlace::BeforeLastMove, &[9, 10, 17, 17, 17, 24]),
            (WaitPlace::AtStart, &[9, 9, 9, 10, 17, 24]),
            (WaitPlace::BeforeMove(0), &[9, 9, 9, 10, 17, 24]),
            (WaitPlace::BeforeMove(1), &[9, 10, 10, 10, 17, 24]),
            (WaitPlace::BeforeMove(200), &[9, 10, 17, 24, 24, 24]),
        ];
        for (place, cells) in table {
            assert_eq!(path(&way).with_waits(5, place), Some(path(cells)), "{place:?}");
        }
    }

    #[test]
    fn gives_the_candidates_of_the_papers_second_experiment() {
        let detour = path(&[29, 22, 15, 16, 17, 24]);
        let waiting = detour.with_waits(6, WaitPlace::default());
        assert_eq!(waiting, Some(path(&[29, 22, 15, 16, 17, 17, 24])));
        let peer = path(&[1, 8, 9, 10, 17, 24]).with_waits(6, WaitPlace::BeforeMove(2)).unwrap();
        let peer = peer.with_waits(7, WaitPlace::BeforeMove(4));
        assert_eq!(peer, Some(path(&[1, 8, 9, 9, 10, 10, 17, 24])));
    }

    #[test]
    fn takes_the_last_real_move_for_the_last() {
        let padded = path(&[9, 10, 10]).with_waits(3, WaitPlace::BeforeLastMove);
        assert_eq!(padded, Some(path(&[9, 9, 10, 10])));
    }

    #[test]
    fn keeps_a_path_that_has_the_length_and_waits_on_an_empty_one() {
        let way = path(&[9, 10, 17]);
        let nowhere = Path::at(Cell(9));
        for place in [WaitPlace::BeforeLastMove, WaitPlace::AtStart, WaitPlace::BeforeMove(1)] {
            assert_eq!(way.with_waits(2, place), Some(way));
            assert_eq!(nowhere.with_waits(2, place), Some(path(&[9, 9, 9])));
        }
    }

    #[test]
    fn neither_shortens_nor_outgrows_the_horizon() {
        let way = path(&[9, 10, 17]);
        assert_eq!(way.with_waits(1, WaitPlace::AtStart), None);
        assert_eq!(way.with_waits(HORIZON + 1, WaitPlace::AtStart), None);
        assert_eq!(way.with_waits(usize::MAX, WaitPlace::AtStart), None);
        assert_eq!(way.with_waits(HORIZON, WaitPlace::AtStart).map(|path| path.len()), Some(HORIZON));
    }
}
