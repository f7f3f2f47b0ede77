//! The events of a flight that are shown and recorded.

use crate::awaited::Awaited;
use crate::beliefs::told;
use crate::phases::WeighedPolicy;
use crate::scenario::{Device, Scenario};
use crate::text::route;
use iibt_core::grid::Cell;
use serde::Serialize;

/// An event of a flight. Robots are named by their index in the scenario, from zero.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum FlightEvent {
    /// An obstacle appeared.
    Appeared {
        /// Where.
        cell: Cell,
    },
    /// An obstacle was taken away.
    Cleared {
        /// Where.
        cell: Cell,
    },
    /// A robot observed an obstacle that no robot had observed.
    Found {
        /// Who.
        robot: usize,
        /// Where.
        cell: Cell,
    },
    /// A robot chose a policy.
    Chose {
        /// Who.
        robot: usize,
        /// In which round.
        round: u32,
        /// The goal it leads to.
        goal: Cell,
        /// The cells of its path, from where it stands.
        path: Vec<Cell>,
        /// The posterior probability of the choice.
        probability: f32,
    },
    /// The joint policies of a round were weighed, of a mission of which not all is known.
    Weighed {
        /// In which round.
        round: u32,
        /// How many there are.
        policies: usize,
        /// The place of the best one in the list, from zero, and its terms.
        best: (usize, WeighedPolicy),
        /// The same of the next best one.
        next: Option<(usize, WeighedPolicy)>,
    },
    /// A robot believes something else about what is not known.
    Believes {
        /// Who.
        robot: usize,
        /// The probability of each value of each unknown.
        unknowns: Vec<Vec<f32>>,
        /// The probability of each world: the value of the last unknown changes fastest.
        worlds: Vec<f32>,
    },
    /// All members of the round know the joint plan.
    Agreed {
        /// In which round.
        round: u32,
    },
    /// A robot stands on its goal.
    Arrived {
        /// Who.
        robot: usize,
        /// Where it stands in truth.
        cell: Cell,
    },
    /// A robot was told to visit a cell before its goal.
    Asked {
        /// Who.
        robot: usize,
        /// Where.
        cell: Cell,
    },
    /// A robot was told to visit a cell, but there is an obstacle or no room for another way-point.
    Refused {
        /// Who.
        robot: usize,
        /// Where.
        cell: Cell,
    },
    /// A robot has visited a way-point according to its belief.
    Visited {
        /// Who.
        robot: usize,
        /// Which.
        cell: Cell,
    },
    /// A robot has taken over a way-point of a lost teammate.
    TookOver {
        /// Who.
        robot: usize,
        /// Which.
        cell: Cell,
    },
    /// A robot has a way-point no more without a visit: a teammate has taken it over, or the robot
    /// has started again.
    GaveUp {
        /// Who.
        robot: usize,
        /// Which.
        cell: Cell,
    },
    /// A robot has seen an obstacle on the way-point, and goes on without a visit until it is gone.
    Obstructed {
        /// Who.
        robot: usize,
        /// Which.
        cell: Cell,
    },
    /// A robot's battery fell.
    Drained {
        /// Whose.
        robot: usize,
        /// To how many percent.
        charge: u8,
    },
    /// A robot goes to charge its battery.
    Left {
        /// Who.
        robot: usize,
        /// Its charge in percent.
        charge: u8,
    },
    /// A robot has charged its battery.
    Returned {
        /// Who.
        robot: usize,
        /// Its charge in percent.
        charge: u8,
    },
    /// A robot stopped.
    Stopped {
        /// Who.
        robot: usize,
    },
    /// A robot that had stopped goes on.
    Resumed {
        /// Who.
        robot: usize,
    },
    /// A device of a robot froze.
    Froze {
        /// Whose.
        robot: usize,
        /// Which.
        device: Device,
    },
    /// A device of a robot that was frozen works again.
    Thawed {
        /// Whose.
        robot: usize,
        /// Which.
        device: Device,
    },
    /// A robot restarted, without its memory.
    Restarted {
        /// Who.
        robot: usize,
    },
    /// A robot has waited for the same for a while.
    Waits {
        /// Who.
        robot: usize,
        /// What it waits for.
        #[serde(rename = "for")]
        awaited: Awaited,
    },
    /// Robots shared or swapped cells, or ran into something.
    Collided {
        /// How often in this tick.
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
            Self::Cleared { cell } => format!("the obstacle at {} is gone", cell.0),
            Self::Found { robot, cell } => format!("{} finds the obstacle at {}", name(*robot), cell.0),
            Self::Chose { robot, goal, path, probability, .. } => format!(
                "{} chooses goal {} by {}, probability {probability:.3}",
                name(*robot),
                goal.0,
                route(path)
            ),
            Self::Weighed { round, policies, best, next } => {
                let (best, others) = (
                    weighed(*best),
                    next.map_or_else(String::new, |next| format!("; next {}", weighed(next))),
                );
                format!("round {round} weighs {policies} policies: {best}{others}")
            }
            Self::Believes { robot, unknowns, .. } => {
                format!("{} believes: {}", name(*robot), told(&scenario.unknowns, unknowns))
            }
            Self::Agreed { round } => format!("all know the plan (round {round})"),
            Self::Arrived { robot, cell } => format!("{} has arrived at {}", name(*robot), cell.0),
            Self::Asked { robot, cell } => format!("{} is to visit {}", name(*robot), cell.0),
            Self::Refused { robot, cell } => format!("{} cannot visit {}", name(*robot), cell.0),
            Self::Visited { robot, cell } => format!("{} visits {}", name(*robot), cell.0),
            Self::TookOver { robot, cell } => format!("{} takes over the way-point {}", name(*robot), cell.0),
            Self::GaveUp { robot, cell } => format!("{} gives up the way-point {}", name(*robot), cell.0),
            Self::Obstructed { robot, cell } => {
                format!("{} does not visit {}: an obstacle is on it", name(*robot), cell.0)
            }
            Self::Drained { robot, charge } => {
                format!("the battery of {} falls to {charge} %", name(*robot))
            }
            Self::Left { robot, charge } => {
                format!("{} leaves to charge with {charge} % in its battery", name(*robot))
            }
            Self::Returned { robot, charge } => format!("{} is back with {charge} %", name(*robot)),
            Self::Stopped { robot } => format!("{} stops", name(*robot)),
            Self::Resumed { robot } => format!("{} goes on", name(*robot)),
            Self::Froze { robot, device } => format!("the {} of {} freezes", device.name(), name(*robot)),
            Self::Thawed { robot, device } => {
                format!("the {} of {} works again", device.name(), name(*robot))
            }
            Self::Restarted { robot } => format!("{} restarts", name(*robot)),
            Self::Waits { robot, awaited } => format!("{} stands, {awaited}", name(*robot)),
            Self::Collided { times } => format!("COLLISION ({times})"),
        }
    }
}

/// A policy by its place in the list, and what it takes.
fn weighed((place, policy): (usize, WeighedPolicy)) -> String {
    let WeighedPolicy { total, epistemic, probability, .. } = policy;
    let ticks = total.map_or_else(|| "no".to_owned(), |total| format!("{total:.1}"));
    let seen =
        if epistemic > 0.0 { format!(" ({epistemic:.1} saved by what will be seen)") } else { String::new() };
    format!("{place} in {ticks} ticks{seen} with {probability:.3}")
}
