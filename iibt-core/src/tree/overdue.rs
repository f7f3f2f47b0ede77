//! Time limits that have passed, as BehaviorTree.CPP sees them: its timers halt a child in between two ticks.

use super::interrupt::halt_from;
use super::kinds::Kinds;
use super::kinds::sealed::Extra;
use super::leaves::Leaves;
use super::memory::Cell;
use super::node::Node;
use super::status::Halt;
use super::table::Row;
use crate::time::Instant;

/// Halts the children of all timeouts whose time is over, before anything is ticked. The timeouts themselves fail
/// when they are next ticked.
pub(super) fn halt_overdue<L, V, K>(
    rows: &[Row<L>],
    cells: &mut [Cell<K>],
    leaves: &mut V,
    now: Instant,
) -> Halt
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let mut result = Halt::Done;
    for (at, row) in rows.iter().enumerate() {
        let Node::Timeout(limit) = row.node() else { continue };
        let is_over = |cell: &Cell<K>| {
            limit.get() > 0 && cell.is_running() && now.since(Instant(cell.extra.get())).0 >= limit.get()
        };
        let child_runs = cells.get(at + 1).is_some_and(Cell::is_running);
        if child_runs
            && cells.get(at).is_some_and(is_over)
            && halt_from(rows, cells, leaves, now, at + 1) == Halt::Pending
        {
            result = Halt::Pending;
        }
    }
    result
}
