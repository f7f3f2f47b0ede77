//! The halting of nodes.

use super::context::TickContext;
use super::kinds::Kinds;
use super::kinds::sealed::Extra;
use super::leaves::Leaves;
use super::memory::Slot;
use super::node::Node;
use super::row::Row;
use super::status::Halt;
use crate::time::Instant;

impl<L, V: Leaves<L> + ?Sized, K: Kinds> TickContext<'_, L, V, K> {
    /// Halts the whole tree.
    #[inline(always)]
    pub(super) fn halt_tree(&mut self) -> Halt {
        if K::FULL {
            return self.halt_full_tree();
        }
        self.halt(0, 0);
        Halt::Done
    }

    #[inline(never)]
    fn halt_full_tree(&mut self) -> Halt {
        let pending = self.has_pending_halt() && self.go_on_halting() == Halt::Pending;
        let is_running = self.is_running(0);
        self.stopping = pending;
        self.halt(0, 0);
        if K::COMPAT {
            if self.rows.len() == 1 && !is_running {
                self.halt_every_action(); // there the root is halted even if idle, then every node
            }
            self.halt_every_action();
        }
        self.note_pending_halt()
    }

    /// Halts what is running in row `first` and the rows after it whose parents are in row `within`
    /// or later.
    #[inline(never)]
    pub(super) fn halt(&mut self, first: usize, within: usize) {
        for at in first..self.rows.len() {
            let (Some(row), Some(cell)) = (self.rows.get(at), self.cells.get_mut(at)) else { break };
            if at > first && row.parent() < within {
                break;
            }
            let before = cell.slot;
            cell.slot = if K::FULL { at_rest(row, before) } else { Slot::IDLE };
            if before.is_running() {
                if let Node::Action(leaf) | Node::Inference(leaf) = &row.node
                    && self.leaves.on_halted(leaf, self.now) == Halt::Pending
                    && K::FULL
                {
                    cell.slot = Slot::STOPPING_LEAF;
                    self.stopping = true;
                }
                self.report(at, before, None);
            }
        }
    }

    /// Whether some action had not stopped when the tree was last ticked or halted.
    pub(super) fn has_pending_halt(&self) -> bool {
        self.cells.first().is_some_and(|root| root.slot.has_pending_halt())
    }

    /// Records in the root's memory that some action has not stopped.
    pub(super) fn note_pending_halt(&mut self) -> Halt {
        if !self.stopping {
            return Halt::Done;
        }
        self.update(0, |root| root.with_pending_halt(true));
        Halt::Pending
    }

    /// Asks every action that is still stopping again.
    #[cold]
    #[inline(never)]
    pub(super) fn go_on_halting(&mut self) -> Halt {
        let mut result = Halt::Done;
        for (row, cell) in self.rows.iter().zip(self.cells.iter_mut()) {
            if let Node::Action(leaf) | Node::Inference(leaf) = &row.node
                && cell.slot.is_stopping()
            {
                if self.leaves.on_halting(leaf, self.now) == Halt::Pending {
                    result = Halt::Pending;
                } else {
                    cell.slot = Slot::IDLE;
                }
            }
        }
        self.update(0, |root| root.with_pending_halt(result == Halt::Pending));
        result
    }

    /// Tells every action to halt, idle or not, as BehaviorTree.CPP does after a halt of the whole
    /// tree.
    fn halt_every_action(&mut self) {
        for row in self.rows {
            if let Node::Action(leaf) | Node::Inference(leaf) = &row.node {
                let _ = self.leaves.on_halted(leaf, self.now);
            }
        }
    }

    /// Halts the children of all timeouts whose time is over, before anything is ticked, as
    /// BehaviorTree.CPP does by timers between two ticks. The timeouts themselves fail when they
    /// are next ticked.
    pub(super) fn halt_overdue(&mut self) {
        for (at, row) in self.rows.iter().enumerate() {
            let (Node::Timeout(limit), Some(cell)) = (&row.node, self.cells.get(at)) else { continue };
            let elapsed = self.now.since(Instant(cell.extra.get())).0;
            let is_over = limit.get() > 0 && cell.is_running() && elapsed >= limit.get();
            if is_over && self.is_running(at + 1) {
                self.halt(at + 1, at);
            }
        }
    }
}

/// The memory that a node keeps when it is halted.
fn at_rest<L>(row: &Row<L>, before: Slot) -> Slot {
    match row.node {
        Node::SequenceWithMemory(_) => before.place(),
        Node::RoundRobin(_) if !before.is_running() => before.place(),
        Node::RunOnce { .. } => before.only_kept(),
        _ if before.is_stopping() => before,
        _ => Slot::IDLE,
    }
}
