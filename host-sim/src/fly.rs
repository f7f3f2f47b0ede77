//! A scenario flown to its end, with its observers and its record.

use crate::awaited::{Awaited, Waits};
use crate::beliefs::Beliefs;
use crate::changes;
use crate::faults::Faults;
use crate::flight::Flight;
use crate::flight_event::FlightEvent;
use crate::phases::{self, Phase};
use crate::progress::is_member;
use crate::record::{self, Activity, Record, RobotRecord, TimedEvent};
use crate::robot::AnyRobot;
use crate::scenario::{Floor, Scenario};
use crate::team::{Boot, Pilot, TeamError, with_team};
use crate::text::counted;
use crate::verdict::{self, Evidence};
use iibt_core::grid::{Cell, Move};
use iibt_core::navigation::{MAX_GOALS, Report, Stage};
use iibt_core::team::RobotId;
use iibt_core::tree::TickEntry;

/// The conditions of a flight besides its scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Conditions {
    /// The seed of all chance.
    pub seed: u64,
    /// The radio's loss, 0 to 1, in place of the scenario's.
    pub loss: Option<f64>,
    /// The pilot of the robots.
    pub tree: Pilot,
}

/// A snapshot of a flight after a tick, for observers.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<'f> {
    /// The scenario.
    pub scenario: &'f Scenario,
    /// The ticks flown.
    pub tick: u32,
    /// The true map.
    pub floor: &'f Floor,
    /// The robots' true cells.
    pub cells: &'f [Cell],
    /// The cells of the strangers.
    pub strangers: &'f [Cell],
    /// The robots' reports.
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
    /// The nodes of each robot's tree that its last tick has changed, unless they are those of the
    /// tick before.
    pub tree_entries: &'f [Option<TickEntry<'f>>],
    /// The frames that the robots sent in the last tick, one after the other.
    pub frames: &'f [u8],
    /// What has happened in the last tick.
    pub events: &'f [TimedEvent],
}

/// A receiver of snapshots of a flight.
pub trait Observer {
    /// Receives a snapshot before the first tick and after every tick.
    fn observe(&mut self, snapshot: &Snapshot<'_>);
}

/// No observer.
impl Observer for () {
    fn observe(&mut self, _: &Snapshot<'_>) {}
}

/// Flies a scenario to its end.
///
/// # Errors
/// [`TeamError`] when the controllers do not accept the mission or the team.
pub fn fly(
    scenario: &Scenario,
    conditions: Conditions,
    observer: &mut dyn Observer,
) -> Result<Record, TeamError> {
    fly_preferring(scenario, conditions, &[], observer)
}

/// Flies a scenario with a preference for each goal, per robot; a robot without an entry has the
/// default.
pub(crate) fn fly_preferring(
    scenario: &Scenario,
    conditions: Conditions,
    preferences: &[[f32; MAX_GOALS]],
    observer: &mut dyn Observer,
) -> Result<Record, TeamError> {
    with_team(scenario, conditions.tree, |boot| {
        let mut recorder = Recorder::new(scenario, conditions, boot)?;
        for (robot, values) in preferences.iter().enumerate().take(scenario.robots.len()) {
            recorder.flight.robot_mut(robot).set_goal_preferences(values);
        }
        recorder.fly(&Interventions::NONE, observer)
    })
}

/// What is done to a flight from outside.
pub(crate) struct Interventions<'i> {
    /// The robots to restart, and the ticks before which they are.
    pub(crate) restarts: &'i [(usize, u32)],
    /// Frames of another flight: each robot hears as many in a tick as there are robots.
    pub(crate) replay: &'i [u8],
    /// Whether to end the flight.
    pub(crate) has_halted: &'i dyn Fn() -> bool,
}

impl Interventions<'_> {
    pub(crate) const NONE: Self = Self { restarts: &[], replay: &[], has_halted: &|| false };
}

/// Flies a scenario with robots that are given.
pub(crate) fn fly_team<'m>(
    scenario: &Scenario,
    conditions: Conditions,
    interventions: &Interventions<'_>,
    boot: Boot<'m, dyn AnyRobot + 'm>,
    observer: &mut dyn Observer,
) -> Result<Record, TeamError> {
    Recorder::new(scenario, conditions, boot)?.fly(interventions, observer)
}

