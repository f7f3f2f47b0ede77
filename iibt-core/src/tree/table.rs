//! A checked tree.

use super::check;
use super::check::{Rule, TreeError};
use super::context::Context;
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
        TreeRef::linked(&self.rows)
    }

    /// Ticks the tree exactly once: one pass, starting or continuing what it leads to.
    ///
    /// `memory` must be this tree's own; with that of another tree the nodes that are ticked mean
    /// nothing, but the tick ends all the same.
    #[inline(always)]
    pub fn tick(
        &self,
        memory: &mut Memory<N, K>,
        leaves: &mut (impl Leaves<L> + ?Sized),
        now: Instant,
    ) -> Tick {
        self.by_ref().tick(&mut memory.cells, leaves, now)
    }

    /// Ticks the tree until it no longer wants the next pass at once, `passes` times at the most and at
    /// least once: what BehaviorTree.CPP calls `tickOnce`, with a bound.
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
    /// While the answer is [`Halt::Pending`], some action has not stopped: call it again, or tick, which goes
    /// on halting before it does anything else.
    #[inline(always)]
    pub fn halt(
        &self,
        memory: &mut Memory<N, K>,
        leaves: &mut (impl Leaves<L> + ?Sized),
        now: Instant,
    ) -> Halt {
        self.by_ref().halt(&mut memory.cells, leaves, now)
    }

    /// The leaf that is running, the first in preorder of several; `None` if none is.
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

    /// How many nodes one pass visits at the most, counting a node once for each time.
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

    /// The tree that `rows`, in preorder, describe. Unlike [`Tree::try_new`] it accepts nodes that no tick
    /// can reach; [`never_ticked`](Self::never_ticked) finds them.
    ///
    /// # Errors
    /// The first row that breaks a [`Rule`].
    pub const fn try_new(rows: &'t mut [Row<L>]) -> Result<Self, TreeError> {
        match check::link(rows, K::FULL) {
            Ok(()) => Ok(Self::linked(rows)),
            Err(error) => Err(error),
        }
    }

    /// The first row that no tick can reach, whatever the leaves return. `scratch` has a byte for each row;
    /// the answer is `None` also if it is shorter.
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
        Context::new(self.rows, memory, leaves, now)
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
        Context::new(self.rows, memory, leaves, now)
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
        Context::new(self.rows, memory, leaves, now).map_or(Halt::Done, |mut context| context.halt_tree())
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
