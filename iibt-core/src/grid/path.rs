//! Paths on a map: a start and the moves from there.

use super::{Cell, Map, Move};
use crate::actions::{ActionError, Actions};
use serde::{Deserialize, Serialize};

/// A start cell and at most [`HORIZON`](crate::actions::HORIZON) moves.
///
/// ```
/// use iibt_core::grid::{Cell, Map, Path, WaitPlace, words};
///
/// let map = Map::<{ words(7, 7) }>::new(7, 7)?;
/// let path = Path::through(&map, &[28, 29, 30].map(Cell)).ok_or("no neighbours")?;
/// assert_eq!((path.len(), path.end(&map)), (2, Cell(30)));
/// assert_eq!(path.rest(&map, 1).start, Cell(29)); // after one move
///
/// // The same way, arriving two steps later.
/// let later = path.with_waits(4, WaitPlace::AtStart).ok_or("too long")?;
/// assert!(later.cells(&map).eq([28, 28, 28, 29, 30].map(Cell)));
/// assert_eq!(Path::through(&map, &[28, 30].map(Cell)), None); // a jump
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "trajectory")]
#[doc(alias = "route")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Path {
    /// The start cell.
    pub start: Cell,
    /// The moves, as [`Move`] codes.
    pub actions: Actions,
}

impl Path {
    /// The path that stays at `start`.
    #[must_use]
    pub const fn at(start: Cell) -> Self {
        Self { start, actions: Actions::EMPTY }
    }

    /// The path through `cells`, each the same as the one before (a wait) or its neighbour on
    /// `map`.
    ///
    /// Returns `None` for no cells, for cells that are not neighbours, and for more moves than the
    /// horizon.
    #[must_use]
    pub const fn through<const W: usize>(map: &Map<W>, cells: &[Cell]) -> Option<Self> {
        let [start, rest @ ..] = cells else { return None };
        let mut path = Self::at(*start);
        let (mut here, mut rest) = (*start, rest);
        while let [next, further @ ..] = rest {
            let Some(step) = map.move_between(here, *next) else { return None };
            if path.push(step).is_err() {
                return None;
            }
            (here, rest) = (*next, further);
        }
        Some(path)
    }

    /// Appends one move.
    ///
    /// # Errors
    /// [`ActionError`] when the path is as long as the horizon.
    pub const fn push(&mut self, step: Move) -> Result<(), ActionError> {
        self.actions.push(step.code())
    }

