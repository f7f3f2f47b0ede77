//! Names and phrases shared by all output.

use iibt_core::grid::{Cell, Move};
use iibt_core::navigation::Cause;
use std::fmt::Display;

/// Returns a number and its noun: `1 goal`, `2 goals`.
pub(crate) fn counted<N: Display + PartialEq + From<u8>>(number: N, thing: &str) -> String {
    format!("{number} {thing}{}", if number == N::from(1) { "" } else { "s" })
}

/// Returns the numbers of cells, separated by spaces.
pub(crate) fn route(cells: &[Cell]) -> String {
    cells.iter().map(|cell| cell.0.to_string()).collect::<Vec<_>>().join(" ")
}

/// The names of the moves, in the order of their codes.
const MOVES: [&str; Move::ALL.len()] = ["up", "down", "left", "right", "wait"];

/// Returns the name of a move.
pub(crate) fn move_name(step: Move) -> &'static str {
    MOVES[usize::from(step.code())]
}

/// Returns the move with a name that is not a wait, or the reason why there is none.
pub(crate) fn move_called(name: &str) -> Result<Move, String> {
    let mut moves = Move::ALL.into_iter().filter(|&step| step != Move::Wait);
    moves
        .find(|&step| move_name(step) == name)
        .ok_or_else(|| format!("no move is called \"{name}\": there are up, down, left and right"))
}

/// Returns the name that is closest to a mistyped one, if one is close.
pub(crate) fn nearest(names: impl Iterator<Item = &'static str>, typed: &str) -> Option<&'static str> {
    let typed = typed.to_lowercase();
    let similarity = |known: &str| strsim::jaro_winkler(known, &typed);
    names.max_by(|a, b| similarity(a).total_cmp(&similarity(b))).filter(|known| similarity(known) > 0.7)
}

/// Returns the cause of a round in a few words.
pub(crate) const fn cause_words(cause: Cause) -> &'static str {
    match cause {
        Cause::Obstacle => "an obstacle",
        Cause::WayPoint => "a way-point",
        Cause::Battery => "a low battery",
        Cause::Free => "an errand done",
        Cause::Position => "off its path",
        Cause::Teammate => "a teammate",
        Cause::Shortfall => "a goal missed",
        Cause::Reading => "what it has read",
        Cause::NoProgress => "no progress",
    }
}
