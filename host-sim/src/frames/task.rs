//! What recorded frames of a team with a table task say: who does what, and how surely.

use super::heard::{Heard, Round};
use super::{HeardFrames, ToldChoice};
use crate::task::{HostTask, TableMission};
use iibt_core::iibt::table::{Announcement, Role, TableMessage, Tables, TablesError, joint_policies};
use iibt_core::team::rounds::Choice;
use iibt_core::team::{Context, Key, RobotId};
use std::fmt;

/// What is known from recorded frames of a task.
///
/// ```
/// use bumpalo::Bump;
/// use host_sim::task::{TableMission, Trouble, built_in};
/// use host_sim::{KEY, TaskFrames};
///
/// let arena = Bump::new();
/// let valves = TableMission::parse(&arena, "valves", built_in("valves").unwrap_or_default())?;
/// let mut bytes = vec![];
/// valves.fly_recorded(3, Trouble::default(), &mut |frames| bytes.extend(frames))?;
/// let frames = TaskFrames::read(&valves, &KEY, &bytes)?;
/// let mut chosen = frames.rounds.iter().filter_map(|round| round.chosen.as_ref());
/// let turn = chosen.find(|chosen| !chosen.parts[0].is_idle).expect("the inlet is turned");
/// assert_eq!(turn.parts[0].operator, "turn");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type TaskFrames = HeardFrames<ChosenParts>;

/// The joint policy that the members of a round carry out.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenParts {
    /// Its number: that of pi in the narration of a flight.
    pub policy: u16,
    /// Its place in the list of the round, from zero.
    pub place: usize,
    /// The number of joint policies in the list.
    pub listed: usize,
    /// Its posterior probability, in steps of 1/255.
    pub probability: f32,
    /// What each member does.
    pub parts: Vec<RobotPart>,
}

/// A robot's part of a joint policy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotPart {
    /// The robot's name.
    pub robot: String,
    /// The name of its operator.
    pub operator: String,
    /// Whether it does nothing.
    pub is_idle: bool,
    /// Whether the operator was under way when the robot joined the round.
    pub goes_on: bool,
    /// Each hidden factor by name, with the state that the robot was sure of.
    pub states: Vec<(String, Option<String>)>,
}

impl TaskFrames {
    /// Reads frames as a [`Controller`](firmware::Controller) sends them, with their delimiters, of
    /// a team that works on a task.
    ///
    /// # Errors
    /// [`TablesError`] when the simulator has no room for the task.
    pub fn read(mission: &TableMission<'_>, key: &Key, bytes: &[u8]) -> Result<Self, TablesError> {
        let tables = &mission.tables;
        let listener = HostTask::new(tables, RobotId(0), 1)?;
        let context = Context::of::<TableMessage>(0, tables.mission());
        let heard =
            Heard::<Announcement, _>::read(bytes, key, context, |said: &TableMessage| listener.accepts(said));
        let name = |robot: RobotId| tables.roles()[robot.index()].name.to_owned();
        Ok(Self::of(heard, name, |round| chosen(round, round.choice?, tables)))
    }
}

fn chosen(
    round: &Round<Announcement, TableMessage>,
    choice: Choice,
    tables: &Tables<'_>,
) -> Option<ChosenParts> {
    if round.missing().next().is_some() {
        return None;
    }
    let list = joint_policies(tables, &round.facts);
    let policy = *list.get(usize::from(choice.policy))?;
    let part = |robot: RobotId| {
        let role = tables.role(robot.index())?;
        Some(part(role, tables.part(policy, robot.index()), round.facts[robot.index()].as_ref()?))
    };
    Some(ChosenParts {
        policy,
        place: choice.policy.into(),
        listed: list.len(),
        probability: f32::from(choice.probability) / 255.0,
        parts: round.members().filter_map(part).collect(),
    })
}

fn part(role: &Role<'_>, operator: u8, fact: &Announcement) -> RobotPart {
    let state = |(number, factor): (usize, &iibt_core::iibt::table::HiddenFactor<'_>)| {
        let sure = fact.state(number).and_then(|state| factor.states.get(usize::from(state)));
        (factor.name.to_owned(), sure.map(|&state| state.to_owned()))
    };
    let is_idle = operator == role.idle;
    RobotPart {
        robot: role.name.to_owned(),
        operator: role.operators.get(usize::from(operator)).map_or("?", |operator| operator.name).to_owned(),
        is_idle,
        goes_on: !is_idle && fact.operator() == operator,
        states: role.factors.iter().enumerate().map(state).collect(),
    }
}

impl ToldChoice for ChosenParts {
    const UNKNOWN: &'static str = "who does what";
}

impl fmt::Display for ChosenParts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { policy, place, listed, probability, parts } = self;
        writeln!(f, "joint policy {place}, one of {listed}, pi{policy}, probability {probability:.3}")?;
        parts.iter().try_for_each(|part| writeln!(f, "  {part}"))
    }
}

impl fmt::Display for RobotPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let does = match (self.is_idle, self.goes_on) {
            (true, _) => "does nothing".to_owned(),
            (false, true) => format!("goes on with {}", self.operator),
            (false, false) => format!("begins {}", self.operator),
        };
        let state = |(factor, state): &(String, Option<String>)| {
            format!("{factor} {}", state.as_deref().unwrap_or("not known"))
        };
        let states: Vec<String> = self.states.iter().map(state).collect();
        write!(f, "{:<4} {does}: {}", self.robot, states.join(", "))
    }
}
