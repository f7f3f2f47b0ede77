//! A robot of section 6.2 on the bench, whose readings and teammate are what a test says.

use host_sim::manipulation::tables::{ELSEWHERE, EMPTY, FREE, GOAL_C, GRIP, HOLDS, IDLE, PLACE};
use iibt_core::iibt::table::{Command, Percept, TableMessage, TableTask, Tables};
use iibt_core::iibt::{InferenceNode, Task};
use iibt_core::team::{Envelope, Limits, Member, RobotId, Roster, Stamp};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::Status;

/// The task of one of the two robots.
pub type Handling = TableTask<'static, 7, 2, 16>;

/// One robot, its node, and its teammate, which takes part in the rounds and wants nothing.
#[derive(Debug)]
pub struct Bench {
    /// Its task.
    pub task: Handling,
    /// Its inference node.
    pub node: InferenceNode<Handling>,
    /// Its teammate.
    pub roster: Roster<TableMessage>,
    /// The time of the next tick.
    pub now: u32,
    /// What is read of the place and of the semantic state.
    pub readings: [u8; 2],
    /// Whether an operator is under way.
    pub busy: bool,
    teammate: Teammate,
    sent: Option<TableMessage>,
}

/// The timeout of the node, in ticks.
pub const TIMEOUT: u32 = 50;

/// What a teammate is sure of, and what it is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Said {
    place: u8,
    grip: u8,
    operator: u8,
}

/// A teammate that is sure of these, and is doing that.
#[must_use]
pub const fn said(place: u8, grip: u8, operator: u8) -> Said {
    Said { place, grip, operator }
}

/// A teammate that has not begun.
#[must_use]
pub const fn idle() -> Said {
    said(ELSEWHERE, EMPTY, IDLE)
}

/// A teammate that stands at goal C and holds its object.
#[must_use]
pub const fn ready() -> Said {
    said(GOAL_C, HOLDS, IDLE)
}

/// The other robot: the task without a node.
#[derive(Debug)]
struct Teammate {
    task: Handling,
    roster: Roster<TableMessage>,
    is: Option<Said>,
    sent: u32,
}

impl Teammate {
    /// Makes it what a test says: it looks until it is sure, then begins what it is to do.
    fn change_to(&mut self, now: Said) {
        if self.is.replace(now) == Some(now) {
            return;
        }
        let readings = self.readings();
        for tick in 0..30 {
            // Before every other time, so that nothing counts twice.
            let percept = percept(u32::MAX / 2 + 100 * self.sent + tick, false, readings);
            self.task.sense(&percept);
        }
        let sure = [PLACE, GRIP].map(|factor| self.task.sure(factor.into()));
        assert_eq!(sure, [now.place, now.grip].map(|state| Some(state.into())));
        if now.operator != IDLE {
            self.task.begin(Command { operator: now.operator, target: Some(GOAL_C) });
        }
    }

    /// What it reads of the place and of the semantic state.
    fn readings(&self) -> [u8; 2] {
        let Said { place, grip, .. } = self.is.unwrap_or(idle());
        let role = self.task.role();
        [place, role.states.of(role.factors, |factor| usize::from([place, grip][factor])) as u8]
    }

    /// Hears the robot and answers.
    fn tick(&mut self, now: u32, heard: Option<TableMessage>) -> Envelope<TableMessage> {
        let own = self.roster.own();
        if let Some(message) = heard {
            let envelope = Envelope { sender: RobotId(1 - own.0), stamp: stamp(self.sent), message };
            self.roster.hear(envelope, Instant(now)).expect("it is newer");
        }
        let is_busy = self.is.is_some_and(|said| said.operator != IDLE);
        self.task.observe(&percept(now, is_busy, self.readings()), self.roster.at(Instant(now)));
        let message = self.task.announce(self.roster.at(Instant(now)));
        self.sent += 1;
        Envelope { sender: own, stamp: stamp(self.sent), message }
    }
}

const fn stamp(sequence: u32) -> Stamp {
    Stamp { epoch: 1, sequence }
}

fn percept(now: u32, busy: bool, readings: [u8; 2]) -> Percept {
    let mut percept = Percept { at: Instant(now), busy, ..Percept::default() };
    if !busy {
        percept.readings = std::array::from_fn(|sensor| readings.get(sensor).copied());
    }
    percept
}

fn roster(robot: u8) -> Roster<TableMessage> {
    let limits = Limits::for_beacons(Duration(1)).expect("a tick is short");
    Roster::new(Member::new(RobotId(robot), 2).expect("a team of two"), limits)
}

impl Bench {
    /// Robot `robot` of these tables, elsewhere and with an empty grip.
    #[must_use]
    pub fn new(tables: &'static Tables<'static>, robot: u8) -> Self {
        let task = |robot| Handling::new(tables, RobotId(robot), 1).expect("it is sized by the tables");
        let other = 1 - robot;
        Self {
            task: task(robot),
            node: InferenceNode::new(Duration(TIMEOUT)),
            roster: roster(robot),
            now: 0,
            readings: [ELSEWHERE, FREE],
            busy: false,
            teammate: Teammate { task: task(other), roster: roster(other), is: None, sent: 0 },
            sent: None,
        }
    }

    /// Ticks the teammate, if there is one, then the robot, which hears it in the same tick.
    pub fn step(&mut self, teammate: Option<Said>) -> Status {
        self.listen(teammate);
        let status = self.tick_node();
        self.speak();
        status
    }

    /// Lets the robots tell each other what is so, then ticks the robot until it begins something
    /// or stops; for as long as a round takes, twice.
    pub fn tick(&mut self, teammate: Option<Said>) -> Status {
        for _ in 0..4 {
            self.listen(teammate);
            self.task.observe(&self.percept(), self.roster.at(Instant(self.now)));
            self.speak();
        }
        let mut status = self.step(teammate);
        for _ in 0..3 {
            if status == Status::Running && self.begun().is_none() {
                status = self.step(teammate);
            }
        }
        status
    }

    fn listen(&mut self, teammate: Option<Said>) {
        if let Some(said) = teammate {
            self.teammate.change_to(said);
            let answer = self.teammate.tick(self.now, self.sent.take());
            self.roster.hear(answer, Instant(self.now)).expect("it is newer");
        }
    }

    fn speak(&mut self) {
        self.sent = Some(self.task.announce(self.roster.at(Instant(self.now))));
        self.now = self.now.wrapping_add(1);
    }

    fn percept(&self) -> Percept {
        percept(self.now, self.busy, self.readings)
    }

    /// Ticks the node with the readings of now, once more if it was ticked before.
    pub fn tick_node(&mut self) -> Status {
        let (percept, now) = (self.percept(), Instant(self.now));
        self.node.tick(&mut self.task, &percept, self.roster.at(now), now)
    }

    /// Puts the robot somewhere, with a semantic state, and lets it look until it is sure.
    pub fn put(&mut self, place: u8, state: u8) {
        self.readings = [place, state];
        for _ in 0..20 {
            self.task.sense(&self.percept());
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
}
