//! The kinds of nodes beyond the basic set: how each is entered, and what it does when a child returns.

use super::interrupt::kept_status;
use super::kinds::Kinds;
use super::kinds::sealed::Extra;
use super::leaves::Leaves;
use super::memory::{Cell, Slot};
use super::node::{Millis, Node};
use super::status::Status;
use super::table::Row;
use super::walk::Walk;
use super::{composites, decorators};
use crate::time::Instant;
use core::ops::ControlFlow::{self, Break, Continue};

/// The row of the next node to enter, or the node's own status.
pub(super) type Step = ControlFlow<Status, usize>;

/// Ticks the node in row `at`, which is not of the basic set.
#[inline(never)]
pub(super) fn enter<L, V, K>(walk: &mut Walk<'_, L, V, K>, row: &Row<L>, at: usize) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    match &row.node {
        Node::SequenceWithMemory(_) | Node::AsyncSequence(_) | Node::AsyncFallback(_) => {
            let child = walk.slot(at).child(at);
            walk.note_child(at, child);
            Continue(child)
        }
        Node::Parallel { .. } | Node::ParallelAll { .. } => composites::enter_parallel(walk, at),
        Node::IfThenElse(_) => Continue(walk.slot(at).child(at)),
        Node::Switch(count, leaf) => composites::enter_switch(walk, at, *count, leaf),
        Node::RoundRobin(_) => composites::enter_round_robin(walk, at),
        Node::RecoveryNode(_) => {
            walk.begin(at, 0);
            Continue(walk.slot(at).child(at))
        }
        Node::PipelineSequence(_) => {
            walk.put(at, walk.slot(at).with_skips(0));
            Continue(at + 1)
        }
        Node::RetryUntilSuccessful(times) => decorators::enter_loop(walk, at, *times, Status::Failure),
        Node::Repeat(times) => decorators::enter_loop(walk, at, *times, Status::Success),
        Node::Timeout(limit) => decorators::enter_timeout(walk, at, *limit),
        Node::Delay(time) => decorators::enter_delay(walk, at, *time),
        Node::RunOnce { then_skip } => match kept_status(walk.slot(at)) {
            Some(_) if *then_skip => walk.conclude(at, Status::Skipped),
            Some(status) => walk.conclude(at, status),
            None => Continue(at + 1),
        },
        Node::Precondition { condition, otherwise } => {
            decorators::enter_precondition(walk, at, condition, *otherwise)
        }
        Node::RateController(period) => decorators::enter_rate_controller(walk, at, *period),
        Node::Sleep(time) => decorators::enter_sleep(walk, at, *time),
        Node::AlwaysSuccess => walk.conclude(at, Status::Success),
        Node::AlwaysFailure => walk.conclude(at, Status::Failure),
        _ => Continue(at + 1),
    }
}

/// Tells the node in row `at`, which is not of the basic set, what its child in row `child` returned.
#[inline(never)]
pub(super) fn returned<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    row: &Row<L>,
    at: usize,
    child: usize,
    status: Status,
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    use Status::{Failure, Running, Skipped, Success};
    match &row.node {
        Node::SequenceWithMemory(_) | Node::AsyncSequence(_) => {
            composites::yielding(walk, &row.node, at, child, status, Success)
        }
        Node::AsyncFallback(_) => composites::yielding(walk, &row.node, at, child, status, Failure),
        Node::Parallel { children, success_count, failure_count } => {
            composites::parallel(walk, at, child, status, *children, (*success_count, *failure_count))
        }
        Node::ParallelAll { children, max_failures } => {
            composites::parallel_all(walk, at, child, status, *children, *max_failures)
        }
        Node::IfThenElse(_) => composites::if_then_else(walk, at, child, status),
        Node::WhileDoElse(_) => composites::while_do_else(walk, at, child, status),
        Node::PipelineSequence(count) => composites::pipeline(walk, at, child, status, *count),
        Node::RoundRobin(count) => composites::round_robin(walk, at, child, status, *count),
        Node::RecoveryNode(retries) => composites::recovery(walk, at, child, status, *retries),
        Node::RetryUntilSuccessful(times) => decorators::looped(walk, at, status, *times, Failure),
        Node::Repeat(times) => decorators::looped(walk, at, status, *times, Success),
        Node::RunOnce { .. } => decorators::run_once(walk, at, child, status),
        Node::RateController(_) => decorators::rate_controller(walk, at, child, status),
        Node::Delay(_) => decorators::delay(walk, at, child, status),
        Node::ForceSuccess if matches!(status, Success | Failure) => walk.conclude(at, Success),
        Node::ForceFailure if matches!(status, Success | Failure) => walk.conclude(at, Failure),
        Node::KeepRunningUntilFailure if matches!(status, Success | Skipped) => walk.wait(at, child),
        _ if status == Running => walk.wait(at, child),
        _ => walk.conclude(at, status),
    }
}

