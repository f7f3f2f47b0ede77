//! The team: a controller for every robot, each in a body of its own: the firmware's own, or one
//! with a conventional tree.
//!
//! A controller is compiled for a size of map, which is chosen here.

use crate::body::{Body, body};
use crate::campaign::Ablation;
use crate::conventional::{ConventionalRobot, ConventionalTree, period};
use crate::radio::KEY;
use crate::robot::{AnyRobot, shrunk};
use crate::scenario::{MAX_CELLS, Scenario, UnknownSpec};
use clap::ValueEnum;
use firmware::{Controller, Navigator, Settings, missions};
use iibt_core::grid::{Cell, Path, words};
use iibt_core::inference::learning::Rates;
use iibt_core::navigation::{Decider, Mission, MissionError};
use iibt_core::team::{Keys, Member, MemberError, RobotId};
use serde::{Serialize, Serializer};
use std::num::NonZero;
use thiserror::Error;

/// A navigating robot with the firmware's controller in a simulated body.
pub type Navigating<'m, const S: usize, const W: usize, const L: usize, const M: usize, const K: usize> =
    Controller<Navigator<'m, S, W, L, M, K>, Body>;

/// Builds the controller of a robot by its number and the epoch of its start.
pub(crate) type Boot<'m, R> = Box<dyn Fn(u8, u32) -> Result<Box<R>, TeamError> + 'm>;

pub(crate) const SMALL: usize = 64;
pub(crate) const MEDIUM: usize = 256;

/// The steps of a plan, its start included.
pub(crate) const LAYERS: usize = 65;

/// The nodes of a search for robots with goals of their own.
pub(crate) const NODES: usize = 4096;

/// The work units of a tick unless the scenario says otherwise: a simulated robot has time.
pub(crate) const UNLIMITED: u32 = u32::MAX;

/// The joint policies that are weighed at the most.
pub(crate) const POLICIES: usize = 16;

