//! The walk for trees of the basic set, along the ways that the table holds.
//!
//! A way is the next row to enter or, past the end of every table, one up. A composite that was not running
//! is passed on the way up by a look at its cell.

use super::interrupt::halt_among;
use super::kinds::Kinds;
use super::leaves::Leaves;
use super::memory::Slot;
use super::node::Node;
use super::status::Status;
use super::table::{ASK, LATER, NONE, Row, UP};
use super::walk::Walk;

impl<L, V: Leaves<L> + ?Sized, K: Kinds> Walk<'_, L, V, K> {
    /// Ticks a tree of the basic set, which has as many cells as rows, in one pass.
    #[inline(never)]
    pub(super) fn basic_pass(&mut self) -> Status {
        let nodes = self.rows.len().min(self.cells.len());
        let (mut way, mut failed) = (0, 0);
        loop {
            if way < nodes
                && let (Some(row), Some(cell)) = (self.rows.get(way), self.cells.get_mut(way))
            {
                match &row.node {
                    Node::Condition(leaf) => {
                        failed = usize::from(!self.leaves.condition(leaf, self.now));
                        self.report(way, Slot::IDLE, Some(ended(failed)));
                    }
                    Node::Action(leaf) | Node::Inference(leaf) => {
                        let before = cell.slot;
                        let status = if before.is_running() {
                            self.leaves.on_running(leaf, self.now)
                        } else {
                            self.leaves.on_start(leaf, self.now)
                        };
                        if status == Status::Running {
                            if !before.is_running() {
                                cell.slot = Slot::RUNNING;
                                self.report(way, before, Some(status));
                                self.suspend(way);
                            }
                            return status;
                        }
                        cell.slot = Slot::IDLE;
                        self.report(way, before, Some(status));
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
            if up < nodes
                && let (Some(row), Some(cell)) = (self.rows.get(up), self.cells.get(up))
                && cell.slot == Slot::IDLE
            {
                self.report(up, Slot::IDLE, Some(ended(failed)));
                way = row.way(failed);
                continue;
            }
            if way >= usize::from(LATER) {
                return ended(failed);
            }
            failed ^= usize::from(way >= usize::from(ASK)); // in the basic set, by an inverter
            way = self.finish(way & usize::from(NONE), failed);
        }
    }

    /// Ends the tick of the inner node in row `at`: its way on. A child of it that is still running is halted:
    /// only a reactive node has one.
    #[inline(never)]
    fn finish(&mut self, at: usize, failed: usize) -> usize {
        let (Some(row), Some(cell)) = (self.rows.get(at), self.cells.get_mut(at)) else {
            return usize::from(LATER);
        };
        let before = core::mem::replace(&mut cell.slot, Slot::IDLE);
        if before.is_running() {
            self.halt_rows(at + 1, at);
        }
        self.report(at, before, Some(ended(failed)));
        row.way(failed)
    }

    /// Leaves all nodes above the leaf in row `at`, which has begun to run, waiting for it. What was running
    /// before, behind a reactive node, is halted.
    #[inline(never)]
    fn suspend(&mut self, mut at: usize) {
        self.halt_rows(at + 1, 0);
        while let Some(parent) = self.rows.get(at).map(Row::parent) {
            let (Some(above), Some(cell)) = (self.rows.get(parent), self.cells.get_mut(parent)) else {
                break;
            };
            let before = cell.slot;
            cell.slot = match above.node {
                Node::ReactiveSequence(_) | Node::ReactiveFallback(_) => Slot::RUNNING,
                _ => Slot::waiting(parent, at),
            };
            self.report(parent, before, Some(Status::Running));
            at = parent;
        }
    }

    /// Halts what is running in row `first` and the rows after it whose parents are in row `within` or later.
    #[inline(never)]
    pub(super) fn halt_rows(&mut self, first: usize, within: usize) {
        let _ = halt_among(self.rows, self.cells, self.leaves, self.now, first, within);
    }
}

const fn ended(failed: usize) -> Status {
    if failed == 0 { Status::Success } else { Status::Failure }
}
