//! Sets of cells, one bit each.

use super::Cell;

/// A set of cells in `W` words of 32 cells each; see [`words`](super::words).
///
/// Cells from `32 * W` on are in no set: inserting one changes nothing.
///
/// ```
/// use iibt_core::grid::{Cell, CellSet, words};
///
/// let mut near = CellSet::<{ words(7, 7) }>::EMPTY;
/// for cell in [21, 29, 35] {
///     near.insert(Cell(cell));
/// }
/// let mut taken = CellSet::EMPTY;
/// taken.insert(Cell(29));
/// assert!(near.without(&taken).iter().eq([Cell(21), Cell(35)]));
/// assert_eq!((near.union(&taken).len(), near.intersection(&taken).len()), (3, 1));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CellSet<const W: usize> {
    words: [u32; W],
}

impl<const W: usize> CellSet<W> {
    /// The set without cells.
    pub const EMPTY: Self = Self { words: [0; W] };

    /// The first `count` cells, or all that a set can hold if there are fewer.
    #[must_use]
    pub(super) fn first(count: usize) -> Self {
        let mut set = Self::EMPTY;
        for (index, word) in set.words.iter_mut().enumerate() {
            let here = count.saturating_sub(32 * index).min(32) as u32;
            *word = u32::MAX.checked_shr(32 - here).unwrap_or(0);
        }
        set
    }

    /// Whether the cell is in the set.
    #[must_use]
    pub const fn contains(&self, cell: Cell) -> bool {
        let word = cell.index() / 32;
        word < W && self.words[word] & bit(cell) != 0
    }

    /// Adds a cell; returns whether the set changed.
    pub const fn insert(&mut self, cell: Cell) -> bool {
        let word = cell.index() / 32;
        if word >= W {
            return false;
        }
        let before = self.words[word];
        self.words[word] = before | bit(cell);
        self.words[word] != before
    }

    /// Takes a cell out; returns whether it was there.
    pub const fn remove(&mut self, cell: Cell) -> bool {
        let was_there = self.contains(cell);
        if was_there {
            self.words[cell.index() / 32] &= !bit(cell);
        }
        was_there
    }

    /// How many cells there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Whether there is no cell.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|&word| word == 0)
    }

    /// The cells in the order of their numbers.
    pub fn iter(&self) -> impl Iterator<Item = Cell> + '_ {
        self.words.iter().enumerate().flat_map(|(index, &word)| {
            let mut left = word;
            core::iter::from_fn(move || {
                let lowest = left.checked_ilog2().map(|_| left.trailing_zeros())?;
                left &= left - 1;
                Some(Cell((32 * index) as u16 + lowest as u16))
            })
        })
    }

    /// The cells of either set.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        self.zip(other, |ours, theirs| ours | theirs)
    }

    /// The cells of both sets.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        self.zip(other, |ours, theirs| ours & theirs)
    }

    /// The cells of this set that are not in the other.
    #[must_use]
    pub fn without(&self, other: &Self) -> Self {
        self.zip(other, |ours, theirs| ours & !theirs)
    }

    /// The cells of this set, and those whose number is one higher or lower, but for the steps out
    /// of the last column to the one side and out of the first column to the other.
    #[inline]
    pub(super) fn beside(&self, first_column: &Self, last_column: &Self) -> Self {
        let right = self.without(last_column);
        let left = self.without(first_column);
        let mut beside = *self;
        let mut below = 0;
        for (to, &word) in beside.words.iter_mut().zip(&right.words) {
            *to |= word << 1 | below >> 31;
            below = word;
        }
        let mut above = 0;
        for (to, &word) in beside.words.iter_mut().zip(&left.words).rev() {
            *to |= word >> 1 | above << 31;
            above = word;
        }
        beside
    }

    /// Adds every cell of another set moved to the number `by` higher; numbers past the end of the
    /// set are dropped.
    #[inline]
    pub(super) fn add_raised(&mut self, other: &Self, by: usize) {
        if by < 32 { self.raise(other, 0, by) } else { self.raise(other, by / 32, by % 32) }
    }

    #[inline(always)]
    fn raise(&mut self, other: &Self, words: usize, bits: usize) {
        let mut below = 0;
        for (to, &word) in self.words.get_mut(words..).unwrap_or_default().iter_mut().zip(&other.words) {
            *to |= word << bits | below >> 1 >> (31 - bits);
            below = word;
        }
    }

    /// Adds every cell of another set moved to the number `by` lower; numbers below zero are
    /// dropped.
    #[inline]
    pub(super) fn add_lowered(&mut self, other: &Self, by: usize) {
        if by < 32 { self.lower(other, 0, by) } else { self.lower(other, by / 32, by % 32) }
    }

    #[inline(always)]
    fn lower(&mut self, other: &Self, words: usize, bits: usize) {
        let mut above = 0;
        let raised = other.words.get(words..).unwrap_or_default();
        for (to, &word) in self.words.iter_mut().zip(raised).rev() {
            *to |= word >> bits | above << 1 << (31 - bits);
            above = word;
        }
    }

    #[inline]
    fn zip(&self, other: &Self, combine: impl Fn(u32, u32) -> u32) -> Self {
        let mut combined = Self::EMPTY;
        for (to, (&ours, &theirs)) in combined.words.iter_mut().zip(self.words.iter().zip(&other.words)) {
            *to = combine(ours, theirs);
        }
        combined
    }
}

