//! Checks that a table is a tree, before the first tick, and in a `const` before the program runs.

use super::node::{Millis, Node};
use super::row::{ASK, LATER, MAX_DEPTH, MAX_NODES, NONE, Row, UP};

/// A rule that a table breaks.
///
/// ```
/// use iibt_core::tree::{Full, Millis, Node, TreeRule, Tree};
/// use Node::*;
///
/// fn broken<const N: usize>(nodes: [Node<()>; N]) -> Option<TreeRule> {
///     Tree::<(), N, Full>::try_new(nodes).err().map(|error| error.rule)
/// }
///
/// assert_eq!(broken([Sequence(1), Action(())]), None);
/// assert_eq!(broken([]), Some(TreeRule::Empty));
/// assert_eq!(broken([Sequence(0)]), Some(TreeRule::NoChildren));
/// assert_eq!(broken([Sequence(2), Action(())]), Some(TreeRule::MissingChildren));
/// assert_eq!(broken([Action(()), Action(())]), Some(TreeRule::Unreachable));
/// assert_eq!(broken([IfThenElse(1), Action(())]), Some(TreeRule::Arity));
/// assert_eq!(broken([RateController(Millis::new(0)), Action(())]), Some(TreeRule::Duration));
/// assert_eq!(broken([Fallback(2), AlwaysSuccess, Action(())]), Some(TreeRule::NeverTicked));
/// let three = Parallel { children: 1, success_count: 3, failure_count: 1 };
/// assert_eq!(broken([three, Action(())]), Some(TreeRule::SuccessCount));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TreeRule {
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
    /// An if-then-else or while-do-else has 2 or 3 children, a switch 3 to 7.
    Arity,
    /// A parallel node has at most 127 children.
    TooManyChildren,
    /// A parallel node has as many children as must succeed.
    SuccessCount,
    /// A parallel node has as many children as must fail.
    FailureCount,
    /// A number of attempts or cycles is -1, for ever, or from 0 to [`Times::MAX`].
    ///
    /// [`Times::MAX`]: super::Times::MAX
    Times,
    /// A duration is what [`Millis`] can hold, and a period more than zero.
    Duration,
    /// The kind of node belongs to the tree's set.
    NotInSet,
    /// Every node can be ticked, whatever the leaves return.
    NeverTicked,
}

/// The error of a table that is not a tree: the first row that breaks a rule.
///
/// ```
/// use iibt_core::tree::{Node, TreeRule, Tree, TreeError};
///
/// let nodes = [Node::Sequence(2), Node::Action("fetch"), Node::Fallback(0)];
/// let error = Tree::<_, 3>::try_new(nodes).unwrap_err();
/// assert_eq!(error, TreeError { node: 2, rule: TreeRule::NoChildren });
/// assert_eq!(error.to_string(), "node 2: a composite of a behavior tree has no children");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TreeError {
    /// The row, from zero.
    pub node: u16,
    /// The rule that it breaks.
    pub rule: TreeRule,
}

/// Links the rows of a table in preorder.
///
/// `open` is the innermost row that misses children and lies past the end of the table when none
/// does. Until a row has all its children, its links are the row of its parent and how many of them
/// are still to come.
pub(super) const fn link<L>(rows: &mut [Row<L>], full: bool) -> Result<(), TreeError> {
    if rows.is_empty() {
        return Err(TreeError { node: 0, rule: TreeRule::Empty });
    }
    if rows.len() > MAX_NODES {
        return Err(TreeError { node: MAX_NODES as u16, rule: TreeRule::TooLarge });
    }
    let mut open = NONE as usize;
    let mut depth = 0;
    let mut at = 0;
    while at < rows.len() {
        let rule = match placed_wrongly(at, open < rows.len(), depth) {
            None => broken(&rows[at].node, full),
            rule => rule,
        };
        if let Some(rule) = rule {
            return Err(TreeError { node: at as u16, rule });
        }
        let children = match rows[at].node.children() {
            Some(count) => count as u16,
            None => 0,
        };
        rows[at].links = [open as u16, children];
        open = at;
        depth += 1;
        while open < rows.len() && rows[open].links[1] == 0 {
            depth -= 1;
            let parent = rows[open].links[0] as usize;
            rows[open].links = if parent < rows.len() {
                rows[parent].links[1] -= 1;
                let sibling = if rows[parent].links[1] > 0 { at as u16 + 1 } else { NONE };
                links(&rows[parent].node, parent as u16, sibling)
            } else {
                [LATER | NONE; 2]
            };
            open = parent;
        }
        at += 1;
    }
    if open < rows.len() {
        return Err(TreeError { node: open as u16, rule: TreeRule::MissingChildren });
    }
    Ok(())
}

