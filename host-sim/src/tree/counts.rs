//! The number of nodes of a tree, by kind and by level.

use super::instance::Instance;
use std::collections::BTreeMap;

/// The size of a tree.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KindCounts {
    /// The number of nodes of each kind, by the kind's name.
    pub kinds: BTreeMap<String, usize>,
    /// The number of nodes of each class: Control, Decorator, Condition, Action, SubTree.
    pub classes: BTreeMap<&'static str, usize>,
    /// The number of nodes on each level, the root's first.
    pub levels: Vec<usize>,
}

impl KindCounts {
    /// The number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.levels.iter().sum()
    }

    /// The number of levels.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.levels.len()
    }
}

impl Instance {
    /// Counts the nodes.
    #[must_use]
    pub fn counts(&self) -> KindCounts {
        let mut counts = KindCounts::default();
        for node in &self.nodes {
            *counts.kinds.entry(node.id().to_owned()).or_default() += 1;
            *counts.classes.entry(node.model.class.tag()).or_default() += 1;
            if counts.levels.len() < node.level {
                counts.levels.resize(node.level, 0);
            }
            if let Some(count) = counts.levels.get_mut(node.level - 1) {
                *count += 1;
            }
        }
        counts
    }
}
