//! A flight: the loop that lets the world, the robots and the radio take turns, and keeps the record.
//!
//! ```text
//! one tick   world: events happen ─► sensors and arrived frames into the bodies
//!            every controller ticks, alone in its body
//!            frames to the radio ─► commands to the world, all at once ─► referee ─► news
//! ```
//! What a robot sends in a tick arrives in a later one and all moves are made at once, so the order in which
//! the robots tick does not matter.

use crate::chance::{Chance, Purpose};
use crate::changes;
use crate::news::News;
use crate::phases::{self, Phase};
use crate::progress::Progress;
use crate::radio::Radio;
use crate::record::{self, Activity, Dated, Outcome, Record, RobotRecord};
use crate::referee::Collisions;
use crate::robot::AnyRobot;
use crate::scenario::{self, Floor, Scenario, Wear};
use crate::team::{Pilot, Team, TeamError, with_team};
use crate::world::World;
use iibt_core::grid::{Cell, Move};
use iibt_core::navigation::{MAX_GOALS, Report, Stage};

/// What a flight depends on besides its scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Conditions {
    /// The seed of all chance.
    pub seed: u64,
    /// The radio's loss, 0 to 1, in place of the scenario's.
    pub loss: Option<f64>,
    /// What flies the robots.
    pub tree: Pilot,
}

/// A flight as it stands after a tick, for those who look on.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'f> {
    /// What is flown.
    pub scenario: &'f Scenario,
    /// The ticks flown.
    pub tick: u32,
    /// Free and blocked cells, in truth.
    pub floor: &'f Floor,
    /// Where the robots stand, in truth.
    pub cells: &'f [Cell],
    /// What the robots say of themselves.
    pub reports: &'f [Report],
    /// The charge of their batteries in percent.
    pub charges: &'f [u8],
    /// Whether they have stopped.
    pub stopped: &'f [bool],
    /// Whether they are between two cells, of which `cells` has the first.
    pub moving: &'f [bool],
    /// The moves that the robots were told to make in the last tick, none before the first.
    pub commands: &'f [Option<Move>],
    /// The leaf of each robot's tree that is running.
    pub activities: &'f [Option<&'static str>],
    /// What has happened in the last tick.
    pub news: &'f [Dated],
}

