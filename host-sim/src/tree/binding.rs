//! Trees from files in a program: each leaf is bound by its name to one of the program's own.

use super::diagnostic::{Diagnostic, Place};
use super::instance::{Instance, Node};
use super::lower::{HookTask, Rules};
use iibt_core::tree::{Full, OwnedTree, Row};

/// A tree whose leaves are the program's `L`, linked once. Robots share it; each has a memory of
/// its own, of
/// [`NodeMemory`](iibt_core::tree::NodeMemory) for each node.
pub type BoundTree<L> = OwnedTree<L, Vec<Row<L>>, Full>;

/// A leaf as it stands in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeafNode {
    /// Its kind: its ID in the file.
    pub kind: String,
    /// Its name in the file, else its kind.
    pub name: String,
    /// The values of its ports, by name, in alphabetical order.
    pub ports: Vec<(String, String)>,
    /// Its place in the file.
    pub place: Place,
}

impl LeafNode {
    fn of(node: &Node) -> Self {
        Self {
            kind: node.id().to_owned(),
            name: node.name.clone(),
            ports: node.ports.iter().map(|(name, value)| (name.clone(), value.text.clone())).collect(),
            place: node.place.clone(),
        }
    }

    /// The value of a port.
    #[must_use]
    pub fn port(&self, name: &str) -> Option<&str> {
        self.ports.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }
}

impl Instance {
    /// Binds the leaves of this tree: `find` says which of the program's leaves each stands for, or
    /// why none does.
    ///
    /// # Errors
    /// The place of the first leaf for which there is none, of the first script, or of the first
    /// node that the engine does not have.
    pub fn bind<L: Clone>(
        &self,
        find: impl Fn(&LeafNode) -> Result<L, String>,
    ) -> Result<BoundTree<L>, Diagnostic> {
        let lowered = self.lower(Rules::Ours)?;
        let bound = lowered.hooks.iter().map(|hook| match (&hook.task, self.nodes.get(hook.node)) {
            (HookTask::Leaf, Some(node)) => {
                find(&LeafNode::of(node)).map_err(|reason| Diagnostic::error(&node.place, reason))
            }
            _ => {
                let (place, name) = self.place_and_name(hook.node);
                Err(Diagnostic::error(&place, format!("'{name}' is more than a leaf")))
            }
        });
        let leaves = bound.collect::<Result<Vec<L>, _>>()?;
        let rows = lowered.rows.iter().map(|row| {
            let node = row.try_map(|hook| leaves.get(usize::from(hook)).cloned().ok_or(()));
            node.map(Row::new)
        });
        // The lowered table is a tree, and each hook of it has a leaf.
        let tree = rows.collect::<Result<_, _>>().ok().and_then(|rows| OwnedTree::try_new(rows).ok());
        tree.ok_or_else(|| Diagnostic::error(&self.place_and_name(0).0, "this tree cannot be bound"))
    }

    fn place_and_name(&self, node: usize) -> (Place, &str) {
        match self.nodes.get(node) {
            Some(node) => (node.place.clone(), &node.name),
            None => (Place::start_of(&self.main), &self.main),
        }
    }
}
