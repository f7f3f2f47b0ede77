//! The skills of conventional trees: conditions on the settled state, and actions that end when
//! their result is settled.

use super::record::Thought;
use super::run::Hand;
use super::sense::Sense;
use super::skill::Skill;
use super::tables::{EMPTY, GRIP, HOLD, HOLDS, IDLE, MOVE_TO, PICK, PLACE, PLACED, PUT, PUT_DOWN};
use crate::task::{HostTask, Station, Worker};
use crate::tree::BoundTree;
use firmware::Robot;
use iibt_core::iibt::table::{Announcement, Command, Percept};
use iibt_core::team::{Message, Peers, rounds};
use iibt_core::time::Instant;
use iibt_core::tree::{Full, Halt, Leaves, NodeMemory, Status};
use serde::{Deserialize, Serialize};

/// What such a robot announces: it decides alone, and not in rounds.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Told(Announcement);

impl Message for Told {
    const SCHEMA: &'static str = "conventional: states u32, operator u8, operator u8";
    const MAX_BYTES: usize = <Announcement as rounds::Fact>::MAX_BYTES;
}

/// A robot with a conventional tree.
pub(super) struct Conventional<'t> {
    tree: BoundTree<Skill>,
    memory: Vec<NodeMemory<Full>>,
    skills: Skills<'t>,
}

/// The state that its leaves share.
struct Skills<'t> {
    percept: Percept,
    sense: Sense<'t>,
    teammate: Option<Announcement>,
    doing: Option<Command>,
    command: Option<Command>,
}

impl<'t> Conventional<'t> {
    pub(super) fn new(tree: BoundTree<Skill>, sense: Sense<'t>) -> Self {
        let percept = Percept::default();
        let memory = vec![NodeMemory::NEW; tree.len()];
        let skills = Skills { percept, sense, teammate: None, doing: None, command: None };
        Self { tree, memory, skills }
    }
}

impl Skills<'_> {
    fn begin(&mut self, operator: u8, target: Option<u8>) -> Status {
        let command = Command { operator, target };
        (self.command, self.doing) = (Some(command), Some(command));
        self.sense.unsettle(Some(command));
        Status::Running
    }

    fn is_teammate(&self, factor: u8, state: u8) -> bool {
        self.teammate.is_some_and(|said| said.state(factor.into()) == Some(state))
    }
}

impl Robot<Station> for Conventional<'_> {
    type Message = Told;

    fn sense(&mut self, station: &mut Station, _: Instant) {
        self.skills.percept = station.percept;
    }

    fn tick(&mut self, peers: Peers<'_, Told>, now: Instant) -> Status {
        let skills = &mut self.skills;
        skills.command = None;
        if !skills.percept.busy {
            skills.doing = None;
        }
        skills.teammate = peers.fresh().next().map(|peer| peer.message().0);
        skills.sense.perceive(&skills.percept);
        self.tree.tick(&mut self.memory, skills, now).status
    }

    fn act(&mut self, station: &mut Station) {
        station.command = self.skills.command;
    }

    fn message(&self) -> Option<Told> {
        let Skills { sense, doing, .. } = &self.skills;
        let place = Some(sense.place()).filter(|_| doing.is_none());
        let grip = match sense.state() {
            HOLD => HOLDS,
            PUT => PLACED,
            _ => EMPTY,
        };
        let operator = doing.map_or(IDLE, |command| command.operator);
        Some(Told(Announcement::new([place, Some(grip)], operator, operator)))
    }
}

impl<'t> Worker<'t> for Conventional<'t> {
    fn task(&self) -> Option<&HostTask<'t>> {
        None
    }
}

impl<'t> Hand<'t> for Conventional<'t> {
    fn thought(&self) -> Option<Thought> {
        None
    }

    fn leaf(&self) -> Option<&'static str> {
        self.tree.running(&self.memory).map(|skill| skill.name())
    }
}

impl Leaves<Skill> for Skills<'_> {
    fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
        match *leaf {
            Skill::IsReached(place) => self.sense.place() == place,
            Skill::IsHolding => self.sense.state() == HOLD,
            Skill::IsPlaced => self.sense.state() == PUT,
            Skill::IsTeammateAt(place) => self.is_teammate(PLACE, place),
            Skill::IsTeammateHolding => self.is_teammate(GRIP, HOLDS),
            _ => false,
        }
    }

    fn on_start(&mut self, leaf: &Skill, _: Instant) -> Status {
        match *leaf {
            Skill::MoveTo(place) => self.begin(MOVE_TO, Some(place)),
            Skill::Pick => self.begin(PICK, None),
            Skill::Place => self.begin(PUT_DOWN, None),
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
            Skill::Pick => self.sense.state() == HOLD,
            Skill::Place => self.sense.state() == PUT,
            Skill::Look => true,
            _ => false,
        })
    }

    fn on_halted(&mut self, _: &Skill, _: Instant) -> Halt {
        self.command = None;
        Halt::Done
    }
}
