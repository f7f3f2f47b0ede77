//! A robot that works on a table task, with a tree that is only known at run time.

use super::flight::Worker;
use super::{HostTask, HostWanted, Station};
use firmware::{Skills, TableRobot, TaskLeaf};
use iibt_core::iibt::table::{Aim, TablesError};
use iibt_core::time::Duration;
use iibt_core::tree::{Full, Node, NodeMemory, OwnedTree, Row};

/// The ticks for which a precondition may stay unmet before an inference node fails.
pub(crate) const TIMEOUT: Duration = Duration(50);

/// A robot with room for any task file.
pub(crate) type HostRobot<'t, K> = TableRobot<'t, Station, K, Vec<NodeMemory<Full>>, 64, 4, 256, Full>;

impl<'t, K: Skills<Station, Message = ()>> Worker<'t> for HostRobot<'t, K> {
    fn task(&self) -> Option<&HostTask<'t>> {
        Some(self.task())
    }

    fn raised(&self) -> Option<&HostWanted> {
        self.node().raised()
    }
}

/// The tree of a robot in a task file: its aims, one after the other, and then nothing more.
pub(super) type AimsTree = OwnedTree<TaskLeaf<()>, Vec<Row<TaskLeaf<()>>>, Full>;

pub(super) fn tree_of(aims: &[Aim<'_>]) -> Result<AimsTree, TablesError> {
    let too_many = TablesError { role: None, table: "aims", row: None, reason: "a robot has at most 254" };
    let children = u8::try_from(aims.len() + 1).map_err(|_| too_many)?;
    let finished = TaskLeaf::Own(());
    let mut nodes = vec![Node::Fallback(2), Node::Condition(finished), Node::Sequence(children)];
    nodes.extend((0..aims.len()).map(|aim| Node::Inference(TaskLeaf::Aim(aim))));
    nodes.push(Node::Action(finished));
    OwnedTree::try_new(nodes.into_iter().map(Row::new).collect()).map_err(|_| too_many)
}
