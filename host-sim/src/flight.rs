//! A flight: the loop that lets the world, the robots and the radio take turns.
//!
//! ```text
//! one tick   world: events happen ─► sensors and arrived frames into the bodies
//!            every controller ticks, alone in its body
//!            frames to the radio ─► commands to the world, all at once ─► referee ─► faults
//! ```
//! What a robot sends in a tick arrives in a later one and all moves are made at once, so the order
//! in which the robots tick does not matter.

use crate::faults::{FaultInjector, Faults};
use crate::flight_event::FlightEvent;
use crate::progress::Progress;
use crate::radio::{KEY, RadioChannel, Traffic};
use crate::random::{Random, Stream};
use crate::referee::Collisions;
use crate::robot::AnyRobot;
use crate::scenario::{Device, DriveFault, EventEffect, Floor, Scenario, parts};
use crate::team::{Boot, Navigating, TeamError, UNLIMITED, navigating};
use crate::world::World;
use iibt_core::grid::{Cell, Move};
use iibt_core::navigation::{self as sight, Mission, Report, Says, Tells};
use iibt_core::team::Keys;
use iibt_core::time::Instant;
use iibt_core::tree::Status;
use std::collections::VecDeque;

/// The reading of a localiser.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reading {
    /// The true cell, or another one with the probability that the scenario or the faults give.
    #[default]
    Drawn,
    /// Always this cell.
    Cell(Cell),
    /// No reading.
    Nothing,
}

/// A team in flight, ticked step by step, that can be disturbed and inspected between two ticks.
///
/// The robots are the firmware's controllers, each alone in a simulated body; world, radio and
/// referee are those of [`fly`](crate::fly). Robots are named by their index, from zero; methods
/// that take one panic when there is no such robot. The same mission, faults and seed give the same
/// flight.
///
/// ```
/// use host_sim::{EventEffect, Faults, NavigatorFlight, Radio};
/// use iibt_core::grid::{Cell, Map};
/// use iibt_core::navigation::Mission;
///
/// let map = Map::<1>::drawn("....\n....\n....")?;
/// let (starts, goals) = ([Cell(0), Cell(8)], [Cell(3), Cell(11)]);
/// let mission = Mission::new(map, &starts, &goals);
/// let radio = Radio { loss: 0.2, jitter: 2, ..Radio::default() };
/// let mut flight =
///     NavigatorFlight::<12, 1, 33, 64, 16>::over(&mission, Faults { radio, ..Faults::default() }, 7)?;
///
/// while flight.reports().iter().any(|report| report.policy.is_none()) {
///     flight.tick();
/// }
/// flight.cause(EventEffect::Block(Cell(1))); // an obstacle appears
/// flight.restart(1)?; // a robot has lost what it knew
/// while !flight.has_arrived() && flight.ticks() < 200 {
///     flight.tick();
/// }
/// assert!(flight.has_arrived() && flight.collisions().total() == 0);
/// assert!(flight.robot(0).robot().navigation().hazards().any(|cell| cell == Cell(1)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Flight<'m, R: AnyRobot + ?Sized> {
    boot: Boot<'m, R>,
    robots: Vec<Box<R>>,
    epochs: Vec<u32>,
    scenario: Scenario,
    world: World,
    radio: RadioChannel,
    trouble: FaultInjector,
    localisers: Random,
    drive_faults: Random,
    slips: Random,
    sights: Random,
    readings: Vec<Reading>,
    /// How far each robot's clock has been turned.
    turned: Vec<u32>,
    /// What each robot's localiser has read last.
    last_readings: Vec<Option<Cell>>,
    began: u32,
    tick: u32,
    statuses: Vec<Status>,
    reports: Vec<Report>,
    progress: Progress,
    found: Vec<Cell>,
    commands: Vec<Option<Move>>,
    collisions: Collisions,
}

/// A flight of navigating robots, with the sizes of their
/// [`Navigation`](iibt_core::navigation::Navigation).
pub type NavigatorFlight<'m, const S: usize, const W: usize, const L: usize, const M: usize, const K: usize> =
    Flight<'m, Navigating<'m, S, W, L, M, K>>;