    /// The number of moves, waits included.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.actions.len()
    }

    /// Whether the path stays where it starts without a move.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.actions.is_empty()
    }

    /// The moves in order; a code that is no move (a path from the radio may have one) is a wait.
    pub fn moves(&self) -> impl Iterator<Item = Move> + '_ {
        self.actions.iter().map(|code| Move::from_code(code).unwrap_or(Move::Wait))
    }

    /// The cells in order, the start first: one more than there are moves.
    pub fn cells<'a, const W: usize>(&'a self, map: &'a Map<W>) -> impl Iterator<Item = Cell> + 'a {
        let mut here = self.start;
        core::iter::once(here).chain(self.moves().map(move |step| {
            if step != Move::Wait {
                here = map.neighbour(here, step);
            }
            here
        }))
    }

    /// Returns the cell at every step from the start on, without end: after its last move a robot
    /// stays.
    pub fn timeline<'a, const W: usize>(&'a self, map: &'a Map<W>) -> impl Iterator<Item = Cell> + 'a {
        let mut here = self.start;
        let mut cells = self.cells(map);
        core::iter::from_fn(move || {
            here = cells.next().unwrap_or(here);
            Some(here)
        })
    }

    /// The cell after `step` moves; past the end, the last cell.
    #[must_use]
    pub fn cell_at<const W: usize>(&self, map: &Map<W>, step: usize) -> Cell {
        self.cells(map).take(step.saturating_add(1)).last().unwrap_or(self.start)
    }

    /// The cell where the path ends.
    #[must_use]
    pub fn end<const W: usize>(&self, map: &Map<W>) -> Cell {
        self.cell_at(map, self.len())
    }

    /// The rest of the path after `done` moves; past the end only the last cell.
    #[must_use]
    pub fn rest<const W: usize>(&self, map: &Map<W>, done: usize) -> Self {
        let mut rest = Self::at(self.cell_at(map, done));
        for step in self.moves().skip(done) {
            let _ = rest.push(step); // never longer than this path
        }
        rest
    }

    /// This path and then the moves of another one, which should begin where this one ends; `None`
    /// when they are more than the horizon has room for.
    #[must_use]
    pub fn then(&self, next: &Self) -> Option<Self> {
        let mut whole = *self;
        for code in next.actions.iter() {
            whole.actions.push(code).ok()?;
        }
        Some(whole)
    }

    /// Whether a robot can follow the path: it starts on a free cell, every code is a move, and
    /// every move leads to a free cell of the map rather than into an obstacle or the border.
    #[must_use]
    pub fn is_open<const W: usize>(&self, map: &Map<W>) -> bool {
        let mut here = self.start;
        map.is_free(here)
            && self.actions.iter().all(|code| {
                let Some(step) = Move::from_code(code) else { return false };
                let before = here;
                here = map.neighbour(before, step);
                map.is_free(here) && (step == Move::Wait || here != before)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::super::pictures::{drawn, paper};
    use super::*;
    use crate::actions::HORIZON;
    use std::vec::Vec;

    fn path(cells: &[u16]) -> Path {
        let cells: Vec<Cell> = cells.iter().copied().map(Cell).collect();
        Path::through(&paper(&[]), &cells).unwrap()
    }

    fn numbers(cells: impl Iterator<Item = Cell>) -> Vec<u16> {
        cells.map(|cell| cell.0).collect()
    }

    #[test]
    fn goes_through_the_cells_it_was_made_of() {
        let path = path(&[28, 29, 29, 22, 23]);
        assert_eq!(numbers(path.cells(&paper(&[]))), [28, 29, 29, 22, 23]);
        assert_eq!(numbers(path.timeline(&paper(&[])).take(7)), [28, 29, 29, 22, 23, 23, 23]);
        assert_eq!([0, 3, 4, 9].map(|step| path.cell_at(&paper(&[]), step).0), [28, 22, 23, 23]);
    }

    #[test]
    fn does_not_jump_and_does_not_outgrow_the_horizon() {
        let map = paper(&[]);
        assert_eq!(Path::through(&map, &[]), None);
        assert_eq!(Path::through(&map, &[Cell(6), Cell(7)]), None);
        assert_eq!(Path::through(&map, &[Cell(3); HORIZON + 1]).map(|path| path.len()), Some(HORIZON));
        assert_eq!(Path::through(&map, &[Cell(3); HORIZON + 2]), None);
    }

    #[test]
    fn leaves_the_rest_of_the_way() {
        let map = paper(&[]);
        let whole = path(&[28, 29, 29, 22, 23]);
        assert_eq!(whole.rest(&map, 0), whole);
        assert_eq!(whole.rest(&map, 2), path(&[29, 22, 23]));
        assert_eq!(whole.rest(&map, 4), Path::at(Cell(23)));
        assert_eq!(whole.rest(&map, 99), Path::at(Cell(23)));
    }

    #[test]
    fn goes_on_with_another_path_while_there_is_room() {
        let (first, second) = (path(&[28, 29, 29]), path(&[29, 22, 23]));
        assert_eq!(first.then(&second), Some(path(&[28, 29, 29, 22, 23])));
        assert_eq!(first.then(&Path::at(Cell(29))), Some(first));
        let long = path(&[29; HORIZON]);
        assert_eq!(Path::at(Cell(29)).then(&long), Some(long));
        assert_eq!(first.then(&long), None);
    }

    #[test]
    fn is_open_only_along_free_cells() {
        let path = path(&[28, 29, 29, 22]);
        assert!(path.is_open(&paper(&[])));
        for obstacle in [28, 29, 22] {
            assert!(!path.is_open(&paper(&[obstacle])), "{obstacle}");
        }
    }

    #[test]
    fn is_not_open_into_the_border_or_with_unknown_codes() {
        let map = drawn(&["..."]);
        for code in [Move::Up.code(), Move::Down.code(), Move::Left.code(), 5, 15] {
            let path = Path { start: Cell(0), actions: Actions::new(&[code]).unwrap() };
            assert!(!path.is_open(&map), "{code}");
            assert_eq!(path.end(&map), Cell(0));
        }
        assert!(!Path::at(Cell(3)).is_open(&map));
    }
}
