//! A row of a tree's table: a node and its links.
//!
//! A link is what follows when the node has succeeded, or failed:
//!
//! ```text
//!  15 14 13                             0
//! ┌─────┬────────────────────────────────┐
//! │ how │ row, 0x3FFF for none           │   links[0] after a success, links[1] after a failure
//! └─────┴────────────────────────────────┘
//!   0 0   next    enter the next child of the same parent, in `row`
//!   0 1   UP      the parent, in `row`, has the status of this child
//!   1 0   ASK     the parent, in `row`, decides
//!   1 1   LATER   the next child, in `row`, if the parent, which is asked first, wants it
//! ```
//!
//! | parent | after a success | after a failure |
//! |---|---|---|
//! | sequence | the next child, `UP` from the last | `UP` |
//! | fallback | `UP` | the next child, `UP` from the last |
//! | inverter | `ASK` | `ASK` |
//! | any other | `ASK` | `LATER` |
//! | none: the root | `LATER`, none | `LATER`, none |
//!
//! So each row names its parent and its next sibling in four bytes, and a tick through sequences
//! and fallbacks follows one link a node. In the table of
//!
//! ```text
//! 0 Sequence ──► 1 Fallback ──► 2 Condition        row  success   failure
//!     │              └────────► 3 Action             1  4         UP 0
//!     └────────► 4 Action                            2  UP 1      3
//!                                                    3  UP 1      UP 1
//!                                                    4  UP 0      UP 0
//! ```

use super::node::Node;

/// The most levels a tree may have, the root being the first: what BehaviorTree.CPP loads.
pub const MAX_DEPTH: usize = 256;

/// The most nodes a tree may have.
pub const MAX_NODES: usize = 8191;

/// A node and its links to the rows that follow.
///
/// ```
/// use iibt_core::tree::{Node, Row, TreeRef};
///
/// let nodes = [Node::Fallback(2), Node::Condition("is open"), Node::Action("open it")];
/// let mut rows = nodes.map(Row::new);
/// assert_eq!(rows[1].node(), &Node::Condition("is open"));
/// let tree: TreeRef<&str> = TreeRef::try_new(&mut rows)?;
/// assert_eq!(tree.parent(2), Some(0));
/// # Ok::<(), iibt_core::tree::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row<L> {
    pub(super) node: Node<L>,
    pub(super) links: [u16; 2],
}

/// Past the end of every table.
pub(super) const NONE: u16 = 0x3FFF;

/// To the parent, which has the status of this child.
pub(super) const UP: u16 = 1 << 14;

/// To the parent, which decides the next step.
pub(super) const ASK: u16 = 2 << 14;

/// To the next child if the parent, which is asked first, wants it.
pub(super) const LATER: u16 = 3 << 14;

impl<L> Row<L> {
    /// A row that is not linked yet.
    pub const fn new(node: Node<L>) -> Self {
        Self { node, links: [LATER | NONE; 2] }
    }

    /// The node.
    pub const fn node(&self) -> &Node<L> {
        &self.node
    }

    /// The row of the parent; past the end of every table for the root.
    #[inline]
    pub(super) const fn parent(&self) -> usize {
        let [success, failure] = self.links;
        ((if success < UP { failure } else { success }) & NONE) as usize
    }

    /// The row of the next child of the same parent.
    pub(super) const fn sibling(&self) -> Option<usize> {
        let [success, failure] = self.links;
        let next = if success < UP { success } else { failure };
        if matches!(next & LATER, UP | ASK) || next & NONE == NONE {
            None
        } else {
            Some((next & NONE) as usize)
        }
    }

    /// The link that follows an [`end`](Status::end). Only the parent knows what follows when it is
    /// neither success nor failure, which no node of the basic set leaves to it.
    #[inline(always)]
    pub(super) const fn link(&self, end: usize, full: bool) -> usize {
        if full && end > 1 { ASK as usize } else { self.links[end & 1] as usize }
    }
}
