//! The kinds of nodes.

use super::status::Status;

/// One row of a tree's table; `L` names the caller's leaves.
///
/// An inner node is followed by its children, each with all its descendants. A composite says how many
/// children follow. The rules are those of BehaviorTree.CPP 4.10 and, for the four nodes named so,
/// of Nav2; the [module](super) lists where they differ.
///
/// The kinds up to [`Inverter`](Self::Inverter) make the [`Basic`](super::Basic) set; the others need
/// [`Full`](super::Full).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Node<L> {
    /// An action, which may take several ticks.
    Action(L),
    /// An interactive inference node: to the tree an action like any other.
    Inference(L),
    /// A question that is answered at once.
    Condition(L),

    /// Succeeds when all its children have succeeded, fails with the first that fails; resumes at the
    /// child that was running.
    Sequence(u8),
    /// Succeeds with the first child that succeeds, fails when all have failed; resumes at the child that
    /// was running.
    Fallback(u8),
    /// A sequence that starts from its first child at every tick.
    ReactiveSequence(u8),
    /// A fallback that starts from its first child at every tick.
    ReactiveFallback(u8),
    /// Exchanges success and failure of its one child.
    Inverter,

    /// A sequence that, after a failure or a halt, goes on at the child it had come to. Yields after each
    /// child that finishes in its first tick.
    SequenceWithMemory(u8),
    /// A sequence that yields after each child that succeeds in its first tick, so that it can be interrupted.
    AsyncSequence(u8),
    /// A fallback that yields after each child that fails in its first tick.
    AsyncFallback(u8),
    /// Ticks all its children that have not finished, in order, until enough have succeeded or failed; then
    /// halts the rest. A negative count counts from all of them: -1 all, -2 all but one.
    Parallel {
        /// How many children follow, 127 at the most.
        children: u8,
        /// How many of them must succeed.
        success_count: i8,
        /// How many failures make it fail.
        failure_count: i8,
    },
    /// Ticks its children until all have finished; then fails if at least `max_failures` (negative: as in
    /// [`Parallel`](Self::Parallel)) have failed.
    ParallelAll {
        /// How many children follow, 127 at the most.
        children: u8,
        /// How many failures make it fail.
        max_failures: i8,
    },
    /// Ticks its second child if the first succeeds, else its third or, without one, fails. The first is
    /// not asked again while the chosen child runs.
    IfThenElse(u8),
    /// Like [`IfThenElse`](Self::IfThenElse), but asks the first child at every tick and halts the other when the
    /// answer changes.
    WhileDoElse(u8),
    /// Ticks the child that [`Leaves::case`](super::Leaves::case) names; the last of the 3 to 7 children is the
    /// default. Halts the one it leaves.
    Switch(u8, L),
    /// Nav2: a sequence that, while a child runs, ticks all those before it again.
    PipelineSequence(u8),
    /// Nav2: a fallback that begins where the last one ended, and goes round.
    RoundRobin(u8),
    /// Nav2: ticks its second child when the first fails, then the first again, so many times at the most.
    RecoveryNode(u8),

    /// Success when its child has finished.
    ForceSuccess,
    /// Failure when its child has finished.
    ForceFailure,
    /// Running until its child fails.
    KeepRunningUntilFailure,
    /// Ticks its child again when it has failed, so many times in all.
    RetryUntilSuccessful(Times),
    /// Ticks its child again when it has succeeded, so many times in all.
    Repeat(Times),
    /// Halts its child and fails after so many milliseconds; 0 is no limit.
    Timeout(Millis),
    /// Waits so many milliseconds before it ticks its child.
    Delay(Millis),
    /// Ticks its child until that has finished once, then never again.
    RunOnce {
        /// Whether it is skipped from then on; otherwise it repeats the status.
        then_skip: bool,
    },
    /// Ticks its child while the condition holds, else halts it.
    Precondition {
        /// The name of the condition, for [`Leaves::condition`](super::Leaves::condition).
        condition: L,
        /// Its own status while the condition does not hold.
        otherwise: Status,
    },
    /// Nav2: starts its child at most once in so many milliseconds; running meanwhile.
    RateController(Millis),
    /// The place where another tree was put in: passes its child's status on. Keeps the numbering of
    /// BehaviorTree.CPP, where such a node has a number of its own.
    SubTree,

    /// Success.
    AlwaysSuccess,
    /// Failure.
    AlwaysFailure,
    /// Success after so many milliseconds, running meanwhile.
    Sleep(Millis),
}

