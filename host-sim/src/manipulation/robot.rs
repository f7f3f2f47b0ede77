//! A robot: a tree from a file, and the skills behind its leaves.

use super::skill::Skill;
use iibt_core::iibt::manipulation::{Announcement, Command, Deed, Manipulation, Percept, Place, State};
use iibt_core::iibt::{Node, Task as _};
use iibt_core::team::{Intention, RobotId, Roster, Round, Status as Doing};
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

/// The skills of a conventional tree: its conditions are settled readings, its actions end when the readings after them
/// are settled.
#[derive(Debug)]
pub(super) struct Conventional {
    robot: RobotId,
    roster: Roster,
    percept: Percept,
    place: Settled<Place>,
    state: Settled<State>,
    doing: Option<Command>,
    command: Option<Command>,
}

impl Conventional {
    pub(super) fn new(robot: RobotId, roster: Roster, settle: u8) -> Self {
        Self {
            robot,
            roster,
            percept: Percept::default(),
            place: Settled::new(Place::Elsewhere, settle),
            state: Settled::new(State::Free, settle),
            doing: None,
            command: None,
        }
    }

    fn begin(&mut self, leaf: Skill) -> Status {
        let (deed, place) = match leaf {
            Skill::MoveTo(place) => (Deed::MoveTo, place),
            Skill::Pick => (Deed::Pick, self.place.value),
            Skill::Place => (Deed::Place, self.place.value),
            Skill::Announce => return Status::Success,
            Skill::Look => {
                self.unsettle();
                return Status::Running;
            }
            Skill::Wait => return Status::Running,
            _ => return Status::Failure,
        };
        let command = Command { deed, place };
        (self.command, self.doing) = (Some(command), Some(command));
        self.unsettle();
        Status::Running
    }

    fn unsettle(&mut self) {
        self.place.run = 0;
        self.state.run = 0;
    }

    fn teammate(&self) -> Option<Announcement> {
        self.roster.fresh(self.percept.now).next().and_then(Announcement::read)
    }
}

impl Skills for Conventional {
    fn perceive(&mut self, percept: Percept) {
        self.percept = percept;
        self.command = None;
        if !percept.busy {
            self.doing = None;
            self.place.read(percept.place);
            self.state.read(percept.state);
        }
    }

    fn command(&self) -> Option<Command> {
        self.command
    }

    fn roster_mut(&mut self) -> &mut Roster {
        &mut self.roster
    }

    fn intention(&self) -> Intention {
        let place = if self.doing.is_none() { self.place.value } else { Place::Elsewhere };
        let deed = self.doing.map_or(Default::default(), |command| command.deed);
        let path = Announcement { place, state: self.state.value, deed }.path();
        Intention {
            robot: self.robot,
            epoch: 0,
            sequence: 0,
            tick: self.percept.now,
            round: Round(0),
            status: if self.doing.is_some() { Doing::Announced } else { Doing::Deciding },
            plan: 0,
            goal: None,
            path,
            step: 0,
            probability: 1.0,
            hazards: Default::default(),
        }
    }

    fn task(&self) -> Option<&Manipulation> {
        None
    }
}

impl Leaves<Skill> for Conventional {
    fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
        match *leaf {
            Skill::IsReached(place) => self.place.value == place,
            Skill::IsHolding => self.state.value == State::Hold,
            Skill::IsPlaced => self.state.value == State::Place,
            Skill::IsTeammateAt(place) => self.teammate().is_some_and(|said| said.place == place),
            Skill::IsTeammateHolding => self.teammate().is_some_and(|said| said.state == State::Hold),
            _ => false,
        }
    }

    fn on_start(&mut self, leaf: &Skill, _: Instant) -> Status {
        self.begin(*leaf)
    }

    fn on_running(&mut self, leaf: &Skill, _: Instant) -> Status {
        if *leaf == Skill::Wait {
            return Status::Failure;
        }
        if self.percept.busy || !self.place.is_settled() || !self.state.is_settled() {
            return Status::Running;
        }
        Status::from(match *leaf {
            Skill::MoveTo(place) => self.place.value == place,
            Skill::Pick => self.state.value == State::Hold,
            Skill::Place => self.state.value == State::Place,
            Skill::Look => true,
            _ => false,
        })
    }

    fn on_halted(&mut self, _: &Skill, _: Instant) -> Halt {
        self.command = None;
        Halt::Done
    }
}

/// A value that changes when enough readings in a row agree on another.
#[derive(Clone, Copy, Debug)]
struct Settled<T> {
    value: T,
    last: Option<T>,
    /// How many equal readings there were in a row.
    run: u8,
    enough: u8,
}

impl<T: Copy + PartialEq> Settled<T> {
    fn new(value: T, enough: u8) -> Self {
        Self { value, last: None, run: 0, enough: enough.max(1) }
    }

    fn read(&mut self, reading: Option<T>) {
        let Some(reading) = reading else { return };
        let again = self.run > 0 && self.last == Some(reading);
        self.run = if again { self.run.saturating_add(1) } else { 1 };
        self.last = Some(reading);
        if self.is_settled() {
            self.value = reading;
        }
    }

    fn is_settled(&self) -> bool {
        self.run >= self.enough
    }
}
