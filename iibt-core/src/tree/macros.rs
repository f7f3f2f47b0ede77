//! The nested notation for trees.

/// Builds a [`Tree`](crate::tree::Tree) from nested nodes; the numbers of children are counted.
///
/// Each node is the name of a [`Node`](crate::tree::Node) with its children in braces or its leaf
/// in parentheses. What else a node needs stands in parentheses before its children, durations in
/// milliseconds:
///
/// | written | |
/// |---|---|
/// | `Parallel(-1, 1) { .. }` | counts of successes and failures |
/// | `ParallelAll(1) { .. }` | count of failures |
/// | `Switch(leaf) { .. }`, `RecoveryNode(3) { .. }` | the name of the choice; retries |
/// | `RetryUntilSuccessful(3) { .. }`, `Repeat(-1) { .. }` | times, -1 for ever |
/// | `Timeout(500) { .. }`, `Delay(20) { .. }` | milliseconds |
/// | `RateController(100) { .. }`, `Sleep(10)` | milliseconds |
/// | `Precondition(leaf, Status::Skipped) { .. }` | condition; status while it does not hold |
/// | `RunOnce(true) { .. }` | whether it is skipped afterwards |
/// | `AlwaysSuccess()`, `AlwaysFailure()` | |
///
/// In a `static` or `const`, a mistake fails the build.
///
/// The macro recurses once a node: more than about 120 nodes need a larger `recursion_limit` in the
/// crate that uses it, or a table given to [`Tree::new`](crate::tree::Tree::new).
///
/// ```
/// use iibt_core::tree::{Node, Tree};
///
/// #[derive(Clone, Copy, Debug, PartialEq)]
/// enum Skill { BatteryEnough, Charge, MoveToGoal }
///
/// static MISSION: Tree<Skill, 5> = iibt_core::tree! {
///     Sequence {
///         Fallback {
///             Condition(Skill::BatteryEnough),
///             Action(Skill::Charge),
///         },
///         Inference(Skill::MoveToGoal),
///     }
/// };
///
/// assert_eq!(MISSION, Tree::new([
///     Node::Sequence(2),
///         Node::Fallback(2),
///             Node::Condition(Skill::BatteryEnough),
///             Node::Action(Skill::Charge),
///         Node::Inference(Skill::MoveToGoal),
/// ]));
/// ```
///
/// Kinds beyond the basic ones need the full set:
///
/// ```
/// use iibt_core::tree::{Full, Node, Tree};
///
/// const KNOCK: Tree<&str, 6, Full> = iibt_core::tree! {
///     Timeout(5000) {
///         RetryUntilSuccessful(3) {
///             Sequence { Action("knock"), Delay(500) { Action("listen") } }
///         }
///     }
/// };
///
/// assert_eq!(KNOCK.counts().decorators, 3);
/// assert_eq!(KNOCK.nodes().nth(5), Some(&Node::Action("listen")));
/// ```
///
/// ```compile_fail
/// use iibt_core::tree::Tree;
///
/// // error: a behavior tree of the basic set has a node of another kind: use Full
/// static KNOCK: Tree<&str, 2> = iibt_core::tree! { Repeat(3) { Action("knock") } };
/// ```
#[doc(alias("behavior tree", "builder", "XML"))]
#[macro_export]
macro_rules! tree {
    (@table [$($row:expr,)*]) => {
        $crate::tree::Tree::new([$($row),*])
    };
    (@table [$($row:expr,)*] $kind:ident ($($with:tt)*) { $($children:tt)* } $($rest:tt)*) => {
        $crate::tree!(@inner [$($row,)*] $kind ($($with)*) { $($children)* } $($rest)*)
    };
    (@table [$($row:expr,)*] $kind:ident { $($children:tt)* } $($rest:tt)*) => {
        $crate::tree!(@inner [$($row,)*] $kind () { $($children)* } $($rest)*)
    };
    (@table [$($row:expr,)*] $kind:ident ($($with:tt)*) $($rest:tt)*) => {
        $crate::tree!(@table [$($row,)* $crate::tree!(@leaf $kind ($($with)*)),] $($rest)*)
    };
    (
        @inner [$($row:expr,)*] $kind:ident $with:tt
        { $($child:ident $(($($child_with:tt)*))? $({$($below:tt)*})?),* $(,)? } $($rest:tt)*
    ) => {
        $crate::tree!(
            @table
            [$($row,)* $crate::tree!(@node $kind $with {
                const CHILDREN: &[&::core::primitive::str] = &[$(::core::stringify!($child)),*];
                ::core::assert!(CHILDREN.len() <= 255, "a composite has at most 255 children");
                CHILDREN.len() as u8
            }),]
            $($child $(($($child_with)*))? $({$($below)*})?)* $($rest)*
        )
    };
    (@node Inverter () $count:block) => { $crate::tree!(@only_child $count $crate::tree::Node::Inverter) };
    (@node ForceSuccess () $count:block) => { $crate::tree!(@only_child $count $crate::tree::Node::ForceSuccess) };
    (@node ForceFailure () $count:block) => { $crate::tree!(@only_child $count $crate::tree::Node::ForceFailure) };
    (@node KeepRunningUntilFailure () $count:block) => {
        $crate::tree!(@only_child $count $crate::tree::Node::KeepRunningUntilFailure)
    };
    (@node SubTree () $count:block) => { $crate::tree!(@only_child $count $crate::tree::Node::SubTree) };
    (@node RetryUntilSuccessful ($times:expr) $count:block) => {
        $crate::tree!(@only_child $count $crate::tree::Node::RetryUntilSuccessful($crate::tree::Times::new($times)))
    };
    (@node Repeat ($times:expr) $count:block) => {
        $crate::tree!(@only_child $count $crate::tree::Node::Repeat($crate::tree::Times::new($times)))
    };
    (@node Timeout ($time:expr) $count:block) => {
        $crate::tree!(@only_child $count $crate::tree::Node::Timeout($crate::tree::Millis::new($time)))
    };
    (@node Delay ($time:expr) $count:block) => {
        $crate::tree!(@only_child $count $crate::tree::Node::Delay($crate::tree::Millis::new($time)))
    };
    (@node RateController ($time:expr) $count:block) => {
        $crate::tree!(@only_child $count $crate::tree::Node::RateController($crate::tree::Millis::new($time)))
    };
    (@node RunOnce ($skip:expr) $count:block) => {
        $crate::tree!(@only_child $count $crate::tree::Node::RunOnce { then_skip: $skip })
    };
    (@node Precondition ($leaf:expr, $otherwise:expr) $count:block) => {
        $crate::tree!(
            @only_child $count $crate::tree::Node::Precondition { condition: $leaf, otherwise: $otherwise }
        )
    };
    (@node RecoveryNode ($retries:expr) $count:block) => {{
        ::core::assert!($count == 2, "a recovery node has exactly two children");
        $crate::tree::Node::RecoveryNode($retries)
    }};
    (@node Switch ($leaf:expr) $count:block) => { $crate::tree::Node::Switch($count, $leaf) };
    (@node Parallel ($success:expr, $failure:expr) $count:block) => {
        $crate::tree::Node::Parallel { children: $count, success_count: $success, failure_count: $failure }
    };
    (@node ParallelAll ($failures:expr) $count:block) => {
        $crate::tree::Node::ParallelAll { children: $count, max_failures: $failures }
    };
    (@node $kind:ident () $count:block) => { $crate::tree::Node::$kind($count) };
    (@only_child $count:block $node:expr) => {{
        ::core::assert!($count == 1, "a decorator has exactly one child");
        $node
    }};
    (@leaf AlwaysSuccess ()) => { $crate::tree::Node::AlwaysSuccess };
    (@leaf AlwaysFailure ()) => { $crate::tree::Node::AlwaysFailure };
    (@leaf Sleep ($time:expr)) => { $crate::tree::Node::Sleep($crate::tree::Millis::new($time)) };
    (@leaf $kind:ident ($leaf:expr)) => { $crate::tree::Node::$kind($leaf) };
    ($($tree:tt)*) => {
        $crate::tree!(@table [] $($tree)*)
    };
}