/// A number of milliseconds in three bytes, so that a row of the table takes eight: each below 2^23 (2 hours), from
/// there on whole seconds up to 24 days, which is what a wrapping clock can measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Millis([u8; 3]);

impl Millis {
    /// The most milliseconds.
    pub const MAX: u32 = i32::MAX as u32 / 1000 * 1000;

    const SECONDS: u32 = 1 << 23;

    /// So many milliseconds. A table with a number that does not fit is refused.
    #[must_use]
    pub const fn new(milliseconds: u32) -> Self {
        let code = if milliseconds < Self::SECONDS {
            milliseconds
        } else if milliseconds <= Self::MAX && milliseconds.is_multiple_of(1000) {
            Self::SECONDS | (milliseconds / 1000)
        } else {
            0xFF_FFFF
        };
        let [a, b, c, _] = code.to_le_bytes();
        Self([a, b, c])
    }

    /// The number; [`u32::MAX`] for one that did not fit.
    #[must_use]
    pub const fn get(self) -> u32 {
        let [a, b, c] = self.0;
        match u32::from_le_bytes([a, b, c, 0]) {
            0xFF_FFFF => u32::MAX,
            code if code < Self::SECONDS => code,
            code => (code - Self::SECONDS) * 1000,
        }
    }
}

/// How often, or for ever; three bytes like [`Millis`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Times([u8; 3]);

impl Times {
    /// The most times.
    pub const MAX: i32 = (1 << 23) - 1;

    /// Without end, written -1 in BehaviorTree.CPP.
    pub const FOREVER: Self = Self::new(-1);

    /// So many times, -1 for ever. A table with a number that does not fit is refused.
    #[must_use]
    pub const fn new(times: i32) -> Self {
        let fits = times >= -1 && times <= Self::MAX;
        let [a, b, c, _] = (if fits { times } else { -2 }).to_le_bytes();
        Self([a, b, c])
    }

    /// The number; -1 for ever, -2 for one that did not fit.
    #[must_use]
    pub const fn get(self) -> i32 {
        let [a, b, c] = self.0;
        i32::from_le_bytes([0, a, b, c]) >> 8
    }

    /// Whether `count` is less than this.
    pub(super) const fn more_than(self, count: u32) -> bool {
        self.get() < 0 || count < self.get() as u32
    }
}

impl<L> Node<L> {
    /// How many children follow, or `None` for a leaf.
    #[must_use]
    pub const fn children(&self) -> Option<u8> {
        match self {
            Self::Sequence(count)
            | Self::Fallback(count)
            | Self::ReactiveSequence(count)
            | Self::ReactiveFallback(count)
            | Self::SequenceWithMemory(count)
            | Self::AsyncSequence(count)
            | Self::AsyncFallback(count)
            | Self::Parallel { children: count, .. }
            | Self::ParallelAll { children: count, .. }
            | Self::IfThenElse(count)
            | Self::WhileDoElse(count)
            | Self::Switch(count, _)
            | Self::PipelineSequence(count)
            | Self::RoundRobin(count) => Some(*count),
            Self::RecoveryNode(_) => Some(2),
            Self::Inverter
            | Self::ForceSuccess
            | Self::ForceFailure
            | Self::KeepRunningUntilFailure
            | Self::RetryUntilSuccessful(_)
            | Self::Repeat(_)
            | Self::Timeout(_)
            | Self::Delay(_)
            | Self::RunOnce { .. }
            | Self::Precondition { .. }
            | Self::RateController(_)
            | Self::SubTree => Some(1),
            Self::Condition(_)
            | Self::Action(_)
            | Self::Inference(_)
            | Self::AlwaysSuccess
            | Self::AlwaysFailure
            | Self::Sleep(_) => None,
        }
    }

