//! A tree of a size known only at run time that owns its rows.

use super::check::TreeError;
use super::kinds::{Basic, Kinds};
use super::leaves::Leaves;
use super::memory::NodeMemory;
use super::row::Row;
use super::status::{Halt, Tick};
use super::table::TreeRef;
use crate::time::Instant;
use core::marker::PhantomData;

/// A behavior tree that owns its rows `R`: a `Vec<Row<L>>`, a `Box<[Row<L>]>`, an array.
///
/// It is checked and linked once, when it is built. It never changes, so that robots share it, for
/// instance in an `Arc`; each has a [`NodeMemory`] of its own for each node. A tree that the
/// program knows is better a [`Tree`](super::Tree), which is checked by the compiler.
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Halt, Leaves, Node, NodeMemory, OwnedTree, Row, Status};
/// use std::sync::Arc;
///
/// struct Robot(Vec<String>);
///
/// impl Leaves<String> for Robot {
///     fn condition(&mut self, _: &String, _: Instant) -> bool { false }
///     fn on_start(&mut self, leaf: &String, _: Instant) -> Status {
///         self.0.push(leaf.clone());
///         Status::Running
///     }
///     fn on_running(&mut self, _: &String, _: Instant) -> Status { Status::Success }
///     fn on_halted(&mut self, _: &String, _: Instant) -> Halt { Halt::Done }
/// }
///
/// let (is_open, open) = ("is open".to_string(), "open it".to_string());
/// let nodes = vec![Node::Fallback(2), Node::Condition(is_open), Node::Action(open)];
/// let rows: Vec<Row<String>> = nodes.into_iter().map(Row::new).collect();
/// let tree: Arc<OwnedTree<String, Vec<Row<String>>>> = Arc::new(OwnedTree::try_new(rows)?);
///
/// let (mut robot, mut memory) = (Robot(Vec::new()), vec![NodeMemory::NEW; tree.len()]);
/// assert_eq!(tree.tick(&mut memory, &mut robot, Instant(0)).status, Status::Running);
/// assert_eq!(tree.running(&memory).map(String::as_str), Some("open it"));
/// assert_eq!(tree.tick(&mut memory, &mut robot, Instant(1)).status, Status::Success);
/// assert_eq!((tree.running(&memory), robot.0), (None, vec!["open it".to_string()]));
/// # Ok::<(), iibt_core::tree::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OwnedTree<L, R, K: Kinds = Basic> {
    rows: R,
    set: PhantomData<(L, K)>,
}

impl<L, R: AsRef<[Row<L>]>, K: Kinds> OwnedTree<L, R, K> {
    /// Links `rows`, in preorder, into a tree. As [`TreeRef::try_new`] it accepts nodes that no
    /// tick can reach.
    ///
    /// # Errors
    /// The first row that breaks a [`TreeRule`](super::TreeRule).
    pub fn try_new(mut rows: R) -> Result<Self, TreeError>
    where
        R: AsMut<[Row<L>]>,
    {
        TreeRef::<L, K>::try_new(rows.as_mut())?;
        Ok(Self { rows, set: PhantomData })
    }

    /// The tree, borrowed.
    #[must_use]
    pub fn by_ref(&self) -> TreeRef<'_, L, K> {
        TreeRef::linked(self.rows.as_ref())
    }

    /// The number of nodes.
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "a tree has at least a root")]
    pub fn len(&self) -> usize {
        self.rows.as_ref().len()
    }

    /// Ticks the tree once. `memory` has an element for each node, else the tree fails.
    pub fn tick(
        &self,
        memory: &mut [NodeMemory<K>],
        leaves: &mut (impl Leaves<L> + ?Sized),
        now: Instant,
    ) -> Tick {
        self.by_ref().tick(memory, leaves, now)
    }

    /// Interrupts the tree, as [`Tree::halt`](super::Tree::halt).
    pub fn halt(
        &self,
        memory: &mut [NodeMemory<K>],
        leaves: &mut (impl Leaves<L> + ?Sized),
        now: Instant,
    ) -> Halt {
        self.by_ref().halt(memory, leaves, now)
    }

    /// The leaf that is running, the first in preorder of several; `None` if none is.
    #[must_use]
    pub fn running(&self, memory: &[NodeMemory<K>]) -> Option<&L> {
        self.by_ref().running(memory)
    }
}
