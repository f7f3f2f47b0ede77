//! A robot: a tree from a file, and the skills behind its leaves.

use super::skill::Skill;
use iibt_core::iibt::Manipulation;
use iibt_core::iibt::manipulation::{Command, Percept};
use iibt_core::iibt::{Node, Task as _};
use iibt_core::team::{Intention, Roster};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::{Halt, Leaves, Status};

/// What runs the leaves of a tree.
pub(super) trait Skills: Leaves<Skill> {
    /// Takes in what was sensed.
    fn perceive(&mut self, percept: Percept);
    /// What the body is to do.
    fn command(&self) -> Option<Command>;
    /// What is heard goes here.
    fn roster_mut(&mut self) -> &mut Roster;
    /// What the teammate is told.
    fn intention(&self) -> Intention;
    /// The task behind the inference nodes, if there are any.
    fn task(&self) -> Option<&Manipulation>;
}

/// The skills of a tree with inference nodes.
#[derive(Debug)]
pub(super) struct Inferring {
    task: Manipulation,
    node: Node,
}

/// A precondition that stays unmet for so many ticks fails the node.
const TIMEOUT: Duration = Duration(50);

impl Inferring {
    pub(super) fn new(task: Manipulation) -> Self {
        Self { task, node: Node::new(TIMEOUT) }
    }
}

impl Skills for Inferring {
    fn perceive(&mut self, percept: Percept) {
        self.task.perceive(percept);
    }

    fn command(&self) -> Option<Command> {
        self.task.command()
    }

    fn roster_mut(&mut self) -> &mut Roster {
        self.task.roster_mut()
    }

    fn intention(&self) -> Intention {
        self.task.intention()
    }

    fn task(&self) -> Option<&Manipulation> {
        Some(&self.task)
    }
}

impl Leaves<Skill> for Inferring {
    fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
        matches!(*leaf, Skill::IsReached(place) if self.task.is_reached(place))
    }

    fn on_start(&mut self, leaf: &Skill, now: Instant) -> Status {
        if let Skill::Infer(aim) = *leaf {
            self.task.pursue(aim);
        }
        self.on_running(leaf, now)
    }

    fn on_running(&mut self, leaf: &Skill, now: Instant) -> Status {
        match *leaf {
            Skill::Infer(_) => self.node.tick(&mut self.task, now),
            Skill::MoveTo(place) => self.task.go(place),
            _ => Status::Failure,
        }
    }

    fn on_halted(&mut self, leaf: &Skill, _: Instant) -> Halt {
        match leaf {
            Skill::Infer(_) => self.node.halt(&mut self.task),
            _ => self.task.wait(),
        }
        Halt::Done
    }
}