/// The reason why a team is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(transparent)]
pub enum TeamError {
    /// The team is too large.
    Member(#[from] MemberError),
    /// The mission does not fit.
    Mission(#[from] MissionError),
}

/// The pilot of the robots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, ValueEnum)]
pub enum Pilot {
    /// The firmware's tree with its inference node.
    #[default]
    Inference,
    /// The same with the sizes of plans and searches in images, for maps of at most 64 cells.
    Image,
    /// The same with frames of at most 64 bytes, for maps of at most 64 cells.
    Compact,
    /// The conventional tree of figure 8.
    Conventional,
    /// The conventional tree of figure 5(a), for missions with two goals.
    #[value(name = "figure-5")]
    Figure5,
    /// The firmware's tree, but something else decides where something is unknown.
    #[value(skip)]
    Ablated(&'static Ablation),
}

impl Serialize for Pilot {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Pilot {
    /// The name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Inference => "inference",
            Self::Image => "image",
            Self::Compact => "compact",
            Self::Conventional => "conventional",
            Self::Figure5 => "figure-5",
            Self::Ablated(ablation) => ablation.name,
        }
    }

    /// Returns the most cells of a map that it flies on.
    #[must_use]
    pub const fn most_cells(self) -> usize {
        if matches!(self, Self::Image | Self::Compact) { SMALL } else { MAX_CELLS }
    }

    /// What decides where something is unknown.
    const fn decider(self) -> Decider {
        if let Self::Ablated(ablation) = self { ablation.decider } else { Decider::Inference }
    }

    /// Whether it is a conventional tree.
    #[must_use]
    pub const fn is_conventional(self) -> bool {
        self.figure().is_some()
    }

    /// The conventional tree, if it is one.
    const fn figure(self) -> Option<ConventionalTree> {
        match self {
            Self::Inference | Self::Image | Self::Compact | Self::Ablated(_) => None,
            Self::Conventional => Some(ConventionalTree::Eight),
            Self::Figure5 => Some(ConventionalTree::Five),
        }
    }
}

/// Prepares the controllers of a scenario's robots for as long as `fly` lasts.
pub(crate) fn with_team<T>(
    scenario: &Scenario,
    pilot: Pilot,
    fly: impl for<'m> FnOnce(Boot<'m, dyn AnyRobot + 'm>) -> Result<T, TeamError>,
) -> Result<T, TeamError> {
    let cells = scenario.map.len();
    if cells > pilot.most_cells() {
        Err(MissionError::MapTooLarge.into())
    } else if pilot == Pilot::Image {
        as_in_images(scenario, fly)
    } else if pilot == Pilot::Compact {
        with_small_frames(scenario, fly)
    } else if cells <= SMALL {
        sized::<SMALL, { words(SMALL, 1) }, T>(scenario, pilot, fly)
    } else if cells <= MEDIUM {
        sized::<MEDIUM, { words(MEDIUM, 1) }, T>(scenario, pilot, fly)
    } else {
        sized::<MAX_CELLS, { words(MAX_CELLS, 1) }, T>(scenario, pilot, fly)
    }
}

fn sized<const S: usize, const W: usize, T>(
    scenario: &Scenario,
    pilot: Pilot,
    fly: impl for<'m> FnOnce(Boot<'m, dyn AnyRobot + 'm>) -> Result<T, TeamError>,
) -> Result<T, TeamError> {
    let team = scenario.robots.len();
    if let Some(figure) = pilot.figure() {
        return fly(Box::new(|robot, epoch| {
            let settings = settings(robot, team, KEY.into(), epoch, period(scenario))?;
            let robot = ConventionalRobot::<S, W>::new(scenario, figure, &settings)?;
            Ok(Box::new(Controller::new(robot, settings, body())))
        }));
    }
    let decider = pilot.decider();
    on_mission_by::<W, T>(decider, scenario, |mission| {
        fly(boot::<S, W, LAYERS, NODES, POLICIES>(scenario, mission))
    })
}

/// Robots with the sizes of images.
fn as_in_images<T>(
    scenario: &Scenario,
    fly: impl for<'m> FnOnce(Boot<'m, dyn AnyRobot + 'm>) -> Result<T, TeamError>,
) -> Result<T, TeamError> {
    use missions::{LAYERS, NODES, POLICIES};
    const W: usize = words(SMALL, 1);
    on_mission::<W, T>(scenario, |mission| fly(boot::<SMALL, W, LAYERS, NODES, POLICIES>(scenario, mission)))
}

/// Robots whose frames fit 64 bytes.
fn with_small_frames<T>(
    scenario: &Scenario,
    fly: impl for<'m> FnOnce(Boot<'m, dyn AnyRobot + 'm>) -> Result<T, TeamError>,
) -> Result<T, TeamError> {
    use missions::compact::{CELLS, LAYERS, NODES, POLICIES, WORDS};
    on_mission::<WORDS, T>(scenario, |mission| {
        fly(boot::<CELLS, WORDS, LAYERS, NODES, POLICIES>(scenario, mission))
    })
}

/// Starts the navigating robots of a scenario.
fn boot<'m, const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>(
    scenario: &Scenario,
    mission: &'m Mission<'m, W>,
) -> Boot<'m, dyn AnyRobot + 'm> {
    let budget = scenario.inference.budget.unwrap_or(UNLIMITED);
    Box::new(move |robot, epoch| {
        Ok(Box::new(navigating::<S, W, L, M, K>(mission, KEY.into(), robot, epoch, budget)?))
    })
}

/// Gives the mission of a scenario to `work`, on maps of `W` words.
pub(crate) fn on_mission<const W: usize, T>(
    scenario: &Scenario,
    work: impl for<'m> FnOnce(&'m Mission<'m, W>) -> Result<T, TeamError>,
) -> Result<T, TeamError> {
    on_mission_by(Decider::Inference, scenario, work)
}

/// The same for robots with another decider.
fn on_mission_by<const W: usize, T>(
    decider: Decider,
    scenario: &Scenario,
    work: impl for<'m> FnOnce(&'m Mission<'m, W>) -> Result<T, TeamError>,
) -> Result<T, TeamError> {
    let starts: Vec<Cell> = scenario.robots.iter().map(|robot| robot.start).collect();
    let paths: Vec<&[Path]> = scenario.robots.iter().map(|robot| robot.paths.as_slice()).collect();
    let chargers: Vec<Option<Cell>> = scenario.robots.iter().map(|robot| robot.charger).collect();
    let mut mission = Mission::new(shrunk::<W>(&scenario.map), &starts, &scenario.goals);
    mission.chargers = &chargers;
    let own_goals: Vec<Option<Cell>> = scenario.robots.iter().map(|robot| robot.goal).collect();
    if own_goals.iter().any(Option::is_some) {
        mission.own_goals = &own_goals;
    }
    let owned = own_goals.iter().flatten().count();
    mission.need = u8::try_from(scenario.need.saturating_sub(owned)).ok();
    (mission.waits_for_charging, mission.forgets) = (scenario.waits_for_charging, scenario.forgets);
    if paths.iter().all(|paths| !paths.is_empty()) {
        mission.paths = Some(&paths);
    }
    let unknowns: Vec<_> = scenario.unknowns.iter().map(UnknownSpec::as_known).collect();
    mission.unknowns = &unknowns;
    mission.decider = decider;
    tune(&mut mission, scenario);
    let paces: Vec<u8> = scenario.robots.iter().map(crate::scenario::RobotSpec::steps).collect();
    let sensor = mission.sensor;
    let sensors: Vec<f32> = scenario.robots.iter().map(|robot| robot.sensor.unwrap_or(sensor)).collect();
    if !scenario.inference.alike {
        (mission.paces, mission.sensors) = (&paces, &sensors);
    }
    work(&mission)
}

/// A robot of the team of a mission, by its number.
pub(crate) fn navigating<
    'm,
    const S: usize,
    const W: usize,
    const L: usize,
    const M: usize,
    const K: usize,
>(
    mission: &'m Mission<'m, W>,
    keys: Keys,
    robot: u8,
    epoch: u32,
    budget: u32,
) -> Result<Navigating<'m, S, W, L, M, K>, TeamError> {
    let settings = settings(robot, mission.starts.len(), keys, epoch, NonZero::<u16>::MIN)?;
    Ok(Controller::new(Navigator::new(mission, &settings)?.with_budget(budget), settings, body()))
}

fn settings(
    robot: u8,
    team: usize,
    keys: Keys,
    epoch: u32,
    tick: NonZero<u16>,
) -> Result<Settings, TeamError> {
    Ok(Settings::with_keys(Member::new(RobotId(robot), team)?, keys, epoch, tick))
}

fn tune<const W: usize>(mission: &mut Mission<'_, W>, scenario: &Scenario) {
    let wanted = &scenario.inference;
    let settings = [
        (&mut mission.sensor, wanted.sensor),
        (&mut mission.precision, wanted.precision),
        (&mut mission.habit, wanted.habit),
    ];
    for (setting, value) in settings {
        *setting = value.unwrap_or(*setting);
    }
    mission.policies = wanted.policies.unwrap_or(mission.policies);
    if let Some(learning) = wanted.learning {
        mission.learning = Rates::new(learning, mission.learning.forgetting());
    }
}