/// A flight and its record so far.
struct Recorder<'f, 'm> {
    scenario: &'f Scenario,
    conditions: Conditions,
    flight: Flight<'m, dyn AnyRobot + 'm>,
    activities: Vec<Option<&'static str>>,
    tree: Vec<Vec<Activity>>,
    waypoints: Vec<Vec<Cell>>,
    visited: Vec<Vec<Cell>>,
    waits: Waits,
    beliefs: Beliefs,
    phases: Vec<Phase>,
    certainty: Vec<Vec<f32>>,
    frames: Vec<u8>,
    events: Vec<TimedEvent>,
    history: Vec<Vec<Cell>>,
    strangers: Vec<Vec<Cell>>,
}

impl<'f, 'm> Recorder<'f, 'm> {
    fn new(
        scenario: &'f Scenario,
        conditions: Conditions,
        boot: Boot<'m, dyn AnyRobot + 'm>,
    ) -> Result<Self, TeamError> {
        let mut flown = scenario.clone();
        flown.radio.loss = conditions.loss.unwrap_or(scenario.radio.loss);
        let flight = Flight::new(flown, Faults::default(), conditions.seed, boot)?;
        let size = scenario.robots.len();
        Ok(Self {
            scenario,
            conditions,
            activities: vec![None; size],
            tree: vec![Vec::new(); size],
            waypoints: vec![Vec::new(); size],
            visited: vec![Vec::new(); size],
            waits: Waits::new(size),
            beliefs: Beliefs::new(&scenario.unknowns, size),
            phases: Vec::new(),
            certainty: Vec::new(),
            frames: Vec::new(),
            events: Vec::new(),
            history: vec![flight.cells().to_vec()],
            strangers: vec![flight.strangers().collect()],
            flight,
        })
    }

    /// Flies to the end.
    fn fly(
        mut self,
        interventions: &Interventions<'_>,
        observer: &mut dyn Observer,
    ) -> Result<Record, TeamError> {
        let mut old = interventions.replay.split(|&byte| byte == 0).filter(|frame| !frame.is_empty());
        self.show(observer, 0);
        while !self.is_over() && !(interventions.has_halted)() {
            let (told, tick) = (self.events.len(), self.flight.ticks());
            for &(robot, _) in interventions.restarts.iter().filter(|&&(_, when)| when == tick) {
                self.restart(robot)?;
            }
            let robots = self.scenario.robots.len();
            for frame in old.by_ref().take(robots) {
                let frame = [&[0], frame, &[0]].concat();
                (0..robots).for_each(|robot| self.flight.deliver(robot, &frame));
            }
            self.tick();
            self.show(observer, told);
        }
        Ok(self.record())
    }

    /// Restarts a robot, which forgets what it was told to visit.
    fn restart(&mut self, robot: usize) -> Result<(), TeamError> {
        self.flight.restart(robot)?;
        self.waypoints[robot].clear();
        let tick = self.flight.ticks();
        self.events.push(TimedEvent { tick, event: FlightEvent::Restarted { robot } });
        Ok(())
    }

    /// Shows the observer the state of the flight and the new events.
    fn show(&self, observer: &mut dyn Observer, told: usize) {
        let (robots, world) = (0..self.scenario.robots.len(), self.flight.world());
        let charges: Vec<_> = robots.clone().map(|robot| world.battery(robot).percent()).collect();
        let stopped: Vec<_> = robots.clone().map(|robot| world.is_stopped(robot)).collect();
        let moving: Vec<_> = robots.map(|robot| world.is_moving(robot)).collect();
        let strangers: Vec<_> = world.strangers().collect();
        let tree_entries: Vec<_> = self.flight.robots().map(AnyRobot::tree_entry).collect();
        observer.observe(&Snapshot {
            scenario: self.scenario,
            tick: self.flight.ticks(),
            floor: world.floor(),
            cells: world.cells(),
            strangers: &strangers,
            reports: self.flight.reports(),
            charges: &charges,
            stopped: &stopped,
            moving: &moving,
            commands: self.flight.commands(),
            activities: &self.activities,
            tree_entries: &tree_entries,
            frames: &self.frames,
            events: &self.events[told..],
        });
    }

    /// Whether every robot says that it has arrived, or is lost to the team for good, the mission
    /// is accomplished, and no event is to come.
    fn is_over(&self) -> bool {
        let members = self.members();
        let (reports, world) = (self.flight.reports(), self.flight.world());
        let has_arrived = |(robot, report): (usize, &Report)| {
            report.stage == Stage::Arrived || (!members[robot] && world.is_stopped(robot))
        };
        let is_done =
            !world.has_event_to_come(self.flight.progress()) && reports.iter().enumerate().all(has_arrived);
        self.flight.ticks() >= self.scenario.limit
            || (is_done && self.evidence(&members, &self.moving()).is_accomplished())
    }

