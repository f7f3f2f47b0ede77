//! One mission with many seeds, and its statistics.

use super::run::{Detail, RunError, run};
use super::terms::RunTerms;
use crate::parallel::parallel_map;
use crate::statistics::{Distribution, Share};
use serde::Serialize;
use std::num::NonZeroUsize;

/// The seeds `terms.seed`, `terms.seed + 1` and so on, `seeds` in all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CampaignRuns {
    /// The terms of every run.
    pub terms: RunTerms,
    /// The number of runs.
    pub seeds: u32,
}

/// The findings of a campaign.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Findings {
    /// The share of runs with the bottle truly on the plate.
    pub success: Share,
    /// The share of runs in which robot 1's tree succeeded although it was not.
    pub mistaken: Share,
    /// The ticks of the runs that succeeded.
    pub ticks: Distribution,
    /// Their retries.
    pub retries: Distribution,
    /// Their actions, retries included.
    pub actions: Distribution,
}

/// The summary of one run.
#[derive(Clone, Copy, Debug)]
struct Brief {
    success: bool,
    believed: bool,
    ticks: u32,
    retries: u32,
    actions: u32,
}

impl CampaignRuns {
    /// Runs all seeds, on as many threads as there are cores if that is left open; the findings do
    /// not depend on how many.
    ///
    /// # Errors
    /// [`RunError`] when the terms are none.
    pub fn run(&self, threads: Option<NonZeroUsize>) -> Result<Findings, RunError> {
        let briefs: Result<Vec<_>, _> =
            parallel_map(self.seeds as usize, threads, |index| self.brief(index)).into_iter().collect();
        Ok(Findings::of(&briefs?))
    }

    fn brief(&self, index: usize) -> Result<Brief, RunError> {
        let terms = RunTerms { seed: self.terms.seed.wrapping_add(index as u64), ..self.terms };
        let run = run(&terms, Detail::Outcome)?;
        let actions = run.actions.moves + run.actions.picks + run.actions.placings;
        let (success, believed) = (run.success, run.believed);
        Ok(Brief { success, believed, ticks: run.ticks, retries: run.retries, actions })
    }
}

impl Findings {
    fn of(runs: &[Brief]) -> Self {
        let of = |number: fn(&Brief) -> u32| {
            Distribution::of(runs.iter().filter(|run| run.success).map(|run| f64::from(number(run))))
        };
        Self {
            success: Share::of(runs, |run| run.success),
            mistaken: Share::of(runs, |run| run.believed && !run.success),
            ticks: of(|run| run.ticks),
            retries: of(|run| run.retries),
            actions: of(|run| run.actions),
        }
    }
}
