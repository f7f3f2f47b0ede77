//! Inference trees and conventional ones on the same mission, with the same seeds and the same
//! disturbances.

use super::campaign::{CampaignRuns, Findings};
use super::run::RunError;
use super::terms::{Disturbances, Order, RunTerms, Trees, Trust};
use serde::Serialize;

/// A contender.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contender {
    /// Its description.
    pub name: &'static str,
    /// Its trees.
    pub trees: Trees,
    /// The order of fetching, in inference nodes.
    pub order: Order,
    /// The readings that conventional leaves trust.
    pub trust: Trust,
}

/// One contender at one level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Compared {
    /// Its description.
    pub contender: &'static str,
    /// The share of grasps that fail, and of readings that are wrong.
    pub level: f64,
    /// The findings of its runs.
    pub findings: Findings,
}

/// The shares of failed grasps and wrong readings at which contenders are compared.
pub const LEVELS: [f64; 4] = [0.0, 0.1, 0.2, 0.3];

const fn inference(name: &'static str, order: Order) -> Contender {
    Contender { name, trees: Trees::Inference, order, trust: Trust::DEFAULT }
}

const fn conventional(name: &'static str, trees: Trees, trust: Trust) -> Contender {
    Contender { name, trees, order: Order::InTurn, trust }
}

/// The contenders. A conventional tree that trusts readings has to choose how many in a row should
/// agree, between fast and safe: the three next to the best are here. One that asks the inference
/// nodes' own belief shows what is the belief's doing and what the tree's.
pub const CONTENDERS: [Contender; 7] = [
    inference("inference, in turn", Order::InTurn),
    inference("inference, both at once", Order::Together),
    conventional("conventional, the same belief", Trees::Conventional, Trust::Belief),
    conventional("conventional, 2 equal readings", Trees::Conventional, Trust::Equal(2)),
    conventional("conventional, 3 equal readings", Trees::Conventional, Trust::Equal(3)),
    conventional("conventional, 4 equal readings", Trees::Conventional, Trust::Equal(4)),
    conventional("table 6, 3 equal readings", Trees::Table6, Trust::Equal(3)),
];

/// Runs `seeds` seeds from `seed` on for every level and contender, level by level.
///
/// # Errors
/// None that can occur with the built-in trees.
pub fn compare(seed: u64, seeds: u32) -> Result<Vec<Compared>, RunError> {
    let pairs = LEVELS.into_iter().flat_map(|level| CONTENDERS.map(|contender| (level, contender)));
    let one = |(level, contender): (f64, Contender)| {
        let disturbances = Disturbances { wrong_readings: level, failed_grasps: level, ..Disturbances::NONE };
        let Contender { name, trees, order, trust } = contender;
        let terms = RunTerms { trees, order, trust, disturbances, ..RunTerms::new(seed) };
        let findings = CampaignRuns { terms, seeds }.run(None)?;
        Ok(Compared { contender: name, level, findings })
    };
    pairs.map(one).collect()
}