impl<'m, const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    NavigatorFlight<'m, S, W, L, M, K>
{
    /// The team of a mission at its start. Robots see the cells around them.
    ///
    /// # Errors
    /// [`TeamError`] when the mission is not sound or does not fit the sizes.
    pub fn over(mission: &'m Mission<'m, W>, faults: Faults, seed: u64) -> Result<Self, TeamError> {
        Self::with_key(mission, KEY, faults, seed)
    }

    /// Starts the flight with a key of the team's own, or one for each sender.
    ///
    /// # Errors
    /// As [`over`](Self::over).
    pub fn with_key(
        mission: &'m Mission<'m, W>,
        keys: impl Into<Keys>,
        faults: Faults,
        seed: u64,
    ) -> Result<Self, TeamError> {
        let keys = keys.into();
        let boot =
            move |robot, epoch| navigating(mission, keys.clone(), robot, epoch, UNLIMITED).map(Box::new);
        Self::new(Scenario::of(mission, &faults)?, faults, seed, Box::new(boot))
    }
}

impl<'m, R: AnyRobot + ?Sized> Flight<'m, R> {
    pub(crate) fn new(
        scenario: Scenario,
        faults: Faults,
        seed: u64,
        boot: Boot<'m, R>,
    ) -> Result<Self, TeamError> {
        let size = scenario.robots.len();
        let robots: Vec<_> = (0..size as u8).map(|robot| boot(robot, 1)).collect::<Result<_, _>>()?;
        Ok(Self {
            epochs: vec![1; size],
            world: World::new(&scenario, seed),
            sights: Random::of(seed, Stream::Sight),
            radio: RadioChannel::new(scenario.radio, size, seed),
            trouble: FaultInjector::new(faults, size, seed),
            localisers: Random::of(seed, Stream::Localiser),
            drive_faults: Random::of(seed, Stream::DriveFault),
            slips: Random::of(seed, Stream::Slip),
            readings: vec![Reading::Drawn; size],
            turned: vec![0; size],
            last_readings: scenario.robots.iter().map(|robot| Some(robot.start)).collect(),
            began: 0,
            tick: 0,
            statuses: vec![Status::Running; size],
            reports: robots.iter().map(|robot| robot.report()).collect(),
            progress: Progress::default(),
            found: Vec::new(),
            commands: vec![None; size],
            collisions: Collisions::default(),
            boot,
            robots,
            scenario,
        })
    }

    /// Starts the robots' clocks at an instant, such as shortly before they wrap.
    #[must_use]
    pub const fn beginning_at(mut self, instant: Instant) -> Self {
        self.began = instant.0;
        self
    }

    /// Ticks the world and every robot once; returns the events, without those that robots report.
    pub fn tick(&mut self) -> Vec<FlightEvent> {
        let ahead: Vec<_> = (0..self.robots.len()).map(|robot| self.ahead(robot)).collect();
        let mut events = self.world.begin(self.tick, self.progress, |robot| ahead[robot]);
        self.instruct(&mut events);
        events.extend(self.sense());
        let awake = |index: &usize| !self.world.is_stopped(*index);
        for index in (0..self.robots.len()).filter(awake) {
            self.robots[index].prepare();
        }
        for (index, robot) in self.robots.iter_mut().enumerate() {
            if !self.world.is_stopped(index) {
                act_in_turn(&mut || self.statuses[index] = robot.tick());
            }
        }
        self.transmit();
        events.extend(self.drive());
        self.reports = self.robots.iter().map(|robot| robot.report()).collect();
        self.progress.note(&self.reports);
        let mut restarting = self.trouble.strike(&mut self.world, &self.scenario);
        restarting.extend(self.exhausted());
        for robot in restarting {
            self.restart(robot).unwrap_or_else(|_| unreachable!("it has been built before"));
        }
        self.tick += 1;
        events
    }

    /// The robots that stand and have used up the numbers of their frames: as on a robot that is
    /// flashed, each takes the next epoch by starting again.
    fn exhausted(&self) -> Vec<usize> {
        let is_due = |&robot: &usize| self.robots[robot].needs_new_epoch() && !self.world.is_moving(robot);
        (0..self.robots.len()).filter(is_due).collect()
    }

