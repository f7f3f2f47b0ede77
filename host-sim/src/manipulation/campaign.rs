//! The same mission with many seeds, and what they say together.

use super::run::{Detail, RunError, run};
use super::terms::Terms;
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
    pub success: Rate,
    /// How often robot 1's tree succeeded when it was not.
    pub mistaken: Rate,
    /// The ticks of the runs that succeeded.
    pub ticks: Mean,
    /// Their retries.
    pub retries: Mean,
    /// Their actions, retries included.
    pub actions: Mean,
}

/// How often something was so.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rate {
    /// How often it was.
    pub count: u32,
    /// How often it could have been.
    pub of: u32,
    /// count / of; zero of nothing.
    pub rate: f64,
    /// The true probability lies between these with 95 % confidence: the score interval (Wilson 1927).
    pub interval: [f64; 2],
}

/// A mean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mean {
    /// The mean; zero of nothing.
    pub mean: f64,
    /// The true mean lies between these with 95 % confidence, by the normal distribution of means.
    pub interval: [f64; 2],
    /// Of how many.
    pub of: u32,
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

/// 97.5 % of a normal distribution lie below so many standard deviations.
const Z: f64 = 1.959_963_984_540_054;

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
        let count = |is: fn(&Brief) -> bool| runs.iter().filter(|run| is(run)).count() as u32;
        let all = runs.len() as u32;
        let mean = |of: fn(&Brief) -> u32| {
            Mean::of(runs.iter().filter(|run| run.success).map(|run| f64::from(of(run))))
        };
        Self {
            success: Rate::of(count(|run| run.success), all),
            mistaken: Rate::of(count(|run| run.believed && !run.success), all),
            ticks: mean(|run| run.ticks),
            retries: mean(|run| run.retries),
            actions: mean(|run| run.actions),
        }
    }
}

impl Rate {
    /// The rate of `count` in `of`.
    #[must_use]
    pub fn of(count: u32, of: u32) -> Self {
        if of == 0 {
            return Self { count, of, rate: 0.0, interval: [0.0, 1.0] };
        }
        let (n, rate) = (f64::from(of), f64::from(count) / f64::from(of));
        let z2 = Z * Z / n;
        let spread = Z * (rate * (1.0 - rate) / n + z2 / (4.0 * n)).sqrt();
        let interval = [rate + z2 / 2.0 - spread, rate + z2 / 2.0 + spread];
        Self { count, of, rate, interval: interval.map(|bound| (bound / (1.0 + z2)).clamp(0.0, 1.0)) }
    }
}

impl Mean {
    /// The mean of some values.
    #[must_use]
    pub fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let of = values.clone().count() as u32;
        let n = f64::from(of);
        if of == 0 {
            return Self { mean: 0.0, interval: [0.0; 2], of };
        }
        let mean = values.clone().sum::<f64>() / n;
        let squares: f64 = values.map(|value| (value - mean).powi(2)).sum();
        let spread = if of > 1 { Z * (squares / (n - 1.0) / n).sqrt() } else { 0.0 };
        Self { mean, interval: [mean - spread, mean + spread], of }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_has_wilson_s_interval_and_a_mean_that_of_the_normal_distribution() {
        // 81 of 263: Newcombe 1998, "Two-sided confidence intervals for the single proportion", table I.
        let Rate { interval: [low, high], .. } = Rate::of(81, 263);
        assert!((low - 0.2553).abs() < 5e-5 && (high - 0.3662).abs() < 5e-5, "{low} {high}");
        assert_eq!(Rate::of(0, 0).interval, [0.0, 1.0]);
        // 2, 4, 4, 4, 5, 5, 7, 9: mean 5, standard deviation 2.138, of the mean 0.7559.
        let mean = Mean::of([2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].into_iter());
        assert!((mean.mean - 5.0).abs() < 1e-12 && (mean.interval[1] - 5.0 - Z * 0.755_929).abs() < 1e-5);
    }
}
