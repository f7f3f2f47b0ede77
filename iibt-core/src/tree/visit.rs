//! The view of a node when it is ticked, and its possible decisions.
//!
//! The rules of the nodes are functions from the one to the other; they change nothing. The walk
//! asks them, and it alone changes memory and calls leaves.

use super::kinds::Kinds;
use super::kinds::sealed::Extra;
use super::memory::{NodeMemory, Slot};
use super::node::{Millis, Node};
use super::row::Row;
use super::status::Status;
use crate::time::Instant;

/// The node in row `at`, with its own memory and a view of its children.
pub(super) struct Visit<'a, L, K: Kinds> {
    pub(super) rows: &'a [Row<L>],
    pub(super) cells: &'a [NodeMemory<K>],
    pub(super) node: &'a Node<L>,
    pub(super) at: usize,
    pub(super) slot: Slot,
    /// A count, or the time at which something began.
    pub(super) extra: u32,
    pub(super) now: Instant,
}

/// The next step of the walk.
#[derive(Clone, Copy)]
pub(super) enum Step {
    /// To the child in this row.
    Enter(usize),
    /// To the parent, with the node's own status.
    Return(Status),
}

/// A side effect that a node requests before the walk continues.
#[derive(Clone, Copy)]
pub(super) enum VisitEffect {
    Nothing,
    /// Halt the child in this row and those after it.
    Halt(usize),
    /// Mark the child in this row as one that has ended and is not ticked again.
    Done(usize),
    /// Ask for the next pass at once.
    Yield,
}

/// The decision of a node: its new memory and the next step of the walk.
pub(super) struct VisitOutcome {
    pub(super) slot: Slot,
    pub(super) extra: u32,
    pub(super) effect: VisitEffect,
    pub(super) step: Step,
}

impl VisitOutcome {
    pub(super) const fn with_slot(self, slot: Slot) -> Self {
        Self { slot, ..self }
    }

    pub(super) const fn with_extra(self, extra: u32) -> Self {
        Self { extra, ..self }
    }

    /// Also halts the child in row `first` and those after it, if there is one.
    pub(super) const fn halting(self, first: Option<usize>) -> Self {
        match first {
            Some(first) => Self { effect: VisitEffect::Halt(first), ..self },
            None => self,
        }
    }

    pub(super) const fn and(self, effect: VisitEffect) -> Self {
        Self { effect, ..self }
    }
}

impl<'a, L, K: Kinds> Visit<'a, L, K> {
    /// The node in `row` and its memory, at place `at` of their tables.
    #[inline(always)]
    pub(super) fn new(
        rows: &'a [Row<L>],
        cells: &'a [NodeMemory<K>],
        row: &'a Row<L>,
        cell: &NodeMemory<K>,
        at: usize,
        now: Instant,
    ) -> Self {
        Self { rows, cells, node: &row.node, at, slot: cell.slot, extra: cell.extra.get(), now }
    }

    /// Ticks the child in row `child`.
    pub(super) const fn enter(&self, child: usize) -> VisitOutcome {
        self.decide(self.slot, Step::Enter(child))
    }

    /// As [`enter`](Self::enter), and remembers whether the child was running before.
    pub(super) fn enter_noting(&self, child: usize) -> VisitOutcome {
        self.enter(child).with_slot(self.slot.with_flag(self.is_running(child)))
    }

    /// Ends with `status`, which may be running without any child running.
    pub(super) const fn conclude(&self, status: Status) -> VisitOutcome {
        self.conclude_with(status, self.slot.only_kept())
    }

    /// Ends with `status`; idle, it keeps `rest`.
    pub(super) const fn conclude_with(&self, status: Status, rest: Slot) -> VisitOutcome {
        self.decide(rest.with_running(matches!(status, Status::Running)), Step::Return(status))
    }

    /// Is running, at the child in row `child`.
    pub(super) const fn wait(&self, child: usize) -> VisitOutcome {
        let place = Slot::waiting(self.at, child).with_skips(self.slot.skips());
        self.decide(place.with_flag(self.slot.has_flag()), Step::Return(Status::Running))
    }

    const fn decide(&self, slot: Slot, step: Step) -> VisitOutcome {
        VisitOutcome { slot, extra: self.extra, effect: VisitEffect::Nothing, step }
    }

    /// The row of the child that it waits for, its first child if none.
    pub(super) const fn place(&self) -> usize {
        self.slot.child(self.at)
    }

    /// The row of the first child.
    pub(super) const fn first(&self) -> usize {
        self.at + 1
    }

    /// The row of the child after the one in row `child`.
    pub(super) fn sibling(&self, child: usize) -> Option<usize> {
        self.rows.get(child)?.sibling()
    }

    pub(super) fn is_running(&self, row: usize) -> bool {
        self.cells.get(row).is_some_and(NodeMemory::is_running)
    }

    /// The first child that has not ended, from the one in row `child` on.
    pub(super) fn unfinished(&self, mut child: Option<usize>) -> Option<usize> {
        while let Some(row) = child
            && self.cells.get(row).is_some_and(|cell| cell.slot.is_done())
        {
            child = self.sibling(row);
        }
        child
    }

    /// Its count or measured time: `value` if it was not running.
    pub(super) const fn begun(&self, value: u32) -> u32 {
        if self.slot.is_running() { self.extra } else { value }
    }

    /// Whether `time` has passed since the instant `begun`.
    pub(super) fn has_passed(&self, begun: u32, time: Millis) -> bool {
        self.now.since(Instant(begun)).0 >= time.get()
    }
}
