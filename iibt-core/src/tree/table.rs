//! A checked tree.

use super::check;
use super::check::{TreeError, TreeRule};
use super::context::TickContext;
use super::kinds::{Basic, Kinds};
use super::leaves::Leaves;
use super::memory::{Memory, NodeMemory};
use super::node::Node;
use super::row::{NONE, Row};
use super::status::{Halt, Next, Status, Tick};
use crate::time::Instant;
use core::marker::PhantomData;

/// A behavior tree of `N` nodes of the set `K`, whose leaves are named by `L`.
///
/// It never changes: keep it in a `static`, and a [`Memory`] with each robot that ticks it.
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Halt, Leaves, Memory, Node, Status, Tree};
///
/// #[derive(Clone, Copy, Debug, PartialEq)]
/// enum Skill { DoorOpen, OpenDoor, DriveThrough }
///
/// /// The same as `tree! { Sequence { Fallback { .. }, Action(Skill::DriveThrough) } }`.
/// static ENTER: Tree<Skill, 5> = Tree::new([
///     Node::Sequence(2),
///         Node::Fallback(2),
///             Node::Condition(Skill::DoorOpen),
///             Node::Action(Skill::OpenDoor),
///         Node::Action(Skill::DriveThrough),
/// ]);
///
/// struct Robot { open: bool, inside: bool }
///
/// impl Leaves<Skill> for Robot {
///     fn condition(&mut self, _: &Skill, _: Instant) -> bool { self.open }
///     fn on_start(&mut self, _: &Skill, _: Instant) -> Status { Status::Running }
///     fn on_running(&mut self, leaf: &Skill, _: Instant) -> Status {
///         self.open |= *leaf == Skill::OpenDoor;
///         self.inside |= *leaf == Skill::DriveThrough;
///         Status::Success
///     }
///     fn on_halted(&mut self, _: &Skill, _: Instant) -> Halt { Halt::Done }
/// }
///
/// let (mut robot, mut memory) = (Robot { open: false, inside: false }, Memory::new());
/// let mut tick = |now| ENTER.tick(&mut memory, &mut robot, Instant(now)).status;
/// assert_eq!([tick(0), tick(1), tick(2)], [Status::Running, Status::Running, Status::Success]);
/// assert!(robot.open && robot.inside);
/// assert_eq!(ENTER.parent(3), Some(1));
/// assert_eq!(ENTER.nodes().nth(4), Some(&Node::Action(Skill::DriveThrough)));
/// ```
#[doc(alias("behavior tree", "behaviour tree", "BT"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tree<L, const N: usize, K: Kinds = Basic> {
    pub(super) rows: [Row<L>; N],
    kinds: PhantomData<K>,
}

/// A tree whose size is known only at run time, over rows that live elsewhere.
///
/// [`OwnedTree`](super::OwnedTree) owns its rows.
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Full, Halt, Leaves, Node, NodeMemory, Row, Status, TreeRef};
///
/// struct Robot;
///
/// impl Leaves<u16> for Robot {
///     fn condition(&mut self, number: &u16, _: Instant) -> bool { *number == 0 }
///     fn on_start(&mut self, _: &u16, _: Instant) -> Status { Status::Running }
///     fn on_running(&mut self, _: &u16, _: Instant) -> Status { Status::Running }
///     fn on_halted(&mut self, _: &u16, _: Instant) -> Halt { Halt::Done }
/// }
///
/// let mut rows = [Node::Sequence(2), Node::Condition(0), Node::Action(1)].map(Row::new);
/// let tree: TreeRef<u16, Full> = TreeRef::try_new(&mut rows)?;
/// let mut memory = [NodeMemory::NEW; 3];
/// assert_eq!(tree.tick(&mut memory, &mut Robot, Instant(0)).status, Status::Running);
/// assert_eq!(tree.running(&memory), Some(&1));
/// assert_eq!(tree.halt(&mut memory, &mut Robot, Instant(1)), Halt::Done);
/// assert_eq!((tree.running(&memory), tree.visits(&mut [(0, 0); 3])), (None, 3));
/// assert_eq!(tree.never_ticked(&mut [0; 3]), None);
///
/// let too_short = &mut memory[..2];
/// assert_eq!(tree.tick(too_short, &mut Robot, Instant(2)).status, Status::Failure);
/// # Ok::<(), iibt_core::tree::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct TreeRef<'t, L, K: Kinds = Basic> {
    rows: &'t [Row<L>],
    kinds: PhantomData<K>,
}

