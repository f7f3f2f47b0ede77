//! The same mission with many seeds, and what they say together.

use super::run::{Detail, RunError, run};
use super::terms::Terms;
use crate::statistics::{Distribution, Share};
use serde::Serialize;
use std::thread;

/// The seeds `terms.seed`, `terms.seed + 1` and so on, `seeds` in all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Campaign {
    /// What every run has in common.
    pub terms: Terms,
    /// How many runs.
    pub seeds: u32,
}

/// What came of a campaign.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Findings {
    /// How often the bottle is on the plate, in truth.
    pub success: Share,
    /// How often robot 1's tree succeeded when it was not.
    pub mistaken: Share,
    /// The ticks of the runs that succeeded.
    pub ticks: Distribution,
    /// Their retries.
    pub retries: Distribution,
    /// Their actions, retries included.
    pub actions: Distribution,
}

/// One run in short.
#[derive(Clone, Copy, Debug)]
struct Brief {
    success: bool,
    believed: bool,
    ticks: u32,
    retries: u32,
    actions: u32,
}

impl Campaign {
    /// Runs all seeds on `threads` threads, one at the least; the findings do not depend on how many.
    ///
    /// # Errors
    /// [`RunError`] when the terms are none.
    pub fn run(&self, threads: usize) -> Result<Findings, RunError> {
        let share = self.seeds.div_ceil(threads.clamp(1, 64) as u32).max(1);
        let parts = (0..self.seeds).step_by(share as usize);
        let briefs: Result<Vec<Vec<Brief>>, RunError> = thread::scope(|scope| {
            let workers: Vec<_> = parts
                .map(|from| scope.spawn(move || self.part(from, (from + share).min(self.seeds))))
                .collect();
            workers
                .into_iter()
                .map(|worker| worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
                .collect()
        });
        Ok(Findings::of(&briefs?.concat()))
    }

    fn part(&self, from: u32, to: u32) -> Result<Vec<Brief>, RunError> {
        let one = |index: u32| {
            let terms = Terms { seed: self.terms.seed.wrapping_add(u64::from(index)), ..self.terms };
            let run = run(&terms, Detail::Outcome)?;
            let actions = run.actions.moves + run.actions.picks + run.actions.placings;
            let (success, believed) = (run.success, run.believed);
            Ok(Brief { success, believed, ticks: run.ticks, retries: run.retries, actions })
        };
        (from..to).map(one).collect()
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
