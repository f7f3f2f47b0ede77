//! The events of a flight that are shown and recorded.

use crate::scenario::Scenario;
use crate::text::route;
use iibt_core::grid::Cell;
use serde::Serialize;

/// An event of a flight. Robots are named by their index in the scenario, from zero.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum FlightEvent {
    /// An obstacle appeared.
    Appeared {
        /// The cell.
        cell: Cell,
    },
    /// A robot observed an obstacle that no robot had observed.
    Found {
        /// The robot, by its index.
        robot: usize,
        /// The cell.
        cell: Cell,
    },
    /// A robot chose a policy.
    Chose {
        /// The robot, by its index.
        robot: usize,
        /// The round.
        round: u16,
        /// The goal it leads to.
        goal: Cell,
        /// The cells of its path, from where it stands.
        path: Vec<Cell>,
        /// The posterior probability of the choice.
        probability: f32,
    },
    /// All robots know each other's choices and will follow their own.
    Agreed {
        /// The round.
        round: u16,
    },
    /// A robot stands on its goal.
    Arrived {
        /// The robot, by its index.
        robot: usize,
        /// Its true cell.
        cell: Cell,
    },
    /// A robot was told to visit a cell before its goal.
    Asked {
        /// The robot, by its index.
        robot: usize,
        /// The cell.
        cell: Cell,
    },
    /// A robot was told to visit a cell, but there is an obstacle or no room for another way-point.
    Refused {
        /// The robot, by its index.
        robot: usize,
        /// The cell.
        cell: Cell,
    },
    /// A robot has visited a way-point according to its belief.
    Visited {
        /// The robot, by its index.
        robot: usize,
        /// The way-point.
        cell: Cell,
    },
    /// A robot's battery fell.
    Drained {
        /// The robot, by its index.
        robot: usize,
        /// The charge afterwards, in percent.
        charge: u8,
    },
    /// A robot left the team, to charge or to step out of a teammate's way.
    Left {
        /// The robot, by its index.
        robot: usize,
        /// Its charge in percent.
        charge: u8,
    },
    /// A robot is back and takes part again.
    Returned {
        /// The robot, by its index.
        robot: usize,
        /// Its charge in percent.
        charge: u8,
    },
    /// A robot stopped.
    Stopped {
        /// The robot, by its index.
        robot: usize,
    },
    /// A robot that had stopped goes on.
    Resumed {
        /// The robot, by its index.
        robot: usize,
    },
    /// Robots shared or swapped cells, or ran into something.
    Collided {
        /// The number of collisions in this tick.
        times: u32,
    },
}

impl FlightEvent {
    /// Returns the event in one line of text.
    #[must_use]
    pub fn line(&self, scenario: &Scenario) -> String {
        let name = |robot: usize| scenario.robots.get(robot).map_or("?", |robot| robot.name.as_str());
        match self {
            Self::Appeared { cell } => format!("an obstacle appears at {}", cell.0),
            Self::Found { robot, cell } => format!("{} finds the obstacle at {}", name(*robot), cell.0),
            Self::Chose { robot, goal, path, probability, .. } => format!(
                "{} chooses goal {} by {}, probability {probability:.3}",
                name(*robot),
                goal.0,
                route(path)
            ),
            Self::Agreed { round } => format!("all agree (round {round})"),
            Self::Arrived { robot, cell } => format!("{} has arrived at {}", name(*robot), cell.0),
            Self::Asked { robot, cell } => format!("{} is to visit {}", name(*robot), cell.0),
            Self::Refused { robot, cell } => format!("{} cannot visit {}", name(*robot), cell.0),
            Self::Visited { robot, cell } => format!("{} visits {}", name(*robot), cell.0),
            Self::Drained { robot, charge } => {
                format!("the battery of {} falls to {charge} %", name(*robot))
            }
            Self::Left { robot, charge } => {
                format!("{} leaves the team with {charge} % in its battery", name(*robot))
            }
            Self::Returned { robot, charge } => format!("{} is back with {charge} %", name(*robot)),
            Self::Stopped { robot } => format!("{} stops", name(*robot)),
            Self::Resumed { robot } => format!("{} goes on", name(*robot)),
            Self::Collided { times } => format!("COLLISION ({times})"),
        }
    }
}
