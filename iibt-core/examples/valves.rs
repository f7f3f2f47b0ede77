//! Two robots close two valves in an order: R2 the outlet once R1 has announced that the inlet is
//! closed. Each has one sensor, which errs now and then; a valve that sticks is turned again. They
//! decide together, in rounds.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[macro_use]
mod chip;

use iibt_core::iibt::InferenceNode;
use iibt_core::iibt::table::{
    Aim, Fact, HiddenFactor, Operator, Percept, Reads, Remedy, Role, Sensor, TableMessage, TableTask, Tables,
};
use iibt_core::team::{Envelope, Limits, Member, RobotId, Roster, Stamp};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::Status;

const OPEN: u8 = 0;
const CLOSED: u8 = 1;
const TURN: u8 = 0;
const IDLE: u8 = 1;

const IS_CLOSED: Fact = Fact::sure("closed", 0, &[CLOSED]);
const R2_IDLE: Fact = Fact::doing("R2 idle", 1, &[IDLE]);
const INLET_CLOSED: Fact = Fact::announced("inlet closed", 0, 0, &[CLOSED]);

/// A turn closes the valve four times in five. It needs fact 1, the turn, and forbids fact 0, a
/// closed valve.
const TURN_IT: Operator =
    Operator { requires: &[1], forbids: &[0], ..Operator::bringing("turn", CLOSED, 0.8) };

/// A robot with a valve.
const VALVE: Role = Role {
    sensors: &[Sensor::even("position", Reads::Factor(0), 0.9)],
    operators: &[TURN_IT, Operator::IDLE],
    idle: IDLE,
    // While it is the other's turn, the valve is better left open.
    remedies: &[Remedy::above_all(1, OPEN)],
    aims: &[Aim::new("close", &[0], &[0.0, 1.0])],
    ..Role::of(&[HiddenFactor::unknown("valve", &["open", "closed"])])
};

/// A robot whose valve may be turned when the second of its facts holds.
const fn role(name: &'static str, facts: &'static [Fact<'static>]) -> Role<'static> {
    Role { name, facts, ..VALVE }
}

static VALVES: Tables =
    Tables::new(&[role("R1", &[IS_CLOSED, R2_IDLE]), role("R2", &[IS_CLOSED, INLET_CLOSED])]);

/// The task of one robot; its sizes are those of the tables.
type Valve = TableTask<'static, { VALVES.states() }, { VALVES.robots() }, { VALVES.policies() }>;

/// One robot: its task and node, its teammate as it was heard, and its valve in truth.
struct Robot {
    task: Valve,
    node: InferenceNode<Valve>,
    roster: Roster<TableMessage>,
    said: Option<TableMessage>,
    turns: u32,
    /// The turns for which the valve sticks.
    sticks: u32,
}

impl Robot {
    fn new(number: u8, sticks: u32) -> Self {
        let member = Member::new(RobotId(number), 2).unwrap();
        let roster = Roster::new(member, Limits::for_beacons(Duration(1)).unwrap());
        let task = Valve::new(&VALVES, RobotId(number), 1).unwrap();
        Self { task, node: InferenceNode::new(Duration(20)), roster, said: None, turns: 0, sticks }
    }

    fn is_closed(&self) -> bool {
        self.turns > self.sticks
    }

    /// Reads the valve, every seventh time wrongly, decides, and turns the valve if that was
    /// decided.
    fn tick(&mut self, now: Instant) -> Status {
        let mut percept = Percept { at: now, ..Percept::default() };
        percept.readings[0] = Some(u8::from(self.is_closed() ^ (now.0 % 7 == 3)));
        let status = self.node.tick(&mut self.task, &percept, self.roster.at(now), now);
        self.said = Some(self.task.announce(self.roster.at(now)));
        self.turns += u32::from(self.task.command().is_some_and(|command| command.operator == TURN));
        status
    }
}

fn play() {
    let mut robots = [Robot::new(0, 1), Robot::new(1, 0)];
    let (mut statuses, mut closed) = ([Status::Running; 2], [None; 2]);
    for tick in 0..80 {
        let now = Instant(tick);
        let mut said = robots.each_mut().map(|robot| robot.said.take());
        for (number, robot) in robots.iter_mut().enumerate() {
            let (sender, stamp) = (RobotId(1 - number as u8), Stamp { epoch: 1, sequence: tick });
            if let Some(message) = said[sender.index()].take() {
                robot.roster.hear(Envelope { sender, stamp, message }, now).unwrap();
            }
            statuses[number] = robot.tick(now);
            closed[number] = closed[number].or(robot.is_closed().then_some(tick));
        }
    }
    show!("the inlet is closed at tick {:?}, the outlet at tick {:?}", closed[0], closed[1]);
    assert_eq!(statuses, [Status::Success; 2]);
    assert_eq!(robots.map(|robot| robot.turns), [2, 1], "R1 turns again what stuck");
    assert!(closed[0] < closed[1], "the inlet is closed before the outlet: {closed:?}");
}

play!(play);