/// Somebody who looks on.
pub trait Audience {
    /// Sees the flight before the first tick and after every one.
    fn see(&mut self, scene: &Scene<'_>);
}

/// Nobody.
impl Audience for () {
    fn see(&mut self, _: &Scene<'_>) {}
}

/// Two who look on; the second may be missing.
impl<A: Audience> Audience for (Box<dyn Audience + '_>, Option<A>) {
    fn see(&mut self, scene: &Scene<'_>) {
        self.0.see(scene);
        if let Some(other) = &mut self.1 {
            other.see(scene);
        }
    }
}

/// Flies a scenario to its end.
///
/// # Errors
/// [`TeamError`] when the controllers do not accept the mission or the team.
pub fn fly(
    scenario: &Scenario,
    conditions: Conditions,
    audience: &mut dyn Audience,
) -> Result<Record, TeamError> {
    fly_preferring(scenario, conditions, &[], audience)
}

/// The same with robots to whom the goals are worth so much; those without an entry know no difference.
pub(crate) fn fly_preferring(
    scenario: &Scenario,
    conditions: Conditions,
    preferences: &[[f32; MAX_GOALS]],
    audience: &mut dyn Audience,
) -> Result<Record, TeamError> {
    with_team(scenario, conditions.tree, |team| {
        for (robot, values) in team.iter_mut().zip(preferences) {
            robot.prefer(values);
        }
        let mut flight = Flight::new(scenario, conditions, team);
        flight.show(audience, 0);
        while !flight.is_over() {
            let told = flight.news.len();
            flight.tick();
            flight.show(audience, told);
        }
        flight.record()
    })
}

struct Flight<'f, 'm> {
    scenario: &'f Scenario,
    seed: u64,
    pilot: Pilot,
    terms: scenario::Radio,
    team: &'f mut Team<'m>,
    world: World,
    radio: Radio,
    localisers: Chance,
    wear: Chance,
    slips: Chance,
    collisions: Collisions,
    tick: u32,
    reports: Vec<Report>,
    activities: Vec<Option<&'static str>>,
    tree: Vec<Vec<Activity>>,
    progress: Progress,
    found: Vec<Cell>,
    waypoints: Vec<Vec<Cell>>,
    visited: Vec<Vec<Cell>>,
    phases: Vec<Phase>,
    certainty: Vec<Vec<f32>>,
    commands: Vec<Option<Move>>,
    news: Vec<Dated>,
    history: Vec<Vec<Cell>>,
}

impl<'f, 'm> Flight<'f, 'm> {
    fn new(scenario: &'f Scenario, conditions: Conditions, team: &'f mut Team<'m>) -> Self {
        let terms =
            scenario::Radio { loss: conditions.loss.unwrap_or(scenario.radio.loss), ..scenario.radio };
        let world = World::new(scenario);
        Self {
            seed: conditions.seed,
            pilot: conditions.tree,
            terms,
            radio: Radio::new(terms, team.len(), conditions.seed),
            localisers: Chance::new(conditions.seed, Purpose::Localiser),
            wear: Chance::new(conditions.seed, Purpose::Wear),
            slips: Chance::new(conditions.seed, Purpose::Slip),
            collisions: Collisions::default(),
            tick: 0,
            reports: team.iter().map(|robot| robot.report()).collect(),
            activities: vec![None; team.len()],
            tree: vec![Vec::new(); team.len()],
            progress: Progress::default(),
            found: Vec::new(),
            waypoints: vec![Vec::new(); team.len()],
            visited: vec![Vec::new(); team.len()],
            phases: Vec::new(),
            certainty: Vec::new(),
            commands: vec![None; team.len()],
            news: Vec::new(),
            history: vec![world.cells().to_vec()],
            scenario,
            team,
            world,
        }
    }

    /// Shows how things stand, and the news but for those told already.
    fn show(&self, audience: &mut dyn Audience, told: usize) {
        let robots = 0..self.team.len();
        let charges: Vec<_> = robots.clone().map(|robot| self.world.battery(robot).percent()).collect();
        let stopped: Vec<_> = robots.clone().map(|robot| self.world.is_stopped(robot)).collect();
        let moving: Vec<_> = robots.map(|robot| self.world.is_moving(robot)).collect();
        audience.see(&Scene {
            scenario: self.scenario,
            tick: self.tick,
            floor: self.world.floor(),
            cells: self.world.cells(),
            reports: &self.reports,
            charges: &charges,
            stopped: &stopped,
            moving: &moving,
            commands: &self.commands,
            activities: &self.activities,
            news: &self.news[told..],
        });
    }

    fn is_over(&self) -> bool {
        let arrived = self.reports.iter().all(|report| report.stage == Stage::Arrived);
        let accomplished = arrived && record::at_different_goals(&self.scenario.goals, self.world.cells());
        accomplished || self.tick >= self.scenario.limit
    }

    fn tick(&mut self) {
        let mut news = self.world.begin(self.tick, self.progress);
        self.instruct(&mut news);
        news.extend(self.sense());
        for (index, robot) in self.team.iter_mut().enumerate() {
            if !self.world.is_stopped(index) {
                act_in_turn(robot.as_mut());
            }
        }
        self.certainty.push(self.certainties());
        self.transmit();
        news.extend(self.drive());
        news.extend(self.compare());
        self.news.extend(news.into_iter().map(|news| Dated { tick: self.tick, news }));
        self.tick += 1;
    }