impl<L: Copy, const N: usize, K: Kinds> Tree<L, N, K> {
    /// Creates the tree that a table in preorder describes. In a `const` or `static`, a table that
    /// breaks a [`TreeRule`] fails the build with a message that names the rule.
    ///
    /// ```compile_fail
    /// use iibt_core::tree::{Node, Tree};
    ///
    /// // error: evaluation panicked: a composite of a behavior tree has no children
    /// static TREE: Tree<u8, 1> = Tree::new([Node::Sequence(0)]);
    /// ```
    ///
    /// # Panics
    /// When called at run time with a table that breaks a rule: use [`try_new`](Self::try_new)
    /// there.
    #[must_use]
    pub const fn new(nodes: [Node<L>; N]) -> Self {
        match Self::try_new(nodes) {
            Ok(tree) => tree,
            Err(error) => panic!("{}", error.rule.message()),
        }
    }

    /// Creates the tree that a table in preorder describes.
    ///
    /// # Errors
    /// The first row that breaks a [`TreeRule`]; for [`TreeRule::MissingChildren`] the innermost
    /// node that lacks a child.
    ///
    /// ```
    /// use iibt_core::tree::{Node, TreeRule, Tree};
    ///
    /// let nodes = [Node::Sequence(2), Node::Fallback(2), Node::Action('a')];
    /// let error = Tree::<_, 3>::try_new(nodes).unwrap_err();
    /// assert_eq!((error.node, error.rule), (1, TreeRule::MissingChildren));
    /// assert!(Tree::<_, 2>::try_new([Node::Inverter, Node::Condition('c')]).is_ok());
    /// ```
    pub const fn try_new(nodes: [Node<L>; N]) -> Result<Self, TreeError> {
        if N == 0 {
            return Err(TreeError { node: 0, rule: TreeRule::Empty });
        }
        let mut rows = [Row::new(nodes[0]); N];
        let mut at = 0;
        while at < N {
            rows[at] = Row::new(nodes[at]);
            at += 1;
        }
        if let Err(error) = check::link(&mut rows, K::FULL) {
            return Err(error);
        }
        match check::never_ticked(&rows, &mut [0; N]) {
            Some(node) => Err(TreeError { node, rule: TreeRule::NeverTicked }),
            None => Ok(Self { rows, kinds: PhantomData }),
        }
    }
}

impl<L, const N: usize, K: Kinds> Tree<L, N, K> {
    /// The number of nodes.
    pub const NODES: usize = N;