/// The links from a child of `node`, which is in row `parent`, to the next in row `sibling`.
const fn links<L>(node: &Node<L>, parent: u16, sibling: u16) -> [u16; 2] {
    let up = UP | parent;
    match node {
        Node::Sequence(_) | Node::ReactiveSequence(_) => [if sibling == NONE { up } else { sibling }, up],
        Node::Fallback(_) | Node::ReactiveFallback(_) => [up, if sibling == NONE { up } else { sibling }],
        Node::Inverter => [ASK | parent; 2],
        _ => [ASK | parent, LATER | sibling],
    }
}

/// The rule that a node in row `at` breaks, whatever it is, below `depth` levels, of which the
/// lowest is `open` for a child.
const fn placed_wrongly(at: usize, open: bool, depth: usize) -> Option<TreeRule> {
    if at > 0 && !open {
        Some(TreeRule::Unreachable)
    } else if depth == MAX_DEPTH {
        Some(TreeRule::TooDeep)
    } else {
        None
    }
}

/// The rule that `node` breaks by itself.
const fn broken<L>(node: &Node<L>, full: bool) -> Option<TreeRule> {
    if !full && !node.is_basic() {
        return Some(TreeRule::NotInSet);
    }
    if let Some(0) = node.children() {
        return Some(TreeRule::NoChildren);
    }
    match node {
        Node::IfThenElse(count) | Node::WhileDoElse(count) if *count < 2 || *count > 3 => {
            Some(TreeRule::Arity)
        }
        Node::Switch(count, _) if *count < 3 || *count > 7 => Some(TreeRule::Arity),
        Node::Parallel { children, .. } | Node::ParallelAll { children, .. } if *children > 127 => {
            Some(TreeRule::TooManyChildren)
        }
        Node::Parallel { children, success_count, .. } if *success_count > *children as i8 => {
            Some(TreeRule::SuccessCount)
        }
        Node::Parallel { children, failure_count: most, .. }
        | Node::ParallelAll { children, max_failures: most }
            if *most > *children as i8 =>
        {
            Some(TreeRule::FailureCount)
        }
        Node::RetryUntilSuccessful(times) | Node::Repeat(times) if times.get() < -1 => Some(TreeRule::Times),
        Node::Timeout(time) | Node::Delay(time) | Node::Sleep(time) | Node::RateController(time)
            if time.get() > Millis::MAX =>
        {
            Some(TreeRule::Duration)
        }
        Node::RateController(period) if period.get() == 0 => Some(TreeRule::Duration),
        _ => None,
    }
}

/// The next child of the same parent; past every table after the last.
const fn next<L>(rows: &[Row<L>], child: usize) -> usize {
    if child >= rows.len() {
        return NONE as usize;
    }
    match rows[child].sibling() {
        Some(next) => next,
        None => NONE as usize,
    }
}

/// The most nodes that one pass visits. For each row, `most` gets the number below it if the node
/// was running before, and if it was idle.
pub(super) const fn visits<L>(rows: &[Row<L>], most: &mut [(u32, u32)]) -> u32 {
    let mut at = rows.len();
    while at > 0 {
        at -= 1;
        let (mut all, mut idle, mut largest) = (0_u32, 0_u32, 0_u32);
        let (mut last, mut last_idle) = (0, 0);
        let mut child = if rows[at].node.children().is_some() { at + 1 } else { NONE as usize };
        while child < rows.len() {
            (last, last_idle) = most[child];
            all = all.saturating_add(last);
            idle = idle.saturating_add(last_idle);
            if last > largest {
                largest = last;
            }
            child = next(rows, child);
        }
        let (running, idle) = match rows[at].node {
            Node::Switch(..) => (largest, largest),
            Node::RetryUntilSuccessful(_) | Node::Repeat(_) => (last.saturating_add(last_idle), last_idle),
            Node::RecoveryNode(retries) => {
                let first = idle - last_idle;
                let rounds = idle.saturating_mul(retries as u32).saturating_add(first);
                (rounds.saturating_add(all - idle), rounds)
            }
            _ => (all, idle),
        };
        most[at] = (running.saturating_add(1), idle.saturating_add(1));
    }
    if rows.is_empty() { 0 } else { most[0].0 }
}

/// Sets of statuses that a node can return.
const R: u8 = 1;
const S: u8 = 2;
const F: u8 = 4;
const K: u8 = 8;

/// The statuses that the node in a row can return: none past the end.
const fn of(can: &[u8], row: usize) -> u8 {
    if row < can.len() { can[row] } else { 0 }
}

