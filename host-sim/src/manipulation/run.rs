//! A run: the mission flown with two trees, and its record.

use super::conventional::Conventional;
use super::record::{
    ActionCounts, Decided, RobotTick, Run, Thought, TickRecord, operator_name, place_name, state_name,
};
use super::robot::Inferring;
use super::sense::Sense;
use super::skill::Skill;
use super::tables::{
    GOAL_A, GOAL_B, GOAL_C, GRIP, HOLDS, MOVE_TO, PICK, PLACE, PLACED, PUT_DOWN, TEAM, tables,
};
use super::terms::{Disturbances, RunTerms, Trees, Trust};
use crate::scenario;
use crate::task::{Flown, Goal, HostTask, Station, TaskFlight, Truth, Worker};
use crate::tree::{BoundTree, Diagnostic};
use bumpalo::Bump;
use firmware::Robot;
use iibt_core::iibt::table::{Announcement, Tables, TablesError};
use iibt_core::team::{Invalid, MemberError, Peers, RobotId};
use iibt_core::time::Instant;
use iibt_core::tree::Status;
use thiserror::Error;

/// The detail of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// The outcome and the decisions.
    Outcome,
    /// Every tick.
    History,
}

/// The reason why a run is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum RunError {
    /// A tree cannot be run by these robots.
    #[error(transparent)]
    Tree(#[from] Diagnostic),
    /// The numbers make no tables.
    #[error(transparent)]
    Tables(#[from] TablesError),
    /// There is no such team.
    #[error(transparent)]
    Team(#[from] MemberError),
    /// A disturbance is no probability.
    #[error("{0}: a probability is a number from 0 to 1")]
    Disturbance(&'static str),
}

/// Runs a mission to its end: robot 1's tree has succeeded, or there are no more ticks.
///
/// # Errors
/// [`RunError`] when the terms are none.
pub fn run(terms: &RunTerms, detail: Detail) -> Result<Run, RunError> {
    check(terms)?;
    let arena = Bump::new();
    let tables = tables(&arena, terms.order, terms.preset)?;
    let truth = truth(&tables, terms.disturbances);
    let [left, right] = terms.trees.bind()?;
    let robots = vec![Hand::new(terms, &tables, 0, left)?, Hand::new(terms, &tables, 1, right)?];
    let radio = scenario::Radio { loss: terms.disturbances.loss, ..scenario::Radio::default() };
    let mut history = Vec::new();
    let flight = TaskFlight::new(&tables, &truth, radio, terms.seed, robots)?;
    let flown = flight.fly(terms.max_ticks, |statuses| statuses[0] == Status::Success, &mut |flight| {
        if detail == Detail::History {
            history.push(noted(flight));
        }
    });
    Ok(record(terms, flown, history))
}

fn check(terms: &RunTerms) -> Result<(), RunError> {
    let of = terms.disturbances;
    let named = [
        ("wrong readings", of.wrong_readings),
        ("failed grasps", of.failed_grasps),
        ("failed moves", of.failed_moves),
        ("failed placings", of.failed_placings),
        ("loss", of.loss),
    ];
    let wrong = named.into_iter().find(|(_, p)| !(0.0..=1.0).contains(p));
    wrong.map_or(Ok(()), |(name, _)| Err(RunError::Disturbance(name)))
}

/// The world: the bottle is on the plate, and robot 1 holds that at goal C.
fn truth(tables: &Tables<'_>, of: Disturbances) -> Truth {
    let goal =
        |robot: usize, factor: u8, state: u8| Goal { robot, factor: factor.into(), states: vec![state] };
    Truth {
        ticks: vec![vec![4, 2, 2, 1]; TEAM],
        fails: vec![vec![of.failed_moves, of.failed_grasps, of.failed_placings, 0.0]; TEAM],
        wrong: Some(of.wrong_readings),
        goals: vec![goal(0, GRIP, PLACED), goal(1, GRIP, HOLDS), goal(1, PLACE, GOAL_C)],
        ..Truth::of(tables)
    }
}

/// One robot with its tree.
enum Hand<'t> {
    Inferring(Box<Inferring<'t>>),
    Conventional(Box<Conventional<'t>>),
}

impl<'t> Hand<'t> {
    fn new(
        terms: &RunTerms,
        tables: &'t Tables<'t>,
        index: u8,
        tree: BoundTree<Skill>,
    ) -> Result<Self, RunError> {
        let task = || HostTask::new(tables, RobotId(index));
        let sense = match (terms.trees, terms.trust) {
            (Trees::Inference, _) => {
                return Ok(Self::Inferring(Box::new(Inferring::of(tree, task()?, terms.order))));
            }
            (_, Trust::Equal(enough)) => Sense::debounced(enough),
            (_, Trust::Belief) => Sense::believed(tables, index.into(), task()?),
        };
        Ok(Self::Conventional(Box::new(Conventional::new(tree, sense))))
    }

    fn thought(&self) -> Option<Thought> {
        match self {
            Self::Inferring(robot) => Some(robot.thought()),
            Self::Conventional(_) => None,
        }
    }

    fn running(&self) -> Option<Skill> {
        match self {
            Self::Inferring(robot) => robot.running(),
            Self::Conventional(robot) => robot.running(),
        }
    }
}

impl Robot<Station> for Hand<'_> {
    type Message = Announcement;

    fn mission(&self) -> u64 {
        match self {
            Self::Inferring(robot) => robot.mission(),
            Self::Conventional(robot) => robot.mission(),
        }
    }

    fn accepts(&self, said: &Announcement) -> Result<(), Invalid> {
        match self {
            Self::Inferring(robot) => robot.accepts(said),
            Self::Conventional(robot) => robot.accepts(said),
        }
    }

    fn sense(&mut self, station: &mut Station, now: Instant) {
        match self {
            Self::Inferring(robot) => robot.sense(station, now),
            Self::Conventional(robot) => robot.sense(station, now),
        }
    }

    fn tick(&mut self, peers: Peers<'_, Announcement>, now: Instant) -> Status {
        match self {
            Self::Inferring(robot) => robot.tick(peers, now),
            Self::Conventional(robot) => robot.tick(peers, now),
        }
    }

    fn act(&mut self, station: &mut Station) {
        match self {
            Self::Inferring(robot) => robot.act(station),
            Self::Conventional(robot) => robot.act(station),
        }
    }

    fn message(&self) -> Announcement {
        match self {
            Self::Inferring(robot) => robot.message(),
            Self::Conventional(robot) => robot.message(),
        }
    }
}

impl<'t> Worker<'t> for Hand<'t> {
    fn task(&self) -> Option<&HostTask<'t>> {
        match self {
            Self::Inferring(robot) => robot.task(),
            Self::Conventional(robot) => robot.task(),
        }
    }
}

fn noted<'t>(flight: &TaskFlight<'t, Hand<'t>>) -> TickRecord {
    let world = &flight.world;
    let robots = [0, 1].map(|index| {
        let (robot, place) = (flight.robots().nth(index), world.state(index, PLACE.into()));
        let parts = flight.parts(index);
        let [read_place, read_state, ..] = parts.percept.readings;
        RobotTick {
            place: place_name(place),
            state: state_name(world.semantic(index)),
            reading: read_place
                .zip(read_state)
                .map(|(place, state)| [place_name(place.into()), state_name(state.into())]),
            begins: parts.command.map(|command| {
                let at = command.target.map_or(place, usize::from);
                [operator_name(command.operator), place_name(at)]
            }),
            status: match flight.statuses[index] {
                Status::Success => "success",
                Status::Failure => "failure",
                Status::Running | Status::Skipped => "running",
            },
            leaf: robot.and_then(Hand::running).map(Skill::name),
            thought: robot.and_then(Hand::thought),
        }
    });
    let [bottle, plate] =
        [(0, GOAL_A), (1, GOAL_B)].map(|(robot, source)| match world.state(robot, GRIP.into()) as u8 {
            HOLDS => format!("held by robot {}", robot + 1),
            PLACED => "on the plate".to_owned(),
            _ => format!("at {}", place_name(source.into())),
        });
    TickRecord { tick: flight.tick, robots, bottle, plate }
}

fn record(terms: &RunTerms, flown: Flown, history: Vec<TickRecord>) -> Run {
    let count = |operator| flown.operated.iter().filter(|begun| begun.operator == operator).count() as u32;
    let mut begun = Vec::new();
    let mut retries = 0;
    for one in &flown.operated {
        let what = (one.robot, one.operator, one.target);
        retries += u32::from(begun.contains(&what));
        begun.push(what);
    }
    let decided = flown.operated.iter().filter_map(|one| {
        one.policy.map(|(policy, probability)| Decided::of(one.tick, one.robot, policy, probability))
    });
    Run {
        seed: terms.seed,
        trees: terms.trees,
        disturbances: terms.disturbances,
        success: flown.success,
        believed: flown.believed,
        ticks: flown.ticks,
        actions: ActionCounts { moves: count(MOVE_TO), picks: count(PICK), placings: count(PUT_DOWN) },
        retries,
        frames: flown.frames,
        decisions: decided.collect(),
        history,
    }
}