    /// Borrows the tree without its size in its type.
    ///
    /// ```
    /// use iibt_core::tree::{Tree, TreeRef};
    ///
    /// static SMALL: Tree<u8, 1> = iibt_core::tree! { Action(1) };
    /// static LARGE: Tree<u8, 3> = iibt_core::tree! { Fallback { Condition(1), Action(2) } };
    ///
    /// let trees: [TreeRef<u8>; 2] = [SMALL.by_ref(), LARGE.by_ref()];
    /// assert_eq!(trees.map(|tree| tree.nodes().len()), [1, 3]);
    /// ```
    #[must_use]
    pub const fn by_ref(&self) -> TreeRef<'_, L, K> {
        TreeRef::linked(&self.rows)
    }

    /// Ticks the tree exactly once: one pass, starting or continuing what it leads to.
    ///
    /// `memory` must be this tree's own; with that of another tree the nodes that are ticked mean
    /// nothing, but the tick ends all the same.
    ///
    /// ```
    /// # use iibt_core::time::Instant;
    /// # use iibt_core::tree::{Full, Halt, Leaves, Memory, Next, Status, Tree};
    /// # struct Robot { charged: bool }
    /// # impl Leaves<&str> for Robot {
    /// #     fn condition(&mut self, _: &&str, _: Instant) -> bool { self.charged }
    /// #     fn on_start(&mut self, _: &&str, _: Instant) -> Status { Status::Running }
    /// #     fn on_running(&mut self, _: &&str, _: Instant) -> Status { Status::Success }
    /// #     fn on_halted(&mut self, _: &&str, _: Instant) -> Halt { Halt::Done }
    /// # }
    /// static CHARGE: Tree<&str, 3> = iibt_core::tree! {
    ///     Fallback { Condition("charged"), Action("charge") }
    /// };
    ///
    /// let (mut robot, mut memory) = (Robot { charged: false }, Memory::new());
    /// let first = CHARGE.tick(&mut memory, &mut robot, Instant(0));
    /// assert_eq!((first.status, first.next), (Status::Running, Next::Event));
    /// let second = CHARGE.tick(&mut memory, &mut robot, Instant(10));
    /// assert_eq!((second.status, second.next), (Status::Success, Next::Event));
    /// ```
    #[doc(alias("tickExactlyOnce", "execute", "update"))]
    #[inline(always)]
    pub fn tick(
        &self,
        memory: &mut Memory<N, K>,
        leaves: &mut (impl Leaves<L> + ?Sized),
        now: Instant,
    ) -> Tick {
        self.by_ref().tick(&mut memory.cells, leaves, now)
    }

    /// Ticks the tree until it no longer wants the next pass at once, `passes` times at the most
    /// and at least once. This is what BehaviorTree.CPP calls `tickOnce`, with a bound.
    ///
    /// ```
    /// # use iibt_core::time::Instant;
    /// # use iibt_core::tree::{Full, Halt, Leaves, Memory, Next, Status, Tree};
    /// # struct Robot { charged: bool }
    /// # impl Leaves<&str> for Robot {
    /// #     fn condition(&mut self, _: &&str, _: Instant) -> bool { self.charged }
    /// #     fn on_start(&mut self, _: &&str, _: Instant) -> Status { Status::Running }
    /// #     fn on_running(&mut self, _: &&str, _: Instant) -> Status { Status::Success }
    /// #     fn on_halted(&mut self, _: &&str, _: Instant) -> Halt { Halt::Done }
    /// # }
    /// static TWICE: Tree<&str, 2, Full> = iibt_core::tree! { Repeat(3) { Condition("charged") } };
    ///
    /// let (mut robot, mut memory) = (Robot { charged: true }, Memory::new());
    /// let tick = TWICE.tick(&mut memory, &mut robot, Instant(0));
    /// assert_eq!((tick.status, tick.next), (Status::Running, Next::Now), "a loop yields");
    /// let tick = TWICE.tick_until_idle(&mut memory, &mut robot, Instant(0), 10);
    /// assert_eq!(tick.status, Status::Success);
    /// ```
    #[doc(alias("tickOnce", "tickWhileRunning"))]
    pub fn tick_until_idle(
        &self,
        memory: &mut Memory<N, K>,
        leaves: &mut (impl Leaves<L> + ?Sized),
        now: Instant,
        passes: u16,
    ) -> Tick {
        self.by_ref().tick_until_idle(&mut memory.cells, leaves, now, passes)
    }

    /// Interrupts the tree: halts every running action and leaves all nodes idle.
    ///
    /// While the answer is [`Halt::Pending`], some action has not stopped: call it again, or tick,
    /// which goes on halting before it does anything else.
    ///
    /// ```
    /// # use iibt_core::time::Instant;
    /// # use iibt_core::tree::{Full, Halt, Leaves, Memory, Next, Status, Tree};
    /// # struct Robot { charged: bool }
    /// # impl Leaves<&str> for Robot {
    /// #     fn condition(&mut self, _: &&str, _: Instant) -> bool { self.charged }
    /// #     fn on_start(&mut self, _: &&str, _: Instant) -> Status { Status::Running }
    /// #     fn on_running(&mut self, _: &&str, _: Instant) -> Status { Status::Success }
    /// #     fn on_halted(&mut self, _: &&str, _: Instant) -> Halt { Halt::Done }
    /// # }
    /// static CHARGE: Tree<&str, 1> = iibt_core::tree! { Action("charge") };
    ///
    /// let (mut robot, mut memory) = (Robot { charged: false }, Memory::new());
    /// CHARGE.tick(&mut memory, &mut robot, Instant(0));
    /// assert!(!memory.is_idle());
    /// assert_eq!(CHARGE.halt(&mut memory, &mut robot, Instant(5)), Halt::Done);
    /// assert!(memory.is_idle());
    /// ```
    #[doc(alias("haltTree", "interrupt", "stop", "preempt", "reset"))]
    #[inline(always)]
    pub fn halt(
        &self,
        memory: &mut Memory<N, K>,
        leaves: &mut (impl Leaves<L> + ?Sized),
        now: Instant,
    ) -> Halt {
        self.by_ref().halt(&mut memory.cells, leaves, now)
    }

    /// The leaf that is running, the first in preorder of several; `None` if none is. It looks at
    /// each node once.
    ///
    /// ```
    /// # use iibt_core::time::Instant;
    /// # use iibt_core::tree::{Full, Halt, Leaves, Memory, Next, Status, Tree};
    /// # struct Robot { charged: bool }
    /// # impl Leaves<&str> for Robot {
    /// #     fn condition(&mut self, _: &&str, _: Instant) -> bool { self.charged }
    /// #     fn on_start(&mut self, _: &&str, _: Instant) -> Status { Status::Running }
    /// #     fn on_running(&mut self, _: &&str, _: Instant) -> Status { Status::Success }
    /// #     fn on_halted(&mut self, _: &&str, _: Instant) -> Halt { Halt::Done }
    /// # }
    /// static CHARGE: Tree<&str, 3> = iibt_core::tree! {
    ///     Fallback { Condition("charged"), Action("charge") }
    /// };
    ///
    /// let (mut robot, mut memory) = (Robot { charged: false }, Memory::new());
    /// assert_eq!(CHARGE.running(&memory), None);
    /// CHARGE.tick(&mut memory, &mut robot, Instant(0));
    /// assert_eq!(CHARGE.running(&memory), Some(&"charge"));
    /// ```
    #[doc(alias("activity", "current action"))]
    #[must_use]
    pub fn running(&self, memory: &Memory<N, K>) -> Option<&L> {
        self.by_ref().running(&memory.cells)
    }

    /// The nodes in the order of the table.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = &Node<L>> {
        self.rows.iter().map(|row| &row.node)
    }

    /// The row of the parent of the node in row `node`; `None` for the root and past the end.
    #[must_use]
    pub fn parent(&self, node: u16) -> Option<u16> {
        self.by_ref().parent(node)
    }

    /// The greatest number of nodes that one pass visits, counting a node once for each time.
    ///
    /// ```
    /// use iibt_core::tree::{Full, Tree};
    ///
    /// const ONCE: Tree<(), 3> = iibt_core::tree! { Sequence { Action(()), Action(()) } };
    /// const AGAIN: Tree<(), 3, Full> = iibt_core::tree! {
    ///     RecoveryNode(2) { Action(()), Action(()) }
    /// };
    ///
    /// const BOUND: u32 = ONCE.visits();
    /// // The root, its first child up to three times, its second up to twice.
    /// assert_eq!((BOUND, AGAIN.visits()), (3, 6));
    /// ```
    #[doc(alias("worst case", "bound"))]
    #[must_use]
    pub const fn visits(&self) -> u32 {
        check::visits(&self.rows, &mut [(0, 0); N])
    }
}

