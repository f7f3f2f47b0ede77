//! A team on the bench: robots with the firmware's controllers in a world that is hard on them.

use crate::rig::{Body, DEMO_KEY, settings};
use firmware::{Controller, Navigator};
use iibt_core::grid::{Cell, Map};
use iibt_core::navigation::{Intention, Mission, Said};
use iibt_core::team::{Context, MAX_FRAME, SipHash64, encode};
use iibt_core::time::Instant;
use iibt_core::tree::Status;

/// A small generator of random numbers (xorshift64*), so that a test is the same everywhere.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A generator from a seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// The next 32 bits.
    pub fn bits(&mut self) -> u32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32) as u32
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        f64::from(self.bits()) < probability * f64::from(u32::MAX)
    }

    /// A number below `limit`.
    pub fn below(&mut self, limit: u32) -> u32 {
        self.bits() % limit.max(1)
    }
}

/// What makes life hard.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hardship {
    /// The probability that a frame does not reach one receiver.
    pub loss: f64,
    /// The most ticks a frame takes beyond the first.
    pub delay: u32,
    /// The probability that a frame arrives twice.
    pub duplicates: f64,
    /// The bytes of noise on each robot's line before each frame, none of them a delimiter.
    pub stray: usize,
    /// The random bytes on each robot's line in each tick.
    pub garbage: usize,
    /// The probability that a move fails and the robot stays.
    pub slip: f64,
    /// The probability per robot and tick of a restart.
    pub restart: f64,
    /// The probability that a localiser reads some cell at random.
    pub misreading: f64,
    /// The probability per tick that a free cell becomes an obstacle, up to three times.
    pub obstacle: f64,
    /// The probability per robot and tick that its battery falls to a tenth, up to twice a robot.
    pub low_battery: f64,
    /// The probability per robot and tick that it is told to visit some free cell, up to twice a robot.
    pub errand: f64,
}

/// How a flight ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// The tick at which all robots had arrived, if they did.
    pub arrived: Option<u32>,
    /// How often two robots shared or swapped a cell.
    pub collisions: u32,
    /// How many frames were lost.
    pub lost: u32,
}

/// A robot of the team.
pub type Bench<'m> = Controller<Navigator<'m, 49, 2, 16>, Body>;

/// A team in the air.
#[derive(Debug)]
pub struct Team<'m> {
    mission: &'m Mission<'m, 2>,
    /// The robots.
    pub robots: Vec<Bench<'m>>,
    /// The world as it is.
    pub map: Map<2>,
    epochs: Vec<u32>,
    on_air: Vec<(u32, usize, Vec<u8>)>,
    random: Random,
    hardship: Hardship,
    now: u32,
    obstacles: u32,
    low_batteries: Vec<u32>,
    errands: Vec<u32>,
    statuses: Vec<Status>,
    silent: Vec<bool>,
    misreadings: Vec<Option<Cell>>,
    outcome: Outcome,
}

impl<'m> Team<'m> {
    /// A team at the start of a mission, its clock shortly before it wraps.
    ///
    /// # Panics
    /// When the mission is not sound.
    #[must_use]
    pub fn new(mission: &'m Mission<'m, 2>, hardship: Hardship, seed: u64) -> Self {
        let robots =
            (0..mission.starts.len()).map(|robot| boot(mission, robot, mission.starts[robot], 1)).collect();
        Self {
            mission,
            robots,
            map: mission.map,
            epochs: vec![1; mission.starts.len()],
            on_air: vec![],
            random: Random::new(seed),
            hardship,
            now: 0,
            obstacles: 0,
            low_batteries: vec![0; mission.starts.len()],
            errands: vec![0; mission.starts.len()],
            statuses: vec![Status::Running; mission.starts.len()],
            silent: vec![false; mission.starts.len()],
            misreadings: vec![None; mission.starts.len()],
            outcome: Outcome { arrived: None, collisions: 0, lost: 0 },
        }
    }

