//! The rules of the nodes with one child, and of the timer that is a leaf.

use super::kinds::Kinds;
use super::memory::Slot;
use super::node::{Millis, Node, Times};
use super::row::Row;
use super::status::Status;
use super::visit::{Visit, VisitEffect, VisitOutcome};
use Status::{Failure, Running, Skipped, Success};

impl<L, K: Kinds> Visit<'_, L, K> {
    /// A loop that goes on while its child returns `again`.
    pub(super) fn enter_loop(&self, times: Times, again: Status) -> VisitOutcome {
        let decision =
            if times.more_than(0) { self.enter_noting(self.first()) } else { self.conclude(again) };
        decision.with_extra(self.begun(0))
    }

    pub(super) fn looped(&self, status: Status, times: Times, again: Status) -> VisitOutcome {
        let count = self.extra.saturating_add(1);
        let decision = match status {
            Running => return self.wait(self.first()),
            _ if status != again => return self.conclude(status),
            _ if !times.more_than(count) => self.conclude(again),
            _ if self.slot.has_flag() => self.enter_noting(self.first()),
            _ => self.wait(self.first()).and(VisitEffect::Yield),
        };
        decision.with_extra(count)
    }

    pub(super) fn enter_timeout(&self, limit: Millis) -> VisitOutcome {
        let begun = self.begun(self.now.0);
        let is_over = self.slot.is_running() && limit.get() > 0 && self.has_passed(begun, limit);
        let decision = if is_over {
            self.conclude(Failure).halting(Some(self.first()))
        } else {
            self.enter(self.first())
        };
        decision.with_extra(begun)
    }

    /// Once the flag is set the child runs on without another delay; when it has ended, the next
    /// one waits again.
    pub(super) fn enter_delay(&self, time: Millis) -> VisitOutcome {
        let begun = self.begun(self.now.0);
        let decision = if self.slot.has_flag() || self.has_passed(begun, time) {
            self.enter(self.first()).with_slot(self.slot.with_flag(true))
        } else {
            self.wait(self.first())
        };
        decision.with_extra(begun)
    }

    pub(super) fn enter_sleep(&self, time: Millis) -> VisitOutcome {
        let begun = self.begun(self.now.0);
        self.conclude(if self.has_passed(begun, time) { Success } else { Running }).with_extra(begun)
    }

    pub(super) fn enter_run_once(&self, then_skip: bool) -> VisitOutcome {
        match self.slot.kept_status() {
            Some(_) if then_skip => self.conclude(Skipped),
            Some(status) => self.conclude(status),
            None => self.enter(self.first()),
        }
    }

    pub(super) fn run_once(&self, child: usize, status: Status) -> VisitOutcome {
        match status {
            Running => self.wait(child),
            Skipped => self.conclude(status),
            Success | Failure => self.conclude_with(status, Slot::keeping(status as u32)),
        }
    }

    pub(super) fn enter_precondition(&self, holds: bool, otherwise: Status) -> VisitOutcome {
        if holds {
            return self.enter(self.first());
        }
        let halted = self.is_running(self.first()).then_some(self.first());
        self.conclude(otherwise).halting(halted)
    }

    /// The flag says that the rate is being kept, from the time in the extra word on.
    pub(super) fn enter_rate_controller(&self, period: Millis) -> VisitOutcome {
        if !self.slot.has_flag() {
            let slot = self.slot.with_flag(true);
            return self.enter(self.first()).with_slot(slot).with_extra(self.now.0);
        }
        if self.is_running(self.first()) || self.has_passed(self.extra, period) {
            return self.enter(self.first());
        }
        self.wait(self.first())
    }

    /// Only a pipeline ticks a child again that has succeeded: there the rate outlives the success.
    pub(super) fn rate_controller(&self, child: usize, status: Status) -> VisitOutcome {
        if status == Running {
            return self.wait(child);
        }
        let parent = self.rows.get(self.at).and_then(|row| self.rows.get(row.parent()));
        let piped = matches!(parent.map(Row::node), Some(Node::PipelineSequence(_)));
        let decision = self.conclude_with(status, Slot::IDLE.with_flag(piped && status == Success));
        if status == Success { decision.with_extra(self.now.0) } else { decision }
    }
}
