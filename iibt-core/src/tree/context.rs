//! A tree with its memory and its leaves, while it is ticked or halted.

use super::kinds::Kinds;
use super::leaves::Leaves;
use super::log::StatusChange;
use super::memory::{NodeMemory, Slot};
use super::row::Row;
use super::status::Status;
use crate::time::Instant;

pub(super) struct TickContext<'a, L, V: ?Sized, K: Kinds> {
    pub(super) rows: &'a [Row<L>],
    pub(super) cells: &'a mut [NodeMemory<K>],
    pub(super) leaves: &'a mut V,
    pub(super) now: Instant,
    /// Whether an action that was halted in this pass has not stopped.
    pub(super) stopping: bool,
    /// Whether a node wants the next pass at once.
    pub(super) yielded: bool,
}

impl<'a, L, V: Leaves<L> + ?Sized, K: Kinds> TickContext<'a, L, V, K> {
    /// `None` if the memory is too short for the table.
    #[inline(always)]
    pub(super) fn new(
        rows: &'a [Row<L>],
        cells: &'a mut [NodeMemory<K>],
        leaves: &'a mut V,
        now: Instant,
    ) -> Option<Self> {
        // One length for both spares the walk every other bounds check.
        let cells = cells.get_mut(..rows.len())?;
        Some(Self { rows, cells, leaves, now, stopping: false, yielded: false })
    }

    pub(super) fn is_running(&self, at: usize) -> bool {
        self.cells.get(at).is_some_and(NodeMemory::is_running)
    }

    pub(super) fn update(&mut self, at: usize, change: impl FnOnce(Slot) -> Slot) {
        if let Some(cell) = self.cells.get_mut(at) {
            cell.slot = change(cell.slot);
        }
    }

    #[inline]
    pub(super) fn report(&mut self, at: usize, before: Slot, to: Option<Status>) {
        let from = before.is_running().then_some(Status::Running);
        if from != to {
            self.leaves.transition(StatusChange { time: self.now, node: at as u16, from, to });
        }
    }
}
