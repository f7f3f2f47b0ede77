//! The composites of the full set.

use super::full::Step;
use super::kinds::Kinds;
use super::leaves::Leaves;
use super::memory::Slot;
use super::node::Node;
use super::status::Status;
use super::walk::Walk;
use Status::{Failure, Running, Skipped, Success};
use core::ops::ControlFlow::{Break, Continue};

/// A sequence (`passing` success) or fallback (failure) that yields after each child that passed in its first
/// tick. One with memory keeps its place when it ends early.
pub(super) fn yielding<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    node: &Node<L>,
    at: usize,
    child: usize,
    status: Status,
    passing: Status,
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    if status == Running {
        return walk.wait(at, child);
    }
    let next = walk.sibling(child);
    if status == Skipped {
        return match walk.skip(at, child) {
            Continue(next) => {
                walk.note_child(at, next);
                Continue(next)
            }
            Break(own) => walk.conclude(at, own),
        };
    }
    let fresh = !walk.slot(at).has_latch();
    match next {
        _ if status != passing => {
            let keeps = matches!(node, Node::SequenceWithMemory(_));
            let rest = if keeps { Slot::waiting(at, child).place() } else { Slot::IDLE };
            walk.conclude_with(at, status, rest)
        }
        None => walk.conclude(at, status),
        Some(next) if fresh => walk.yield_at(at, next),
        Some(next) => {
            walk.note_child(at, next);
            Continue(next)
        }
    }
}

/// Which of a parallel node's children have ended how: three numbers in a node's extra word.
#[derive(Clone, Copy)]
struct Tally {
    successes: u8,
    failures: u8,
    skipped: u8,
}

impl Tally {
    const fn read(word: u32) -> Self {
        let [successes, failures, skipped, _] = word.to_le_bytes();
        Self { successes, failures, skipped }
    }

    const fn word(self) -> u32 {
        u32::from_le_bytes([self.successes, self.failures, self.skipped, 0])
    }

    const fn after(mut self, status: Status) -> Self {
        match status {
            Success => self.successes = self.successes.wrapping_add(1),
            Failure => self.failures = self.failures.wrapping_add(1),
            Skipped => self.skipped = self.skipped.wrapping_add(1),
            Running => {}
        }
        self
    }
}

/// The number that a threshold stands for: a negative one counts from all `children`.
fn threshold(count: i8, children: u8) -> i32 {
    let count = i32::from(count);
    if count < 0 { (i32::from(children) + count + 1).max(0) } else { count }
}

pub(super) fn enter_parallel<L, V, K>(walk: &mut Walk<'_, L, V, K>, at: usize) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    walk.begin(at, 0);
    let tally = Tally { skipped: 0, ..Tally::read(walk.extra(at)) };
    walk.put_extra(at, tally.word());
    match unfinished(walk, Some(at + 1)) {
        Some(child) => Continue(child),
        None => walk.conclude(at, Running), // only with the memory of another tree
    }
}

/// The first child that has not ended, from `child` on.
fn unfinished<L, V, K>(walk: &Walk<'_, L, V, K>, mut child: Option<usize>) -> Option<usize>
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    while let Some(at) = child
        && walk.slot(at).is_done()
    {
        child = walk.sibling(at);
    }
    child
}

/// Counts how a child of a parallel node has ended.
fn tallied<L, V, K>(walk: &mut Walk<'_, L, V, K>, at: usize, child: usize, status: Status) -> Tally
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    if matches!(status, Success | Failure) {
        walk.put(child, walk.slot(child).done());
    }
    let tally = Tally::read(walk.extra(at)).after(status);
    walk.put_extra(at, tally.word());
    tally
}

pub(super) fn parallel<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    at: usize,
    child: usize,
    status: Status,
    children: u8,
    (success_count, failure_count): (i8, i8),
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let tally = tallied(walk, at, child, status);
    let required = threshold(success_count, children);
    let (successes, failures) = (i32::from(tally.successes), i32::from(tally.failures));
    let spared = if success_count < 0 { i32::from(tally.skipped) } else { 0 };
    let result = if successes + spared >= required {
        Success
    } else if i32::from(children) - failures < required || failures == threshold(failure_count, children) {
        Failure
    } else if let Some(next) = unfinished(walk, walk.sibling(child)) {
        return Continue(next);
    } else if tally.skipped == children {
        return walk.conclude(at, Skipped);
    } else {
        return walk.wait(at, at + 1);
    };
    walk.reset_children(at);
    walk.conclude(at, result)
}