/// The first row that no tick can reach; `can` gets the set of statuses that each node can return.
pub(super) const fn never_ticked<L>(rows: &[Row<L>], can: &mut [u8]) -> Option<u16> {
    let mut found = None;
    let mut at = rows.len();
    while at > 0 {
        at -= 1;
        let (set, dead) = outcomes(rows, can, at);
        can[at] = set;
        if dead < rows.len() {
            found = Some(dead as u16);
        }
    }
    found
}

/// The statuses that the node in row `at` can return, and the first of its children that it never
/// ticks.
const fn outcomes<L>(rows: &[Row<L>], can: &[u8], at: usize) -> (u8, usize) {
    const NO_ROW: usize = NONE as usize;
    let child = of(can, at + 1);
    let second = next(rows, at + 1);
    let node = &rows[at].node;
    let set = match node {
        Node::Sequence(_)
        | Node::SequenceWithMemory(_)
        | Node::AsyncSequence(_)
        | Node::ReactiveSequence(_)
        | Node::PipelineSequence(_) => return chain(node, rows, can, at, S),
        Node::Fallback(_) | Node::AsyncFallback(_) | Node::ReactiveFallback(_) => {
            return chain(node, rows, can, at, F);
        }
        Node::IfThenElse(_) | Node::WhileDoElse(_) => return branches(rows, can, at, second),
        Node::RecoveryNode(retries) => {
            let recovers = child & F != 0 && *retries > 0;
            let below = child | if recovers { of(can, second) & R } else { 0 };
            return (below, if recovers { NO_ROW } else { second });
        }
        Node::RetryUntilSuccessful(times) | Node::Repeat(times) => {
            let (again, end) = if matches!(node, Node::Repeat(_)) { (S, F) } else { (F, S) };
            if times.get() == 0 {
                return (again, at + 1);
            }
            let exhausted = if times.get() > 0 { again } else { 0 };
            child & (R | K | end) | if child & again != 0 { R | exhausted } else { 0 }
        }
        Node::Parallel { .. } | Node::ParallelAll { .. } | Node::Switch(..) | Node::RoundRobin(_) => {
            R | S | F | K
        }
        Node::Inverter => child & (R | K) | (child & S) << 1 | (child & F) >> 1,
        Node::ForceSuccess => child & (R | K) | if child & (S | F) != 0 { S } else { 0 },
        Node::ForceFailure => child & (R | K) | if child & (S | F) != 0 { F } else { 0 },
        Node::KeepRunningUntilFailure => child & F | if child & !F != 0 { R } else { 0 },
        Node::Timeout(_) => child | if child & R != 0 { F } else { 0 },
        Node::Delay(_) | Node::RateController(_) => child | R,
        Node::RunOnce { then_skip } => child | if *then_skip { K } else { 0 },
        Node::Precondition { otherwise, .. } => child | 1 << (*otherwise as u8 - 1),
        Node::SubTree => child,
        Node::Condition(_) => S | F,
        Node::Action(_) | Node::Inference(_) => R | S | F | K,
        Node::AlwaysSuccess => S,
        Node::AlwaysFailure => F,
        Node::Sleep(_) => R | S,
    };
    (set, NO_ROW)
}

/// The outcomes of a sequence (`passing` success) or fallback (failure) in row `at`.
const fn chain<L>(node: &Node<L>, rows: &[Row<L>], can: &[u8], at: usize, passing: u8) -> (u8, usize) {
    let yields =
        matches!(node, Node::SequenceWithMemory(_) | Node::AsyncSequence(_) | Node::AsyncFallback(_));
    let mut set = 0;
    let mut some_pass = false;
    let mut all_skip = true;
    let mut child = at + 1;
    loop {
        let this = of(can, child);
        set |= this & !(passing | K);
        some_pass |= this & passing != 0;
        all_skip &= this & K != 0;
        let next = next(rows, child);
        if this & (passing | K) == 0 {
            return (set, next);
        }
        if next >= rows.len() {
            break;
        }
        if yields && this & passing != 0 {
            set |= R;
        }
        child = next;
    }
    (set | if some_pass { passing } else { 0 } | if all_skip { K } else { 0 }, NONE as usize)
}

/// The outcomes of a node with a condition in row `at + 1` and one or two branches from row
/// `second` on.
const fn branches<L>(rows: &[Row<L>], can: &[u8], at: usize, second: usize) -> (u8, usize) {
    let condition = of(can, at + 1);
    let third = next(rows, second);
    let mut set = condition & (R | K);
    let mut dead = NONE as usize;
    if condition & F == 0 {
        dead = third;
    } else {
        set |= if third < rows.len() { of(can, third) } else { F };
    }
    if condition & S == 0 {
        dead = second;
    } else {
        set |= of(can, second);
    }
    (set, dead)
}

