//! When a tree that is running wants to be ticked again.

use super::kinds::Kinds;
use super::kinds::sealed::Extra;
use super::leaves::Leaves;
use super::memory::Cell;
use super::node::Node;
use super::table::{Next, Row};
use crate::time::{Duration, Instant};

/// The earliest time at which a timer is due; looks at every node once.
#[inline(never)]
pub(super) fn next<L, V, K>(rows: &[Row<L>], cells: &[Cell<K>], leaves: &mut V, now: Instant) -> Next
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let mut earliest: Option<Instant> = None;
    for (at, (row, cell)) in rows.iter().zip(cells).enumerate() {
        if !cell.is_running() {
            continue;
        }
        let child_runs = cells.get(at + 1).is_some_and(Cell::is_running);
        let begun = Instant(cell.extra.get());
        let due = match &row.node {
            Node::Timeout(time) if time.get() > 0 => Some(begun.after(Duration(time.get()))),
            Node::Sleep(time) => Some(begun.after(Duration(time.get()))),
            Node::Delay(time) if !cell.slot.has_latch() => Some(begun.after(Duration(time.get()))),
            Node::RateController(time) if !child_runs => Some(begun.after(Duration(time.get()))),
            Node::Action(leaf) | Node::Inference(leaf) => leaves.deadline(leaf, now),
            _ => None,
        };
        if let Some(due) = due
            && earliest.is_none_or(|earliest| earliest.has_reached(due))
        {
            earliest = Some(due);
        }
    }
    match earliest {
        Some(due) if now.has_reached(due) => Next::Now,
        Some(due) => Next::At(due),
        None => Next::Event,
    }
}
