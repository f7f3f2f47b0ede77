//! The decorators and timers of the full set.

use super::full::Step;
use super::kinds::Kinds;
use super::leaves::Leaves;
use super::memory::Slot;
use super::node::{Millis, Node, Times};
use super::status::Status;
use super::table::Row;
use super::walk::Walk;
use Status::{Failure, Running, Skipped, Success};
use core::ops::ControlFlow::Continue;

/// A loop that goes on while its child returns `again`.
pub(super) fn enter_loop<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    at: usize,
    times: Times,
    again: Status,
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    walk.begin(at, 0);
    if !times.more_than(0) {
        return walk.conclude(at, again);
    }
    walk.note_child(at, at + 1);
    Continue(at + 1)
}

pub(super) fn looped<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    at: usize,
    status: Status,
    times: Times,
    again: Status,
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    if status == Running {
        return walk.wait(at, at + 1);
    }
    if status != again {
        return walk.conclude(at, status);
    }
    let count = walk.extra(at).saturating_add(1);
    walk.put_extra(at, count);
    if !times.more_than(count) {
        walk.conclude(at, again)
    } else if walk.slot(at).has_latch() {
        walk.note_child(at, at + 1);
        Continue(at + 1)
    } else {
        walk.yield_at(at, at + 1)
    }
}

pub(super) fn enter_timeout<L, V, K>(walk: &mut Walk<'_, L, V, K>, at: usize, limit: Millis) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    walk.begin(at, walk.now.0);
    if walk.is_running(at) && limit.get() > 0 && walk.has_passed(at, limit) {
        walk.halt_from(at + 1);
        return walk.conclude(at, Failure);
    }
    Continue(at + 1)
}

pub(super) fn enter_delay<L, V, K>(walk: &mut Walk<'_, L, V, K>, at: usize, time: Millis) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    walk.begin(at, walk.now.0);
    let slot = walk.slot(at);
    if slot.has_latch() || walk.has_passed(at, time) {
        walk.put(at, slot.with_latch(true));
        return Continue(at + 1);
    }
    walk.wait(at, at + 1)
}

/// The child runs on without another delay; when it has ended, the next one waits again.
pub(super) fn delay<L, V, K>(walk: &mut Walk<'_, L, V, K>, at: usize, child: usize, status: Status) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    if status == Running { walk.wait(at, child) } else { walk.conclude(at, status) }
}

pub(super) fn enter_sleep<L, V, K>(walk: &mut Walk<'_, L, V, K>, at: usize, time: Millis) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    walk.begin(at, walk.now.0);
    let status = if walk.has_passed(at, time) { Success } else { Running };
    walk.conclude(at, status)
}

pub(super) fn run_once<L, V, K>(walk: &mut Walk<'_, L, V, K>, at: usize, child: usize, status: Status) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    match status {
        Running => walk.wait(at, child),
        Skipped => walk.conclude(at, status),
        Success | Failure => walk.conclude_with(at, status, Slot::keeping(status as u32)),
    }
}

/// BehaviorTree.CPP does not ask again while the child runs.
pub(super) fn enter_precondition<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    at: usize,
    condition: &L,
    otherwise: Status,
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let runs = walk.is_running(at + 1);
    if K::COMPAT && runs || walk.leaves.condition(condition, walk.now) {
        return Continue(at + 1);
    }
    if runs {
        walk.halt_from(at + 1);
    }
    walk.conclude(at, otherwise)
}

/// The latch says that the rate is being kept, from the time in the extra word on.
pub(super) fn enter_rate_controller<L, V, K>(walk: &mut Walk<'_, L, V, K>, at: usize, period: Millis) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let slot = walk.slot(at);
    if !slot.has_latch() {
        walk.put_extra(at, walk.now.0);
        walk.put(at, slot.with_latch(true));
        return Continue(at + 1);
    }
    if walk.is_running(at + 1) || walk.has_passed(at, period) {
        return Continue(at + 1);
    }
    walk.wait(at, at + 1)
}

/// Only a pipeline ticks a child again that has succeeded: there the rate outlives the success.
pub(super) fn rate_controller<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    at: usize,
    child: usize,
    status: Status,
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    if status == Running {
        return walk.wait(at, child);
    }
    let parent = walk.rows.get(at).map_or(at, Row::parent);
    let piped = matches!(walk.rows.get(parent).map(Row::node), Some(Node::PipelineSequence(_)));
    if status == Success {
        walk.put_extra(at, walk.now.0);
    }
    walk.conclude_with(at, status, Slot::IDLE.with_latch(piped && status == Success))
}
