//! A checked tree.

use super::leaves::{Leaves, Status};
use super::memory::Memory;
use super::node::Node;
use super::walk;
use crate::time::Instant;

/// The most levels a tree may have, the root being the first: what BehaviorTree.CPP loads.
pub const MAX_DEPTH: usize = 256;

/// The most nodes a tree may have.
pub const MAX_NODES: usize = 1 << 15;

/// A behavior tree of `N` nodes whose leaves are named by `L`.
///
/// It never changes; keep it in a `static` and its [`Memory`] beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tree<L, const N: usize> {
    pub(super) rows: [Row<L>; N],
}

/// A node and its relatives, as row numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Row<L> {
    pub(super) node: Node<L>,
    /// The parent; [`NONE`] for the root.
    pub(super) parent: u16,
    /// The next child of the same parent; [`NONE`] for the last.
    pub(super) next: u16,
    /// The status of this node at which the parent goes on to `next`; running if it never does.
    pub(super) next_on: Status,
}

/// Past the end of every table.
pub(super) const NONE: u16 = u16::MAX;

/// A rule that a table broke.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Rule {
    /// A tree has at least a root.
    Empty,
    /// A tree has at most [`MAX_NODES`] nodes.
    TooLarge,
    /// A composite has at least one child.
    NoChildren,
    /// The children of an inner node follow it.
    MissingChildren,
    /// Every node but the root is the child of another.
    Unreachable,
    /// A tree has at most [`MAX_DEPTH`] levels.
    TooDeep,
}

/// A table that is no tree: the first row that breaks a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TreeError {
    /// The row, from zero.
    pub node: u16,
    /// What is wrong with it.
    pub rule: Rule,
}

impl<L: Copy, const N: usize> Tree<L, N> {
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
        if N > MAX_NODES {
            return Err(TreeError { node: MAX_NODES as u16, rule: Rule::TooLarge });
        }
        let mut rows = [Row { node: nodes[0], parent: NONE, next: NONE, next_on: Status::Running }; N];
        match link(&mut rows, &nodes, [0; N]) {
            Ok(()) => Ok(Self { rows }),
            Err(error) => Err(error),
        }
    }
}

impl<L, const N: usize> Tree<L, N> {
    /// Ticks the tree once: every node at most once, starting or continuing what it leads to.
    ///
    /// `memory` must be this tree's own; with that of another tree the nodes that are ticked mean
    /// nothing, but the tick ends all the same.
    pub fn tick<V>(&self, memory: &mut Memory<N>, leaves: &mut V, now: Instant) -> Status
    where
        V: Leaves<L> + ?Sized,
    {
        walk::tick(&self.rows, &mut memory.slots, leaves, now)
    }

    /// Interrupts the tree: halts every running action and leaves all nodes idle.
    pub fn halt<V>(&self, memory: &mut Memory<N>, leaves: &mut V, now: Instant)
    where
        V: Leaves<L> + ?Sized,
    {
        walk::halt(&self.rows, &mut memory.slots, leaves, now, 0);
    }

    /// The nodes in the order of the table.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = &Node<L>> {
        self.rows.iter().map(|row| &row.node)
    }

    /// The row of the parent of the node in row `node`; `None` for the root and past the end.
    #[must_use]
    pub fn parent(&self, node: u16) -> Option<u16> {
        self.rows.get(usize::from(node)).map(|row| row.parent).filter(|&parent| parent != NONE)
    }
}

/// Fills `rows` from `nodes`; `missing` counts for each row the children that are still to come.
///
/// `open` is the innermost row that misses children and lies past the end of the table when none does.
const fn link<L: Copy, const N: usize>(
    rows: &mut [Row<L>; N],
    nodes: &[Node<L>; N],
    mut missing: [u8; N],
) -> Result<(), TreeError> {
    let mut open = NONE as usize;
    let mut depth = 0;
    let mut at = 0;
    while at < N {
        if let Some(rule) = broken(&nodes[at], at, open < N, depth) {
            return Err(TreeError { node: at as u16, rule });
        }
        rows[at] = Row { node: nodes[at], parent: open as u16, next: NONE, next_on: Status::Running };
        missing[at] = match nodes[at].children() {
            Some(count) => count,
            None => 0,
        };
        open = at;
        depth += 1;
        while open < N && missing[open] == 0 {
            let parent = rows[open].parent as usize;
            depth -= 1;
            if parent < N {
                missing[parent] -= 1;
                if missing[parent] > 0 {
                    rows[open].next = at as u16 + 1;
                    rows[open].next_on = goes_on(&nodes[parent]);
                }
            }
            open = parent;
        }
        at += 1;
    }
    if open < N {
        return Err(TreeError { node: open as u16, rule: Rule::MissingChildren });
    }
    Ok(())
}