impl<L, V: Leaves<L> + ?Sized, K: Kinds> Walk<'_, L, V, K> {
    pub(super) fn slot(&self, at: usize) -> Slot {
        self.cells.get(at).map_or(Slot::IDLE, |cell| cell.slot)
    }

    pub(super) fn put(&mut self, at: usize, slot: Slot) {
        if let Some(cell) = self.cells.get_mut(at) {
            cell.slot = slot;
        }
    }

    pub(super) fn extra(&self, at: usize) -> u32 {
        self.cells.get(at).map_or(0, |cell| cell.extra.get())
    }

    pub(super) fn put_extra(&mut self, at: usize, value: u32) {
        if let Some(cell) = self.cells.get_mut(at) {
            cell.extra = K::Extra::of(value);
        }
    }

    pub(super) fn is_running(&self, at: usize) -> bool {
        self.cells.get(at).is_some_and(Cell::is_running)
    }

    /// The next child of the same parent.
    pub(super) fn sibling(&self, at: usize) -> Option<usize> {
        self.rows.get(at)?.sibling()
    }

    /// Sets what a node that is not running counts or measures.
    pub(super) fn begin(&mut self, at: usize, value: u32) {
        if !self.is_running(at) {
            self.put_extra(at, value);
        }
    }

    /// Whether `time` has passed since the node began.
    pub(super) fn has_passed(&self, at: usize, time: Millis) -> bool {
        self.now.since(Instant(self.extra(at))).0 >= time.get()
    }

    /// Keeps in mind whether the child that is about to be ticked was running before.
    pub(super) fn note_child(&mut self, at: usize, child: usize) {
        let running = self.is_running(child);
        self.put(at, self.slot(at).with_latch(running));
    }

    /// Ends a node with `status`, which may be running without any child running.
    pub(super) fn conclude(&mut self, at: usize, status: Status) -> Step {
        self.conclude_with(at, status, self.slot(at).only_kept())
    }

    /// Ends a node with `status`; idle, it keeps `rest`.
    pub(super) fn conclude_with(&mut self, at: usize, status: Status, rest: Slot) -> Step {
        let before = self.slot(at);
        self.put(at, rest.with_running(status == Status::Running));
        self.report(at, before, Some(status));
        Break(status)
    }

    /// Leaves a node running, at the child in row `child`.
    pub(super) fn wait(&mut self, at: usize, child: usize) -> Step {
        let before = self.slot(at);
        let place = Slot::waiting(at, child);
        self.put(at, place.with_skips(before.skips()).with_latch(before.has_latch()));
        self.report(at, before, Some(Status::Running));
        Break(Status::Running)
    }

    /// As [`wait`](Self::wait), and asks for the next pass at once.
    pub(super) fn yield_at(&mut self, at: usize, child: usize) -> Step {
        self.yielded = true;
        self.wait(at, child)
    }

    /// Halts what is running among the children of the node in row `at`, and forgets how they ended.
    pub(super) fn reset_children(&mut self, at: usize) {
        let mut child = Some(at + 1);
        while let Some(top) = child {
            self.halt_from(top);
            child = self.sibling(top);
        }
    }
}
