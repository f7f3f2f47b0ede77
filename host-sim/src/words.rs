//! Words that people read, shared by all who write to them.

use iibt_core::grid::{Cell, Move};

/// A number and what it counts: `1 goal`, `2 goals`.
pub(crate) fn counted(number: u32, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

/// Cells as their numbers, one after another.
pub(crate) fn route(cells: &[Cell]) -> String {
    cells.iter().map(|cell| cell.0.to_string()).collect::<Vec<_>>().join(" ")
}

/// The names of the moves, in the order of their codes.
const MOVES: [&str; Move::ALL.len()] = ["up", "down", "left", "right", "wait"];

/// A move in one word.
pub(crate) fn move_name(step: Move) -> &'static str {
    MOVES[usize::from(step.code())]
}

/// The move with a name, or `None`.
pub(crate) fn move_called(name: &str) -> Option<Move> {
    Move::ALL.into_iter().find(|&step| move_name(step) == name)
}
