//! Cells of several robots at several steps.

use super::super::Cell;

/// The cells of all robots at every layer or step.
pub(super) type Table<const L: usize, const N: usize> = [[Cell; N]; L];

/// No cell: larger than the number of any cell of a map.
pub(super) const NOWHERE: Cell = Cell(u16::MAX);

/// The cell of a path at a layer or step.
pub(super) fn cell<const L: usize, const N: usize>(table: &Table<L, N>, at: usize, path: usize) -> Cell {
    table.get(at).and_then(|cells| cells.get(path)).copied().unwrap_or(NOWHERE)
}

/// Sets the cell of a path.
pub(super) fn set<const L: usize, const N: usize>(table: &mut Table<L, N>, at: usize, path: usize, to: Cell) {
    if let Some(slot) = table.get_mut(at).and_then(|cells| cells.get_mut(path)) {
        *slot = to;
    }
}

/// The cells of a path from a layer down to the lowest.
pub(super) fn column<const L: usize, const N: usize>(
    table: &Table<L, N>,
    top: usize,
    path: usize,
) -> impl Iterator<Item = Cell> + '_ {
    let layers = table.get(..=top).unwrap_or_default();
    layers.iter().rev().map(move |cells| cells.get(path).copied().unwrap_or(NOWHERE))
}
