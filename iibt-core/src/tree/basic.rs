//! The walk for trees of the basic set, along the ways that the table holds.
//!
//! A way is the next row to enter or, past the end of every table, one up. A composite that was not running
//! is passed on the way up by a look at its cell.

use super::interrupt::halt_among;
use super::kinds::Kinds;
use super::leaves::{Leaves, Status};
use super::memory::{Cell, Slot};
use super::node::Node;
use super::table::{ASK, LATER, NONE, Row, UP};
use super::walk::report;
use crate::time::Instant;

/// Ticks the tree in `rows`, which has as many `cells`, in one pass.
#[inline(always)]
pub(super) fn pass<L, V, K>(rows: &[Row<L>], cells: &mut [Cell<K>], leaves: &mut V, now: Instant) -> Status
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let (mut way, mut failed) = (0, 0);
    loop {
        if let (Some(row), Some(cell)) = (rows.get(way), cells.get_mut(way)) {
            match &row.node {
                Node::Condition(leaf) => {
                    failed = usize::from(!leaves.condition(leaf, now));
                    report(leaves, now, way, Slot::IDLE, Some(ended(failed)));
                }
                Node::Action(leaf) | Node::Inference(leaf) => {
                    let before = cell.slot;
                    let status = if before.is_running() {
                        leaves.on_running(leaf, now)
                    } else {
                        leaves.on_start(leaf, now)
                    };
                    if status == Status::Running {
                        if !before.is_running() {
                            cell.slot = Slot::RUNNING;
                            report(leaves, now, way, before, Some(status));
                            suspend(rows, cells, leaves, now, way);
                        }
                        return status;
                    }
                    cell.slot = Slot::IDLE;
                    report(leaves, now, way, before, Some(status));
                    failed = usize::from(status == Status::Failure);
                }
                _ => {
                    way = cell.slot.child(way);
                    continue;
                }
            }
            way = row.way(failed);
            continue;
        }
        let up = way ^ usize::from(UP);
        if let (Some(row), Some(cell)) = (rows.get(up), cells.get(up))
            && cell.slot == Slot::IDLE
        {
            report(leaves, now, up, Slot::IDLE, Some(ended(failed)));
            way = row.way(failed);
            continue;
        }
        if way >= usize::from(LATER) {
            return ended(failed);
        }
        let asked = way >= usize::from(ASK); // in the basic set, by an inverter
        failed ^= usize::from(asked);
        way = finish(rows, cells, leaves, now, way & usize::from(NONE), failed);
    }
}

const fn ended(failed: usize) -> Status {
    if failed == 0 { Status::Success } else { Status::Failure }
}

/// Ends the tick of the inner node in row `at`: its way on. A child of it that is still running is halted: only
/// a reactive node has one.
#[inline(never)]
fn finish<L, V, K>(
    rows: &[Row<L>],
    cells: &mut [Cell<K>],
    leaves: &mut V,
    now: Instant,
    at: usize,
    failed: usize,
) -> usize
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let (Some(row), Some(cell)) = (rows.get(at), cells.get_mut(at)) else { return usize::from(LATER) };
    let before = core::mem::replace(&mut cell.slot, Slot::IDLE);
    if before.is_running() {
        halt_among(rows, cells, leaves, now, at + 1, at);
    }
    report(leaves, now, at, before, Some(ended(failed)));
    row.way(failed)
}

/// Leaves all nodes above the leaf in row `at`, which has begun to run, waiting for it. What was running before,
/// behind a reactive node, is halted.
#[inline(never)]
fn suspend<L, V, K>(rows: &[Row<L>], cells: &mut [Cell<K>], leaves: &mut V, now: Instant, mut at: usize)
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    halt_among(rows, cells, leaves, now, at + 1, 0);
    while let Some(parent) = rows.get(at).map(Row::parent) {
        let (Some(above), Some(cell)) = (rows.get(parent), cells.get_mut(parent)) else { break };
        let before = cell.slot;
        cell.slot = match above.node {
            Node::ReactiveSequence(_) | Node::ReactiveFallback(_) => Slot::RUNNING,
            _ => Slot::waiting(parent, at),
        };
        report(leaves, now, parent, before, Some(Status::Running));
        at = parent;
    }
}
