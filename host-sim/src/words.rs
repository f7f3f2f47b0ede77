//! Words that people read, shared by all who write to them.

use iibt_core::grid::Cell;

/// A number and what it counts: `1 goal`, `2 goals`.
pub(crate) fn counted(number: u32, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

/// Cells as their numbers, one after another.
pub(crate) fn route(cells: &[Cell]) -> String {
    cells.iter().map(|cell| cell.0.to_string()).collect::<Vec<_>>().join(" ")
}