impl<'t, L, K: Kinds> TreeRef<'t, L, K> {
    /// The tree over rows that are linked.
    pub(super) const fn linked(rows: &'t [Row<L>]) -> Self {
        Self { rows, kinds: PhantomData }
    }

    /// Links `rows`, in preorder, to a tree. Unlike [`Tree::try_new`] it accepts nodes that no tick
    /// can reach; [`never_ticked`](Self::never_ticked) finds them.
    ///
    /// # Errors
    /// The first row that breaks a [`TreeRule`].
    pub const fn try_new(rows: &'t mut [Row<L>]) -> Result<Self, TreeError> {
        match check::link(rows, K::FULL) {
            Ok(()) => Ok(Self::linked(rows)),
            Err(error) => Err(error),
        }
    }

    /// The first row that no tick can reach, whatever the leaves return. `scratch` has a byte for
    /// each row; the answer is `None` also if it is shorter.
    ///
    /// ```
    /// use iibt_core::tree::{Full, Node, Row, TreeRef};
    ///
    /// let nodes = [Node::Fallback(2), Node::AlwaysSuccess, Node::Action("never")];
    /// let mut rows = nodes.map(Row::new);
    /// let tree: TreeRef<&str, Full> = TreeRef::try_new(&mut rows).unwrap();
    /// assert_eq!(tree.never_ticked(&mut [0; 3]), Some(2));
    /// ```
    #[doc(alias = "unreachable")]
    #[must_use]
    pub const fn never_ticked(&self, scratch: &mut [u8]) -> Option<u16> {
        if scratch.len() < self.rows.len() { None } else { check::never_ticked(self.rows, scratch) }
    }