impl<const W: usize> Default for CellSet<W> {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl<const W: usize> FromIterator<Cell> for CellSet<W> {
    fn from_iter<I: IntoIterator<Item = Cell>>(cells: I) -> Self {
        let mut set = Self::EMPTY;
        for cell in cells {
            set.insert(cell);
        }
        set
    }
}

const fn bit(cell: Cell) -> u32 {
    1 << (cell.0 % 32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn set(cells: &[u16]) -> CellSet<3> {
        cells.iter().copied().map(Cell).collect()
    }

    fn numbers(set: &CellSet<3>) -> Vec<u16> {
        set.iter().map(|cell| cell.0).collect()
    }

    #[test]
    fn holds_what_was_inserted_in_order() {
        let cells = set(&[95, 0, 31, 64, 32, 31]);
        assert_eq!(numbers(&cells), [0, 31, 32, 64, 95]);
        assert_eq!(cells.len(), 5);
        assert!(cells.contains(Cell(32)) && !cells.contains(Cell(33)));
    }

    #[test]
    fn holds_nothing_past_its_words() {
        let mut cells = set(&[96, 1000, u16::MAX]);
        assert!(cells.is_empty() && !cells.contains(Cell(96)));
        assert!(cells.insert(Cell(95)) && !cells.insert(Cell(95)) && !cells.insert(Cell(96)));
        assert!(cells.remove(Cell(95)) && !cells.remove(Cell(95)) && !cells.remove(Cell(96)));
        assert!(cells.is_empty());
    }

    #[test]
    fn shifts_as_every_single_cell_does() {
        let cells = [0, 1, 30, 31, 32, 33, 63, 64, 80, 95];
        for by in 0..=100 {
            let up: Vec<u16> = cells.iter().map(|cell| cell + by).filter(|&cell| cell < 96).collect();
            let down: Vec<u16> = cells.iter().filter_map(|cell| cell.checked_sub(by)).collect();
            let (mut raised, mut lowered) = (CellSet::EMPTY, CellSet::EMPTY);
            raised.add_raised(&set(&cells), by.into());
            lowered.add_lowered(&set(&cells), by.into());
            assert_eq!(numbers(&raised), up, "raised by {by}");
            assert_eq!(numbers(&lowered), down, "lowered by {by}");
        }
    }

    #[test]
    fn combines_cell_by_cell() {
        let (ours, theirs) = (set(&[1, 40, 70]), set(&[40, 71]));
        assert_eq!(numbers(&ours.union(&theirs)), [1, 40, 70, 71]);
        assert_eq!(numbers(&ours.intersection(&theirs)), [40]);
        assert_eq!(numbers(&ours.without(&theirs)), [1, 70]);
    }

    #[test]
    fn begins_with_the_first_cells() {
        for count in 0..=96 {
            assert_eq!(numbers(&CellSet::first(count)), (0..count as u16).collect::<Vec<_>>());
        }
        assert_eq!(CellSet::<3>::first(200).len(), 96);
    }
}
