//! The skills of conventional trees: conditions that look at what is settled, actions that end when what came of them is.

use super::robot::Skills;
use super::sense::Sense;
use super::skill::Skill;
use crate::tree::BoundTree;
use iibt_core::iibt::Manipulation;
use iibt_core::iibt::manipulation::{Announcement, Command, Deed, Percept, Place, STATES, State, TEAM};
use iibt_core::inference::Preference;
use iibt_core::team::Peers;
use iibt_core::time::Instant;
use iibt_core::tree::{Full, Halt, Leaves, NodeMemory, Status};

/// A robot with a conventional tree.
#[derive(Debug)]
pub(super) struct Conventional {
    /// What the teammate has announced, while that is fresh.
    teammate: Option<Announcement>,
    percept: Percept,
    sense: Sense,
    doing: Option<Command>,
    command: Option<Command>,
}

impl Conventional {
    pub(super) fn new(sense: Sense) -> Self {
        Self { teammate: None, percept: Percept::default(), sense, doing: None, command: None }
    }

    fn begin(&mut self, deed: Deed, place: Place) -> Status {
        let command = Command { deed, place };
        (self.command, self.doing) = (Some(command), Some(command));
        self.sense.unsettle(Some(command));
        Status::Running
    }

    fn teammate(&self) -> Option<Announcement> {
        self.teammate
    }
}

impl Skills for Conventional {
    fn perceive(&mut self, percept: Percept, peers: Peers<'_, Announcement>) {
        self.teammate = peers.fresh().next().map(|peer| *peer.message());
        self.percept = percept;
        self.command = None;
        if !percept.busy {
            self.doing = None;
        }
        self.sense.perceive(percept, peers);
    }

    fn command(&self) -> Option<Command> {
        self.command
    }

    fn tick(
        &mut self,
        tree: &BoundTree<Skill>,
        memory: &mut [NodeMemory<Full>],
        _: Peers<'_, Announcement>,
        now: Instant,
    ) -> Status {
        tree.tick(memory, self, now).status
    }

    fn announcement(&self) -> Announcement {
        let place = if self.doing.is_none() { self.sense.place() } else { Place::Elsewhere };
        let deed = self.doing.map_or(Deed::Idle, |command| command.deed);
        Announcement { place, state: self.sense.state(), deed }
    }

    fn task(&self) -> Option<&Manipulation> {
        None
    }

    fn preferences(&self) -> Option<[Preference<STATES>; TEAM]> {
        None
    }
}

impl Leaves<Skill> for Conventional {
    fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
        match *leaf {
            Skill::IsReached(place) => self.sense.place() == place,
            Skill::IsHolding => self.sense.state() == State::Hold,
            Skill::IsPlaced => self.sense.state() == State::Place,
            Skill::IsTeammateAt(place) => self.teammate().is_some_and(|said| said.place == place),
            Skill::IsTeammateHolding => self.teammate().is_some_and(|said| said.state == State::Hold),
            _ => false,
        }
    }

    fn on_start(&mut self, leaf: &Skill, _: Instant) -> Status {
        match *leaf {
            Skill::MoveTo(place) => self.begin(Deed::MoveTo, place),
            Skill::Pick => self.begin(Deed::Pick, self.sense.place()),
            Skill::Place => self.begin(Deed::Place, self.sense.place()),
            Skill::Announce => Status::Success,
            Skill::Look => {
                self.sense.unsettle(None);
                Status::Running
            }
            Skill::Wait => Status::Running,
            _ => Status::Failure,
        }
    }

    fn on_running(&mut self, leaf: &Skill, _: Instant) -> Status {
        if *leaf == Skill::Wait {
            return Status::Failure;
        }
        if self.percept.busy || !self.sense.is_settled() {
            return Status::Running;
        }
        Status::from(match *leaf {
            Skill::MoveTo(place) => self.sense.place() == place,
            Skill::Pick => self.sense.state() == State::Hold,
            Skill::Place => self.sense.state() == State::Place,
            Skill::Look => true,
            _ => false,
        })
    }

    fn on_halted(&mut self, _: &Skill, _: Instant) -> Halt {
        self.command = None;
        Halt::Done
    }
}
