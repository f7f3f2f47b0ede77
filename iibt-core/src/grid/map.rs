//! The map: a rectangle of free and blocked cells, one bit each.

use super::{Cell, CellSet, Move};
use core::num::NonZeroU16;

/// The 32-bit words that a map of `width` x `height` cells needs: the parameter of [`Map`].
#[must_use]
pub const fn words(width: usize, height: usize) -> usize {
    (width * height).div_ceil(32)
}

/// A rectangle of free and blocked cells in `W` words of 32 cells each; see [`words`].
///
/// ```
/// use iibt_core::grid::{Cell, Map, Move, words};
///
/// let mut map = Map::<{ words(7, 7) }>::new(7, 7)?;
/// assert!(map.block(Cell(30)));
/// assert!(!map.is_free(Cell(30)) && !map.is_free(Cell(49))); // blocked; outside
/// assert_eq!(map.neighbour(Cell(28), Move::Right), Cell(29));
/// assert_eq!(map.neighbour(Cell(28), Move::Left), Cell(28)); // the border
/// assert_eq!(map.move_between(Cell(28), Cell(21)), Some(Move::Up));
/// assert_eq!(map.manhattan(Cell(28), Cell(26)), 6);
/// assert_eq!(map.free_neighbours(Cell(29)).count(), 3); // one of four is blocked
/// # Ok::<(), iibt_core::grid::MapError>(())
/// ```
#[doc(alias = "occupancy grid")]
#[doc(alias = "grid world")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Map<const W: usize> {
    width: NonZeroU16,
    height: NonZeroU16,
    blocked: CellSet<W>,
}

/// The reason why a map is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MapError {
    /// Width or height is zero.
    #[error("the map has no cells")]
    Empty,
    /// More cells than the `W` words hold, or than cell numbers of 16 bits can name.
    #[error("the map has more cells than its type holds")]
    TooLarge,
}

impl<const W: usize> Map<W> {
    /// A map without obstacles.
    ///
    /// # Errors
    /// [`MapError::Empty`] for a zero width or height, [`MapError::TooLarge`] when the cells do not
    /// fit `W` words.
    pub const fn new(width: u16, height: u16) -> Result<Self, MapError> {
        let (Some(width), Some(height)) = (NonZeroU16::new(width), NonZeroU16::new(height)) else {
            return Err(MapError::Empty);
        };
        match width.get().checked_mul(height.get()) {
            Some(cells) if (cells as usize).div_ceil(32) <= W => {
                Ok(Self { width, height, blocked: CellSet::EMPTY })
            }
            _ => Err(MapError::TooLarge),
        }
    }

    /// The map with more cells blocked; cells outside are ignored.
    ///
    /// This is how a planner is told to stay clear of cells for one call.
    #[must_use]
    pub fn avoiding(mut self, cells: impl IntoIterator<Item = Cell>) -> Self {
        for cell in cells {
            self.block(cell);
        }
        self
    }

    /// The number of columns.
    #[must_use]
    pub const fn width(&self) -> u16 {
        self.width.get()
    }

    /// The number of rows.
    #[must_use]
    pub const fn height(&self) -> u16 {
        self.height.get()
    }

