//! A checked tree.

use super::check;
use super::check::{Rule, TreeError};
use super::kinds::{Basic, Kinds};
use super::leaves::Leaves;
use super::memory::{Cell, Memory};
use super::node::Node;
use super::status::{Halt, Status};
use super::walk;
use crate::time::Instant;
use core::marker::PhantomData;

/// The most levels a tree may have, the root being the first: what BehaviorTree.CPP loads.
pub const MAX_DEPTH: usize = 256;

/// The most nodes a tree may have.
pub const MAX_NODES: usize = 8191;

/// A behavior tree of `N` nodes of the set `K`, whose leaves are named by `L`.
///
/// It never changes; keep it in a `static` and its [`Memory`] beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tree<L, const N: usize, K: Kinds = Basic> {
    pub(super) rows: [Row<L>; N],
    kinds: PhantomData<K>,
}

/// A tree whose size is known only at run time, over rows that live elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct TreeRef<'t, L, K: Kinds = Basic> {
    rows: &'t [Row<L>],
    kinds: PhantomData<K>,
}

/// A node and its way on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row<L> {
    pub(super) node: Node<L>,
    /// What follows when the node has succeeded, and when it has failed. The low 14 bits are a row, [`NONE`] for
    /// none, the high two say which: the next child of the same parent (0), the parent ([`UP`], [`ASK`]), or the
    /// next child if the parent so decides ([`LATER`]; the parent is then in the other of the two).
    pub(super) ways: [u16; 2],
}

/// Past the end of every table.
pub(super) const NONE: u16 = 0x3FFF;

/// To the parent, which has the status of this child.
pub(super) const UP: u16 = 1 << 14;

/// To the parent, which decides what comes next.
pub(super) const ASK: u16 = 2 << 14;

/// To the next child if the parent, which is asked first, wants it.
pub(super) const LATER: u16 = 3 << 14;

/// What a tick came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tick {
    /// The status of the root.
    pub status: Status,
    /// When the next tick can change something.
    pub next: Next,
}

/// When ticking again can change something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Next {
    /// At once: a node has yielded, or an action is still stopping.
    Now,
    /// At this time a timer of the tree, or an action that knows when, is due; an event may come before.
    At(Instant),
    /// When a leaf has something new to say; the tree waits for no time.
    Event,
}

impl<L> Row<L> {
    /// A row that is not linked yet.
    pub const fn new(node: Node<L>) -> Self {
        Self { node, ways: [LATER | NONE; 2] }
    }

    /// The node.
    pub const fn node(&self) -> &Node<L> {
        &self.node
    }

    /// The row of the parent; past the end of every table for the root.
    #[inline]
    pub(super) const fn parent(&self) -> usize {
        let [success, failure] = self.ways;
        ((if success < UP { failure } else { success }) & NONE) as usize
    }

    /// The row of the next child of the same parent.
    pub(super) const fn sibling(&self) -> Option<usize> {
        let [success, failure] = self.ways;
        let next = if success < UP { success } else { failure };
        if matches!(next & LATER, UP | ASK) || next & NONE == NONE {
            None
        } else {
            Some((next & NONE) as usize)
        }
    }

    /// The way on from a success (0) or a failure (1).
    #[inline(always)]
    pub(super) const fn way(&self, failed: usize) -> usize {
        self.ways[failed & 1] as usize
    }

    /// The row of the next child of the same parent, if that is what follows `status` in any case.
    pub(super) const fn next_on(&self, status: Status) -> Option<usize> {
        let [success, failure] = self.ways;
        let way = match status {
            Status::Success => success,
            Status::Failure => failure,
            Status::Running | Status::Skipped => UP,
        };
        if way < UP { Some(way as usize) } else { None }
    }
}

impl<L: Copy, const N: usize, K: Kinds> Tree<L, N, K> {
    /// The tree that a table in preorder describes; in a `const` or `static`, one that breaks a
    /// [`Rule`] fails the build with a message that names the rule.
    ///
    /// ```compile_fail
    /// use iibt_core::tree::{Node, Tree};
    ///
    /// // error: evaluation panicked: a composite of a behavior tree has no children
    /// static TREE: Tree<u8, 1> = Tree::new([Node::Sequence(0)]);
    /// ```
    ///
    /// # Panics
    /// When called at run time with a table that breaks a rule: use [`try_new`](Self::try_new) there.
    #[must_use]
    pub const fn new(nodes: [Node<L>; N]) -> Self {
        match Self::try_new(nodes) {
            Ok(tree) => tree,
            Err(error) => panic!("{}", error.rule.message()),
        }
    }

