//! The rules of each kind of node, for a tick and for the return of a child.

use super::kinds::Kinds;
use super::node::Node;
use super::status::Status;
use super::visit::{Visit, VisitOutcome};
use Status::{Failure, Running, Skipped, Success};

impl<L, K: Kinds> Visit<'_, L, K> {
    /// The decision of the node when it is ticked. `answer` is the case of a switch, and whether
    /// the condition of a precondition holds.
    pub(super) fn ticked(&self, answer: usize) -> VisitOutcome {
        match self.node {
            Node::SequenceWithMemory(_) | Node::AsyncSequence(_) | Node::AsyncFallback(_) => {
                self.enter_noting(self.place())
            }
            Node::Parallel { .. } | Node::ParallelAll { .. } => self.enter_parallel(),
            Node::IfThenElse(_) => self.enter(self.place()),
            Node::Switch(children, _) => self.enter_switch(*children, answer),
            Node::RoundRobin(_) => self.enter_round_robin(),
            Node::RecoveryNode(_) => self.enter(self.place()).with_extra(self.begun(0)),
            Node::PipelineSequence(_) => self.enter(self.first()).with_slot(self.slot.with_skips(0)),
            Node::RetryUntilSuccessful(times) => self.enter_loop(*times, Failure),
            Node::Repeat(times) => self.enter_loop(*times, Success),
            Node::Timeout(limit) => self.enter_timeout(*limit),
            Node::Delay(time) => self.enter_delay(*time),
            Node::RunOnce { then_skip } => self.enter_run_once(*then_skip),
            Node::Precondition { otherwise, .. } => self.enter_precondition(answer != 0, *otherwise),
            Node::RateController(period) => self.enter_rate_controller(*period),
            Node::Sleep(time) => self.enter_sleep(*time),
            Node::AlwaysSuccess => self.conclude(Success),
            Node::AlwaysFailure => self.conclude(Failure),
            _ => self.enter(self.first()),
        }
    }

    /// The decision of the node when its child in row `child` has returned `status`.
    #[inline(always)]
    pub(super) fn child_returned(&self, child: usize, status: Status) -> VisitOutcome {
        match self.node {
            node if K::FULL && !node.is_basic() => self.child_of_other_returned(child, status),
            Node::Inverter => self.settle(child, status),
            _ if K::FULL && status == Skipped => self.child_skipped(child),
            _ => self.settle(child, status),
        }
    }

    #[cold]
    fn child_skipped(&self, child: usize) -> VisitOutcome {
        match self.skip(child) {
            (slot, Ok(next)) => self.enter(next).with_slot(slot),
            (_, Err(own)) => self.settle(child, own),
        }
    }

    #[inline(never)]
    fn child_of_other_returned(&self, child: usize, status: Status) -> VisitOutcome {
        match self.node {
            Node::SequenceWithMemory(_) | Node::AsyncSequence(_) => self.yielding(child, status, Success),
            Node::AsyncFallback(_) => self.yielding(child, status, Failure),
            Node::Parallel { children, success_count, failure_count } => {
                self.parallel(child, status, *children, (*success_count, *failure_count))
            }
            Node::ParallelAll { children, max_failures } => {
                self.parallel_all(child, status, *children, *max_failures)
            }
            Node::IfThenElse(_) => self.if_then_else(child, status),
            Node::WhileDoElse(_) => self.while_do_else(child, status),
            Node::PipelineSequence(children) => self.pipeline(child, status, *children),
            Node::RoundRobin(children) => self.round_robin(child, status, *children),
            Node::RecoveryNode(retries) => self.recovery(child, status, *retries),
            Node::RetryUntilSuccessful(times) => self.looped(status, *times, Failure),
            Node::Repeat(times) => self.looped(status, *times, Success),
            Node::RunOnce { .. } => self.run_once(child, status),
            Node::RateController(_) => self.rate_controller(child, status),
            Node::ForceSuccess if matches!(status, Success | Failure) => self.conclude(Success),
            Node::ForceFailure if matches!(status, Success | Failure) => self.conclude(Failure),
            Node::KeepRunningUntilFailure if matches!(status, Success | Skipped) => self.wait(child),
            _ if status == Running => self.wait(child),
            _ => self.conclude(status),
        }
    }
}
