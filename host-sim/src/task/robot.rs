//! A robot that works on a table task with an inference node.

use super::flight::Worker;
use super::{HostTask, Station};
use firmware::Robot;
use iibt_core::iibt::table::{Announcement, Percept};
use iibt_core::iibt::{InferenceNode, Task as _};
use iibt_core::team::{Invalid, Peers};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::Status;

/// The ticks for which a precondition may stay unmet before the node fails.
const TIMEOUT: Duration = Duration(50);

/// The context of a tree in a tick.
pub(crate) struct Turn<'k, 't> {
    pub(crate) task: &'k mut HostTask<'t>,
    pub(crate) node: &'k mut InferenceNode<HostTask<'t>>,
    pub(crate) percept: &'k Percept,
    pub(crate) peers: Peers<'k, Announcement>,
}

impl Turn<'_, '_> {
    /// Ticks the inference node.
    pub(crate) fn infer(&mut self, now: Instant) -> Status {
        self.node.tick(self.task, self.percept, self.peers, now)
    }
}

/// A tree in any form.
pub(crate) trait Ticked {
    /// Ticks it once.
    fn tick(&mut self, turn: Turn<'_, '_>, now: Instant) -> Status;
}

/// A robot whose tree has inference nodes, of which one runs at a time.
pub(crate) struct TaskRobot<'t, T> {
    pub(crate) tree: T,
    pub(crate) task: HostTask<'t>,
    pub(crate) node: InferenceNode<HostTask<'t>>,
    percept: Percept,
}

impl<'t, T> TaskRobot<'t, T> {
    pub(crate) fn new(tree: T, task: HostTask<'t>) -> Self {
        Self { tree, task, node: InferenceNode::new(TIMEOUT), percept: Percept::default() }
    }
}

impl<T: Ticked> Robot<Station> for TaskRobot<'_, T> {
    type Message = Announcement;

    fn mission(&self) -> u64 {
        self.task.mission()
    }

    fn accepts(&self, said: &Announcement) -> Result<(), Invalid> {
        self.task.accepts(said)
    }

    fn sense(&mut self, station: &mut Station, _: Instant) {
        self.percept = station.percept;
    }

    fn tick(&mut self, peers: Peers<'_, Announcement>, now: Instant) -> Status {
        let Self { tree, task, node, percept } = self;
        task.observe(percept, peers);
        tree.tick(Turn { task, node, percept, peers }, now)
    }

    fn act(&mut self, station: &mut Station) {
        station.command = self.task.command();
    }

    fn message(&self) -> Announcement {
        self.task.announcement()
    }
}

impl<'t, T: Ticked> Worker<'t> for TaskRobot<'t, T> {
    fn task(&self) -> Option<&HostTask<'t>> {
        Some(&self.task)
    }
}
