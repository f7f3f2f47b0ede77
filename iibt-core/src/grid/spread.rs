//! All the cells one move away from a set of cells, a word of cells at a time.

use super::{Cell, CellSet, Map};

/// The free cells of a map, and its outer columns, where a move to the side must not come out on
/// the other side.
#[derive(Clone, Debug)]
pub(super) struct Spread<const W: usize> {
    width: usize,
    free: CellSet<W>,
    first_column: CellSet<W>,
    last_column: CellSet<W>,
}

impl<const W: usize> Spread<W> {
    pub(super) fn over(map: &Map<W>) -> Self {
        Self::within(map, map.free_cells())
    }

    /// The spread of a map without cells.
    pub(super) const NOTHING: Self =
        Self { width: 0, free: CellSet::EMPTY, first_column: CellSet::EMPTY, last_column: CellSet::EMPTY };

    /// The same with other free cells than the map's.
    pub(super) fn within(map: &Map<W>, free: CellSet<W>) -> Self {
        let width = map.width();
        let column = |first: u16| (0..map.height()).map(move |row| Cell(row * width + first)).collect();
        let (first_column, last_column) = (column(0), column(width - 1));
        Self { width: width.into(), free, first_column, last_column }
    }

    /// The free cells.
    pub(super) fn cells(&self) -> &CellSet<W> {
        &self.free
    }

    /// The free cells that one move, a wait included, reaches from some cell of the set.
    ///
    /// Cost: 4 shifts of `W` words.
    pub(super) fn from(&self, set: &CellSet<W>) -> CellSet<W> {
        let mut reached = set.beside(&self.first_column, &self.last_column);
        reached.add_raised(set, self.width);
        reached.add_lowered(set, self.width);
        reached.intersection(&self.free)
    }

    /// The cells beside a cell of the map, whether or not they are free, in the order of their
    /// numbers; below the last row, numbers that no cell has.
    pub(super) fn beside(&self, cell: Cell) -> impl Iterator<Item = Cell> + Clone {
        let (at, width) = (cell.0, self.width as u16);
        let left = at.checked_sub(1).filter(|_| !self.first_column.contains(cell));
        let right = at.checked_add(1).filter(|_| !self.last_column.contains(cell));
        [at.checked_sub(width), left, right, at.checked_add(width)].into_iter().flatten().map(Cell)
    }

    /// Visits a cell and every free cell that moves from there reach with the number of moves, the
    /// nearest first.
    ///
    /// Cost: linear in `W` per distance, and one visit of every cell reached.
    pub(super) fn flood(&self, from: Cell, mut visit: impl FnMut(Cell, u16)) {
        let mut reached = CellSet::EMPTY;
        let mut layer: CellSet<W> = [from].into_iter().collect();
        for distance in 0..u16::MAX {
            for cell in layer.iter() {
                visit(cell, distance);
            }
            reached = reached.union(&layer);
            layer = self.from(&layer).without(&reached);
            if layer.is_empty() {
                break;
            }
        }
    }
}

impl<const W: usize> Map<W> {
    /// Writes the number of moves from each cell to the nearest of some cells, past closed ones;
    /// `u8::MAX` where there is no way. Cells beyond the end of the table are left out.
    ///
    /// Cost: linear in `W` for each distance, and one visit of every cell.
    pub(crate) fn distances(&self, to: &CellSet<W>, closed: &CellSet<W>, table: &mut [u8]) {
        table.fill(u8::MAX);
        let spread = Spread::within(self, self.free_cells().without(closed));
        let mut layer = to.intersection(spread.cells());
        let mut reached = CellSet::EMPTY;
        for distance in 0..u8::MAX {
            for cell in layer.iter() {
                if let Some(slot) = table.get_mut(cell.index()) {
                    *slot = distance;
                }
            }
            reached = reached.union(&layer);
            layer = spread.from(&layer).without(&reached);
            if layer.is_empty() {
                break;
            }
        }
    }

    /// Returns the cells to which moves lead from a cell, that cell included.
    ///
    /// Cost: linear in `W` for each distance.
    ///
    /// ```
    /// use iibt_core::grid::{Cell, Map};
    ///
    /// let map = Map::<1>::drawn("..#.\n#.#.")?;
    /// assert!(map.connected(Cell(0)).iter().eq([0, 1, 5].map(Cell)));
    /// # Ok::<(), iibt_core::grid::DrawingError>(())
    /// ```
    #[must_use]
    pub fn connected(&self, from: Cell) -> CellSet<W> {
        let mut cells = CellSet::EMPTY;
        Spread::over(self).flood(from, |cell, _| _ = cells.insert(cell));
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::super::pictures::Random;
    use super::*;

    /// Widths from one word and a bit to several rows per word; rows are split by words in most of
    /// them.
    #[test]
    fn reaches_what_the_single_moves_reach() {
        let mut random = Random(11);
        for (width, height) in [(1, 9), (5, 5), (7, 7), (31, 4), (32, 4), (33, 3), (45, 2), (64, 2), (67, 1)]
        {
            for _ in 0..50 {
                let map: Map<4> = random.map(width, height, 25);
                let set: CellSet<4> =
                    (0..5).map(|_| random.cell(&map)).filter(|&cell| map.is_free(cell)).collect();
                let single = set.iter().flat_map(|cell| map.free_neighbours(cell).map(|(_, next)| next));
                let expected: CellSet<4> = single.chain(set.iter()).collect();
                assert_eq!(Spread::over(&map).from(&set), expected, "{map:?} from {set:?}");
            }
        }
    }

    #[test]
    fn does_not_wrap_around_rows() {
        for width in [3, 7, 31, 32, 33, 50] {
            let map: Map<4> = Map::new(width, 2).unwrap();
            let spread = Spread::over(&map);
            let from = |cell| spread.from(&[Cell(cell)].into_iter().collect());
            let (end_of_row, start_of_next) = (width - 1, width);
            assert!(!from(end_of_row).contains(Cell(start_of_next)), "right, {width} columns");
            assert!(!from(start_of_next).contains(Cell(end_of_row)), "left, {width} columns");
            assert_eq!((from(end_of_row).len(), from(start_of_next).len()), (3, 3));
        }
    }
}
