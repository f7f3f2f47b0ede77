//! The team: a controller for every robot, each in a body of its own. It is the firmware's own, or
//! one with a conventional tree.
//!
//! A controller is compiled for a size of map; this module alone chooses the size.

use crate::body::{Body, body};
use crate::conventional::{ConventionalRobot, ConventionalTree, period};
use crate::radio::KEY;
use crate::robot::{AnyRobot, shrunk};
use crate::scenario::{MAX_CELLS, MAX_PATHS, Scenario};
use clap::ValueEnum;
use firmware::{Controller, Navigator, Settings};
use iibt_core::grid::{Cell, Path, words};
use iibt_core::inference::learning::Rates;
use iibt_core::navigation::{Mission, MissionError};
use iibt_core::team::{Key, Member, MemberError, RobotId};
use serde::Serialize;
use std::num::NonZero;
use thiserror::Error;

/// A navigating robot with the firmware's controller in a simulated body.
pub type Navigating<'m, const S: usize, const W: usize, const P: usize> =
    Controller<Navigator<'m, S, W, P>, Body>;

/// Builds the controller of a robot by its number and the epoch of its start.
pub(crate) type Boot<'m, R> = Box<dyn Fn(u8, u32) -> Result<Box<R>, TeamError> + 'm>;

const SMALL: usize = 49;
const MEDIUM: usize = 256;

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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Pilot {
    /// The firmware's tree with its inference node.
    #[default]
    Inference,
    /// The conventional tree of figure 8.
    Conventional,
    /// The conventional tree of figure 5(a), for missions with two goals.
    #[serde(rename = "figure-5")]
    #[value(name = "figure-5")]
    Figure5,
}

impl Pilot {
    /// The name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Inference => "inference",
            Self::Conventional => "conventional",
            Self::Figure5 => "figure-5",
        }
    }

    /// The conventional tree, if it is one.
    const fn figure(self) -> Option<ConventionalTree> {
        match self {
            Self::Inference => None,
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
    if cells <= SMALL {
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
            let settings = settings(robot, team, KEY, epoch, period(scenario))?;
            let robot = ConventionalRobot::<S, W>::new(scenario, figure, &settings)?;
            Ok(Box::new(Controller::new(robot, settings, body())))
        }));
    }
    let starts: Vec<Cell> = scenario.robots.iter().map(|robot| robot.start).collect();
    let paths: Vec<&[Path]> = scenario.robots.iter().map(|robot| robot.paths.as_slice()).collect();
    let chargers: Vec<Option<Cell>> = scenario.robots.iter().map(|robot| robot.charger).collect();
    let mut mission = Mission::new(shrunk::<W>(&scenario.map), &starts, &scenario.goals);
    mission.chargers = &chargers;
    if paths.iter().all(|paths| !paths.is_empty()) {
        mission.candidates = Some(&paths);
    }
    tune(&mut mission, scenario);
    let paces: Vec<u8> = scenario.robots.iter().map(crate::scenario::RobotSpec::steps).collect();
    let sensor = mission.sensor;
    let sensors: Vec<f32> = scenario.robots.iter().map(|robot| robot.sensor.unwrap_or(sensor)).collect();
    if !scenario.inference.alike {
        (mission.paces, mission.sensors) = (&paces, &sensors);
    }
    fly(Box::new(|robot, epoch| Ok(Box::new(navigating::<S, W, MAX_PATHS>(&mission, KEY, robot, epoch)?))))
}

/// A robot of the team of a mission, by its number.
pub(crate) fn navigating<'m, const S: usize, const W: usize, const P: usize>(
    mission: &'m Mission<'m, W>,
    key: Key,
    robot: u8,
    epoch: u32,
) -> Result<Navigating<'m, S, W, P>, TeamError> {
    let settings = settings(robot, mission.starts.len(), key, epoch, NonZero::<u16>::MIN)?;
    Ok(Controller::new(Navigator::new(mission, &settings)?, settings, body()))
}

fn settings(robot: u8, team: usize, key: Key, epoch: u32, tick: NonZero<u16>) -> Result<Settings, TeamError> {
    Ok(Settings::new(Member::new(RobotId(robot), team)?, key, epoch, tick))
}

fn tune<const W: usize>(mission: &mut Mission<'_, W>, scenario: &Scenario) {
    let wanted = &scenario.inference;
    let settings = [
        (&mut mission.sensor, wanted.sensor),
        (&mut mission.peer_sensor, wanted.peer_sensor),
        (&mut mission.lateness_cost, wanted.lateness_cost),
        (&mut mission.collision, wanted.collision),
        (&mut mission.scoring.precision, wanted.precision),
    ];
    for (setting, value) in settings {
        *setting = value.unwrap_or(*setting);
    }
    if let Some(learning) = wanted.learning {
        mission.learning = Rates::new(learning, mission.learning.forgetting());
    }
}
