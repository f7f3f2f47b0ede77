//! The plans of a robot, their preconditions, and the response to an unmet one (the paper's table
//! 2).

use crate::iibt::rules::{Raise, Rule};
use crate::iibt::{Condition, Literal, Logic};

/// Exist(obstacle): an obstacle that is not on the map lies on the rest of the path.
pub const OBSTACLE: u8 = 0;
/// IsArrived(goal): the path is done and the robot stands on a goal.
pub const ARRIVED: u8 = 1;
/// Exist(way): the path leads to a goal. No preference can make it true, so the node waits for the
/// world or the teammates to change, and fails at its timeout.
pub const REACHABLE: u8 = 2;
/// IsArrived(points): the rest of the path leads over every open way-point, in their order.
pub const VISITED: u8 = 3;

/// A choice of the inference node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NavigationPlan {
    /// Stand still for now: the wait policy.
    Wait,
    /// Commit to the candidate with this index.
    Take(usize),
    /// Follow the path that was announced.
    Follow,
}

impl NavigationPlan {
    /// Returns the precondition of the plan.
    #[must_use]
    pub const fn precondition(self) -> Condition {
        match self {
            Self::Wait => Condition::ALWAYS,
            Self::Take(_) | Self::Follow => {
                Condition { all: Logic::of(&[REACHABLE, VISITED]), none: Logic::of(&[OBSTACLE, ARRIVED]) }
            }
        }
    }
}

/// f_L. An obstacle on the way is avoided with -1, the value behind the paper's numbers; its table
/// prints -(max(C) + 1).
pub const RULES: [Rule; 3] = [
    Rule { missing: Literal { variable: OBSTACLE, value: false }, raise: Raise::By(-1.0) },
    Rule { missing: Literal { variable: ARRIVED, value: true }, raise: Raise::AboveAll },
    Rule { missing: Literal { variable: VISITED, value: true }, raise: Raise::AboveAll },
];
