//! A robot that works on a table task, with a tree that is only known at run time.

use super::flight::Worker;
use super::{HostTask, HostWanted, Station};
use firmware::{Skills, TableRobot};
use iibt_core::time::Duration;
use iibt_core::tree::{Full, NodeMemory};

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