    /// The number of cells.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.width.get() as usize * self.height.get() as usize
    }

    /// Always false: a map has at least one cell.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// Whether the map has this cell.
    #[must_use]
    pub const fn contains(&self, cell: Cell) -> bool {
        cell.index() < self.len()
    }

    /// Whether a robot may stand here: a cell of the map that is not blocked.
    #[must_use]
    pub const fn is_free(&self, cell: Cell) -> bool {
        self.contains(cell) && !self.blocked.contains(cell)
    }

    /// The cells where a robot may stand.
    #[must_use]
    pub fn free_cells(&self) -> CellSet<W> {
        CellSet::first(self.len()).without(&self.blocked)
    }

    /// Blocks a cell; returns whether the map changed.
    pub const fn block(&mut self, cell: Cell) -> bool {
        self.contains(cell) && self.blocked.insert(cell)
    }

    /// Frees a cell; returns whether the map changed.
    pub const fn clear(&mut self, cell: Cell) -> bool {
        self.contains(cell) && self.blocked.remove(cell)
    }

    /// The cell one move away; at the border and outside of the map, the same cell. Obstacles are
    /// not looked at.
    #[must_use]
    pub const fn neighbour(&self, cell: Cell, step: Move) -> Cell {
        if !self.contains(cell) {
            return cell;
        }
        let (at, width) = (cell.0, self.width.get());
        match step {
            Move::Up if at >= width => Cell(at - width),
            Move::Down if at as usize + (width as usize) < self.len() => Cell(at + width),
            Move::Left if !at.is_multiple_of(width) => Cell(at - 1),
            Move::Right if !(at + 1).is_multiple_of(width) => Cell(at + 1),
            _ => cell,
        }
    }

    /// The free cells next to a cell with the moves that lead there, in the order of the move
    /// codes.
    pub fn free_neighbours(&self, cell: Cell) -> impl Iterator<Item = (Move, Cell)> + '_ {
        let moves = [Move::Up, Move::Down, Move::Left, Move::Right];
        let neighbours = moves.into_iter().map(move |step| (step, self.neighbour(cell, step)));
        neighbours.filter(move |&(_, next)| next != cell && self.is_free(next))
    }

    /// The move that leads from one cell to another, if they are the same or neighbours.
    #[must_use]
    pub const fn move_between(&self, from: Cell, to: Cell) -> Option<Move> {
        if !self.contains(from) || !self.contains(to) {
            return None;
        }
        let width = self.width.get();
        match (to.0.abs_diff(from.0), to.0 > from.0) {
            (0, _) => Some(Move::Wait),
            (by, true) if by == width => Some(Move::Down),
            (by, false) if by == width => Some(Move::Up),
            (1, true) if !to.0.is_multiple_of(width) => Some(Move::Right),
            (1, false) if !from.0.is_multiple_of(width) => Some(Move::Left),
            _ => None,
        }
    }

    /// The Manhattan distance of two cells: columns plus rows apart.
    #[must_use]
    pub fn manhattan(&self, a: Cell, b: Cell) -> u16 {
        let columns = (a.0 % self.width).abs_diff(b.0 % self.width);
        columns + (a.0 / self.width).abs_diff(b.0 / self.width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    const MAP: Map<1> = {
        let Ok(mut map) = Map::<1>::new(5, 3) else { panic!("15 cells in one word") };
        map.block(Cell(7));
        map
    };

    #[test]
    fn is_built_at_compile_time() {
        assert!(!MAP.is_free(Cell(7)) && MAP.is_free(Cell(6)) && !MAP.is_free(Cell(15)));
        assert_eq!(MAP.free_cells().len(), 14);
    }

    #[test]
    fn refuses_sizes_it_cannot_hold() {
        assert_eq!(Map::<1>::new(0, 3), Err(MapError::Empty));
        assert_eq!(Map::<1>::new(3, 0), Err(MapError::Empty));
        assert_eq!(Map::<1>::new(11, 3), Err(MapError::TooLarge));
        assert_eq!(Map::<1>::new(u16::MAX, u16::MAX), Err(MapError::TooLarge));
        assert!(Map::<1>::new(32, 1).is_ok());
    }

    #[test]
    fn blocks_a_cell_once() {
        let mut map = MAP;
        assert!(map.block(Cell(3)) && !map.block(Cell(3)) && !map.block(Cell(15)));
        assert_eq!(map, MAP.avoiding([Cell(3), Cell(7), Cell(99)]));
    }

    #[test]
    fn ends_at_every_border() {
        let around = |cell| {
            Move::ALL.map(|step| MAP.neighbour(Cell(cell), step).0) // up, down, left, right, wait
        };
        assert_eq!(around(0), [0, 5, 0, 1, 0]);
        assert_eq!(around(4), [4, 9, 3, 4, 4]);
        assert_eq!(around(10), [5, 10, 10, 11, 10]);
        assert_eq!(around(14), [9, 14, 13, 14, 14]);
        assert_eq!(around(u16::MAX), [u16::MAX; 5]);
    }

    #[test]
    fn names_the_free_neighbours() {
        let free: Vec<_> = MAP.free_neighbours(Cell(2)).collect();
        assert_eq!(free, [(Move::Left, Cell(1)), (Move::Right, Cell(3))]);
    }

    #[test]
    fn knows_the_move_between_neighbours_only() {
        assert_eq!(MAP.move_between(Cell(4), Cell(9)), Some(Move::Down));
        assert_eq!(MAP.move_between(Cell(4), Cell(4)), Some(Move::Wait));
        assert_eq!(MAP.move_between(Cell(4), Cell(5)), None);
        assert_eq!(MAP.move_between(Cell(14), Cell(15)), None);
    }

    #[test]
    fn measures_columns_plus_rows() {
        assert_eq!(MAP.manhattan(Cell(0), Cell(14)), 6);
        assert_eq!(MAP.manhattan(Cell(9), Cell(5)), 4);
    }
}
