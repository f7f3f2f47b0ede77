//! A robot of section 6.2 on the bench, whose readings and teammate are what a test says.

use host_sim::manipulation::tables::{ELSEWHERE, EMPTY, FREE, GOAL_C, GRIP, HOLDS, IDLE, PLACE};
use iibt_core::iibt::table::{Announcement, Percept, TableTask, Tables};
use iibt_core::iibt::{InferenceNode, Task};
use iibt_core::team::{Envelope, Limits, Member, RobotId, Roster, Stamp};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::Status;

/// The task of one of the two robots.
pub type Handling = TableTask<'static, 7, 2, 16>;

/// One robot, its node, and its teammate as it was heard.
#[derive(Debug)]
pub struct Bench {
    /// Its task.
    pub task: Handling,
    /// Its inference node.
    pub node: InferenceNode<Handling>,
    /// Its teammate.
    pub roster: Roster<Announcement>,
    /// The time of the next tick.
    pub now: u32,
    /// What is read of the place and of the semantic state.
    pub readings: [u8; 2],
    /// Whether an operator is under way.
    pub busy: bool,
    said: u32,
}

/// The timeout of the node, in ticks.
pub const TIMEOUT: u32 = 50;

/// A teammate that is sure of these, and is doing that.
#[must_use]
pub fn said(place: u8, grip: u8, operator: u8) -> Announcement {
    Announcement::new([Some(place), Some(grip)], operator, 1.0)
}

/// A teammate that has not begun.
#[must_use]
pub fn idle() -> Announcement {
    said(ELSEWHERE, EMPTY, IDLE)
}

/// A teammate that stands at goal C and holds its object.
#[must_use]
pub fn ready() -> Announcement {
    said(GOAL_C, HOLDS, IDLE)
}

impl Bench {
    /// Robot `robot` of these tables, elsewhere and with an empty grip.
    #[must_use]
    pub fn new(tables: &'static Tables<'static>, robot: u8) -> Self {
        let limits = Limits::for_beacons(Duration(1)).expect("a tick is short");
        let member = Member::new(RobotId(robot), 2).expect("a team of two");
        Self {
            task: Handling::new(tables, RobotId(robot)).expect("it is sized by the tables"),
            node: InferenceNode::new(Duration(TIMEOUT)),
            roster: Roster::new(member, limits),
            now: 0,
            readings: [ELSEWHERE, FREE],
            busy: false,
            said: 0,
        }
    }

    /// What the teammate says now.
    pub fn hear(&mut self, message: Announcement) {
        let sender = RobotId(1 - self.roster.own().0);
        let stamp = Stamp { epoch: 1, sequence: self.said };
        self.said += 1;
        let envelope = Envelope { sender, stamp, message };
        self.roster.hear(envelope, Instant(self.now)).expect("it is newer");
    }

    /// Senses, and ticks the node, after hearing the teammate if it says something.
    pub fn tick(&mut self, message: Option<Announcement>) -> Status {
        if let Some(message) = message {
            self.hear(message);
        }
        let (percept, now) = (self.percept(), Instant(self.now));
        self.now = self.now.wrapping_add(1);
        self.node.tick(&mut self.task, &percept, self.roster.at(now), now)
    }

    /// Puts the robot somewhere, with a semantic state, and lets it look until it is sure.
    pub fn put(&mut self, place: u8, state: u8) {
        self.readings = [place, state];
        for _ in 0..20 {
            let percept = self.percept();
            self.task.observe(&percept, self.roster.at(Instant(self.now)));
            self.now = self.now.wrapping_add(1);
        }
        assert_eq!(self.task.sure(PLACE.into()), Some(place.into()));
        assert!(self.task.sure(GRIP.into()).is_some());
    }

    /// The number and the posterior probability of the joint policy that was chosen in this tick.
    #[must_use]
    pub fn decided(&self) -> (u16, f32) {
        let decision = self.task.decision().expect("it has decided");
        (decision.choice, decision.posterior[usize::from(decision.choice)])
    }

    /// C of both robots in the decision of this tick, raises included.
    #[must_use]
    pub fn preferences(&self) -> [[f32; 4]; 2] {
        let rows = self.task.decision().expect("it has decided").preferences;
        rows.map(|row| [row[0], row[1], row[2], row[3]])
    }

    /// The operator that was begun in this tick, and its target.
    #[must_use]
    pub fn begun(&self) -> Option<(u8, Option<u8>)> {
        self.task.command().map(|command| (command.operator, command.target))
    }

    fn percept(&self) -> Percept {
        let mut percept = Percept { at: Instant(self.now), busy: self.busy, ..Percept::default() };
        if !self.busy {
            percept.readings = std::array::from_fn(|sensor| self.readings.get(sensor).copied());
        }
        percept
    }
}
