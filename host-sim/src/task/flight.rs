//! A flight: the loop in which the world, the robots and the radio take turns.

use super::station::Station;
use super::waiting;
use super::world::{TaskWorld, Truth};
use super::{HostTask, HostWanted};
use crate::radio::{KEY, Traffic};
use crate::scenario;
use crate::testbed::{Shadow, Testbed};
use firmware::Robot;
use iibt_core::iibt::table::{Command, JointDecision, Tables};
use iibt_core::team::{Keys, MemberError};
use iibt_core::tree::Status;
use serde::Serialize;

/// A robot that works on a table task.
pub(crate) trait Worker<'t>: Robot<Station> {
    /// The task behind its inference nodes, if there are any.
    fn task(&self) -> Option<&HostTask<'t>>;

    /// What its inference node has raised while a precondition is missing.
    fn raised(&self) -> Option<&HostWanted> {
        None
    }
}

/// An operator that a robot began.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Operated {
    /// The tick.
    pub tick: u32,
    /// The robot, from zero.
    pub robot: usize,
    /// The number of the operator.
    pub operator: u8,
    /// Its target, if it has one.
    pub target: Option<u8>,
    /// The joint policy by which it was chosen and that policy's posterior probability; `None` for
    /// a plain leaf.
    pub policy: Option<(u16, f32)>,
}

/// The result of a flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Flown {
    /// Whether all goals are reached in truth, and the robots believe it.
    pub success: bool,
    /// Whether the trees that count have succeeded: what the robots believe.
    pub believed: bool,
    /// The ticks it took.
    pub ticks: u32,
    /// The operators that were begun, in order.
    pub operated: Vec<Operated>,
    /// What is missing at the end, a line each: what the robots wait for, or where they err. Empty
    /// after a success.
    pub missing: Vec<String>,
    /// The frames of all robots.
    pub frames: Traffic,
}

/// A flight under way.
pub(crate) struct TaskFlight<'t, R: Worker<'t>> {
    pub(crate) world: TaskWorld<'t>,
    pub(crate) statuses: Vec<Status>,
    /// The tick that is flown.
    pub(crate) tick: u32,
    testbed: Testbed<R, Station>,
    operated: Vec<Operated>,
}

impl<'t, R: Worker<'t>> TaskFlight<'t, R> {
    pub(crate) fn new(
        tables: &'t Tables<'t>,
        truth: &'t Truth,
        radio: scenario::Radio,
        seed: u64,
        robots: Vec<R>,
    ) -> Result<Self, MemberError> {
        Self::beside(tables, truth, (radio, seed), robots, Keys::shared(&KEY), None)
    }

    /// A flight of a team with its keys, and with what runs beside it.
    pub(crate) fn beside(
        tables: &'t Tables<'t>,
        truth: &'t Truth,
        (radio, seed): (scenario::Radio, u64),
        robots: Vec<R>,
        keys: Keys,
        shadow: Option<Box<dyn Shadow<R, Station>>>,
    ) -> Result<Self, MemberError> {
        let statuses = vec![Status::Running; robots.len()];
        let team = robots.into_iter().map(|robot| (robot, Station::default()));
        let testbed = Testbed::beside(team, radio, seed, keys, shadow)?;
        let world = TaskWorld::new(tables, truth, seed);
        Ok(Self { world, statuses, tick: 0, testbed, operated: Vec::new() })
    }

    /// Flies until `done` holds of the trees' statuses, or for `limit` ticks; `watch` sees the
    /// flight after every tick, before the world moves on.
    pub(crate) fn fly(
        mut self,
        limit: u32,
        done: impl Fn(&[Status]) -> bool,
        watch: &mut dyn FnMut(&Self),
    ) -> Flown {
        while self.testbed.ticks() < limit && !done(&self.statuses) {
            self.tick();
            watch(&self);
            self.world.pass();
        }
        let believed = done(&self.statuses);
        Flown {
            success: believed && self.world.is_accomplished(),
            believed,
            ticks: self.testbed.ticks(),
            missing: if believed { self.world.open_goals() } else { self.waits() },
            operated: self.operated,
            frames: self.testbed.traffic(),
        }
    }

    /// What each robot waits for that is not done.
    fn waits(&self) -> Vec<String> {
        let tables = self.world.tables();
        let robots = self.robots().zip(tables.roles()).zip(&self.statuses);
        let waiting = robots.filter(|(_, status)| **status != Status::Success);
        let line = waiting.filter_map(|((robot, role), _)| {
            let waits = waiting::of_robot(tables, robot.task()?, robot.raised())?;
            Some(format!("{} {waits}", role.name))
        });
        line.collect()
    }

    fn tick(&mut self) {
        self.tick = self.testbed.ticks();
        for robot in 0..self.statuses.len() {
            let (busy, readings) = (self.world.is_busy(robot), self.world.read(robot));
            self.testbed.parts_mut(robot).sense(self.tick, busy, readings);
        }
        self.statuses = self.testbed.tick();
        for robot in 0..self.statuses.len() {
            if let Some(command) = self.parts(robot).command {
                self.begin(robot, command);
            }
        }
    }

    /// The frames that the robots sent in this tick.
    pub(crate) fn frames(&self) -> &[u8] {
        self.testbed.frames()
    }

    /// The percept and the command of a robot in this tick.
    pub(crate) fn parts(&self, robot: usize) -> &Station {
        self.testbed.parts(robot)
    }

    /// The robots in their order.
    pub(crate) fn robots(&self) -> impl Iterator<Item = &R> {
        self.testbed.robots()
    }

    fn begin(&mut self, robot: usize, command: Command) {
        self.world.begin(robot, command);
        let task = self.robots().nth(robot).and_then(Worker::task);
        let of = |decision: &JointDecision<64, 4, 256>| {
            let probability = decision.posterior.get(usize::from(decision.choice)).copied().unwrap_or(0.0);
            (decision.choice, probability)
        };
        let policy = task.and_then(HostTask::decision).map(of);
        let Command { operator, target } = command;
        self.operated.push(Operated { tick: self.tick, robot, operator, target, policy });
    }
}
