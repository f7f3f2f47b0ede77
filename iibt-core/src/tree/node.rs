//! The kinds of nodes.

use super::status::Status;

/// One node of a tree's table; `L` names the caller's leaves.
///
/// An inner node is followed by its children, each with all its descendants. A composite says how
/// many children follow. The rules are those of BehaviorTree.CPP 4.10 and, for the four nodes named
/// so, of Nav2; the [module](super) lists where they differ.
///
/// The kinds up to [`Inverter`](Self::Inverter) make the [`Basic`](super::Basic) set. The others
/// need
/// [`Full`](super::Full). The examples tick each tree once, with leaves that return what they are
/// called:
///
/// ```
/// use Status::{Failure, Running, Skipped, Success};
/// use iibt_core::time::Instant;
/// use iibt_core::tree;
/// use iibt_core::tree::{Full, Halt, Leaves, Memory, Status, Tree};
///
/// struct AsCalled;
///
/// impl Leaves<Status> for AsCalled {
///     fn condition(&mut self, leaf: &Status, _: Instant) -> bool { *leaf == Success }
///     fn on_start(&mut self, leaf: &Status, _: Instant) -> Status { *leaf }
///     fn on_running(&mut self, leaf: &Status, _: Instant) -> Status { *leaf }
///     fn on_halted(&mut self, _: &Status, _: Instant) -> Halt { Halt::Done }
///     fn case(&mut self, _: &Status, _: Instant) -> usize { 1 }
/// }
///
/// fn tick<const N: usize>(tree: Tree<Status, N, Full>) -> Status {
///     tree.tick(&mut Memory::new(), &mut AsCalled, Instant(0)).status
/// }
///
/// // Leaves, and what decides without a leaf.
/// assert_eq!(tick(tree! { Condition(Success) }), Success);
/// assert_eq!(tick(tree! { Action(Running) }), Running);
/// assert_eq!(tick(tree! { Inference(Failure) }), Failure);
/// assert_eq!(tick(tree! { AlwaysSuccess() }), Success);
/// assert_eq!(tick(tree! { AlwaysFailure() }), Failure);
/// assert_eq!(tick(tree! { Sleep(100) }), Running);
///
/// // Sequences stop at the first child that does not succeed.
/// assert_eq!(tick(tree! { Sequence { Action(Success), Action(Success) } }), Success);
/// assert_eq!(tick(tree! { Sequence { Action(Failure), Action(Running) } }), Failure);
/// assert_eq!(tick(tree! { ReactiveSequence { Action(Success), Action(Running) } }), Running);
/// assert_eq!(tick(tree! { PipelineSequence { Action(Success), Action(Success) } }), Success);
///
/// // Fallbacks stop at the first child that does not fail.
/// assert_eq!(tick(tree! { Fallback { Action(Failure), Action(Failure) } }), Failure);
/// assert_eq!(tick(tree! { Fallback { Action(Failure), Action(Success) } }), Success);
/// assert_eq!(tick(tree! { ReactiveFallback { Condition(Failure), Action(Running) } }), Running);
/// assert_eq!(tick(tree! { RoundRobin { Action(Failure), Action(Success) } }), Success);
///
/// // Nodes that yield are running until the next pass.
/// assert_eq!(tick(tree! { SequenceWithMemory { Action(Success), Action(Success) } }), Running);
/// assert_eq!(tick(tree! { AsyncSequence { Action(Success), Action(Success) } }), Running);
/// assert_eq!(tick(tree! { AsyncFallback { Action(Failure), Action(Success) } }), Running);
/// assert_eq!(tick(tree! { AsyncFallback { Action(Success), Action(Failure) } }), Success);
///
/// // Children that are skipped count as if they were not there.
/// assert_eq!(tick(tree! { Sequence { Action(Skipped), Action(Success) } }), Success);
/// assert_eq!(tick(tree! { Fallback { Action(Skipped), Action(Failure) } }), Failure);
/// assert_eq!(tick(tree! { Sequence { Action(Skipped), Action(Skipped) } }), Skipped);
///
/// // Parallel nodes tick every child: two of three must succeed; one failure is one too many.
/// let tree = tree! { Parallel(2, 1) { Action(Success), Action(Running), Action(Success) } };
/// assert_eq!(tick(tree), Success);
/// let tree = tree! { Parallel(2, 1) { Action(Success), Action(Running), Action(Failure) } };
/// assert_eq!(tick(tree), Failure);
/// assert_eq!(tick(tree! { Parallel(-1, 1) { Action(Success), Action(Running) } }), Running);
/// assert_eq!(tick(tree! { ParallelAll(1) { Action(Failure), Action(Success) } }), Failure);
/// assert_eq!(tick(tree! { ParallelAll(2) { Action(Failure), Action(Success) } }), Success);
///
/// // Branches.
/// let tree = tree! { IfThenElse { Condition(Success), Action(Running), Action(Failure) } };
/// assert_eq!(tick(tree), Running);
/// let tree = tree! { IfThenElse { Condition(Failure), Action(Running), Action(Success) } };
/// assert_eq!(tick(tree), Success);
/// assert_eq!(tick(tree! { IfThenElse { Condition(Failure), Action(Running) } }), Failure);
/// let tree = tree! { WhileDoElse { Condition(Success), Action(Running), Action(Failure) } };
/// assert_eq!(tick(tree), Running);
/// let tree = tree! { Switch(Success) { Action(Failure), Action(Running), Action(Success) } };
/// assert_eq!(tick(tree), Running);
///
/// // Decorators change what their child returns, or repeat it.
/// assert_eq!(tick(tree! { Inverter { Action(Success) } }), Failure);
/// assert_eq!(tick(tree! { Inverter { Action(Running) } }), Running);
/// assert_eq!(tick(tree! { ForceSuccess { Action(Failure) } }), Success);
/// assert_eq!(tick(tree! { ForceFailure { Action(Success) } }), Failure);
/// assert_eq!(tick(tree! { KeepRunningUntilFailure { Action(Success) } }), Running);
/// assert_eq!(tick(tree! { RetryUntilSuccessful(3) { Action(Success) } }), Success);
/// assert_eq!(tick(tree! { RetryUntilSuccessful(3) { Action(Failure) } }), Running);
/// assert_eq!(tick(tree! { Repeat(1) { Action(Success) } }), Success);
/// assert_eq!(tick(tree! { RecoveryNode(1) { Action(Failure), Action(Running) } }), Running);
/// assert_eq!(tick(tree! { RunOnce(true) { Action(Failure) } }), Failure);
/// assert_eq!(tick(tree! { SubTree { Action(Success) } }), Success);
///
/// // Decorators that ask first, or that watch the clock.
/// assert_eq!(tick(tree! { Precondition(Success, Skipped) { Action(Running) } }), Running);
/// assert_eq!(tick(tree! { Precondition(Failure, Skipped) { Action(Running) } }), Skipped);
/// assert_eq!(tick(tree! { Delay(50) { Action(Success) } }), Running);
/// assert_eq!(tick(tree! { Timeout(50) { Action(Success) } }), Success);
/// assert_eq!(tick(tree! { RateController(50) { Action(Success) } }), Success);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Node<L> {
    /// An action, which may take several ticks.
    #[doc(alias("task", "behavior", "StatefulActionNode"))]
    Action(L),
    /// An interactive inference node: to the tree an action like any other.
    #[doc(alias("active inference", "AIF"))]
    Inference(L),
    /// A condition, which is answered at once.
    #[doc(alias("predicate", "check"))]
    Condition(L),

    /// Succeeds when all its children have succeeded and fails with the first that fails. Resumes
    /// at the child that was running.
    #[doc(alias("and", "sequence"))]
    Sequence(u8),
    /// Succeeds with the first child that succeeds and fails when all have failed. Resumes at the
    /// child that was running.
    #[doc(alias("selector", "or", "priority", "fallback"))]
    Fallback(u8),
    /// A sequence that starts from its first child at every tick.
    #[doc(alias("memoryless sequence", "guard"))]
    ReactiveSequence(u8),
    /// A fallback that starts from its first child at every tick.
    #[doc(alias("reactive selector", "memoryless fallback"))]
    ReactiveFallback(u8),
    /// Exchanges success and failure of its one child.
    #[doc(alias("not", "decorator", "negation"))]
    Inverter,

    /// A sequence that, after a failure or a halt, goes on at the child it had come to. Yields
    /// after each child that finishes in its first tick.
    #[doc(alias = "SequenceStar")]
    SequenceWithMemory(u8),
    /// A sequence that yields after each child that succeeds in its first tick, so that it can be
    /// interrupted.
    AsyncSequence(u8),
    /// A fallback that yields after each child that fails in its first tick.
    AsyncFallback(u8),
    /// Ticks all its children that have not finished, in order, until enough have succeeded or
    /// failed. Then it halts the rest. A negative count counts from all of them: -1 all, -2 all but
    /// one.
    #[doc(alias("concurrent", "threshold"))]
    Parallel {
        /// The number of children, 127 at the most.
        children: u8,
        /// The number of successes with which it succeeds.
        success_count: i8,
        /// The number of failures with which it fails.
        failure_count: i8,
    },
    /// Ticks its children until all have finished. Then it fails if at least `max_failures`
    /// (negative: as in [`Parallel`](Self::Parallel)) have failed.
    ParallelAll {
        /// The number of children, 127 at the most.
        children: u8,
        /// The number of failures with which it fails.
        max_failures: i8,
    },
    /// Ticks its second child if the first succeeds, else its third or, without one, fails. The
    /// first is not asked again while the chosen child runs.
    #[doc(alias = "branch")]
    IfThenElse(u8),
    /// Like [`IfThenElse`](Self::IfThenElse), but asks the first child at every tick and halts the
    /// other when the answer changes.
    WhileDoElse(u8),
    /// Ticks the child that [`Leaves::case`](super::Leaves::case) names. The last of the 3 to 7
    /// children is the default. Halts the one it leaves.
    #[doc(alias("case", "match"))]
    Switch(u8, L),
    /// Nav2: a sequence that, while a child runs, ticks all those before it again.
    PipelineSequence(u8),
    /// Nav2: a fallback that starts after the child that succeeded last, and goes round.
    RoundRobin(u8),
    /// Nav2: ticks its second child when the first fails, then the first again. Holds the greatest
    /// number of retries.
    RecoveryNode(u8),

    /// Returns success when its child has finished.
    ForceSuccess,
    /// Returns failure when its child has finished.
    ForceFailure,
    /// Is running until its child fails.
    KeepRunningUntilFailure,
    /// Ticks its child again when it has failed. Holds the number of attempts.
    #[doc(alias = "retry")]
    RetryUntilSuccessful(Times),
    /// Ticks its child again when it has succeeded. Holds the number of cycles.
    #[doc(alias("loop", "for", "while"))]
    Repeat(Times),
    /// Halts its child and fails when the time has passed. Zero is no limit.
    #[doc(alias = "deadline")]
    Timeout(Millis),
    /// Waits before it ticks its child.
    #[doc(alias = "wait")]
    Delay(Millis),
    /// Ticks its child until that has finished once, then never again.
    #[doc(alias = "one shot")]
    RunOnce {
        /// Whether it is skipped from then on; otherwise it repeats the status.
        then_skip: bool,
    },
    /// Ticks its child while the condition holds, else halts it.
    #[doc(alias = "guard")]
    Precondition {
        /// The name of the condition, for [`Leaves::condition`](super::Leaves::condition).
        condition: L,
        /// Its own status while the condition does not hold.
        otherwise: Status,
    },
    /// Nav2: starts its child at most once in a period and is running meanwhile.
    #[doc(alias = "throttle")]
    RateController(Millis),
    /// Marks the place where another tree was put in, and passes its child's status on. It keeps
    /// the numbering of BehaviorTree.CPP, where such a node has a number of its own.
    SubTree,

    /// Succeeds at once.
    AlwaysSuccess,
    /// Fails at once.
    AlwaysFailure,
    /// Is running until the time has passed, then succeeds.
    #[doc(alias = "wait")]
    Sleep(Millis),
}