/// Builds a tree of the basic kinds as code instead of a table, in the notation of
/// [`tree!`](crate::tree!).
///
/// The value's type is the tree; see [`compiled`](crate::tree::compiled). Let a function own it, or
/// be generic over
/// [`Compiled`](crate::tree::Compiled).
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Compiled, Halt, Leaves, Status};
///
/// struct Door { open: bool }
///
/// impl Leaves<&str> for Door {
///     fn condition(&mut self, _: &&str, _: Instant) -> bool { self.open }
///     fn on_start(&mut self, _: &&str, _: Instant) -> Status { self.open = true; Status::Success }
///     fn on_running(&mut self, _: &&str, _: Instant) -> Status { Status::Success }
///     fn on_halted(&mut self, _: &&str, _: Instant) -> Halt { Halt::Done }
/// }
///
/// let mut tree = iibt_core::compiled_tree! {
///     Fallback { Condition("is open"), Action("open it") }
/// };
/// let mut door = Door { open: false };
/// assert_eq!(tree.tick(&mut door, Instant(0)), Status::Success);
/// assert!(door.open);
/// ```
#[macro_export]
macro_rules! compiled_tree {
    (@list) => { $crate::tree::compiled::End };
    (@list $kind:ident $body:tt $(, $($rest:tt)*)?) => {
        $crate::tree::compiled::Cons(
            $crate::compiled_tree!(@node $kind $body),
            $crate::compiled_tree!(@list $($($rest)*)?),
        )
    };
    (@node Sequence { $($children:tt)* }) => {
        $crate::tree::compiled::Composite::<_, true, false>($crate::compiled_tree!(@list $($children)*))
    };
    (@node Fallback { $($children:tt)* }) => {
        $crate::tree::compiled::Composite::<_, false, false>($crate::compiled_tree!(@list $($children)*))
    };
    (@node ReactiveSequence { $($children:tt)* }) => {
        $crate::tree::compiled::Composite::<_, true, true>($crate::compiled_tree!(@list $($children)*))
    };
    (@node ReactiveFallback { $($children:tt)* }) => {
        $crate::tree::compiled::Composite::<_, false, true>($crate::compiled_tree!(@list $($children)*))
    };
    (@node Inverter { $kind:ident $body:tt $(,)? }) => {
        $crate::tree::compiled::Inverter($crate::compiled_tree!(@node $kind $body))
    };
    (@node Condition ($leaf:expr)) => { $crate::tree::compiled::CompiledCondition(|| $leaf) };
    (@node Action ($leaf:expr)) => { $crate::tree::compiled::CompiledAction(|| $leaf) };
    (@node Inference ($leaf:expr)) => { $crate::tree::compiled::CompiledAction(|| $leaf) };
    ($kind:ident $body:tt) => {
        $crate::tree::compiled::Root::new($crate::compiled_tree!(@node $kind $body))
    };
}
