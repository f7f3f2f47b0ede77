//! The terms of a handling mission.

use super::tables::SENSOR;
use serde::Serialize;

/// Who fetches when.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Order {
    /// One after the other; both leave for the meeting place together.
    #[default]
    InTurn,
    /// Both at once.
    Together,
}

/// The numbers by which joint policies are judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// How likely a reading is right; each of the others has an equal share of the rest.
    pub sensor: f32,
    /// How likely an action is taken to bring its state about when policies are compared; else the
    /// robot is free.
    pub success: f32,
    /// γ, the precision.
    pub precision: f32,
}

impl Preset {
    /// Nothing tuned: actions are judged by their effects, and γ is one.
    pub const DEFAULT: Self = Self { sensor: SENSOR, success: 1.0, precision: 1.0 };

    /// The reported probabilities to a thousandth. The pair of success and precision is one of
    /// several that give them.
    pub const CALIBRATED: Self = Self { success: 0.863, precision: 1.381, ..Self::DEFAULT };
}

/// The trees of the robots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Trees {
    /// Figure 14: inference nodes.
    #[default]
    Inference,
    /// Conventional trees in the usual style: reactive, with each part checking its own conditions.
    Conventional,
    /// A conventional tree for robot 1 with the node counts of table 6.
    #[value(name = "table-6")]
    Table6,
    /// Figure 14 with figures 15 and 16 in the place of its inference nodes, as drawn.
    AsDrawn,
}

/// The readings that the leaves of a conventional tree trust.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trust {
    /// A number of equal readings in a row, at least one.
    Equal(u8),
    /// The states that the inference nodes' belief is sure of: the same filter under another tree.
    Belief,
}

impl Trust {
    /// Three equal readings: with one in ten wrong, two are faster and end one mission in a hundred
    /// by mistake.
    pub const DEFAULT: Self = Self::Equal(3);
}

/// The probabilities of disturbances.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Disturbances {
    /// That a reading, of the place or of the state, is wrong; which wrong one is even.
    pub wrong_readings: f64,
    /// That a pick fails and leaves the thing where it is.
    pub failed_grasps: f64,
    /// That a move fails and leaves the robot where it is.
    pub failed_moves: f64,
    /// That placing fails and leaves the thing in the grip.
    pub failed_placings: f64,
    /// That a frame does not reach the teammate.
    pub loss: f64,
}

impl Disturbances {
    /// No disturbances.
    pub const NONE: Self =
        Self { wrong_readings: 0.0, failed_grasps: 0.0, failed_moves: 0.0, failed_placings: 0.0, loss: 0.0 };

    /// One grasp in ten fails, one reading in ten is wrong.
    pub const TENTH: Self = Self { wrong_readings: 0.1, failed_grasps: 0.1, ..Self::NONE };
}

/// The terms of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunTerms {
    /// The seed of all chance.
    pub seed: u64,
    /// The trees of the robots.
    pub trees: Trees,
    /// The disturbances.
    pub disturbances: Disturbances,
    /// The numbers of the inference nodes.
    pub preset: Preset,
    /// The order of fetching, in the inference nodes.
    pub order: Order,
    /// The readings that conventional leaves trust.
    pub trust: Trust,
    /// The limit of a run in ticks.
    pub max_ticks: u32,
}

impl RunTerms {
    /// The default mission with a seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self {
            seed,
            trees: Trees::Inference,
            disturbances: Disturbances::TENTH,
            preset: Preset::DEFAULT,
            order: Order::InTurn,
            trust: Trust::DEFAULT,
            max_ticks: 600,
        }
    }
}