    /// Tells the robots which way-points to visit.
    fn instruct(&mut self, news: &mut [News]) {
        for item in news {
            if let News::Asked { robot, cell } = *item {
                if self.team[robot].visit(cell) {
                    self.waypoints[robot].push(cell);
                } else {
                    *item = News::Refused { robot, cell };
                }
            }
        }
    }

    /// How likely each robot takes itself to be where it is.
    fn certainties(&self) -> Vec<f32> {
        self.team.iter().zip(self.world.cells()).map(|(robot, &cell)| robot.belief(cell)).collect()
    }

    /// Fills the bodies with what the sensors and the radio bring in this tick.
    fn sense(&mut self) -> Vec<News> {
        let mut news = Vec::new();
        for index in 0..self.team.len() {
            if self.world.is_stopped(index) {
                continue;
            }
            let reading = self.locate(index);
            let in_view: Vec<_> = self.world.in_view(index, self.scenario.robots[index].view).collect();
            for &cell in &in_view {
                if !self.found.contains(&cell) {
                    self.found.push(cell);
                    news.push(News::Found { robot: index, cell });
                }
            }
            let body = self.team[index].body();
            body.clock.now = self.tick;
            body.battery.charge = self.world.battery(index).percent();
            body.localiser.reading = Some(reading);
            body.drive.moving = self.world.is_moving(index);
            body.scanner.look(in_view);
        }
        for (receiver, frame) in self.radio.arrivals(self.tick) {
            if !self.world.is_stopped(receiver) {
                self.team[receiver].body().link.received.extend(frame);
            }
        }
        news
    }

    fn locate(&mut self, robot: usize) -> Cell {
        let (here, cells) = (self.world.cells()[robot], self.world.floor().len() as u16);
        let is_right = self.localisers.strikes(self.scenario.robots[robot].localiser);
        let other = self.localisers.below(cells - 1);
        if is_right { here } else { Cell(other + u16::from(other >= here.0)) }
    }

    fn transmit(&mut self) {
        for (sender, robot) in self.team.iter_mut().enumerate() {
            for frame in robot.body().link.sent.drain(..) {
                self.radio.send(self.tick, sender, &frame);
            }
        }
    }

    /// Makes the moves that the robots have commanded, as far as their drives let them.
    fn drive(&mut self) -> Option<News> {
        let command = |robot: &mut Box<dyn AnyRobot + 'm>| robot.body().drive.command.take();
        self.commands = self.team.iter_mut().map(command).collect();
        let commands: Vec<_> = (0..self.team.len()).map(|robot| self.made(robot)).collect();
        let (before, faults) = (self.world.cells().to_vec(), self.collisions.total());
        self.world.carry_out(&commands);
        let (cells, entering) = (self.world.cells(), self.world.entering().collect::<Vec<_>>());
        self.collisions.judge(self.world.floor(), (&before, &commands), (cells, &entering));
        self.history.push(self.world.cells().to_vec());
        let times = self.collisions.total() - faults;
        (times > 0).then_some(News::Collided { times })
    }

    /// The move that a robot really makes.
    fn made(&mut self, robot: usize) -> Move {
        let step = self.commands[robot].unwrap_or(Move::Wait);
        let worn = |wear: &&Wear| wear.robot == robot && wear.step == step && wear.from <= self.tick;
        // Drawn one by one: a drive that is worn twice fails for either reason.
        let fails =
            self.scenario.wear.iter().filter(worn).filter(|wear| self.wear.strikes(wear.fails)).count() > 0;
        let slips = step != Move::Wait && self.slips.strikes(self.scenario.robots[robot].slip);
        if fails || slips || self.world.battery(robot).is_empty() { Move::Wait } else { step }
    }

