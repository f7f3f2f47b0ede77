//! Campaigns: a mission flown many times, or many missions, under each disturbance, by several
//! pilots on the same seeds.
//!
//! ```text
//! Campaign ─► Disturbance: the scenario as a seed draws it ─► fly ─► Score: validated
//!                         CampaignReport ◄─ Summary, Comparison ◄────┘
//! ```
//!
//! The flights run in parallel; the report does not depend on the number of threads.
//!
//! ```
//! use host_sim::campaign::{Campaign, Disturbance};
//! use host_sim::{Pilot, library};
//!
//! let scenario = library::find("two-goals").expect("it is built in")?;
//! let pilots = [Pilot::Inference, Pilot::Conventional];
//! let disturbances = [Disturbance::Loss];
//! let scenarios = [scenario];
//! let campaign =
//!     Campaign { scenarios: &scenarios, disturbances: &disturbances, pilots: &pilots, seeds: 5 };
//! let report = campaign.fly(None, &|_, _| ())?;
//! assert_eq!(report.rows[0].summaries[0].accomplished.count, 5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod ablation;
mod cost;
mod disturbance;
mod score;
mod table;
mod validator;

pub use ablation::Ablation;
pub use cost::{Cost, NotMeasured, cost};
pub use disturbance::Disturbance;
pub use score::{Comparison, Score, Summary};
pub use validator::{Trace, Violations};

use crate::fly::{Conditions, fly};
use crate::parallel::parallel_map;
use crate::scenario::Scenario;
use crate::team::Pilot;
use crate::team::TeamError;
use serde::Serialize;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A campaign to fly.
#[doc(alias = "Monte Carlo")]
#[doc(alias = "experiment")]
#[derive(Clone, Copy, Debug)]
pub struct Campaign<'c> {
    /// The missions: seed N flies the N-th from zero, and after the last the first again.
    pub scenarios: &'c [Scenario],
    /// The disturbances, in the order of the report.
    pub disturbances: &'c [Disturbance],
    /// The pilots; the first is compared with each of the others.
    pub pilots: &'c [Pilot],
    /// The number of seeds, from zero on.
    pub seeds: u32,
}

/// The result of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CampaignReport {
    /// The name of the first scenario.
    pub scenario: String,
    /// The number of seeds.
    pub seeds: u32,
    /// A row for each disturbance.
    pub rows: Vec<CampaignRow>,
}

/// All flights under one disturbance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CampaignRow {
    /// The disturbance.
    pub disturbance: Disturbance,
    /// A summary for each pilot.
    pub summaries: Vec<Summary>,
    /// The first pilot compared with each of the others.
    pub comparisons: Vec<Comparison>,
}

impl CampaignReport {
    /// Returns the number of flights of a pilot with a collision.
    #[must_use]
    pub fn collided(&self, pilot: Pilot) -> u32 {
        let summaries = self.rows.iter().flat_map(|row| &row.summaries);
        summaries.filter(|summary| summary.pilot == pilot).map(|summary| summary.collided.count).sum()
    }
}

impl Campaign<'_> {
    /// Returns the number of flights; zero without a scenario.
    #[must_use]
    pub const fn flights(&self) -> usize {
        if self.scenarios.is_empty() {
            return 0;
        }
        self.disturbances.len() * self.pilots.len() * self.seeds as usize
    }

    /// Flies the campaign on `threads` threads; `None` takes one per core.
    ///
    /// `progress` receives the number of flights done and of all flights, from any thread.
    ///
    /// # Errors
    /// [`TeamError`] when a pilot does not accept the mission.
    pub fn fly(
        &self,
        threads: Option<NonZeroUsize>,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<CampaignReport, TeamError> {
        let scores = self.scores(threads, progress)?;
        let mut batches = scores.chunks_exact(self.seeds.max(1) as usize);
        let rows = self.disturbances.iter().map(|&disturbance| {
            let batches: Vec<&[Score]> = batches.by_ref().take(self.pilots.len()).collect();
            self.row(disturbance, &batches)
        });
        let rows = rows.collect();
        let scenario = self.scenarios.first().map_or_else(String::new, |first| first.name.clone());
        Ok(CampaignReport { scenario, seeds: self.seeds, rows })
    }

    fn row(&self, disturbance: Disturbance, batches: &[&[Score]]) -> CampaignRow {
        let summaries =
            self.pilots.iter().zip(batches).map(|(&pilot, scores)| Summary::of(pilot, scores)).collect();
        let mut pairs = self.pilots.iter().zip(batches);
        let comparisons = pairs.next().map(|(&one, first)| {
            pairs.map(|(&other, second)| Comparison::of([one, other], first, second)).collect()
        });
        CampaignRow { disturbance, summaries, comparisons: comparisons.unwrap_or_default() }
    }

    /// Returns the score of every flight: disturbance by disturbance, pilot by pilot, seed by seed.
    ///
    /// # Errors
    /// As [`Campaign::fly`].
    pub fn scores(
        &self,
        threads: Option<NonZeroUsize>,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Vec<Score>, TeamError> {
        let (done, flights) = (AtomicUsize::new(0), self.flights());
        let scores = parallel_map(flights, threads, |flight| {
            let score = self.score(flight);
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, flights);
            score
        });
        scores.into_iter().collect()
    }

    /// Flies one flight.
    fn score(&self, flight: usize) -> Result<Score, TeamError> {
        let (batch, seed) = (flight / self.seeds as usize, (flight % self.seeds as usize) as u64);
        let disturbance = self.disturbances[batch / self.pilots.len()];
        let scenario = disturbance.applied(&self.scenarios[seed as usize % self.scenarios.len()], seed);
        let tree = self.pilots[batch % self.pilots.len()];
        let record = fly(&scenario, Conditions { seed, loss: None, tree }, &mut ())?;
        Ok(Score::of(&scenario, &record))
    }
}
