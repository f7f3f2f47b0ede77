//! The leaves of a tree with inference nodes.

use super::record::Thought;
use super::skill::Skill;
use super::tables::{EMPTY, GOAL_C, GRIP, HOLDS, MOVE_TO, Order, PLACE, PLACED};
use crate::task::{HostTask, TaskRobot, Ticked, Turn};
use crate::tree::BoundTree;
use iibt_core::iibt::Task as _;
use iibt_core::iibt::table::{Announcement, Command};
use iibt_core::time::Instant;
use iibt_core::tree::{Full, Halt, Leaves, NodeMemory, Status};

/// A robot whose tree has inference nodes.
pub(super) type Inferring<'t> = TaskRobot<'t, Inference>;

/// The tree of such a robot.
pub(super) struct Inference {
    tree: BoundTree<Skill>,
    memory: Vec<NodeMemory<Full>>,
    order: Order,
}

impl<'t> Inferring<'t> {
    pub(super) fn of(tree: BoundTree<Skill>, task: HostTask<'t>, order: Order) -> Self {
        let memory = vec![NodeMemory::NEW; tree.len()];
        Self::new(Inference { tree, memory, order }, task)
    }

    /// Its beliefs and decision after a tick.
    pub(super) fn thought(&self) -> Thought {
        Thought::of(&self.task, self.node.raised())
    }

    pub(super) fn running(&self) -> Option<Skill> {
        self.tree.tree.running(&self.tree.memory).copied()
    }
}

impl Ticked for Inference {
    fn tick(&mut self, turn: Turn<'_, '_>, now: Instant) -> Status {
        let mut leaves = Ticking { turn, order: self.order };
        self.tree.tick(&mut self.memory, &mut leaves, now).status
    }
}

/// The leaves in a tick.
struct Ticking<'k, 't> {
    turn: Turn<'k, 't>,
    order: Order,
}

impl Ticking<'_, '_> {
    fn is_at(&self, place: u8) -> bool {
        !self.turn.percept.busy && self.turn.task.sure(PLACE.into()) == Some(place.into())
    }

    /// The plain leaf MoveTo(place). It leaves for the meeting place when, in turn, the teammate
    /// has its object too; it fails when the robot is sure to have nothing to bring there, so that
    /// the tree begins again.
    fn go(&mut self, place: u8) -> Status {
        if !self.turn.task.is_settled() {
            return Status::Running;
        }
        let meets = place == GOAL_C;
        if meets && self.turn.task.sure(GRIP.into()) == Some(EMPTY.into()) {
            return Status::Failure;
        }
        if self.is_at(place) {
            return Status::Success;
        }
        let brings =
            |said: Announcement| said.state(GRIP.into()).is_some_and(|grip| [HOLDS, PLACED].contains(&grip));
        let leaves = self.order == Order::Together
            || (0..2).filter_map(|robot| self.turn.task.teammate(robot)).any(brings);
        if self.turn.peers.all_connected() && (!meets || leaves) {
            self.turn.task.begin(Command { operator: MOVE_TO, target: Some(place) });
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
            self.turn.task.pursue(aim);
        }
        self.on_running(leaf, now)
    }

    fn on_running(&mut self, leaf: &Skill, now: Instant) -> Status {
        match *leaf {
            Skill::Infer(_) => self.turn.infer(now),
            Skill::MoveTo(place) => self.go(place),
            _ => Status::Failure,
        }
    }

    fn on_halted(&mut self, leaf: &Skill, _: Instant) -> Halt {
        match leaf {
            Skill::Infer(_) => self.turn.node.halt(self.turn.task),
            _ => self.turn.task.wait(),
        }
        Halt::Done
    }
}