    /// The cell two moves ahead on a robot's path by the newest plan, or one move ahead where two
    /// are the end of it; none that a robot is in or is to come to.
    fn ahead(&self, robot: usize) -> Option<Cell> {
        let report = &self.reports[robot];
        let is_newest = self.reports.iter().all(|other| other.round <= report.round);
        let is_known = report.policy.is_some() || report.members.is_empty();
        let mut cells: Vec<Cell> = report.path.cells(self.world.floor()).skip(report.step).collect();
        cells.dedup();
        let inner = cells.get(1..cells.len().saturating_sub(1)).filter(|_| is_newest && is_known)?;
        let free = |cell: &Cell| !self.scenario.has_place_at(*cell) && !self.world.cells().contains(cell);
        inner.iter().take(2).rev().copied().find(|cell| free(cell) && self.leaves_ways(*cell))
    }

    /// Whether an obstacle in a cell cuts nothing off, with all that are to appear.
    fn leaves_ways(&self, cell: Cell) -> bool {
        let mut floor = *self.world.floor();
        for event in &self.scenario.events {
            if let EventEffect::Block(cell) = event.effect {
                floor.block(cell);
            }
        }
        parts(&floor.avoiding([cell])) <= parts(&floor)
    }

    /// Tells the robots which way-points to visit.
    fn instruct(&mut self, events: &mut [FlightEvent]) {
        for item in events {
            if let FlightEvent::Asked { robot, cell } = *item
                && !self.robots[robot].visit(cell)
            {
                *item = FlightEvent::Refused { robot, cell };
            }
        }
    }

    /// Fills the bodies with this tick's readings and frames.
    fn sense(&mut self) -> Vec<FlightEvent> {
        let mut events = Vec::new();
        for index in 0..self.robots.len() {
            if self.world.is_stopped(index) {
                continue;
            }
            let reading = self.locate(index);
            let view = self.scenario.robots[index].view;
            let in_view: Vec<_> = self.world.in_view(index, view).collect();
            for &cell in &in_view {
                if !self.found.contains(&cell) {
                    self.found.push(cell);
                    events.push(FlightEvent::Found { robot: index, cell });
                }
            }
            // To a scanner a stranger is an obstacle like any other.
            let scanned = in_view.into_iter().chain(self.world.strangers_in_view(index, view)).collect();
            let clear = self.world.clear_in_view(index, view).collect();
            let readings = self.read(index);
            let sightings: VecDeque<_> = self.world.sightings(index, view).collect();
            let body = self.robots[index].body();
            body.clock.now = self.began.wrapping_add(self.tick).wrapping_add(self.turned[index]);
            body.battery.charge = self.world.battery(index).percent();
            body.localiser.reading = reading;
            body.drive.moving = self.world.is_moving(index);
            body.scanner.look(scanned, clear);
            (body.scanner.readings, body.scanner.sightings) = (readings, sightings);
        }
        for (receiver, frame) in self.radio.arrivals(self.tick) {
            self.deliver(receiver, &frame);
        }
        events
    }

    /// What a robot reads of the unknowns from where it stands.
    fn read(&mut self, robot: usize) -> VecDeque<sight::Reading> {
        let here = self.world.cells()[robot];
        let unknowns = self.scenario.unknowns.iter().zip(self.world.values()).zip(0..);
        let mut readings = VecDeque::new();
        for ((unknown, &value), number) in unknowns {
            for sight in unknown.sights.iter().filter(|sight| sight.from == here) {
                let is_right = self.sights.bernoulli(sight.right.into());
                let other = self.sights.below(unknown.prior.len() - 1) as u8;
                let says = match sight.tells {
                    Tells::Value if is_right => Says::Value(value),
                    Tells::Value => Says::Value(other + u8::from(other >= value)),
                    Tells::Whether(asked) if is_right == (asked == value) => Says::Is(asked),
                    Tells::Whether(asked) => Says::IsNot(asked),
                };
                readings.push_back(sight::Reading { unknown: number, says });
            }
        }
        readings
    }

    fn locate(&mut self, robot: usize) -> Option<Cell> {
        let (here, cells) = (self.world.cells()[robot], self.world.floor().len());
        let is_right = self.localisers.bernoulli(self.scenario.robots[robot].localiser);
        let other = self.localisers.below(cells - 1) as u16;
        let reading = match self.readings[robot] {
            Reading::Drawn if is_right => Some(here),
            Reading::Drawn => Some(Cell(other + u16::from(other >= here.0))),
            Reading::Cell(cell) => Some(cell),
            Reading::Nothing => None,
        };
        if !self.world.is_frozen(robot, Device::Localiser) {
            self.last_readings[robot] = reading;
        }
        self.last_readings[robot]
    }

