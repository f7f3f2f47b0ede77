//! The open list of the planner: a binary heap of cells in a fixed arena.

use super::Cell;

/// Cells by priority, at most one entry per cell, for the cells `0..S`.
///
/// Entering, moving forward and taking out cost `log2(S)` steps. Entries of equal priority come out
/// in the order of their cells.
#[derive(Clone, Debug)]
pub(super) struct OpenList<const S: usize> {
    heap: [Entry; S],
    len: usize,
    /// The place of each cell in the heap, or [`ABSENT`].
    place: [u16; S],
}

/// An entry; the order of the fields is the order of the heap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    priority: u16,
    cell: Cell,
}

const LAST: Entry = Entry { priority: u16::MAX, cell: Cell(u16::MAX) };
const ABSENT: u16 = u16::MAX;

impl<const S: usize> OpenList<S> {
    pub(super) const fn new() -> Self {
        Self { heap: [LAST; S], len: 0, place: [ABSENT; S] }
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
        self.place.fill(ABSENT);
    }

    /// Adds a cell, or moves it forward to a lower priority. Cells from `S` on are not entered.
    pub(super) fn put(&mut self, cell: Cell, priority: u16) {
        let at = match self.place.get(cell.index()) {
            None => return,
            Some(&ABSENT) => {
                self.len += 1;
                self.len - 1
            }
            Some(&place) => place.into(),
        };
        self.rise(at, Entry { priority, cell });
    }

    /// Removes the first cell if its priority is at most `limit`.
    pub(super) fn pop(&mut self, limit: u16) -> Option<Cell> {
        let first = self.entry(0);
        let shorter = self.len.checked_sub(1).filter(|_| first.priority <= limit)?;
        let last = self.entry(shorter);
        self.len = shorter;
        if let Some(place) = self.place.get_mut(first.cell.index()) {
            *place = ABSENT;
        }
        if shorter > 0 {
            self.sink(last);
        }
        Some(first.cell)
    }

    /// Places an entry at `at` or, while it precedes the one above, higher.
    fn rise(&mut self, mut at: usize, entry: Entry) {
        while at > 0 {
            let above = (at - 1) / 2;
            if self.entry(above) <= entry {
                break;
            }
            self.set(at, self.entry(above));
            at = above;
        }
        self.set(at, entry);
    }

    /// Places an entry at the top or, while one below precedes it, lower.
    fn sink(&mut self, entry: Entry) {
        let mut at = 0;
        loop {
            let (left, right) = (2 * at + 1, 2 * at + 2);
            let below = if self.entry(right) < self.entry(left) { right } else { left };
            if entry <= self.entry(below) {
                break;
            }
            self.set(at, self.entry(below));
            at = below;
        }
        self.set(at, entry);
    }

    fn entry(&self, at: usize) -> Entry {
        self.heap.get(at).filter(|_| at < self.len).copied().unwrap_or(LAST)
    }

    fn set(&mut self, at: usize, entry: Entry) {
        if let (Some(slot), Some(place)) = (self.heap.get_mut(at), self.place.get_mut(entry.cell.index())) {
            *slot = entry;
            *place = at as u16;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pictures::Random;
    use super::*;
    use std::vec::Vec;

    fn drain(open: &mut OpenList<40>) -> Vec<u16> {
        core::iter::from_fn(|| open.pop(u16::MAX)).map(|cell| cell.0).collect()
    }

    #[test]
    fn gives_the_cells_by_priority_then_number() {
        let mut random = Random(5);
        let mut open = OpenList::<40>::new();
        for _ in 0..200 {
            let mut expected = Vec::new();
            for cell in 0..random.below(41) as u16 {
                let (first, second) = (random.below(9) as u16, random.below(9) as u16);
                open.put(Cell(cell), first.max(second));
                open.put(Cell(cell), first.min(second));
                expected.push((first.min(second), cell));
            }
            expected.sort_unstable();
            let cells: Vec<u16> = expected.iter().map(|&(_, cell)| cell).collect();
            assert_eq!(drain(&mut open), cells);
        }
    }

    #[test]
    fn keeps_what_is_above_the_limit() {
        let mut open = OpenList::<40>::new();
        open.put(Cell(3), 7);
        assert_eq!(open.pop(6), None);
        assert_eq!(open.pop(7), Some(Cell(3)));
        assert_eq!(open.pop(u16::MAX), None);
    }

    #[test]
    fn forgets_everything_when_cleared_and_takes_no_cell_outside() {
        let mut open = OpenList::<40>::new();
        open.put(Cell(3), 7);
        open.clear();
        open.put(Cell(40), 1);
        assert_eq!(drain(&mut open), []);
        open.put(Cell(3), 9);
        assert_eq!(drain(&mut open), [3]);
    }
}
