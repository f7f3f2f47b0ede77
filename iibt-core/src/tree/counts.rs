//! The size of a tree.

use super::kinds::Kinds;
use super::node::Node;
use super::table::Tree;

/// The size of a tree: its nodes by kind, and its levels.
///
/// ```
/// use iibt_core::tree::{NodeCounts, Tree};
///
/// const TREE: Tree<&str, 5> = iibt_core::tree! {
///     Sequence { Fallback { Condition("charged"), Action("charge") }, Action("patrol") }
/// };
///
/// const COUNTS: NodeCounts = TREE.counts();
/// assert_eq!((COUNTS.sequences, COUNTS.fallbacks), (1, 1));
/// assert_eq!((COUNTS.conditions, COUNTS.actions, COUNTS.inferences), (1, 2, 0));
/// assert_eq!((COUNTS.total(), COUNTS.depth), (5, 3));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NodeCounts {
    /// Sequences, reactive ones included.
    pub sequences: usize,
    /// Fallbacks, reactive ones included.
    pub fallbacks: usize,
    /// Parallel nodes, branches and Nav2's recovery.
    pub controls: usize,
    /// Nodes with exactly one child.
    pub decorators: usize,
    /// Conditions.
    pub conditions: usize,
    /// Actions, inference nodes included.
    pub actions: usize,
    /// Inference nodes.
    pub inferences: usize,
    /// The levels, the root being the first.
    pub depth: usize,
}

impl NodeCounts {
    /// The number of all nodes.
    #[must_use]
    pub const fn total(&self) -> usize {
        self.sequences + self.fallbacks + self.controls + self.decorators + self.conditions + self.actions
    }

    const fn count<L>(&mut self, node: &Node<L>) {
        match node {
            Node::Sequence(_)
            | Node::ReactiveSequence(_)
            | Node::SequenceWithMemory(_)
            | Node::AsyncSequence(_)
            | Node::PipelineSequence(_) => self.sequences += 1,
            Node::Fallback(_) | Node::ReactiveFallback(_) | Node::AsyncFallback(_) | Node::RoundRobin(_) => {
                self.fallbacks += 1;
            }
            Node::Parallel { .. }
            | Node::ParallelAll { .. }
            | Node::IfThenElse(_)
            | Node::WhileDoElse(_)
            | Node::Switch(..)
            | Node::RecoveryNode(_) => self.controls += 1,
            Node::Condition(_) => self.conditions += 1,
            Node::Inference(_) => {
                self.actions += 1;
                self.inferences += 1;
            }
            Node::Action(_) | Node::AlwaysSuccess | Node::AlwaysFailure | Node::Sleep(_) => self.actions += 1,
            _ => self.decorators += 1,
        }
    }
}

impl<L, const N: usize, K: Kinds> Tree<L, N, K> {
    /// Counts the nodes by kind and the levels; time grows as nodes times levels.
    #[must_use]
    pub const fn counts(&self) -> NodeCounts {
        let mut counts = NodeCounts {
            sequences: 0,
            fallbacks: 0,
            controls: 0,
            decorators: 0,
            conditions: 0,
            actions: 0,
            inferences: 0,
            depth: 0,
        };
        let mut at = 0;
        while at < N {
            counts.count(&self.rows[at].node);
            let level = self.level(at);
            if level > counts.depth {
                counts.depth = level;
            }
            at += 1;
        }
        counts
    }

    /// The level of the node in row `at`, 1 for the root and 0 past the end.
    const fn level(&self, mut at: usize) -> usize {
        let mut level = 0;
        while at < N {
            level += 1;
            at = self.rows[at].parent();
        }
        level
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree;

    /// Table 3 of the paper, the tree with an interactive inference node.
    #[test]
    fn the_papers_mission_has_five_nodes_on_three_levels() {
        const MISSION: Tree<&str, 5> = tree! {
            Sequence {
                Fallback { Condition("Battery Enough?"), Action("MoveTo(Charger)") },
                Inference("MoveToGoal"),
            }
        };
        const COUNTS: NodeCounts = MISSION.counts();
        let expected = NodeCounts {
            sequences: 1,
            fallbacks: 1,
            controls: 0,
            decorators: 0,
            conditions: 1,
            actions: 2,
            inferences: 1,
            depth: 3,
        };
        assert_eq!(COUNTS, expected);
        assert_eq!(COUNTS.total(), 5);
    }

    /// Table 7, the classical tree of the second robot: figures 14 (right) and 16a.
    #[test]
    fn the_papers_classical_tree_has_ten_nodes_on_five_levels() {
        let tree: Tree<_, 10> = tree! {
            Sequence {
                Fallback {
                    Condition("IsHolding(Plate)"),
                    Sequence {
                        Condition("IsReached(R1, Goal A)"),
                        Fallback { Condition("IsReached(Goal B)"), Action("MoveTo(Goal B)") },
                        Action("Pick(Plate)"),
                    },
                },
                Action("MoveTo(Goal C)"),
            }
        };
        let counts = tree.counts();
        let kinds = (counts.sequences, counts.fallbacks, counts.conditions, counts.actions);
        assert_eq!((kinds, counts.total(), counts.depth), ((2, 2, 3, 3), 10, 5));
    }

    #[test]
    fn reactive_nodes_and_inverters_are_counted() {
        let tree: Tree<_, 5> = tree! {
            ReactiveSequence { Inverter { Condition('g') }, ReactiveFallback { Action('a') } }
        };
        let counts = tree.counts();
        assert_eq!((counts.sequences, counts.fallbacks, counts.decorators, counts.depth), (1, 1, 1, 3));
    }
}
