//! Random faults during a mission.

use crate::random::{Random, Stream};
use crate::robot::resized;
use crate::scenario::{Device, EventEffect, InferenceSpec, Radio, RobotSpec, Scenario, UnknownSpec};
use crate::team::TeamError;
use crate::world::World;
use iibt_core::grid::Cell;
use iibt_core::navigation::{Mission, MissionError};

/// The most obstacles that appear in one flight.
const OBSTACLES: u32 = 3;

/// The most times that one robot's battery falls, and the most way-points that it is given.
const TIMES: u32 = 2;

/// The charge in percent to which a battery falls: below the level at which a robot leaves its
/// team.
const LOW: u8 = 10;

/// The charge gained per tick, in percent: on the charger, or anywhere for a robot without one.
const CHARGING: [u8; 2] = [20, 4];

/// Random faults, as probabilities and amounts; none by default.
///
/// ```
/// use host_sim::{Faults, Radio};
///
/// let radio = Radio { loss: 0.3, jitter: 3, duplicate: 0.2, ..Radio::default() };
/// let faults = Faults { radio, slip: 0.1, restart: 0.005, ..Faults::default() };
/// assert_eq!((faults.radio.delay, faults.errand), (1, 0.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// The faults of the radio.
    pub radio: Radio,
    /// The probability that a move fails, and the robot stays.
    pub slip: f64,
    /// The probability that a localiser names another cell than the true one.
    pub misreading: f64,
    /// The probability per robot and tick that it restarts without its memory.
    pub restart: f64,
    /// The probability per tick that a cell without a goal becomes an obstacle, up to three times.
    pub obstacle: f64,
    /// The probability per robot and tick that its battery falls to a tenth, up to twice a robot.
    /// A robot without a charger is then charged where it stands, by 4 % a tick.
    pub low_battery: f64,
    /// The probability per robot and tick that it is told to visit a cell, up to twice a robot.
    pub errand: f64,
    /// The probability per robot and tick that its localiser freezes for good.
    pub frozen_localiser: f64,
    /// The probability per robot and tick that its drive freezes for good.
    pub frozen_drive: f64,
}

/// The faults of one flight as they are drawn.
#[derive(Debug)]
pub(crate) struct FaultInjector {
    faults: Faults,
    random: Random,
    obstacles: u32,
    low_batteries: Vec<u32>,
    errands: Vec<u32>,
}

impl FaultInjector {
    pub(crate) fn new(faults: Faults, team: usize, seed: u64) -> Self {
        let random = Random::of(seed, Stream::Fault);
        Self { faults, random, obstacles: 0, low_batteries: vec![0; team], errands: vec![0; team] }
    }

    /// Draws the faults of the next tick; returns the robots that restart.
    pub(crate) fn strike(&mut self, world: &mut World, scenario: &Scenario) -> Vec<usize> {
        self.obstruct(world, &scenario.goals);
        let mut restarting = Vec::new();
        for (index, robot) in scenario.robots.iter().enumerate() {
            self.trouble(world, index, robot);
            if self.random.bernoulli(self.faults.restart) {
                restarting.push(index);
            }
        }
        restarting
    }

    fn obstruct(&mut self, world: &mut World, goals: &[Cell]) {
        if self.obstacles < OBSTACLES && self.random.bernoulli(self.faults.obstacle) {
            let cell = self.cell(world);
            if !goals.contains(&cell) {
                world.cause(EventEffect::Block(cell));
                self.obstacles += 1;
            }
        }
    }

    fn trouble(&mut self, world: &mut World, index: usize, robot: &RobotSpec) {
        if self.faults.low_battery > 0.0 && robot.charger.is_none() {
            world.set_charge(index, world.battery(index).percent() + CHARGING[1]);
        }
        if self.low_batteries[index] < TIMES && self.random.bernoulli(self.faults.low_battery) {
            self.low_batteries[index] += 1;
            world.cause(EventEffect::Charge(index, LOW));
        }
        if self.errands[index] < TIMES && self.random.bernoulli(self.faults.errand) {
            self.errands[index] += 1;
            let cell = self.cell(world);
            world.cause(EventEffect::Visit(index, cell));
        }
        let frozen = [self.faults.frozen_localiser, self.faults.frozen_drive];
        for (device, probability) in Device::ALL.into_iter().zip(frozen) {
            // Flights without this fault have the numbers that they had before there was one.
            if probability > 0.0 && !world.is_frozen(index, device) && self.random.bernoulli(probability) {
                world.cause(EventEffect::Freeze(index, device, None));
            }
        }
    }

    fn cell(&mut self, world: &World) -> Cell {
        Cell(self.random.below(world.floor().len()) as u16)
    }
}

impl Scenario {
    /// A mission as a scenario with these faults: robots that see the cells around them, and move
    /// at the paces of the mission.
    pub(crate) fn of<const W: usize>(mission: &Mission<'_, W>, faults: &Faults) -> Result<Self, TeamError> {
        let robot = |(index, &start): (usize, &Cell)| RobotSpec {
            name: format!("R{}", index + 1),
            start,
            battery: 100,
            charger: mission.chargers.get(index).copied().flatten(),
            goal: mission.own_goals.get(index).copied().flatten(),
            drain: 0.0,
            charging: f64::from(CHARGING[0]),
            slip: faults.slip,
            localiser: 1.0 - faults.misreading,
            sensor: None,
            view: 1,
            pace: mission.paces.get(index).copied().unwrap_or(1).into(),
            paths: Vec::new(),
        };
        let own = mission.own_goals.iter().flatten().filter(|own| !mission.goals.contains(own));
        let goals: Vec<Cell> = mission.goals.iter().chain(own).copied().collect();
        Ok(Self {
            name: "mission".to_owned(),
            title: String::new(),
            limit: u32::MAX,
            map: resized(&mission.map).ok_or(MissionError::MapTooLarge)?,
            serves: vec![1.0; goals.len()],
            unknowns: mission.unknowns.iter().map(UnknownSpec::from).collect(),
            need: mission.need.map_or(goals.len().min(mission.starts.len()), usize::from),
            goals,
            waits_for_charging: mission.waits_for_charging,
            forgets: mission.forgets,
            missions: 1,
            robots: mission.starts.iter().enumerate().map(robot).collect(),
            events: Vec::new(),
            drive_faults: Vec::new(),
            radio: faults.radio,
            inference: InferenceSpec::default(),
        })
    }
}