    /// Flies until all have arrived or the limit is reached.
    pub fn fly(mut self, limit: u32) -> Outcome {
        while self.outcome.arrived.is_none() && self.now < limit {
            self.tick();
        }
        self.outcome
    }

    /// One tick of every robot, then of the world.
    pub fn tick(&mut self) {
        self.deliver();
        for (index, robot) in self.robots.iter_mut().enumerate() {
            let map = &self.map;
            let body = robot.hardware_mut();
            body.now = Instant((u32::MAX - 50).wrapping_add(self.now));
            let misread = self.random.chance(self.hardship.misreading);
            let random = misread.then(|| Cell(self.random.below(map.len() as u32) as u16));
            body.reading = random.or(self.misreadings[index]);
            body.hazards = in_view(self.mission, map, body.cell);
            self.statuses[index] = robot.tick();
        }
        if self.statuses.iter().all(|&status| status == Status::Success) {
            self.outcome.arrived = Some(self.now);
        }
        self.send();
        self.move_all();
        self.charge_all();
        self.change_the_world();
        self.now += 1;
    }

    fn deliver(&mut self) {
        let now = self.now;
        let (due, later) = std::mem::take(&mut self.on_air).into_iter().partition(|(when, ..)| *when <= now);
        self.on_air = later;
        let due: Vec<(u32, usize, Vec<u8>)> = due;
        for (_, to, frame) in due {
            let stray: Vec<u8> = (0..self.hardship.stray).map(|_| self.random.bits() as u8 | 1).collect();
            self.robots[to].hardware_mut().inbox.extend(stray.into_iter().chain(frame));
        }
        for robot in &mut self.robots {
            let garbage = (0..self.hardship.garbage).map(|_| self.random.bits() as u8);
            robot.hardware_mut().inbox.extend(garbage);
        }
    }

    fn send(&mut self) {
        for from in 0..self.robots.len() {
            let frames = std::mem::take(&mut self.robots[from].hardware_mut().outbox);
            let heard = if self.silent[from] { vec![] } else { frames };
            for frame in heard {
                for to in (0..self.robots.len()).filter(|&to| to != from) {
                    let copies = 1 + u32::from(self.random.chance(self.hardship.duplicates));
                    for _ in 0..copies {
                        self.put_on_air(to, &frame);
                    }
                }
            }
        }
    }

    fn put_on_air(&mut self, to: usize, frame: &[u8]) {
        if self.random.chance(self.hardship.loss) {
            self.outcome.lost += 1;
        } else {
            let delay = 1 + self.random.below(self.hardship.delay + 1);
            self.on_air.push((self.now + delay, to, frame.to_vec()));
        }
    }

    fn move_all(&mut self) {
        let before: Vec<Cell> = self.robots.iter().map(|robot| robot.hardware().cell).collect();
        for robot in &mut self.robots {
            if self.random.chance(self.hardship.slip) {
                robot.hardware_mut().asked = None;
            }
            robot.hardware_mut().carry_out(&self.map);
        }
        let after: Vec<Cell> = self.robots.iter().map(|robot| robot.hardware().cell).collect();
        for one in 0..after.len() {
            for other in 0..one {
                let swapped = after[one] == before[other] && after[other] == before[one];
                let (one, other) = (self.robots[one].hardware(), self.robots[other].hardware());
                let shared = one.cells().any(|cell| other.cells().any(|theirs| theirs == cell));
                self.outcome.collisions += u32::from(shared || swapped);
            }
        }
    }

    /// Whoever is on its charger is charged quickly; a robot that has none slowly wherever it is, if batteries fall.
    fn charge_all(&mut self) {
        for robot in &mut self.robots {
            let charger = robot.robot().navigation().charger();
            let body = robot.hardware_mut();
            let gain = if charger == Some(body.cell) {
                20
            } else {
                u8::from(charger.is_none() && self.hardship.low_battery > 0.0) * 4
            };
            body.charge = (body.charge + gain).min(100);
        }
    }