/// The status of one child at which `node` ticks the next; running if it has only one.
const fn goes_on<L>(node: &Node<L>) -> Status {
    match node {
        Node::Sequence(_) | Node::ReactiveSequence(_) => Status::Success,
        Node::Fallback(_) | Node::ReactiveFallback(_) => Status::Failure,
        Node::Inverter | Node::Condition(_) | Node::Action(_) | Node::Inference(_) => Status::Running,
    }
}

/// The rule that `node` breaks in row `at`, below `depth` levels, of which the lowest is `open` for a child.
const fn broken<L>(node: &Node<L>, at: usize, open: bool, depth: usize) -> Option<Rule> {
    if at > 0 && !open {
        return Some(Rule::Unreachable);
    }
    if depth == MAX_DEPTH {
        return Some(Rule::TooDeep);
    }
    match node.children() {
        Some(0) => Some(Rule::NoChildren),
        _ => None,
    }
}

impl Rule {
    const fn message(self) -> &'static str {
        match self {
            Self::Empty => "a behavior tree needs a root",
            Self::TooLarge => "a behavior tree has more than 32768 nodes",
            Self::NoChildren => "a composite of a behavior tree has no children",
            Self::MissingChildren => "a node of a behavior tree has fewer children than it says",
            Self::Unreachable => "a node of a behavior tree is no child of another",
            Self::TooDeep => "a behavior tree has more than 256 levels",
        }
    }
}

impl core::fmt::Display for TreeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "node {}: {}", self.node, self.rule.message())
    }
}

impl core::error::Error for TreeError {}

#[cfg(test)]
mod tests {
    use super::*;
    use Node::{Action, Condition, Fallback, Inverter, ReactiveSequence, Sequence};
    use std::string::ToString;

    #[track_caller]
    fn refuses<const N: usize>(nodes: [Node<char>; N], node: u16, rule: Rule) {
        assert_eq!(Tree::try_new(nodes), Err(TreeError { node, rule }));
    }

    #[test]
    fn a_table_that_breaks_a_rule_is_refused_at_its_row() {
        refuses([], 0, Rule::Empty);
        refuses([Sequence(0)], 0, Rule::NoChildren);
        refuses([Sequence(2), Action('a'), Fallback(0), Action('b')], 2, Rule::NoChildren);
        refuses([Sequence(2), Action('a')], 0, Rule::MissingChildren);
        refuses([Sequence(1), Fallback(3), Action('a'), Action('b')], 1, Rule::MissingChildren);
        refuses([ReactiveSequence(2), Action('a'), Inverter], 2, Rule::MissingChildren);
        refuses([Action('a'), Action('b')], 1, Rule::Unreachable);
        refuses([Inverter, Condition('g'), Action('a')], 2, Rule::Unreachable);
        refuses([Sequence(1), Fallback(1), Action('a'), Sequence(0)], 3, Rule::Unreachable);
        refuses([Inverter; MAX_DEPTH + 1], MAX_DEPTH as u16, Rule::TooDeep);
    }

    #[test]
    fn a_table_has_no_more_rows_than_the_memory_can_name() {
        const REFUSED: Result<Tree<(), { MAX_NODES + 1 }>, TreeError> =
            Tree::try_new([Condition(()); MAX_NODES + 1]);
        assert_eq!(REFUSED.err(), Some(TreeError { node: MAX_NODES as u16, rule: Rule::TooLarge }));
    }

    #[test]
    #[should_panic = "a composite of a behavior tree has no children"]
    fn a_constant_table_names_the_rule_it_breaks() {
        let _ = Tree::new([Inverter, Fallback::<char>(0)]);
    }

    #[test]
    fn errors_name_row_and_rule() {
        let error = Tree::try_new([Sequence(2), Action('a')]).unwrap_err();
        assert_eq!(error.to_string(), "node 0: a node of a behavior tree has fewer children than it says");
    }

    #[test]
    fn children_know_their_parent() {
        let tree = Tree::new([Sequence(3), Fallback(1), Action('a'), Inverter, Action('b'), Action('c')]);
        let parents: [_; 7] = core::array::from_fn(|row| tree.parent(row as u16));
        assert_eq!(parents, [None, Some(0), Some(1), Some(0), Some(3), Some(0), None]);
        assert_eq!(tree.nodes().nth(3), Some(&Inverter));
        assert_eq!(tree.nodes().len(), 6);
    }

    #[test]
    fn a_row_takes_eight_bytes_of_flash_with_a_leaf_of_one() {
        assert_eq!(size_of::<Tree<u8, 21>>(), 21 * 8);
    }
}
