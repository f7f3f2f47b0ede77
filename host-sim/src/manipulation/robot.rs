//! The leaves of a tree with inference nodes.

use super::record::Thought;
use super::skill::Skill;
use super::tables::{EMPTY, GOAL_C, GRIP, HOLDS, MOVE_TO, Order, PLACE, PLACED};
use crate::task::{HostTask, Station, Worker};
use crate::tree::BoundTree;
use firmware::Robot;
use iibt_core::iibt::table::{Announcement, Command, Percept};
use iibt_core::iibt::{InferenceNode, Task};
use iibt_core::team::{Invalid, Peers};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::{Full, Halt, Leaves, NodeMemory, Status};

/// The ticks for which a precondition may stay unmet before the node fails.
const TIMEOUT: Duration = Duration(50);

/// A robot whose tree has inference nodes.
pub(super) struct Inferring<'t> {
    tree: BoundTree<Skill>,
    memory: Vec<NodeMemory<Full>>,
    task: HostTask<'t>,
    node: InferenceNode<HostTask<'t>>,
    order: Order,
    percept: Percept,
}

impl<'t> Inferring<'t> {
    pub(super) fn new(tree: BoundTree<Skill>, task: HostTask<'t>, order: Order) -> Self {
        let memory = vec![NodeMemory::NEW; tree.len()];
        Self { tree, memory, task, node: InferenceNode::new(TIMEOUT), order, percept: Percept::default() }
    }

    /// What it thinks after a tick.
    pub(super) fn thought(&self) -> Thought {
        Thought::of(&self.task, self.node.raised())
    }

    pub(super) fn running(&self) -> Option<Skill> {
        self.tree.running(&self.memory).copied()
    }
}

impl Robot<Station> for Inferring<'_> {
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
        self.task.observe(&self.percept, peers);
        let Self { tree, memory, task, node, order, percept } = self;
        let mut leaves = Ticking { task, node, order: *order, percept: *percept, peers };
        tree.tick(memory, &mut leaves, now).status
    }

    fn act(&mut self, station: &mut Station) {
        station.command = self.task.command();
    }

    fn message(&self) -> Announcement {
        self.task.announcement()
    }
}

impl<'t> Worker<'t> for Inferring<'t> {
    fn task(&self) -> Option<&HostTask<'t>> {
        Some(&self.task)
    }
}

/// The leaves in a tick.
struct Ticking<'k, 't> {
    task: &'k mut HostTask<'t>,
    node: &'k mut InferenceNode<HostTask<'t>>,
    order: Order,
    percept: Percept,
    peers: Peers<'k, Announcement>,
}

impl Ticking<'_, '_> {
    fn is_at(&self, place: u8) -> bool {
        !self.percept.busy && self.task.sure(PLACE.into()) == Some(place.into())
    }

    /// The plain leaf MoveTo(place). It leaves for the meeting place when, in turn, the teammate
    /// has its object too; it fails when the robot is sure to have nothing to bring there, so that
    /// the tree begins again.
    fn go(&mut self, place: u8) -> Status {
        if !self.task.is_settled() {
            return Status::Running;
        }
        let meets = place == GOAL_C;
        if meets && self.task.sure(GRIP.into()) == Some(EMPTY.into()) {
            return Status::Failure;
        }
        if self.is_at(place) {
            return Status::Success;
        }
        let brings =
            |said: Announcement| said.state(GRIP.into()).is_some_and(|grip| [HOLDS, PLACED].contains(&grip));
        let leaves =
            self.order == Order::Together || (0..2).filter_map(|robot| self.task.teammate(robot)).any(brings);
        if self.peers.all_connected() && (!meets || leaves) {
            self.task.begin(Command { operator: MOVE_TO, target: Some(place) });
        }
        Status::Running
    }
}

impl Leaves<Skill> for Ticking<'_, '_> {
    fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
        matches!(*leaf, Skill::IsReached(place) if self.is_at(place))
    }

    fn on_start(&mut self, leaf: &Skill, now: Instant) -> Status {
        if let Skill::Infer(aim) = *leaf {
            self.task.pursue(aim);
        }
        self.on_running(leaf, now)
    }

    fn on_running(&mut self, leaf: &Skill, now: Instant) -> Status {
        match *leaf {
            Skill::Infer(_) => self.node.tick(self.task, &self.percept, self.peers, now),
            Skill::MoveTo(place) => self.go(place),
            _ => Status::Failure,
        }
    }

    fn on_halted(&mut self, leaf: &Skill, _: Instant) -> Halt {
        match leaf {
            Skill::Infer(_) => self.node.halt(self.task),
            _ => self.task.wait(),
        }
        Halt::Done
    }
}