    /// The tree that a table in preorder describes.
    ///
    /// # Errors
    /// The first row that breaks a [`Rule`]; for [`Rule::MissingChildren`] the innermost node that lacks one.
    pub const fn try_new(nodes: [Node<L>; N]) -> Result<Self, TreeError> {
        if N == 0 {
            return Err(TreeError { node: 0, rule: Rule::Empty });
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
            Some(node) => Err(TreeError { node, rule: Rule::NeverTicked }),
            None => Ok(Self { rows, kinds: PhantomData }),
        }
    }
}

impl<L, const N: usize, K: Kinds> Tree<L, N, K> {
    /// How many nodes it has.
    pub const NODES: usize = N;

    /// The same tree, without its size in its type.
    #[must_use]
    pub const fn by_ref(&self) -> TreeRef<'_, L, K> {
        TreeRef { rows: &self.rows, kinds: PhantomData }
    }

    /// Ticks the tree exactly once: one pass, starting or continuing what it leads to.
    ///
    /// `memory` must be this tree's own; with that of another tree the nodes that are ticked mean
    /// nothing, but the tick ends all the same.
    #[inline(always)]
    pub fn tick<V>(&self, memory: &mut Memory<N, K>, leaves: &mut V, now: Instant) -> Tick
    where
        V: Leaves<L> + ?Sized,
    {
        walk::tick(&self.rows, &mut memory.cells, leaves, now)
    }

    /// Ticks the tree until it no longer wants the next pass at once, `passes` times at the most and at
    /// least once: what BehaviorTree.CPP calls `tickOnce`, with a bound.
    pub fn tick_until_idle<V>(
        &self,
        memory: &mut Memory<N, K>,
        leaves: &mut V,
        now: Instant,
        passes: u16,
    ) -> Tick
    where
        V: Leaves<L> + ?Sized,
    {
        walk::tick_until_idle(&self.rows, &mut memory.cells, leaves, now, passes)
    }

    /// Interrupts the tree: halts every running action and leaves all nodes idle.
    ///
    /// While the answer is [`Halt::Pending`], some action has not stopped: call it again, or tick, which goes
    /// on halting before it does anything else.
    #[inline(always)]
    pub fn halt<V>(&self, memory: &mut Memory<N, K>, leaves: &mut V, now: Instant) -> Halt
    where
        V: Leaves<L> + ?Sized,
    {
        walk::halt(&self.rows, &mut memory.cells, leaves, now)
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

    /// How many nodes one pass visits at the most, counting a node once for each time.
    #[must_use]
    pub const fn visits(&self) -> u32 {
        check::visits(&self.rows, &mut [(0, 0); N])
    }
}

impl<'t, L, K: Kinds> TreeRef<'t, L, K> {
    /// The tree that `rows`, in preorder, describe. Unlike [`Tree::try_new`] it accepts nodes that no tick
    /// can reach; [`never_ticked`](Self::never_ticked) finds them.
    ///
    /// # Errors
    /// The first row that breaks a [`Rule`].
    pub const fn try_new(rows: &'t mut [Row<L>]) -> Result<Self, TreeError> {
        match check::link(rows, K::FULL) {
            Ok(()) => Ok(Self { rows, kinds: PhantomData }),
            Err(error) => Err(error),
        }
    }

    /// The first row that no tick can reach, whatever the leaves return. `scratch` has a byte for each row;
    /// the answer is `None` also if it is shorter.
    #[must_use]
    pub const fn never_ticked(&self, scratch: &mut [u8]) -> Option<u16> {
        if scratch.len() < self.rows.len() { None } else { check::never_ticked(self.rows, scratch) }
    }

    /// As [`Tree::tick`]; `memory` has a cell for each row, else the tree fails.
    #[inline(always)]
    pub fn tick<V>(&self, memory: &mut [Cell<K>], leaves: &mut V, now: Instant) -> Tick
    where
        V: Leaves<L> + ?Sized,
    {
        walk::tick(self.rows, memory, leaves, now)
    }

    /// As [`Tree::tick_until_idle`].
    pub fn tick_until_idle<V>(
        &self,
        memory: &mut [Cell<K>],
        leaves: &mut V,
        now: Instant,
        passes: u16,
    ) -> Tick
    where
        V: Leaves<L> + ?Sized,
    {
        walk::tick_until_idle(self.rows, memory, leaves, now, passes)
    }

    /// As [`Tree::halt`].
    #[inline(always)]
    pub fn halt<V>(&self, memory: &mut [Cell<K>], leaves: &mut V, now: Instant) -> Halt
    where
        V: Leaves<L> + ?Sized,
    {
        walk::halt(self.rows, memory, leaves, now)
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
