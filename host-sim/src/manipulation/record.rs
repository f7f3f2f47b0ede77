//! The record of a run.

use super::tables::{IN_TURN, PLACE};
use super::terms::{Disturbances, Trees};
use crate::radio::Traffic;
use crate::task::HostTask;
use iibt_core::iibt::Task as _;
use iibt_core::iibt::table::Wanted;
use serde::Serialize;

/// The record of one run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Run {
    /// The seed of all chance.
    pub seed: u64,
    /// The trees of the robots.
    pub trees: Trees,
    /// The probabilities of the disturbances.
    pub disturbances: Disturbances,
    /// Whether, in truth, the bottle is on the plate and robot 2 holds that at goal C, and robot
    /// 1's tree has succeeded.
    pub success: bool,
    /// Whether robot 1's tree has succeeded: what the robots believe.
    pub believed: bool,
    /// The ticks it took.
    pub ticks: u32,
    /// The actions that were begun.
    pub actions: ActionCounts,
    /// The actions that were begun again: the same by the same robot to the same place.
    pub retries: u32,
    /// The frames of both robots.
    pub frames: Traffic,
    /// The joint policies by which robots have acted, in order.
    pub decisions: Vec<Decided>,
    /// Every tick; empty when only the outcome was asked for.
    pub history: Vec<TickRecord>,
}

/// The number of actions, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ActionCounts {
    /// Moves.
    pub moves: u32,
    /// Picks.
    pub picks: u32,
    /// Placings.
    pub placings: u32,
}

/// A joint policy by which a robot has acted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decided {
    /// The tick.
    pub tick: u32,
    /// The robot, 1 or 2.
    pub robot: usize,
    /// The number of the policy: 3 is π3.
    pub policy: usize,
    /// The actions of robots 1 and 2.
    pub actions: [&'static str; 2],
    /// Its posterior probability among the sixteen.
    pub probability: f32,
}

/// One tick.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TickRecord {
    /// Its number.
    pub tick: u32,
    /// The robots after it.
    pub robots: [RobotTick; 2],
    /// The true place of the bottle.
    pub bottle: String,
    /// The true place of the plate.
    pub plate: String,
}

/// One robot in one tick.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotTick {
    /// Its true place.
    pub place: &'static str,
    /// Its true state.
    pub state: &'static str,
    /// Its readings of place and state, when no action was under way.
    pub reading: Option<[&'static str; 2]>,
    /// The action that it began, and where.
    pub begins: Option<[&'static str; 2]>,
    /// The status of its tree: `running`, `success` or `failure`.
    pub status: &'static str,
    /// The leaf that is running.
    pub leaf: Option<&'static str>,
    /// Its beliefs and decision, if it infers.
    pub thought: Option<Thought>,
}

/// The beliefs and the decision of a robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Thought {
    /// q(s) over loc, hold, place, free.
    pub states: [f32; 4],
    /// q over elsewhere and goals A, B, C.
    pub places: [f32; 4],
    /// C of robots 1 and 2 in the decision of this tick, raises included.
    pub raised: Option<[[f32; 4]; 2]>,
    /// C of robots 1 and 2 after the tick.
    pub preferences: [[f32; 4]; 2],
    /// The posterior over the sixteen joint policies in this tick.
    pub posterior: Option<Vec<f32>>,
    /// The number of the joint policy that was chosen.
    pub choice: Option<usize>,
}

impl Run {
    /// Returns the record as one line of JSON.
    ///
    /// # Errors
    /// None that can occur: every key is text.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string(self)
    }

    /// The sequence of policies by which robots have acted, without repetitions.
    #[must_use]
    pub fn sequence(&self) -> Vec<usize> {
        let mut sequence: Vec<_> = self.decisions.iter().map(|decided| decided.policy).collect();
        sequence.dedup();
        sequence
    }
}

impl Thought {
    pub(super) fn of(task: &HostTask<'_>, raised: Option<&Wanted<64, 4>>) -> Self {
        let decision = task.decision();
        let four = |row: &[f32]| std::array::from_fn(|state| row.get(state).copied().unwrap_or(0.0));
        let two = |rows: &[[f32; 64]; 4]| [four(&rows[0]), four(&rows[1])];
        let wanted = raised.copied().unwrap_or_else(|| task.preference());
        Self {
            states: four(&task.states()),
            places: four(task.belief(PLACE.into())),
            raised: decision.map(|decision| two(&decision.preferences)),
            preferences: two(&wanted.rows.map(|row| row.values())),
            posterior: decision.map(|decision| decision.posterior[..POLICIES].to_vec()),
            choice: decision.map(|decision| decision.choice.into()),
        }
    }
}

/// The number of joint policies.
const POLICIES: usize = IN_TURN[0].operators.len() * IN_TURN[1].operators.len();

impl Decided {
    pub(super) fn of(tick: u32, robot: usize, policy: u16, probability: f32) -> Self {
        let policy = usize::from(policy);
        let actions = [policy / 4, policy % 4].map(|operator| operator_name(operator as u8));
        Self { tick, robot: robot + 1, policy, actions, probability }
    }
}

pub(super) fn operator_name(operator: u8) -> &'static str {
    IN_TURN[0].operators[usize::from(operator)].name
}

pub(super) fn place_name(place: usize) -> &'static str {
    IN_TURN[0].factors[usize::from(PLACE)].states[place]
}

pub(super) fn state_name(state: usize) -> &'static str {
    IN_TURN[0].states.names[state]
}