    fn compare(&mut self) -> Vec<News> {
        let reports: Vec<_> = self.team.iter().map(|robot| robot.report()).collect();
        let before = std::mem::replace(&mut self.reports, reports);
        for (robot, (now, tree)) in self.team.iter().zip(self.activities.iter_mut().zip(&mut self.tree)) {
            let running = robot.activity();
            if std::mem::replace(now, running) != running {
                tree.push(Activity { tick: self.tick, running });
            }
        }
        self.progress.note(&self.reports);
        let obstacles = || self.world.obstacles().collect();
        phases::note(&mut self.phases, self.tick, &self.reports, self.world.floor(), obstacles);
        let mut news = self.ticked_off();
        news.extend(changes::between(&before, &self.reports, &self.world));
        news
    }

    /// The way-points that robots have visited in this tick.
    fn ticked_off(&mut self) -> Vec<News> {
        let mut news = Vec::new();
        for (robot, known) in self.waypoints.iter_mut().enumerate() {
            let mut left = self.team[robot].waypoints().to_vec();
            // From the end: of a cell that is to be visited twice, the first visit comes off first.
            for cell in std::mem::take(known).into_iter().rev() {
                match left.iter().rposition(|&other| other == cell) {
                    Some(index) => known.push(left.remove(index)),
                    None => {
                        self.visited[robot].push(cell);
                        news.push(News::Visited { robot, cell });
                    }
                }
            }
            known.reverse();
        }
        news
    }

    fn record(self) -> Record {
        let robots: Vec<_> = (0..self.team.len()).map(|index| self.robot(index)).collect();
        let outcome = self.outcome(&robots);
        Record {
            scenario: self.scenario.name.clone(),
            title: self.scenario.title.clone(),
            seed: self.seed,
            pilot: self.pilot,
            loss: self.terms.loss,
            ticks: self.tick.saturating_sub(1),
            outcome,
            collisions: self.collisions,
            frames: self.radio.traffic().iter().sum(),
            width: self.world.floor().width(),
            height: self.world.floor().height(),
            goals: self.scenario.goals.clone(),
            robots,
            news: self.news,
            phases: self.phases,
            history: self.history,
            certainty: self.certainty,
        }
    }

    fn outcome(&self, robots: &[RobotRecord]) -> Outcome {
        let is_joint = match self.pilot {
            Pilot::Inference => record::is_joint(robots.iter().map(|robot| robot.path.as_slice())),
            Pilot::Conventional | Pilot::Figure5 => {
                record::is_close(robots.iter().map(|robot| robot.arrived))
            }
        };
        record::outcome(&self.collisions, &self.scenario.goals, self.world.cells(), is_joint)
    }

    fn robot(&self, index: usize) -> RobotRecord {
        let (setup, report) = (&self.scenario.robots[index], &self.reports[index]);
        let received = self.team[index].link_report().received;
        let cells: Vec<_> = self.history.iter().map(|cells| cells[index]).collect();
        let cell = self.world.cells()[index];
        RobotRecord {
            name: setup.name.clone(),
            start: setup.start,
            cell,
            goal: report.goal,
            path: report.path.cells(&self.scenario.map).collect(),
            probability: report.probability,
            status: record::status(report),
            moves: cells.windows(2).filter(|pair| pair[0] != pair[1]).count() as u32,
            arrived: cells.iter().rposition(|&before| before != cell).map_or(0, |last| last as u32 + 1),
            frames: self.radio.traffic()[index],
            battery: self.world.battery(index).percent(),
            visited: self.visited[index].clone(),
            charged: record::times_charged(&self.news, index),
            stopped: self.world.is_stopped(index),
            tree: self.tree[index].clone(),
            accepted: received.accepted,
            rejected: received.refused(),
        }
    }
}

/// One tick of one robot: what [`campaign::cost`](crate::campaign::cost) counts, from the call of this function to that of
/// [`has_acted`].
#[inline(never)]
fn act_in_turn(robot: &mut (dyn AnyRobot + '_)) {
    robot.tick();
    has_acted();
}

/// Marks the end of a robot's tick.
#[inline(never)]
fn has_acted() {
    std::hint::black_box(());
}
