//! What recorded frames of a navigating team say: who goes where, when and how surely.
//!
//! The facts of a round's members give its list of joint policies, and each robot's frame carries
//! the number of the chosen one and its probability. So the frames and the mission are all it
//! takes.

mod heard;
mod task;
mod told;

pub use task::{ChosenParts, RobotPart, TaskFrames};
pub use told::{HeardFrames, HeardRound, ToldChoice};

use self::heard::{Heard, Round};
use crate::scenario::{MAX_CELLS, Scenario};
use crate::team::{LAYERS, MEDIUM, NODES, POLICIES, SMALL, TeamError, on_mission};
use crate::text::{counted, route};
use iibt_core::grid::{Cell, Move, words};
use iibt_core::navigation::{Fact, Intention, Mission, Navigation, Policies, Purpose};
use iibt_core::team::rounds::Choice;
use iibt_core::team::{Context, Key, Member, RobotId};
use std::fmt;

/// What is known from recorded frames.
///
/// ```
/// use host_sim::{KEY, TeamFrames, library};
///
/// let scenario = library::find("two-goals").expect("it is built in")?;
/// let noise = TeamFrames::read(&scenario, &KEY, &[1, 2, 3, 0])?;
/// assert_eq!((noise.accepted, noise.refused.len()), (0, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type TeamFrames = HeardFrames<ChosenPolicy>;

/// The joint policy that the members of a round follow.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenPolicy {
    /// Its number in the list, from zero.
    pub policy: usize,
    /// The number of joint policies in the list.
    pub listed: usize,
    /// Its posterior probability, in steps of 1/255.
    pub probability: f32,
    /// Why it does not lead all robots to their targets, if it does not.
    pub failure: Option<String>,
    /// Where each member goes.
    pub ways: Vec<Way>,
}

/// The way of a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Way {
    /// The robot's name.
    pub robot: String,
    /// What it is for.
    pub purpose: Purpose,
    /// The cells of its path, step by step, waits included.
    pub path: Vec<Cell>,
    /// The moves of the path, waits not counted.
    pub moves: u16,
    /// The moves that its newest frame of the round says are made.
    pub made: u16,
    /// The first cell of its path from where it sees something of what no member knows.
    pub look_out: Option<Cell>,
    /// The way-points that its newest frame of the round says it visits later.
    pub waypoints: Vec<Cell>,
}

impl TeamFrames {
    /// Reads frames as a [`Controller`](firmware::Controller) sends them, with their delimiters, of
    /// a team that flies the mission of a scenario.
    ///
    /// # Errors
    /// [`TeamError`] when the mission has no team.
    pub fn read(scenario: &Scenario, key: &Key, bytes: &[u8]) -> Result<Self, TeamError> {
        let cells = scenario.map.len();
        if cells <= SMALL {
            read::<SMALL, { words(SMALL, 1) }>(scenario, key, bytes)
        } else if cells <= MEDIUM {
            read::<MEDIUM, { words(MEDIUM, 1) }>(scenario, key, bytes)
        } else {
            read::<MAX_CELLS, { words(MAX_CELLS, 1) }>(scenario, key, bytes)
        }
    }
}

fn read<const S: usize, const W: usize>(
    scenario: &Scenario,
    key: &Key,
    bytes: &[u8],
) -> Result<TeamFrames, TeamError> {
    on_mission::<W, _>(scenario, |mission| {
        let listener = Member::new(RobotId(0), scenario.robots.len())?;
        let navigation = Box::new(Navigation::<S, W, LAYERS, NODES, POLICIES>::new(mission, listener, 1)?);
        let context = Context::of::<Intention<W, POLICIES>>(0, navigation.mission_id());
        let accepts = |message: &Intention<W, POLICIES>| navigation.accepts(message);
        let heard = Heard::<Fact<W>, _>::read(bytes, key, context, accepts);
        let name = |robot: RobotId| scenario.robots[robot.index()].name.clone();
        Ok(HeardFrames::of(heard, name, |round| round.chosen::<S>(round.choice?, scenario, mission)))
    })
}

impl<const W: usize> Round<Fact<W>, Intention<W, POLICIES>> {
    fn chosen<const S: usize>(
        &self,
        choice: Choice,
        scenario: &Scenario,
        mission: &Mission<'_, W>,
    ) -> Option<ChosenPolicy> {
        let fact = |robot: RobotId| self.facts[robot.index()].as_ref();
        let list = Policies::<S, W, LAYERS, NODES, POLICIES>::of_round(mission, &self.proposal, fact)?;
        let plan = list.plans().get(usize::from(choice.policy))?;
        let way = |(robot, path): (RobotId, &iibt_core::grid::Path)| Way {
            robot: scenario.robots[robot.index()].name.clone(),
            purpose: fact(robot).map_or(Purpose::Goal, |fact| fact.purpose),
            path: path.cells(&mission.map).collect(),
            moves: path.moves().filter(|&step| step != Move::Wait).count() as u16,
            made: self.made[robot.index()],
            look_out: list.look_out(&mission.map, path, 0),
            waypoints: self.newest[robot.index()].iter().flat_map(|said| said.waypoints.to_vec()).collect(),
        };
        Some(ChosenPolicy {
            policy: choice.policy.into(),
            listed: list.plans().len(),
            probability: f32::from(choice.probability) / 255.0,
            failure: list.failure().map(|failure| failure.to_string()),
            ways: self.proposal.view.iter().zip(plan.paths()).map(way).collect(),
        })
    }
}

impl ToldChoice for ChosenPolicy {
    const UNKNOWN: &'static str = "who goes where";
}

impl fmt::Display for ChosenPolicy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { policy, listed, probability, .. } = self;
        writeln!(f, "joint policy {policy}, one of {listed}, probability {probability:.3}")?;
        for way in &self.ways {
            writeln!(f, "  {way}")?;
        }
        self.failure.iter().try_for_each(|failure| writeln!(f, "  {failure}"))
    }
}

impl fmt::Display for Way {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let end = self.path.last().map_or(0, |cell| cell.0);
        let errand = match self.purpose {
            Purpose::Visit(cell) if cell.0 == end => ", a way-point",
            Purpose::Charge(cell) if cell.0 == end => ", to charge",
            Purpose::Stand => ", to stand",
            _ => "",
        };
        let steps = counted(self.path.len().max(1) - 1, "step");
        let moves = format!("{} of {} made", self.made.min(self.moves), counted(self.moves, "move"));
        write!(f, "{:<4} to {end}{errand} in {steps}, {moves}: {}", self.robot, route(&self.path))?;
        self.look_out.iter().try_for_each(|cell| write!(f, ", by the look-out {}", cell.0))?;
        self.waypoints.iter().try_for_each(|cell| write!(f, ", later by way of {}", cell.0))
    }
}