    /// Which robots take part.
    fn members(&self) -> Vec<bool> {
        let reports = self.flight.reports();
        (0..reports.len()).map(is_member(reports)).collect()
    }

    fn moving(&self) -> Vec<bool> {
        (0..self.scenario.robots.len()).map(|robot| self.flight.world().is_moving(robot)).collect()
    }

    fn evidence<'e>(&'e self, members: &'e [bool], moving: &'e [bool]) -> Evidence<'e> {
        let has_errand = |robot: usize| {
            let is_left_behind = self.flight.reports()[robot].left_behind.is_some();
            members[robot] && (is_left_behind || !self.flight.robot(robot).waypoints().is_empty())
        };
        Evidence {
            scenario: self.scenario,
            collisions: self.flight.collisions(),
            floor: self.flight.floor(),
            history: &self.history,
            moving,
            members,
            useless: self.flight.world().useless(),
            has_errand: (0..members.len()).any(has_errand),
        }
    }

    fn tick(&mut self) {
        let (tick, stood) = (self.flight.ticks(), self.flight.cells().to_vec());
        let before = self.flight.reports().to_vec();
        let mut events = self.flight.tick();
        self.frames = (0..stood.len()).flat_map(|robot| self.flight.sent(robot).concat()).collect();
        for item in &events {
            if let FlightEvent::Asked { robot, cell } = *item {
                self.waypoints[robot].push(cell);
            }
        }
        self.certainty
            .push(self.flight.robots().zip(stood).map(|(robot, cell)| robot.belief(cell)).collect());
        self.history.push(self.flight.cells().to_vec());
        self.strangers.push(self.flight.strangers().collect());
        events.extend(self.compare(tick, &before));
        self.events.extend(events.into_iter().map(|event| TimedEvent { tick, event }));
    }

    fn compare(&mut self, tick: u32, before: &[Report]) -> Vec<FlightEvent> {
        let activities = self.activities.iter_mut().zip(&mut self.tree);
        for (robot, (now, tree)) in self.flight.robots().zip(activities) {
            let running = robot.activity();
            if std::mem::replace(now, running) != running {
                tree.push(Activity { tick, running });
            }
        }
        let (reports, world) = (self.flight.reports(), self.flight.world());
        let obstacles = || world.obstacles().collect();
        let weighed = |robot| self.flight.robot(robot).weighed();
        phases::note(&mut self.phases, tick, reports, world.floor(), obstacles, weighed);
        let mut events = changes::between(before, reports, world);
        events.splice(0..0, self.weighed_in(tick));
        events.extend(self.beliefs());
        events.splice(0..0, self.ticked_off());
        events.extend(self.long_waits());
        events
    }

    /// The rounds whose policies were weighed in this tick, where something is unknown.
    fn weighed_in(&self, tick: u32) -> Vec<FlightEvent> {
        if self.scenario.unknowns.is_empty() {
            return Vec::new();
        }
        let is_new = |phase: &&Phase| phase.choices.iter().flatten().all(|choice| choice.tick == tick);
        self.phases.iter().filter(is_new).filter_map(Phase::weighed).collect()
    }

    /// The robots that have come to believe something else.
    fn beliefs(&mut self) -> Vec<FlightEvent> {
        let unknowns = &self.scenario.unknowns;
        if unknowns.is_empty() {
            return Vec::new();
        }
        let robots = self.flight.robots().enumerate();
        robots.filter_map(|(robot, state)| self.beliefs.changed(unknowns, robot, state.worlds())).collect()
    }

    /// The way-points that robots have visited, given up or taken over in this tick.
    fn ticked_off(&mut self) -> Vec<FlightEvent> {
        let mut events = Vec::new();
        for (robot, known) in self.waypoints.iter_mut().enumerate() {
            let mut left = self.flight.robot(robot).waypoints().to_vec();
            let here = self.flight.reports()[robot].cell;
            // From the end: of a cell that is to be visited twice, the first visit comes off first.
            for cell in std::mem::take(known).into_iter().rev() {
                match left.iter().rposition(|&other| other == cell) {
                    Some(index) => known.push(left.remove(index)),
                    None if cell != here => events.push(FlightEvent::GaveUp { robot, cell }),
                    None => {
                        self.visited[robot].push(cell);
                        events.push(FlightEvent::Visited { robot, cell });
                    }
                }
            }
            known.reverse();
            events.extend(left.iter().map(|&cell| FlightEvent::TookOver { robot, cell }));
            known.extend(left);
        }
        events
    }

    /// The robots that have waited for a while, and for what.
    fn long_waits(&mut self) -> Vec<FlightEvent> {
        let mut events = Vec::new();
        for (robot, report) in self.flight.reports().iter().enumerate() {
            let waiting = report.waiting.filter(|_| !self.flight.world().is_stopped(robot));
            if let Some(waiting) = self.waits.note(robot, waiting) {
                events.push(FlightEvent::Waits { robot, awaited: Awaited::of(waiting, self.scenario) });
            }
        }
        events
    }

    fn record(self) -> Record {
        let members = self.members();
        let robots =
            members.iter().enumerate().map(|(index, &is_member)| self.robot(index, is_member)).collect();
        let outcome = self.evidence(&members, &self.moving()).outcome();
        Record {
            scenario: self.scenario.name.clone(),
            title: self.scenario.title.clone(),
            seed: self.conditions.seed,
            pilot: self.conditions.tree,
            loss: self.conditions.loss.unwrap_or(self.scenario.radio.loss),
            ticks: self.flight.ticks().saturating_sub(1),
            outcome,
            collisions: self.flight.collisions(),
            frames: self.flight.traffic().iter().sum(),
            width: self.flight.floor().width(),
            height: self.flight.floor().height(),
            goals: self.scenario.goals.clone(),
            robots,
            events: self.events,
            phases: self.phases,
            history: self.history,
            strangers: if self.scenario.has_strangers() { self.strangers } else { Vec::new() },
            certainty: self.certainty,
        }
    }

    fn robot(&self, index: usize, is_member: bool) -> RobotRecord {
        let (setup, report) = (&self.scenario.robots[index], &self.flight.reports()[index]);
        let received = self.flight.robot(index).link_report().received;
        let cells: Vec<_> = self.history.iter().map(|cells| cells[index]).collect();
        let (cell, world) = (self.flight.cells()[index], self.flight.world());
        RobotRecord {
            name: setup.name.clone(),
            start: setup.start,
            cell,
            goal: report.goal,
            path: report.path.cells(&self.scenario.map).collect(),
            probability: report.probability,
            status: record::status(report),
            waiting: report.waiting.map(|waiting| Awaited::of(waiting, self.scenario)),
            failure: report
                .failure
                .map(|failure| failure.to_string())
                .or_else(|| shortfall(report, self.scenario))
                .or_else(|| report.obstructed.map(obstructed))
                .or_else(|| report.put_off.map(put_off))
                .or_else(|| report.left_behind.map(left_behind)),
            moves: cells.windows(2).filter(|pair| pair[0] != pair[1]).count() as u32,
            arrived: verdict::arrival(&self.history, index).unwrap_or(0),
            frames: self.flight.traffic()[index],
            battery: world.battery(index).percent(),
            visited: self.visited[index].clone(),
            charged: record::times_charged(&self.events, index),
            stopped: world.is_stopped(index),
            member: is_member,
            tree: self.tree[index].clone(),
            accepted: received.accepted,
            rejected: received.refused(),
        }
    }
}

/// The goals that a plan misses, and who may be on them; `None` where it misses none.
fn shortfall(report: &Report, scenario: &Scenario) -> Option<String> {
    let goals = counted(u32::try_from(report.short_by).ok().filter(|&goals| goals > 0)?, "goal");
    let robots = (0..).map(RobotId).zip(&scenario.robots);
    let lost = robots.filter(|(robot, _)| !report.members.contains(*robot)).map(|(_, setup)| &*setup.name);
    let lost: Vec<&str> = lost.collect();
    let why = match lost[..] {
        [] => "no way leads to it".to_owned(),
        _ => format!("{} may be on what is closed to the others", lost.join(" or ")),
    };
    Some(format!("the plan is {goals} short: {why}"))
}

fn left_behind(cell: Cell) -> String {
    format!("the way-point {} of a lost teammate is left: no member has taken it over", cell.0)
}

fn obstructed(cell: Cell) -> String {
    format!("it does not visit {}, because an obstacle is on it", cell.0)
}

fn put_off(cell: Cell) -> String {
    format!("the way-point {} is put off: no plan was found that leads there", cell.0)
}