pub(super) fn parallel_all<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    at: usize,
    child: usize,
    status: Status,
    children: u8,
    max_failures: i8,
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let tally = tallied(walk, at, child, status);
    if let Some(next) = unfinished(walk, walk.sibling(child)) {
        return Continue(next);
    }
    let ended = u32::from(tally.successes) + u32::from(tally.failures) + u32::from(tally.skipped);
    if tally.skipped == children {
        return walk.conclude(at, Skipped);
    }
    if ended < u32::from(children) {
        return walk.wait(at, at + 1);
    }
    walk.reset_children(at);
    let failed = i32::from(tally.failures) >= threshold(max_failures, children);
    walk.conclude(at, if failed { Failure } else { Success })
}

pub(super) fn if_then_else<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    at: usize,
    child: usize,
    status: Status,
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let then = walk.sibling(at + 1);
    match (status, then) {
        (Running, _) => walk.wait(at, child),
        (Success, Some(then)) if child == at + 1 => Continue(then),
        (Failure, Some(then)) if child == at + 1 => match walk.sibling(then) {
            Some(otherwise) => Continue(otherwise),
            None => walk.conclude(at, Failure),
        },
        _ => walk.conclude(at, status),
    }
}

pub(super) fn while_do_else<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    at: usize,
    child: usize,
    status: Status,
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let first = walk.sibling(at + 1);
    let second = first.and_then(|first| walk.sibling(first));
    let (chosen, other) = match (child == at + 1, status) {
        (_, Running) => return walk.wait(at, child),
        (true, Success) => (first, second),
        (true, Failure) => (second, first),
        _ => (None, None),
    };
    match chosen {
        Some(chosen) => {
            if let Some(other) = other.filter(|&other| walk.is_running(other)) {
                walk.halt_from(other);
            }
            Continue(chosen)
        }
        None => {
            walk.reset_children(at);
            walk.conclude(at, status)
        }
    }
}

pub(super) fn enter_switch<L, V, K>(walk: &mut Walk<'_, L, V, K>, at: usize, count: u8, leaf: &L) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let case = walk.leaves.case(leaf, walk.now).min(usize::from(count).saturating_sub(1));
    let mut chosen = at + 1;
    for _ in 0..case {
        chosen = walk.sibling(chosen).unwrap_or(chosen);
    }
    let left = walk.slot(at).child(at);
    if walk.is_running(at) && left != chosen && walk.is_running(left) {
        walk.halt_from(left);
    }
    Continue(chosen)
}

pub(super) fn pipeline<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    at: usize,
    child: usize,
    status: Status,
    count: u8,
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let slot = walk.slot(at);
    if status == Running && child >= slot.child(at) {
        return walk.wait(at, child);
    }
    if status == Skipped {
        walk.put(at, slot.with_skips(slot.skips() + 1));
    }
    if status != Failure
        && let Some(next) = walk.sibling(child)
    {
        return Continue(next);
    }
    let all_skipped = walk.slot(at).skips() == usize::from(count);
    walk.reset_children(at);
    walk.conclude(
        at,
        if status == Failure {
            Failure
        } else if all_skipped {
            Skipped
        } else {
            Success
        },
    )
}

/// Failures in the low half of the extra word, children skipped in this pass in the high one.
pub(super) fn enter_round_robin<L, V, K>(walk: &mut Walk<'_, L, V, K>, at: usize) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    walk.begin(at, 0);
    walk.put_extra(at, walk.extra(at) & 0xFFFF);
    Continue(walk.slot(at).child(at))
}

pub(super) fn round_robin<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    at: usize,
    child: usize,
    status: Status,
    count: u8,
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    if status == Running {
        return walk.wait(at, child);
    }
    let next = walk.sibling(child).unwrap_or(at + 1);
    if status == Success {
        return walk.conclude_with(at, Success, Slot::waiting(at, next).place());
    }
    let tally = walk.extra(at).wrapping_add(if status == Failure { 1 } else { 0x1_0000 });
    walk.put_extra(at, tally);
    let (failures, skipped) = (tally & 0xFFFF, tally >> 16);
    if failures + skipped < u32::from(count) {
        return Continue(next);
    }
    walk.conclude(at, if skipped >= u32::from(count) { Skipped } else { Failure })
}

pub(super) fn recovery<L, V, K>(
    walk: &mut Walk<'_, L, V, K>,
    at: usize,
    child: usize,
    status: Status,
    retries: u8,
) -> Step
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let count = walk.extra(at);
    match (walk.sibling(child), status) {
        (_, Running) => walk.wait(at, child),
        (Some(recovery), Failure) if count < u32::from(retries) => Continue(recovery),
        (Some(_), _) => walk.conclude(at, status),
        (None, Success) => {
            walk.put_extra(at, count + 1);
            Continue(at + 1)
        }
        (None, _) => walk.conclude(at, Failure),
    }
}
