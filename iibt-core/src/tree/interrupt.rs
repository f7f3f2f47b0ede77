//! Halting.

use super::kinds::Kinds;
use super::leaves::Leaves;
use super::memory::{Cell, Slot};
use super::node::Node;
use super::status::{Halt, Status};
use super::table::Row;
use super::walk::report;
use crate::time::Instant;

/// Halts what is running among the node in row `top` and its descendants.
#[inline(never)]
pub(super) fn halt_from<L, V, K>(
    rows: &[Row<L>],
    cells: &mut [Cell<K>],
    leaves: &mut V,
    now: Instant,
    top: usize,
) -> Halt
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    halt_among(rows, cells, leaves, now, top, top)
}

/// Halts what is running in row `first` and the rows after it whose parents are in row `within` or later.
#[inline(always)]
pub(super) fn halt_among<L, V, K>(
    rows: &[Row<L>],
    cells: &mut [Cell<K>],
    leaves: &mut V,
    now: Instant,
    first: usize,
    within: usize,
) -> Halt
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let mut result = Halt::Done;
    for at in first..rows.len() {
        let (Some(row), Some(cell)) = (rows.get(at), cells.get_mut(at)) else { break };
        if at > first && row.parent() < within {
            break;
        }
        let before = cell.slot;
        cell.slot = if K::FULL { at_rest(row, before) } else { Slot::IDLE };
        if before.is_running() {
            if let Node::Action(leaf) | Node::Inference(leaf) = &row.node
                && leaves.on_halted(leaf, now) == Halt::Pending
                && K::FULL
            {
                cell.slot = Slot::STOPPING_LEAF;
                result = Halt::Pending;
            }
            report(leaves, now, at, before, None);
        }
    }
    result
}

/// What a node keeps when it is halted.
fn at_rest<L>(row: &Row<L>, before: Slot) -> Slot {
    match row.node {
        Node::SequenceWithMemory(_) => before.place(),
        Node::RoundRobin(_) if !before.is_running() => before.place(),
        Node::RunOnce { .. } => before.only_kept(),
        _ if before.is_stopping() => before,
        _ => Slot::IDLE,
    }
}

/// Asks every action that is still stopping once more.
#[cold]
#[inline(never)]
pub(super) fn go_on_halting<L, V, K>(
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
    for (row, cell) in rows.iter().zip(cells.iter_mut()) {
        if let Node::Action(leaf) | Node::Inference(leaf) = &row.node
            && cell.slot.is_stopping()
        {
            if leaves.on_halting(leaf, now) == Halt::Pending {
                result = Halt::Pending;
            } else {
                cell.slot = Slot::IDLE;
            }
        }
    }
    if let Some(root) = cells.first_mut() {
        root.slot = root.slot.with_alarm(result == Halt::Pending);
    }
    result
}

/// Tells every action to halt, idle or not, as BehaviorTree.CPP does after a halt of the whole tree.
pub(super) fn halt_all<L, V>(rows: &[Row<L>], leaves: &mut V, now: Instant) -> Halt
where
    V: Leaves<L> + ?Sized,
{
    for row in rows {
        if let Node::Action(leaf) | Node::Inference(leaf) = &row.node {
            let _ = leaves.on_halted(leaf, now);
        }
    }
    Halt::Done
}

/// The status with which a node that runs once has finished; `None` if it has not.
pub(super) const fn kept_status(slot: Slot) -> Option<Status> {
    match slot.kept() {
        code if code == Status::Success as u32 => Some(Status::Success),
        code if code == Status::Failure as u32 => Some(Status::Failure),
        _ => None,
    }
}
