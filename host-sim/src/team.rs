//! The team: a controller for every robot, each in a body of its own: the firmware's own, or one with a conventional tree.
//!
//! A controller is compiled for a size of map. The sizes are chosen from here; nobody else sees them.

use crate::body::Body;
use crate::conventional::{Conventional, Figure};
use crate::radio::KEY;
use crate::robot::{Robot, shrunk};
use crate::scenario::{MAX_CELLS, MAX_PATHS, Scenario};
use firmware::{Controller, ControllerError, Settings};
use iibt_core::grid::{Cell, Path, words};
use iibt_core::iibt::Mission;
use iibt_core::inference::learning::Rates;
use iibt_core::team::RobotId;
use serde::Serialize;

/// The robots in the order of their numbers.
pub(crate) type Team<'m> = Vec<Box<dyn Robot + 'm>>;

const SMALL: usize = 49;
const MEDIUM: usize = 256;
const EPOCH: u32 = 1;

/// What flies the robots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pilot {
    /// The firmware's tree with its inference node.
    #[default]
    Inference,
    /// The conventional tree of figure 8.
    Conventional,
    /// The conventional tree of figure 5(a), for missions with two goals.
    #[serde(rename = "figure-5")]
    Figure5,
}

impl Pilot {
    /// What it is called on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Inference => "inference",
            Self::Conventional => "conventional",
            Self::Figure5 => "figure-5",
        }
    }

    /// The conventional tree, if it is one.
    const fn figure(self) -> Option<Figure> {
        match self {
            Self::Inference => None,
            Self::Conventional => Some(Figure::Eight),
            Self::Figure5 => Some(Figure::Five),
        }
    }
}

/// Builds the team of a scenario for as long as `fly` lasts.
pub(crate) fn with_team<R>(
    scenario: &Scenario,
    pilot: Pilot,
    fly: impl FnOnce(&mut Team<'_>) -> R,
) -> Result<R, ControllerError> {
    let cells = scenario.map.len();
    if cells <= SMALL {
        sized::<SMALL, { words(SMALL, 1) }, R>(scenario, pilot, fly)
    } else if cells <= MEDIUM {
        sized::<MEDIUM, { words(MEDIUM, 1) }, R>(scenario, pilot, fly)
    } else {
        sized::<MAX_CELLS, { words(MAX_CELLS, 1) }, R>(scenario, pilot, fly)
    }
}

fn sized<const S: usize, const W: usize, R>(
    scenario: &Scenario,
    pilot: Pilot,
    fly: impl FnOnce(&mut Team<'_>) -> R,
) -> Result<R, ControllerError> {
    if let Some(figure) = pilot.figure() {
        let mut team: Team<'_> = Vec::new();
        for robot in 0..scenario.robots.len() as u8 {
            let settings = Settings::new(KEY, EPOCH);
            team.push(Box::new(Conventional::<S, W>::new(scenario, figure, robot, settings)?));
        }
        return Ok(fly(&mut team));
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
    let paces: Vec<u8> = scenario.robots.iter().map(crate::scenario::Robot::steps).collect();
    let sensor = mission.sensor;
    let sensors: Vec<f32> = scenario.robots.iter().map(|robot| robot.sensor.unwrap_or(sensor)).collect();
    if !scenario.inference.alike {
        (mission.paces, mission.sensors) = (&paces, &sensors);
    }
    let mut team: Team<'_> = Vec::new();
    for robot in 0..starts.len() as u8 {
        let settings = Settings::new(KEY, EPOCH);
        let controller =
            Controller::<Body, S, W, MAX_PATHS>::new(&mission, RobotId(robot), settings, Body::default())?;
        team.push(Box::new(controller));
    }
    Ok(fly(&mut team))
}

fn tune<const W: usize>(mission: &mut Mission<'_, W>, scenario: &Scenario) {
    let wanted = &scenario.inference;
    let settings = [
        (&mut mission.sensor, wanted.sensor),
        (&mut mission.peer_sensor, wanted.peer_sensor),
        (&mut mission.haste, wanted.haste),
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