/// A duration in milliseconds that takes three bytes, so that a row of the table takes eight.
///
/// Every number of milliseconds below 2^23 (2 hours) fits, and from there on whole seconds up to 24
/// days, which is what a wrapping clock can measure. A table with a duration that does not fit is
/// refused with [`TreeRule::Duration`](super::TreeRule::Duration).
///
/// ```
/// use iibt_core::tree::{Full, Millis, Node, TreeRule, Tree};
///
/// assert_eq!(Millis::new(2500).get(), 2500);
/// assert_eq!(Millis::new(24 * 3600 * 1000).get(), 86_400_000);
/// assert_eq!(Millis::new(8_388_609).get(), u32::MAX, "more than 2 hours and no whole second");
/// assert_eq!(Millis::new(Millis::MAX).get(), Millis::MAX);
///
/// let tree = Tree::<(), 1, Full>::try_new([Node::Sleep(Millis::new(u32::MAX))]);
/// assert_eq!(tree.map_err(|error| error.rule), Err(TreeRule::Duration));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Millis([u8; 3]);

impl Millis {
    /// The longest duration.
    pub const MAX: u32 = i32::MAX as u32 / 1000 * 1000;

    const SECONDS: u32 = 1 << 23;

    /// A duration of this number of milliseconds.
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

