//! A flight: the loop in which the world, the robots and the radio take turns.

use super::HostTask;
use super::station::Station;
use super::world::{Truth, World};
use crate::radio::{KEY, Radio, Traffic};
use crate::scenario;
use firmware::{Controller, Robot, Settings};
use iibt_core::iibt::table::{Announcement, Command, JointDecision, MAX_SENSORS, Percept, Tables};
use iibt_core::team::{Member, MemberError, RobotId};
use iibt_core::time::Instant;
use iibt_core::tree::Status;
use serde::Serialize;
use std::num::NonZero;

/// A robot that works on a table task.
pub(crate) trait Worker<'t>: Robot<Station, Message = Announcement> {
    /// The task behind its inference nodes, if there are any.
    fn task(&self) -> Option<&HostTask<'t>>;
}

/// An operator that a robot began.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Operated {
    /// When.
    pub tick: u32,
    /// Which robot, from zero.
    pub robot: usize,
    /// The number of the operator.
    pub operator: u8,
    /// Where it leads, if that is a target.
    pub target: Option<u8>,
    /// The joint policy by which it was chosen and that policy's posterior probability; `None` for a plain leaf.
    pub policy: Option<(u16, f32)>,
}

/// What came of a flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Flown {
    /// Whether all goals are reached in truth, and the robots believe it.
    pub success: bool,
    /// Whether the trees that count have succeeded: what the robots believe.
    pub believed: bool,
    /// The ticks it took.
    pub ticks: u32,
    /// Everything that was begun, in order.
    pub operated: Vec<Operated>,
    /// The frames of all robots.
    pub frames: Traffic,
}

/// A flight under way.
pub(crate) struct Flight<'t, R: Worker<'t>> {
    pub(crate) world: World<'t>,
    pub(crate) robots: Vec<Controller<R, Station>>,
    pub(crate) statuses: Vec<Status>,
    pub(crate) operated: Vec<Operated>,
    pub(crate) tick: u32,
    radio: Radio,
}

impl<'t, R: Worker<'t>> Flight<'t, R> {
    pub(crate) fn new(
        tables: &'t Tables<'t>,
        truth: &'t Truth,
        radio: scenario::Radio,
        seed: u64,
        robots: Vec<R>,
    ) -> Result<Self, MemberError> {
        let team = robots.len();
        let controller = |(robot, own): (R, u8)| {
            let settings = Settings::new(Member::new(RobotId(own), team)?, KEY, 1, NonZero::<u16>::MIN);
            Ok(Controller::new(robot, settings, Station::default()))
        };
        let robots = robots.into_iter().zip(0..).map(controller).collect::<Result<_, _>>()?;
        Ok(Self {
            world: World::new(tables, truth, seed),
            radio: Radio::new(radio, team, seed),
            robots,
            statuses: vec![Status::Running; team],
            operated: Vec::new(),
            tick: 0,
        })
    }

    /// Flies until `done` holds of the trees' statuses, or for `limit` ticks; `watch` sees the flight after every tick, before the
    /// world moves on.
    pub(crate) fn fly(
        mut self,
        limit: u32,
        done: impl Fn(&[Status]) -> bool,
        watch: &mut dyn FnMut(&Self),
    ) -> Flown {
        while self.tick < limit && !done(&self.statuses) {
            self.tick(watch);
        }
        let believed = done(&self.statuses);
        Flown {
            success: believed && self.world.is_accomplished(),
            believed,
            ticks: self.tick,
            operated: self.operated,
            frames: self.radio.traffic().iter().sum(),
        }
    }

    fn tick(&mut self, watch: &mut dyn FnMut(&Self)) {
        for (receiver, bytes) in self.radio.arrivals(self.tick) {
            self.robots[receiver].hardware_mut().link.received.extend(bytes);
        }
        for (index, controller) in self.robots.iter_mut().enumerate() {
            let (busy, readings) = (self.world.is_busy(index), self.world.read(index));
            controller.hardware_mut().sense(self.tick, busy, readings);
            self.statuses[index] = controller.tick();
        }
        for index in 0..self.robots.len() {
            if let Some(command) = self.command(index) {
                self.begin(index, command);
            }
            for frame in std::mem::take(&mut self.robots[index].hardware_mut().link.sent) {
                self.radio.send(self.tick, index, &frame);
            }
        }
        watch(self);
        self.world.pass();
        self.tick += 1;
    }

    /// What a robot begins in this tick.
    pub(crate) fn command(&self, robot: usize) -> Option<Command> {
        self.robots[robot].hardware().command
    }

    fn begin(&mut self, robot: usize, command: Command) {
        self.world.begin(robot, command);
        let decision = self.robots[robot].robot().task().and_then(HostTask::decision);
        let of = |decision: &JointDecision<64, 4, 256>| {
            let probability = decision.posterior.get(usize::from(decision.choice)).copied().unwrap_or(0.0);
            (decision.choice, probability)
        };
        self.operated.push(Operated {
            tick: self.tick,
            robot,
            operator: command.operator,
            target: command.target,
            policy: decision.map(of),
        });
    }
}

impl Station {
    /// Puts what is sensed in a tick before the controller.
    fn sense(&mut self, tick: u32, busy: bool, readings: [Option<u8>; MAX_SENSORS]) {
        let readings = if busy { [None; MAX_SENSORS] } else { readings };
        self.percept = Percept { at: Instant(tick), readings, busy };
        (self.clock.now, self.command) = (tick, None);
    }
}