    /// The same node with another name for its leaf, if it has one.
    ///
    /// # Errors
    /// What `name` returns.
    ///
    /// ```
    /// use iibt_core::tree::Node;
    ///
    /// let skills = ["charge", "patrol"];
    /// let find = |index: usize| skills.get(index).copied().ok_or("no such skill");
    /// assert_eq!(Node::Action(1).try_map(find), Ok(Node::Action("patrol")));
    /// assert_eq!(Node::Condition(2).try_map(find), Err("no such skill"));
    /// assert_eq!(Node::Sequence(2).try_map(find), Ok(Node::Sequence(2)));
    /// ```
    pub fn try_map<M, E>(self, name: impl FnOnce(L) -> Result<M, E>) -> Result<Node<M>, E> {
        Ok(match self {
            Self::Action(leaf) => Node::Action(name(leaf)?),
            Self::Inference(leaf) => Node::Inference(name(leaf)?),
            Self::Condition(leaf) => Node::Condition(name(leaf)?),
            Self::Switch(children, leaf) => Node::Switch(children, name(leaf)?),
            Self::Precondition { condition, otherwise } => {
                Node::Precondition { condition: name(condition)?, otherwise }
            }
            Self::Sequence(children) => Node::Sequence(children),
            Self::Fallback(children) => Node::Fallback(children),
            Self::ReactiveSequence(children) => Node::ReactiveSequence(children),
            Self::ReactiveFallback(children) => Node::ReactiveFallback(children),
            Self::Inverter => Node::Inverter,
            Self::SequenceWithMemory(children) => Node::SequenceWithMemory(children),
            Self::AsyncSequence(children) => Node::AsyncSequence(children),
            Self::AsyncFallback(children) => Node::AsyncFallback(children),
            Self::Parallel { children, success_count, failure_count } => {
                Node::Parallel { children, success_count, failure_count }
            }
            Self::ParallelAll { children, max_failures } => Node::ParallelAll { children, max_failures },
            Self::IfThenElse(children) => Node::IfThenElse(children),
            Self::WhileDoElse(children) => Node::WhileDoElse(children),
            Self::PipelineSequence(children) => Node::PipelineSequence(children),
            Self::RoundRobin(children) => Node::RoundRobin(children),
            Self::RecoveryNode(retries) => Node::RecoveryNode(retries),
            Self::ForceSuccess => Node::ForceSuccess,
            Self::ForceFailure => Node::ForceFailure,
            Self::KeepRunningUntilFailure => Node::KeepRunningUntilFailure,
            Self::RetryUntilSuccessful(times) => Node::RetryUntilSuccessful(times),
            Self::Repeat(times) => Node::Repeat(times),
            Self::Timeout(limit) => Node::Timeout(limit),
            Self::Delay(time) => Node::Delay(time),
            Self::RunOnce { then_skip } => Node::RunOnce { then_skip },
            Self::RateController(period) => Node::RateController(period),
            Self::SubTree => Node::SubTree,
            Self::AlwaysSuccess => Node::AlwaysSuccess,
            Self::AlwaysFailure => Node::AlwaysFailure,
            Self::Sleep(time) => Node::Sleep(time),
        })
    }

    /// Whether the node belongs to the [`Basic`](super::Basic) set.
    #[must_use]
    pub const fn is_basic(&self) -> bool {
        matches!(
            self,
            Self::Sequence(_)
                | Self::Fallback(_)
                | Self::ReactiveSequence(_)
                | Self::ReactiveFallback(_)
                | Self::Inverter
                | Self::Condition(_)
                | Self::Action(_)
                | Self::Inference(_)
        )
    }
}
