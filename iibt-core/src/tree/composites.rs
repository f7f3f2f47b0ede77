//! The rules of the nodes with several children.

use super::kinds::Kinds;
use super::memory::Slot;
use super::node::Node;
use super::status::Status;
use super::visit::{Visit, VisitEffect, VisitOutcome};
use Status::{Failure, Running, Skipped, Success};

/// The counts of a parallel node's finished children: three numbers in a node's extra word.
#[derive(Clone, Copy)]
struct ChildCounts {
    successes: u8,
    failures: u8,
    skipped: u8,
}

impl ChildCounts {
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

    const fn ended(self) -> u32 {
        self.successes as u32 + self.failures as u32 + self.skipped as u32
    }
}

/// The number that a threshold stands for: a negative one counts from all `children`.
fn threshold(count: i8, children: u8) -> i32 {
    let count = i32::from(count);
    if count < 0 { (i32::from(children) + count + 1).max(0) } else { count }
}

impl<L, K: Kinds> Visit<'_, L, K> {
    /// A node of the basic set whose child is running, or decides. A later child that is running is
    /// halted: only a reactive node has one.
    #[inline(always)]
    pub(super) fn settle(&self, child: usize, status: Status) -> VisitOutcome {
        let own = if matches!(self.node, Node::Inverter) { status.inverted() } else { status };
        if status != Running {
            let halted = self.slot.is_running().then_some(self.first());
            return self.conclude(own).with_slot(Slot::IDLE).halting(halted);
        }
        let slot = match self.node {
            Node::ReactiveSequence(_) | Node::ReactiveFallback(_) => Slot::RUNNING,
            _ if K::FULL => Slot::waiting(self.at, child).with_skips(self.slot.skips()),
            _ => Slot::waiting(self.at, child),
        };
        // In the basic set, what follows was halted when the leaf began to run.
        let halted = if K::FULL && self.slot.is_running() { self.sibling(child) } else { None };
        self.conclude(own).with_slot(slot).halting(halted)
    }

    /// A sequence or fallback one of whose children was skipped: the next one, or its own status
    /// after the last. It is skipped when all its children were.
    #[cold]
    pub(super) fn skip(&self, child: usize) -> (Slot, Result<usize, Status>) {
        let mut index = 0;
        let mut sibling = self.first();
        while sibling < child {
            index += 1;
            sibling = self.sibling(sibling).unwrap_or(child);
        }
        let all = index == 0 || self.slot.skips() == index;
        let slot = if all { self.slot.with_skips(index + 1) } else { self.slot };
        let step = match (self.sibling(child), self.node) {
            (Some(next), _) => Ok(next),
            _ if all => Err(Skipped),
            (None, Node::Fallback(_) | Node::ReactiveFallback(_) | Node::AsyncFallback(_)) => Err(Failure),
            _ => Err(Success),
        };
        (slot, step)
    }

    /// A sequence (`passing` success) or fallback (failure) that yields after each child that
    /// passed in its first tick. One with memory keeps its place when it ends early.
    pub(super) fn yielding(&self, child: usize, status: Status, passing: Status) -> VisitOutcome {
        let next = self.sibling(child);
        match next {
            _ if status == Running => self.wait(child),
            _ if status == Skipped => match self.skip(child) {
                (slot, Ok(next)) => self.enter(next).with_slot(slot.with_flag(self.is_running(next))),
                (_, Err(own)) => self.conclude(own),
            },
            _ if status != passing => {
                let keeps = matches!(self.node, Node::SequenceWithMemory(_));
                let rest = if keeps { Slot::waiting(self.at, child).place() } else { Slot::IDLE };
                self.conclude_with(status, rest)
            }
            None => self.conclude(status),
            Some(next) if !self.slot.has_flag() => self.wait(next).and(VisitEffect::Yield),
            Some(next) => self.enter_noting(next),
        }
    }

    pub(super) fn enter_parallel(&self) -> VisitOutcome {
        let tally = ChildCounts { skipped: 0, ..ChildCounts::read(self.begun(0)) };
        let decision = match self.unfinished(Some(self.first())) {
            Some(child) => self.enter(child),
            None => self.conclude(Running), // only with the memory of another tree
        };
        decision.with_extra(tally.word())
    }

    /// Continues with the next child of a parallel node that has not ended, or waits for those that
    /// are running.
    fn tallied(&self, child: usize, status: Status, children: u8) -> VisitOutcome {
        let tally = ChildCounts::read(self.extra).after(status);
        let decision = match self.unfinished(self.sibling(child)) {
            Some(next) => self.enter(next),
            None if tally.skipped == children => self.conclude(Skipped),
            None => self.wait(self.first()),
        };
        let has_ended = matches!(status, Success | Failure);
        let effect = if has_ended { VisitEffect::Done(child) } else { VisitEffect::Nothing };
        decision.with_extra(tally.word()).and(effect)
    }

    pub(super) fn parallel(
        &self,
        child: usize,
        status: Status,
        children: u8,
        counts: (i8, i8),
    ) -> VisitOutcome {
        let tally = ChildCounts::read(self.extra).after(status);
        let required = threshold(counts.0, children);
        let (successes, failures) = (i32::from(tally.successes), i32::from(tally.failures));
        let spared = if counts.0 < 0 { i32::from(tally.skipped) } else { 0 };
        let result = if successes + spared >= required {
            Success
        } else if i32::from(children) - failures < required || failures == threshold(counts.1, children) {
            Failure
        } else {
            return self.tallied(child, status, children);
        };
        self.conclude(result).halting(Some(self.first()))
    }

    pub(super) fn parallel_all(&self, child: usize, status: Status, children: u8, most: i8) -> VisitOutcome {
        let tally = ChildCounts::read(self.extra).after(status);
        let ended = tally.ended() == u32::from(children) && tally.skipped < children;
        if !ended || self.unfinished(self.sibling(child)).is_some() {
            return self.tallied(child, status, children);
        }
        let failed = i32::from(tally.failures) >= threshold(most, children);
        self.conclude(if failed { Failure } else { Success }).halting(Some(self.first()))
    }

    pub(super) fn if_then_else(&self, child: usize, status: Status) -> VisitOutcome {
        let then = self.sibling(self.first()).filter(|_| child == self.first());
        match (status, then) {
            (Running, _) => self.wait(child),
            (Success, Some(then)) => self.enter(then),
            (Failure, Some(then)) => {
                self.sibling(then).map_or_else(|| self.conclude(Failure), |otherwise| self.enter(otherwise))
            }
            _ => self.conclude(status),
        }
    }

    pub(super) fn while_do_else(&self, child: usize, status: Status) -> VisitOutcome {
        let first = self.sibling(self.first());
        let second = first.and_then(|first| self.sibling(first));
        let (chosen, other) = match (child == self.first(), status) {
            (_, Running) => return self.wait(child),
            (true, Success) => (first, second),
            (true, Failure) => (second, first),
            _ => (None, None),
        };
        match chosen {
            Some(chosen) => self.enter(chosen).halting(other.filter(|&other| self.is_running(other))),
            None => self.conclude(status).halting(Some(self.first())),
        }
    }

    pub(super) fn enter_switch(&self, children: u8, case: usize) -> VisitOutcome {
        let mut chosen = self.first();
        for _ in 0..case.min(usize::from(children).saturating_sub(1)) {
            chosen = self.sibling(chosen).unwrap_or(chosen);
        }
        let left = self.place();
        let leaves = self.slot.is_running() && left != chosen && self.is_running(left);
        self.enter(chosen).halting(leaves.then_some(left))
    }

    pub(super) fn pipeline(&self, child: usize, status: Status, children: u8) -> VisitOutcome {
        if status == Running && child >= self.place() {
            return self.wait(child);
        }
        let skips = self.slot.skips() + usize::from(status == Skipped);
        match self.sibling(child) {
            Some(next) if status != Failure => self.enter(next).with_slot(self.slot.with_skips(skips)),
            _ => {
                let all_skipped = skips == usize::from(children);
                let result = if status == Failure {
                    Failure
                } else if all_skipped {
                    Skipped
                } else {
                    Success
                };
                self.conclude(result).halting(Some(self.first()))
            }
        }
    }

    /// Failures in the low half of the extra word, children skipped in this pass in the high one.
    pub(super) fn enter_round_robin(&self) -> VisitOutcome {
        self.enter(self.place()).with_extra(self.begun(0) & 0xFFFF)
    }

    pub(super) fn round_robin(&self, child: usize, status: Status, children: u8) -> VisitOutcome {
        let next = self.sibling(child).unwrap_or(self.first());
        let tally = self.extra.wrapping_add(if status == Failure { 1 } else { 0x1_0000 });
        let (failures, skipped) = (tally & 0xFFFF, tally >> 16);
        match status {
            Running => self.wait(child),
            Success => self.conclude_with(Success, Slot::waiting(self.at, next).place()),
            _ if failures + skipped < u32::from(children) => self.enter(next).with_extra(tally),
            _ if skipped >= u32::from(children) => self.conclude(Skipped).with_extra(tally),
            _ => self.conclude(Failure).with_extra(tally),
        }
    }

    pub(super) fn recovery(&self, child: usize, status: Status, retries: u8) -> VisitOutcome {
        match (self.sibling(child), status) {
            (_, Running) => self.wait(child),
            (Some(recovery), Failure) if self.extra < u32::from(retries) => self.enter(recovery),
            (Some(_), _) => self.conclude(status),
            (None, Success) => self.enter(self.first()).with_extra(self.extra.saturating_add(1)),
            (None, _) => self.conclude(Failure),
        }
    }
}