impl TreeRule {
    pub(super) const fn message(self) -> &'static str {
        match self {
            Self::Empty => "a behavior tree needs a root",
            Self::TooLarge => "a behavior tree has more than 8191 nodes",
            Self::NoChildren => "a composite of a behavior tree has no children",
            Self::MissingChildren => "a node of a behavior tree has fewer children than it says",
            Self::Unreachable => "a node of a behavior tree is no child of another",
            Self::TooDeep => "a behavior tree has more than 256 levels",
            Self::Arity => "IfThenElse and WhileDoElse have 2 or 3 children, Switch has 3 to 7",
            Self::TooManyChildren => "a parallel node of a behavior tree has more than 127 children",
            Self::SuccessCount => "a parallel node of a behavior tree has fewer children than must succeed",
            Self::FailureCount => "a parallel node of a behavior tree has fewer children than must fail",
            Self::Times => "a number of attempts or cycles is neither -1 nor from 0 to 8388607",
            Self::Duration => {
                "a duration is more than 24 days, or more than 2 hours and no whole second, or a period is zero"
            }
            Self::NotInSet => "a behavior tree of the basic set has a node of another kind: use Full",
            Self::NeverTicked => "a node of a behavior tree can never be ticked",
        }
    }
}

impl core::fmt::Display for TreeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "node {}: {}", self.node, self.rule)
    }
}

impl core::fmt::Display for TreeRule {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.message())
    }
}

impl core::error::Error for TreeError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::{Full, Tree};
    use Node::*;
    use std::string::ToString;

    #[track_caller]
    fn refuses<const N: usize>(nodes: [Node<char>; N], node: u16, rule: TreeRule) {
        assert_eq!(Tree::<_, N, Full>::try_new(nodes), Err(TreeError { node, rule }));
    }

    #[test]
    fn a_table_that_breaks_a_rule_is_refused_at_its_row() {
        refuses([], 0, TreeRule::Empty);
        refuses([Sequence(0)], 0, TreeRule::NoChildren);
        refuses([Sequence(2), Action('a'), Fallback(0), Action('b')], 2, TreeRule::NoChildren);
        refuses([Sequence(2), Action('a')], 0, TreeRule::MissingChildren);
        refuses([Sequence(1), Fallback(3), Action('a'), Action('b')], 1, TreeRule::MissingChildren);
        refuses([ReactiveSequence(2), Action('a'), Inverter], 2, TreeRule::MissingChildren);
        refuses([Action('a'), Action('b')], 1, TreeRule::Unreachable);
        refuses([Inverter, Condition('g'), Action('a')], 2, TreeRule::Unreachable);
        refuses([Sequence(1), Fallback(1), Action('a'), Sequence(0)], 3, TreeRule::Unreachable);
        refuses([Inverter; MAX_DEPTH + 1], MAX_DEPTH as u16, TreeRule::TooDeep);
    }

    #[test]
    fn a_table_has_no_more_rows_than_the_memory_can_name() {
        const REFUSED: Result<Tree<(), { MAX_NODES + 1 }>, TreeError> =
            Tree::try_new([Condition(()); MAX_NODES + 1]);
        assert_eq!(REFUSED.err(), Some(TreeError { node: MAX_NODES as u16, rule: TreeRule::TooLarge }));
    }

    #[test]
    #[should_panic = "a composite of a behavior tree has no children"]
    fn a_constant_table_names_the_rule_it_breaks() {
        let _ = Tree::<_, 2>::new([Inverter, Fallback::<char>(0)]);
    }

    #[test]
    fn errors_name_row_and_rule() {
        let error = Tree::<_, 2>::try_new([Sequence(2), Action('a')]).unwrap_err();
        assert_eq!(error.to_string(), "node 0: a node of a behavior tree has fewer children than it says");
    }

    #[test]
    fn children_know_their_parent() {
        let tree =
            Tree::<_, 6>::new([Sequence(3), Fallback(1), Action('a'), Inverter, Action('b'), Action('c')]);
        let parents: [_; 7] = core::array::from_fn(|row| tree.parent(row as u16));
        assert_eq!(parents, [None, Some(0), Some(1), Some(0), Some(3), Some(0), None]);
        assert_eq!(tree.nodes().nth(3), Some(&Inverter));
        assert_eq!(tree.nodes().len(), 6);
    }

    #[test]
    fn a_row_takes_eight_bytes_of_flash_with_a_leaf_of_up_to_two() {
        assert_eq!(size_of::<Tree<[u8; 2], 21>>(), 21 * 8);
    }
}
