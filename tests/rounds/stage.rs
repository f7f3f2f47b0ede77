//! Robots to which things happen one by one, and what the tests of the rules say about them.

use super::grid::Grid;
use super::model::{Action, World};
use super::task::Place;
use super::team::{K, Message, Said, Sent, teammates};
use iibt_core::team::rounds::{Answer, Protocol, View, Waiting};
use iibt_core::team::{RobotId, Stamp};
use std::rc::Rc;

pub(super) const R0: RobotId = RobotId(0);
pub(super) const R1: RobotId = RobotId(1);
pub(super) const R2: RobotId = RobotId(2);
pub(super) const R3: RobotId = RobotId(3);

/// Robots on a grid, to which things happen one by one.
pub(super) struct Stage {
    pub(super) world: World,
    pub(super) grid: Grid,
}

impl Stage {
    /// Two to four robots in a corridor of twice as many places: all to the left, or all to the
    /// right.
    pub(super) fn corridor(robots: u8) -> Self {
        let (left, right): (Vec<u8>, Vec<u8>) = ((0..robots).collect(), (robots..2 * robots).collect());
        let targets: [&[u8]; 2] = [&left, &right];
        let places: Vec<u8> = (1..=robots).collect();
        Self { world: World::new(&places, 99, &[9; 8]), grid: Grid::new(2 * robots, 1, targets) }
    }

    pub(super) fn act(&mut self, action: Action) {
        self.world.apply(action, &self.grid);
        assert_eq!(self.world.violation(), None);
    }

    /// One robot hears the newest of another, and does what follows.
    pub(super) fn hear(&mut self, robot: usize, other: usize) {
        self.act(Action::Hear(robot, other, self.world.bodies[other].sent.len() - 1, true));
    }

    /// All hear the newest of all.
    pub(super) fn hear_all(&mut self) {
        let newest: Vec<usize> = self.world.bodies.iter().map(|body| body.sent.len() - 1).collect();
        for robot in 0..newest.len() {
            for (other, &place) in newest.iter().enumerate().filter(|&(other, _)| other != robot) {
                self.act(Action::Hear(robot, other, place, true));
            }
        }
    }

    /// All hear, score, hear and decide on a policy.
    pub(super) fn decide(&mut self, policy: usize) {
        self.hear_all();
        self.hear_all();
        for robot in 0..self.world.bodies.len() {
            self.act(Action::Give(robot, policy));
        }
        self.hear_all();
    }

    pub(super) fn open(&mut self, robot: usize, view: View) {
        self.act(Action::Open(robot, view));
    }

    pub(super) fn step(&mut self, robot: usize) {
        self.act(Action::Begin(robot));
        self.act(Action::End(robot));
    }

    pub(super) fn of(&self, robot: usize) -> &Protocol<Place, K> {
        &self.world.bodies[robot].protocol
    }

    pub(super) fn waiting(&self, robot: usize) -> Option<Waiting> {
        let body = &self.world.bodies[robot];
        body.protocol.waiting(&teammates(&body.heard), &*body.list)
    }

    pub(super) fn may_move(&self, robot: usize) -> bool {
        let body = &self.world.bodies[robot];
        body.protocol.may_move(&teammates(&body.heard), &*body.list)
    }

    pub(super) fn wants_list(&self, robot: usize) -> bool {
        self.of(robot).wanted(&teammates(&self.world.bodies[robot].heard)).is_some()
    }

    pub(super) fn answer(&self, robot: usize) -> &Answer<K> {
        &self.world.bodies[robot].sent.last().expect("something was sent").1.message.answer
    }
}

pub(super) fn view(robots: &[RobotId]) -> View {
    robots.iter().copied().collect()
}

/// What a robot of three has heard: one message of one teammate.
pub(super) fn heard_from(robot: RobotId, epoch: u32, message: Message) -> Vec<Option<Sent>> {
    let mut heard = vec![None; 3];
    heard[robot.index()] = Some((Stamp { epoch, sequence: 9 }, Rc::new(Said { message, number: 0 })));
    heard
}
