//! A robot: a tree from a file, and the skills behind its leaves.

use super::skill::Skill;
use crate::tree::BoundTree;
use iibt_core::iibt::Manipulation;
use iibt_core::iibt::manipulation::{Announcement, Command, Percept, STATES, TEAM};
use iibt_core::iibt::{Node, Task as _};
use iibt_core::inference::Preference;
use iibt_core::team::Peers;
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::{Full, Halt, Leaves, NodeMemory, Status};

/// What a robot with a tree knows and can do; with the teammates as they stand, its leaves.
pub(super) trait Skills {
    /// Takes in what was sensed and heard.
    fn perceive(&mut self, percept: Percept, peers: Peers<'_, Announcement>);
    /// Ticks the tree.
    fn tick(
        &mut self,
        tree: &BoundTree<Skill>,
        memory: &mut [NodeMemory<Full>],
        peers: Peers<'_, Announcement>,
        now: Instant,
    ) -> Status;
    /// What the body is to do.
    fn command(&self) -> Option<Command>;
    /// What the teammate is told.
    fn announcement(&self) -> Announcement;
    /// The task behind the inference nodes, if there are any.
    fn task(&self) -> Option<&Manipulation>;
    /// C of both robots after the tick.
    fn preferences(&self) -> Option<[Preference<STATES>; TEAM]>;
}

/// The skills of a tree with inference nodes.
pub(super) struct Inferring {
    task: Manipulation,
    node: Node<Manipulation>,
    percept: Percept,
}

/// A precondition that stays unmet for so many ticks fails the node.
const TIMEOUT: Duration = Duration(50);

impl Inferring {
    pub(super) fn new(task: Manipulation) -> Self {
        Self { task, node: Node::new(TIMEOUT), percept: Percept::default() }
    }
}

impl Skills for Inferring {
    fn perceive(&mut self, percept: Percept, peers: Peers<'_, Announcement>) {
        self.percept = percept;
        self.task.perceive(percept, peers);
    }

    fn tick(
        &mut self,
        tree: &BoundTree<Skill>,
        memory: &mut [NodeMemory<Full>],
        peers: Peers<'_, Announcement>,
        now: Instant,
    ) -> Status {
        tree.tick(memory, &mut Ticking { skills: self, peers }, now).status
    }

    fn command(&self) -> Option<Command> {
        self.task.command()
    }

    fn announcement(&self) -> Announcement {
        self.task.announcement()
    }

    fn task(&self) -> Option<&Manipulation> {
        Some(&self.task)
    }

    fn preferences(&self) -> Option<[Preference<STATES>; TEAM]> {
        Some(self.node.raised().copied().unwrap_or_else(|| self.task.preference()))
    }
}

struct Ticking<'t> {
    skills: &'t mut Inferring,
    peers: Peers<'t, Announcement>,
}

impl Leaves<Skill> for Ticking<'_> {
    fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
        matches!(*leaf, Skill::IsReached(place) if self.skills.task.is_reached(place))
    }

    fn on_start(&mut self, leaf: &Skill, now: Instant) -> Status {
        if let Skill::Infer(aim) = *leaf {
            self.skills.task.pursue(aim);
        }
        self.on_running(leaf, now)
    }

    fn on_running(&mut self, leaf: &Skill, now: Instant) -> Status {
        let Inferring { task, node, percept } = &mut *self.skills;
        match *leaf {
            Skill::Infer(_) => node.tick(task, percept, self.peers, now),
            Skill::MoveTo(place) => task.go(place),
            _ => Status::Failure,
        }
    }

    fn on_halted(&mut self, leaf: &Skill, _: Instant) -> Halt {
        match leaf {
            Skill::Infer(_) => self.skills.node.halt(&mut self.skills.task),
            _ => self.skills.task.wait(),
        }
        Halt::Done
    }
}