    /// The number of milliseconds; [`u32::MAX`] for one that did not fit.
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

/// A number of attempts or cycles, possibly without end; three bytes like [`Millis`].
///
/// A table with a number that does not fit is refused with
/// [`TreeRule::Times`](super::TreeRule::Times).
///
/// ```
/// use iibt_core::tree::{Full, Node, TreeRule, Times, Tree};
///
/// assert_eq!(Times::new(3).get(), 3);
/// assert_eq!(Times::FOREVER, Times::new(-1));
/// assert_eq!(Times::new(Times::MAX).get(), 8_388_607);
///
/// let nodes = [Node::Repeat(Times::new(-7)), Node::Action(())];
/// let error = Tree::<(), 2, Full>::try_new(nodes).unwrap_err();
/// assert_eq!((error.node, error.rule), (0, TreeRule::Times));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Times([u8; 3]);

impl Times {
    /// The largest number.
    pub const MAX: i32 = (1 << 23) - 1;

    /// Without end, written -1 in BehaviorTree.CPP.
    pub const FOREVER: Self = Self::new(-1);

    /// This number of times, -1 for without end.
    #[must_use]
    pub const fn new(times: i32) -> Self {
        let fits = times >= -1 && times <= Self::MAX;
        let [a, b, c, _] = (if fits { times } else { -2 }).to_le_bytes();
        Self([a, b, c])
    }

    /// The number; -1 for without end, -2 for one that did not fit.
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
    /// The number of children, or `None` for a leaf.
    ///
    /// ```
    /// use iibt_core::tree::Node;
    ///
    /// assert_eq!(Node::<()>::Sequence(3).children(), Some(3));
    /// assert_eq!(Node::<()>::Inverter.children(), Some(1));
    /// assert_eq!(Node::Action("charge").children(), None);
    /// ```
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

    /// The name of its leaf, of its condition or of its choice, if it has one.
    #[must_use]
    pub const fn leaf(&self) -> Option<&L> {
        match self {
            Self::Action(leaf)
            | Self::Inference(leaf)
            | Self::Condition(leaf)
            | Self::Switch(_, leaf)
            | Self::Precondition { condition: leaf, .. } => Some(leaf),
            _ => None,
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
    ///
    /// ```
    /// use iibt_core::tree::{Node, Times};
    ///
    /// assert!(Node::<()>::Fallback(2).is_basic());
    /// assert!(!Node::<()>::Repeat(Times::FOREVER).is_basic());
    /// ```
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
