//! A run: the mission flown with two trees, and its record.

use super::conventional::Conventional;
use super::record::{
    ActionCounts, Decided, RobotTick, Run, Thought, TickRecord, operator_name, place_name, state_name,
};
use super::robot::{Mover, leaf};
use super::sense::Sense;
use super::skill::Skill;
use super::tables::{
    GOAL_A, GOAL_B, GOAL_C, GRIP, HOLDS, MOVE_TO, PICK, PLACE, PLACED, PUT_DOWN, TEAM, tables,
};
use super::terms::{Disturbances, RunTerms, Trees, Trust};
use crate::scenario;
use crate::task::{Flown, Goal, HostRobot, HostTask, TIMEOUT, TaskFlight, Truth, Worker};
use crate::testbed::settings;
use crate::tree::Diagnostic;
use bumpalo::Bump;
use iibt_core::iibt::table::{Tables, TablesError};
use iibt_core::team::{MemberError, RobotId};
use iibt_core::tree::{NodeMemory, Status};
use thiserror::Error;

/// The detail of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// The outcome and the decisions.
    Outcome,
    /// Every tick.
    History,
}

/// Why there is no such run.
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
    let robots = [RobotId(0), RobotId(1)];
    if terms.trees == Trees::Inference {
        let trees = terms.trees.bind(leaf)?;
        let robots = robots.into_iter().zip(&trees).map(|(robot, tree)| {
            let (tree, memory) = (tree.by_ref(), vec![NodeMemory::NEW; tree.len()]);
            let settings = settings(robot, TEAM)?;
            Ok(HostRobot::with_memory(&tables, &settings, tree, memory, Mover(terms.order), TIMEOUT)?)
        });
        return fly(terms, detail, &tables, &truth, robots);
    }
    let trees = terms.trees.bind(Skill::of)?;
    let robots = robots.into_iter().zip(trees).map(|(robot, tree)| {
        let sense = match terms.trust {
            Trust::Equal(enough) => Sense::debounced(enough),
            Trust::Belief => Sense::believed(&tables, robot.index(), HostTask::new(&tables, robot, 1)?),
        };
        Ok(Conventional::new(tree, sense))
    });
    fly(terms, detail, &tables, &truth, robots)
}

/// A robot that takes part, whatever its tree.
pub(super) trait Hand<'t>: Worker<'t> {
    /// What it thinks after a tick, if it infers.
    fn thought(&self) -> Option<Thought>;
    /// The leaf that is running.
    fn leaf(&self) -> Option<&'static str>;
}

fn fly<'t, R: Hand<'t>>(
    terms: &RunTerms,
    detail: Detail,
    tables: &'t Tables<'t>,
    truth: &'t Truth,
    robots: impl Iterator<Item = Result<R, RunError>>,
) -> Result<Run, RunError> {
    let robots = robots.collect::<Result<_, RunError>>()?;
    let radio = scenario::Radio { loss: terms.disturbances.loss, ..scenario::Radio::default() };
    let mut history = Vec::new();
    let flight = TaskFlight::new(tables, truth, radio, terms.seed, robots)?;
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

fn noted<'t, R: Hand<'t>>(flight: &TaskFlight<'t, R>) -> TickRecord {
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
            leaf: robot.and_then(Hand::leaf),
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
