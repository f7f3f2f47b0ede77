//! Navigating robots in flight: the lines of Algorithm 1, errands, teammates that come and go,
//! obstacles that do.

mod errands;
mod fallbacks;
mod given_paths;
mod lines;
mod members;
mod mute;
mod obstacles;
mod progress;
mod twins;
mod unknowns;

use firmware::missions::{LAYERS, NODES, POLICIES};
use host_sim::{EventEffect, Faults, NavigatorFlight, Radio, Reading, reproduce};
use iibt_core::grid::{Cell, Map};
use iibt_core::navigation::{Cause, MAX_GOALS, Mission, Navigation, Purpose, Report, Stage, VisitError};
use iibt_core::team::RobotId;
use iibt_core::team::rounds::{Protocol, View, Waiting};
use iibt_core::tree::Status;
use tests::judge;
use tests::rig::{context, overhear};

/// Robots with the sizes of the images.
type Team<'m> = NavigatorFlight<'m, 49, 2, LAYERS, NODES, POLICIES>;

type Task<'m> = Navigation<'m, 49, 2, LAYERS, NODES, POLICIES>;

type Fact = iibt_core::navigation::Fact<2>;

static STARTS: [Cell; 3] = [Cell(28), Cell(2), Cell(45)];
static GOALS: [Cell; 3] = [Cell(24), Cell(26), Cell(32)];

fn factory() -> Mission<'static, 2> {
    Mission::new(reproduce::map(), &STARTS, &GOALS)
}

/// The factory with the paper's chargers.
fn with_chargers() -> Mission<'static, 2> {
    static CHARGERS: [Option<Cell>; 3] = [Some(Cell(13)), Some(Cell(27)), Some(Cell(41))];
    Mission { chargers: &CHARGERS, ..factory() }
}

fn open_floor() -> Map<2> {
    Map::new(7, 7).expect("49 cells fit two words")
}

fn team<'m>(mission: &'m Mission<'m, 2>) -> Team<'m> {
    Team::over(mission, Faults::default(), 1).expect("a sound mission")
}

fn lossy<'m>(mission: &'m Mission<'m, 2>, loss: f64, seed: u64) -> Team<'m> {
    let faults = Faults { radio: Radio { loss, ..Radio::default() }, ..Faults::default() };
    Team::over(mission, faults, seed).expect("a sound mission")
}

fn stages(team: &Team<'_>) -> Vec<Stage> {
    team.reports().iter().map(|report| report.stage).collect()
}

fn report(team: &Team<'_>, robot: usize) -> Report {
    team.reports()[robot]
}

fn round(team: &Team<'_>) -> u32 {
    team.reports().iter().map(|report| report.round).max().expect("a robot")
}

fn task<'t, 'm>(team: &'t Team<'m>, robot: usize) -> &'t Task<'m> {
    team.robot(robot).robot().navigation()
}

fn protocol<'t>(team: &'t Team<'_>, robot: usize) -> &'t Protocol<Fact, POLICIES> {
    task(team, robot).rounds().expect("it knows where it stands").protocol()
}

fn visit(team: &mut Team<'_>, robot: usize, cell: u16) {
    team.robot_mut(robot).robot_mut().navigation_mut().visit(Cell(cell)).expect("it is free");
}

fn cells(team: &Team<'_>) -> Vec<u16> {
    team.cells().iter().map(|cell| cell.0).collect()
}

fn all(team: &Team<'_>, stage: Stage) -> bool {
    stages(team).iter().all(|&now| now == stage)
}

fn stopped(team: &Team<'_>) -> bool {
    team.statuses().iter().all(|&status| status == Status::Success)
}

/// Whether every robot has decided in its round.
fn has_decided(team: &Team<'_>) -> bool {
    let has = |robot| task(team, robot).rounds().is_some_and(|rounds| rounds.protocol().has_decided());
    (0..team.reports().len()).all(has)
}

/// Whether every robot has decided in a round after this one.
fn decided_after(team: &Team<'_>, round: u32) -> bool {
    let is_later = |robot: usize| {
        let protocol = protocol(team, robot);
        protocol.has_decided() && protocol.proposal().round > round
    };
    (0..team.reports().len()).all(is_later)
}

/// Ticks a team until something holds; fails when it does not within 600 ticks, or when robots
/// collide.
fn fly_until(team: &mut Team<'_>, what: &str, reached: impl Fn(&Team<'_>) -> bool) {
    fly_watching(team, what, |_| (), reached);
}

/// The same, looking at the team after every tick.
fn fly_watching(
    team: &mut Team<'_>,
    what: &str,
    mut look: impl FnMut(&Team<'_>),
    reached: impl Fn(&Team<'_>) -> bool,
) {
    for _ in 0..600 {
        if reached(team) {
            assert_eq!(team.collisions().total(), 0);
            return;
        }
        team.tick();
        look(team);
    }
    let waiting: Vec<_> = team.reports().iter().map(|report| report.waiting).collect();
    panic!("never: {what}; {:?} on {:?}, waiting {waiting:?}", stages(team), cells(team));
}

/// Ticks a team this many times.
fn tick(team: &mut Team<'_>, times: u32) {
    (0..times).for_each(|_| _ = team.tick());
}

fn agreed<'m>(mission: &'m Mission<'m, 2>) -> Team<'m> {
    let mut team = team(mission);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    team
}

fn on_goals(team: &Team<'_>, mission: &Mission<'_, 2>) -> bool {
    team.cells().iter().all(|cell| mission.goals.contains(cell))
}

/// Flies until all have stopped; returns the cells of every robot, tick by tick.
fn fly_to_the_end(team: &mut Team<'_>) -> Vec<Vec<u16>> {
    let mut tracks = vec![vec![]; team.cells().len()];
    team.tick();
    let note = |team: &Team<'_>| {
        for (track, cell) in tracks.iter_mut().zip(cells(team)) {
            track.push(cell);
        }
    };
    fly_watching(team, "all stop", note, stopped);
    tracks
}

/// Whether the cells a robot stood in, tick by tick, pass over these in their order.
fn passed(cells: &[u16], points: &[u16]) -> bool {
    let mut left = cells.iter();
    points.iter().all(|point| left.any(|cell| cell == point))
}
