//! The sets of node kinds.

/// A set of node kinds, chosen by a tree's type: kinds outside the set cost neither flash nor RAM.
///
/// ```
/// use iibt_core::tree::{Basic, Full, Kinds, Node, TreeRule, Times, Tree};
///
/// let nodes = [Node::Repeat(Times::new(3)), Node::Action("knock")];
/// assert!(Tree::<_, 2, Full>::try_new(nodes).is_ok());
/// let error = Tree::<_, 2, Basic>::try_new(nodes).unwrap_err();
/// assert_eq!((error.node, error.rule), (0, TreeRule::NotInSet));
/// assert!(Full::FULL && !Basic::FULL && !Full::COMPAT);
/// ```
///
/// Sealed: the sets are [`Basic`], [`Full`] and [`Compat`].
pub trait Kinds: sealed::Sealed + Copy + core::fmt::Debug + Eq {
    /// Whether the set has every [`Node`](super::Node).
    const FULL: bool;
    /// Whether the set also follows the peculiarities of BehaviorTree.CPP.
    const COMPAT: bool;
    /// The memory of a node besides its slot.
    #[doc(hidden)]
    type Extra: sealed::Extra;
}

/// Sequences and fallbacks, also reactive, inverters, and leaves: 4 bytes of RAM per node.
///
/// It leaves out two more things. [`Halt::Pending`](super::Halt::Pending) counts as done, and
/// [`Status::Skipped`](super::Status::Skipped) is passed on like a success.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basic {}

/// Every kind of node: 8 bytes of RAM a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Full {}

/// Every kind of node, following BehaviorTree.CPP 4.10 also in those differences for which the
/// [module](super) says so.
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Compat, Full, Halt, Kinds, Leaves, Memory, Node, Status, Tree};
///
/// struct Asked(u32);
///
/// impl Leaves<()> for Asked {
///     fn condition(&mut self, _: &(), _: Instant) -> bool { self.0 += 1; true }
///     fn on_start(&mut self, _: &(), _: Instant) -> Status { Status::Running }
///     fn on_running(&mut self, _: &(), _: Instant) -> Status { Status::Running }
///     fn on_halted(&mut self, _: &(), _: Instant) -> Halt { Halt::Done }
/// }
///
/// /// How often a precondition is asked in three ticks of its running child.
/// fn asked<K: Kinds>() -> u32 {
///     let tree: Tree<(), 2, K> = iibt_core::tree! {
///         Precondition((), Status::Failure) { Action(()) }
///     };
///     let (mut leaves, mut memory) = (Asked(0), Memory::new());
///     for tick in 0..3 {
///         tree.tick(&mut memory, &mut leaves, Instant(tick));
///     }
///     leaves.0
/// }
///
/// assert_eq!((asked::<Full>(), asked::<Compat>()), (3, 1));
/// ```
#[doc(alias("BehaviorTree.CPP", "BTCPP"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compat {}

impl Kinds for Basic {
    const FULL: bool = false;
    const COMPAT: bool = false;
    type Extra = ();
}

impl Kinds for Full {
    const FULL: bool = true;
    const COMPAT: bool = false;
    type Extra = u32;
}

impl Kinds for Compat {
    const FULL: bool = true;
    const COMPAT: bool = true;
    type Extra = u32;
}

pub(super) mod sealed {
    pub trait Sealed {}

    impl Sealed for super::Basic {}
    impl Sealed for super::Full {}
    impl Sealed for super::Compat {}

    /// A count, or the time at which something began; empty in the basic set.
    pub trait Extra: Copy + PartialEq + core::fmt::Debug {
        const ZERO: Self;
        fn get(self) -> u32;
        fn of(value: u32) -> Self;
    }

    impl Extra for () {
        const ZERO: Self = ();
        fn get(self) -> u32 {
            0
        }
        fn of(_: u32) -> Self {}
    }

    impl Extra for u32 {
        const ZERO: Self = 0;
        fn get(self) -> u32 {
            self
        }
        fn of(value: u32) -> Self {
            value
        }
    }
}