    /// As [`Tree::tick`]; `memory` has an element for each row, else the tree fails.
    #[inline(always)]
    pub fn tick(
        &self,
        memory: &mut [NodeMemory<K>],
        leaves: &mut (impl Leaves<L> + ?Sized),
        now: Instant,
    ) -> Tick {
        TickContext::new(self.rows, memory, leaves, now)
            .map_or(Tick { status: Status::Failure, next: Next::Event }, |mut context| context.tick())
    }

    /// As [`Tree::tick_until_idle`].
    pub fn tick_until_idle(
        &self,
        memory: &mut [NodeMemory<K>],
        leaves: &mut (impl Leaves<L> + ?Sized),
        now: Instant,
        passes: u16,
    ) -> Tick {
        TickContext::new(self.rows, memory, leaves, now)
            .map_or(Tick { status: Status::Failure, next: Next::Event }, |mut context| {
                context.tick_until_idle(passes)
            })
    }

    /// As [`Tree::halt`].
    #[inline(always)]
    pub fn halt(
        &self,
        memory: &mut [NodeMemory<K>],
        leaves: &mut (impl Leaves<L> + ?Sized),
        now: Instant,
    ) -> Halt {
        TickContext::new(self.rows, memory, leaves, now).map_or(Halt::Done, |mut context| context.halt_tree())
    }

    /// As [`Tree::running`].
    #[must_use]
    pub fn running(&self, memory: &[NodeMemory<K>]) -> Option<&'t L> {
        self.rows.iter().zip(memory).find_map(|(row, cell)| match &row.node {
            Node::Action(leaf) | Node::Inference(leaf) if cell.is_running() => Some(leaf),
            _ => None,
        })
    }

    /// The nodes in the order of the table.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = &'t Node<L>> + use<'t, L, K> {
        self.rows.iter().map(|row| &row.node)
    }

    /// The row of the parent of the node in row `node`; `None` for the root and past the end.
    #[must_use]
    pub fn parent(&self, node: u16) -> Option<u16> {
        let parent = self.rows.get(usize::from(node))?.parent() as u16;
        (parent != NONE).then_some(parent)
    }

    /// As [`Tree::visits`]; `scratch` has a pair for each row, else the answer is 0.
    #[must_use]
    pub const fn visits(&self, scratch: &mut [(u32, u32)]) -> u32 {
        if scratch.len() < self.rows.len() { 0 } else { check::visits(self.rows, scratch) }
    }
}