    /// Hands what the robots send to the radio; a robot that has stopped has sent nothing.
    fn transmit(&mut self) {
        for (sender, robot) in self.robots.iter_mut().enumerate() {
            let link = &mut robot.body().link;
            link.last = std::mem::take(&mut link.sent);
            for frame in &link.last {
                self.radio.send(self.tick, sender, frame);
            }
        }
    }

    /// Makes the commanded moves, unless a drive fails.
    fn drive(&mut self) -> Option<FlightEvent> {
        self.commands = self.robots.iter_mut().map(|robot| robot.body().drive.command.take()).collect();
        let commands: Vec<_> = (0..self.robots.len()).map(|robot| self.made(robot)).collect();
        let (before, faults) = (self.all_cells(), self.collisions.total());
        self.world.carry_out(&commands);
        let (cells, mut entering) = (self.all_cells(), self.world.entering().collect::<Vec<_>>());
        entering.resize(cells.len(), None);
        self.collisions.judge(self.world.floor(), (&before, &commands), (&cells, &entering));
        let times = self.collisions.total() - faults;
        (times > 0).then_some(FlightEvent::Collided { times })
    }

    /// Where the robots stand, and after them the strangers.
    fn all_cells(&self) -> Vec<Cell> {
        self.world.cells().iter().copied().chain(self.world.strangers()).collect()
    }

    /// The move that a robot actually makes.
    fn made(&mut self, robot: usize) -> Move {
        let step = self.commands[robot].unwrap_or(Move::Wait);
        let applies =
            |fault: &&DriveFault| fault.robot == robot && fault.step == step && fault.from <= self.tick;
        // Drawn one by one: a drive with two faults fails for either reason.
        let fails = self
            .scenario
            .drive_faults
            .iter()
            .filter(applies)
            .filter(|fault| self.drive_faults.bernoulli(fault.fails))
            .count()
            > 0;
        let slips = step != Move::Wait && self.slips.bernoulli(self.scenario.robots[robot].slip);
        let stands = self.world.battery(robot).is_empty() || self.world.is_frozen(robot, Device::Drive);
        if fails || slips || stands { Move::Wait } else { step }
    }
}

/// Disturbances between two ticks.
impl<R: AnyRobot + ?Sized> Flight<'_, R> {
    /// Makes an event happen with the next tick.
    pub fn cause(&mut self, effect: EventEffect) {
        self.world.cause(effect);
    }

    /// Restarts a robot in its cell, without its memory.
    ///
    /// # Errors
    /// [`TeamError`], as the robot was built with before.
    pub fn restart(&mut self, robot: usize) -> Result<(), TeamError> {
        self.restart_in(robot, self.epochs[robot] + 1)
    }

    /// Restarts a robot as [`restart`](Self::restart) does, in an epoch that the caller counts.
    ///
    /// # Errors
    /// As [`restart`](Self::restart).
    pub fn restart_in(&mut self, robot: usize, epoch: u32) -> Result<(), TeamError> {
        self.robots[robot] = (self.boot)(robot as u8, epoch)?;
        self.epochs[robot] = epoch;
        Ok(())
    }

    /// Restarts a robot whose power fails: a move that is under way breaks off, and its drive, once
    /// it has power again, centres it on the cell where that began or on the one where it was to
    /// end.
    ///
    /// # Errors
    /// As [`restart`](Self::restart).
    pub fn brown_out(&mut self, robot: usize, goes_back: bool) -> Result<(), TeamError> {
        self.world.break_off(robot, goes_back);
        self.restart(robot)
    }

    /// Turns a robot's clock forward by so many ticks, or back by 2^32 less as many.
    pub fn turn_clock(&mut self, robot: usize, ticks: u32) {
        self.turned[robot] = self.turned[robot].wrapping_add(ticks);
    }

    /// Turns a robot's transmitter off or on.
    pub fn silence(&mut self, robot: usize, silent: bool) {
        self.radio.silence(robot, silent);
    }

    /// Hands bytes to a robot's receiver as if they had arrived; one that has stopped does not hear
    /// them.
    pub fn deliver(&mut self, robot: usize, bytes: &[u8]) {
        if !self.world.is_stopped(robot) {
            self.robots[robot].body().link.received.extend(bytes);
        }
    }

    /// Sets what a robot's localiser reads.
    pub fn set_reading(&mut self, robot: usize, reading: Reading) {
        self.readings[robot] = reading;
    }

    /// Sets the probability that a move of a robot fails.
    pub fn set_slip(&mut self, robot: usize, probability: f64) {
        self.scenario.robots[robot].slip = probability;
    }

    /// Sets the ticks that a move of a robot takes, one at the least.
    pub fn set_pace(&mut self, robot: usize, ticks: u32) {
        self.world.set_pace(robot, ticks);
    }

    /// Sets the charge of a robot's battery in percent, 100 at the most.
    pub fn set_charge(&mut self, robot: usize, percent: u8) {
        self.world.set_charge(robot, percent);
    }

    /// Puts a robot into another cell.
    pub fn place(&mut self, robot: usize, cell: Cell) {
        self.world.place(robot, cell);
    }

    /// A robot, to change it.
    pub fn robot_mut(&mut self, robot: usize) -> &mut R {
        &mut self.robots[robot]
    }
}