    /// Lets a battery fall, or sends a robot to a way-point.
    fn trouble(&mut self, robot: usize) {
        if self.low_batteries[robot] < 2 && self.random.chance(self.hardship.low_battery) {
            self.low_batteries[robot] += 1;
            self.robots[robot].hardware_mut().charge = 10;
        }
        if self.errands[robot] < 2 && self.random.chance(self.hardship.errand) {
            self.errands[robot] += 1;
            let cell = Cell(self.random.below(self.map.len() as u32) as u16);
            // What it refuses it need not visit.
            let _ = self.robots[robot].robot_mut().navigation_mut().visit(cell);
        }
    }

    fn change_the_world(&mut self) {
        if self.obstacles < 3 && self.random.chance(self.hardship.obstacle) {
            let cell = Cell(self.random.below(self.map.len() as u32) as u16);
            let taken = self.robots.iter().any(|robot| robot.hardware().cells().any(|theirs| theirs == cell));
            if !taken && !self.mission.goals.contains(&cell) {
                self.map.block(cell);
                self.obstacles += 1;
            }
        }
        for robot in 0..self.robots.len() {
            self.trouble(robot);
            if self.random.chance(self.hardship.restart) {
                self.restart(robot);
            }
        }
    }

    /// What each robot's tree returned last.
    #[must_use]
    pub fn last_statuses(&self) -> Vec<Status> {
        self.statuses.clone()
    }

    /// Takes a robot's voice away, or gives it back.
    pub fn silence(&mut self, robot: usize, silent: bool) {
        self.silent[robot] = silent;
    }

    /// Has a robot's localiser read this cell until told otherwise.
    pub fn misread(&mut self, robot: usize, reading: Option<Cell>) {
        self.misreadings[robot] = reading;
    }

    /// Has every robot receive an intention, whoever it is from, with a valid tag.
    ///
    /// # Panics
    /// When no frame carries such an intention.
    pub fn overhear(&mut self, said: &Said) {
        let context = Context::of::<Intention>(0, self.mission.id());
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(said, &SipHash64::new(DEMO_KEY), context, &mut buffer).expect("it fits a frame");
        for robot in &mut self.robots {
            robot.hardware_mut().inbox.extend(frame.iter());
        }
    }

    /// Starts a robot again where it stands, without anything it knew.
    pub fn restart(&mut self, robot: usize) {
        self.epochs[robot] += 1;
        let (here, pace, under_way) = {
            let body = self.robots[robot].hardware();
            (body.cell, body.pace, body.under_way)
        };
        self.robots[robot] = boot(self.mission, robot, here, self.epochs[robot]);
        let body = self.robots[robot].hardware_mut();
        (body.pace, body.under_way) = (pace, under_way);
    }

    /// Has the moves of each robot take so many ticks.
    #[must_use]
    pub fn at_paces(mut self, ticks: impl IntoIterator<Item = u32>) -> Self {
        for (robot, ticks) in self.robots.iter_mut().zip(ticks) {
            robot.hardware_mut().pace = ticks;
        }
        self
    }
}

fn boot<'m>(mission: &'m Mission<'m, 2>, robot: usize, here: Cell, epoch: u32) -> Bench<'m> {
    let settings = settings(robot as u8, mission.starts.len(), epoch);
    let robot = Navigator::new(mission, &settings).expect("a sound mission");
    Bench::new(robot, settings, Body::on(here))
}

/// The obstacles next to `here`, corners included, that the mission's map does not show.
fn in_view(mission: &Mission<'_, 2>, map: &Map<2>, here: Cell) -> Vec<Cell> {
    let width = map.width();
    let near = |cell: &Cell| {
        (cell.0 % width).abs_diff(here.0 % width) <= 1 && (cell.0 / width).abs_diff(here.0 / width) <= 1
    };
    let unknown = |cell: &Cell| mission.map.is_free(*cell) && !map.is_free(*cell);
    (0..map.len() as u16).map(Cell).filter(near).filter(unknown).collect()
}