/// Inspection between two ticks.
impl<R: AnyRobot + ?Sized> Flight<'_, R> {
    /// The ticks flown.
    #[must_use]
    pub const fn ticks(&self) -> u32 {
        self.tick
    }

    /// The robots in their order.
    pub fn robots(&self) -> impl Iterator<Item = &R> {
        self.robots.iter().map(Box::as_ref)
    }

    /// A robot.
    #[must_use]
    pub fn robot(&self, robot: usize) -> &R {
        &self.robots[robot]
    }

    /// The last status of each robot's tree.
    #[must_use]
    pub fn statuses(&self) -> &[Status] {
        &self.statuses
    }

    /// Whether every tree has returned success in the last tick.
    #[must_use]
    pub fn has_arrived(&self) -> bool {
        self.statuses.iter().all(|&status| status == Status::Success)
    }

    /// The robots' reports after the last tick.
    #[must_use]
    pub fn reports(&self) -> &[Report] {
        &self.reports
    }

    /// The true cells of the robots.
    #[must_use]
    pub fn cells(&self) -> &[Cell] {
        self.world.cells()
    }

    /// The cells of the strangers, in the order of their unknowns.
    pub fn strangers(&self) -> impl Iterator<Item = Cell> + '_ {
        self.world.strangers()
    }

    /// The number of the present start of a robot.
    #[must_use]
    pub fn epoch(&self, robot: usize) -> u32 {
        self.epochs[robot]
    }

    /// The cell that each robot is moving to; during the move it occupies both.
    pub fn entering(&self) -> impl Iterator<Item = Option<Cell>> + '_ {
        self.world.entering()
    }

    /// The moves that the robots commanded in the last tick.
    #[must_use]
    pub fn commands(&self) -> &[Option<Move>] {
        &self.commands
    }

    /// The true map, with the obstacles that have appeared.
    #[must_use]
    pub fn floor(&self) -> &Floor {
        self.world.floor()
    }

    /// The charge of a robot's battery in percent.
    #[must_use]
    pub fn charge(&self, robot: usize) -> u8 {
        self.world.battery(robot).percent()
    }

    /// The frames that a robot has sent in the last tick.
    pub fn sent(&mut self, robot: usize) -> &[Vec<u8>] {
        &self.robots[robot].body().link.last
    }

    /// The collisions that the referee has counted.
    #[must_use]
    pub const fn collisions(&self) -> Collisions {
        self.collisions
    }

    /// The traffic of each robot's frames.
    #[must_use]
    pub fn traffic(&self) -> &[Traffic] {
        self.radio.traffic()
    }

    pub(crate) const fn progress(&self) -> Progress {
        self.progress
    }

    pub(crate) const fn world(&self) -> &World {
        &self.world
    }
}

/// One tick of one robot: what [`campaign::cost`](crate::campaign::cost) counts, from the call of
/// this function to that of [`has_acted`].
#[inline(never)]
fn act_in_turn(tick: &mut dyn FnMut()) {
    tick();
    has_acted();
}

/// Marks the end of a robot's tick.
#[inline(never)]
fn has_acted() {
    std::hint::black_box(());
}
