//! Campaigns: a mission flown many times, under trouble of many kinds, by several pilots on the same seeds.
//!
//! ```text
//! Campaign ─► Disturbance: the scenario as a seed draws it ─► fly ─► Score: validated ─► Summary, Comparison ─► Report
//! ```
//!
//! The flights are shared out among threads; the report does not depend on how many there are.
//!
//! ```
//! use host_sim::campaign::{Campaign, Disturbance};
//! use host_sim::{Pilot, library};
//!
//! let scenario = library::find("two-goals").expect("it is built in")?;
//! let pilots = [Pilot::Inference, Pilot::Conventional];
//! let campaign = Campaign { scenario: &scenario, disturbances: &[Disturbance::Loss], pilots: &pilots, seeds: 5 };
//! let report = campaign.fly(None, &|_, _| ())?;
//! assert_eq!(report.rows[0].summaries[0].accomplished.count, 5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cost;
mod disturbance;
mod score;
mod table;
mod validator;

pub use cost::{Cost, NotMeasured, cost};
pub use disturbance::Disturbance;
pub use score::{Comparison, Score, Summary};
pub use validator::{Faults, Trace};

use crate::fly::{Conditions, fly};
use crate::scenario::Scenario;
use crate::team::Pilot;
use crate::team::TeamError;
use crate::workers::share_out;
use serde::Serialize;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What is to be flown.
#[derive(Clone, Copy, Debug)]
pub struct Campaign<'c> {
    /// The mission.
    pub scenario: &'c Scenario,
    /// The trouble, one after the other.
    pub disturbances: &'c [Disturbance],
    /// Who flies; the first two are compared.
    pub pilots: &'c [Pilot],
    /// How many seeds, from zero on.
    pub seeds: u32,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The scenario's name.
    pub scenario: String,
    /// The number of seeds.
    pub seeds: u32,
    /// A row for each disturbance.
    pub rows: Vec<Row>,
}

/// All flights under one disturbance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The disturbance.
    pub disturbance: Disturbance,
    /// A summary for each pilot.
    pub summaries: Vec<Summary>,
    /// The first pilot compared with the second; `None` with a single one.
    pub comparison: Option<Comparison>,
}

impl Report {
    /// The flights of a pilot that had a collision.
    #[must_use]
    pub fn collided(&self, pilot: Pilot) -> u32 {
        let summaries = self.rows.iter().flat_map(|row| &row.summaries);
        summaries.filter(|summary| summary.pilot == pilot).map(|summary| summary.collided.count).sum()
    }
}

impl Campaign<'_> {
    /// How many flights it has.
    #[must_use]
    pub const fn flights(&self) -> usize {
        self.disturbances.len() * self.pilots.len() * self.seeds as usize
    }

    /// Flies it with so many threads, as many as there are cores if that is left open. `progress` is told the flights that are
    /// done and how many there are, from any thread.
    ///
    /// # Errors
    /// [`TeamError`] when a pilot does not accept the mission.
    pub fn fly(
        &self,
        threads: Option<NonZeroUsize>,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Report, TeamError> {
        let scores = self.scores(threads, progress)?;
        let mut batches = scores.chunks_exact(self.seeds.max(1) as usize);
        let rows = self.disturbances.iter().map(|&disturbance| {
            let batches: Vec<&[Score]> = batches.by_ref().take(self.pilots.len()).collect();
            self.row(disturbance, &batches)
        });
        let rows = rows.collect();
        Ok(Report { scenario: self.scenario.name.clone(), seeds: self.seeds, rows })
    }

    fn row(&self, disturbance: Disturbance, batches: &[&[Score]]) -> Row {
        let summaries =
            self.pilots.iter().zip(batches).map(|(&pilot, scores)| Summary::of(pilot, scores)).collect();
        let comparison = match (self.pilots, batches) {
            (&[one, other, ..], [first, second, ..]) => Some(Comparison::of([one, other], first, second)),
            _ => None,
        };
        Row { disturbance, summaries, comparison }
    }

    /// Every flight: disturbance by disturbance, pilot by pilot, seed by seed.
    ///
    /// # Errors
    /// As [`Campaign::fly`].
    pub fn scores(
        &self,
        threads: Option<NonZeroUsize>,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Vec<Score>, TeamError> {
        let (done, flights) = (AtomicUsize::new(0), self.flights());
        let scores = share_out(flights, threads, |flight| {
            let score = self.score(flight);
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, flights);
            score
        });
        scores.into_iter().collect()
    }

    /// Flies one of them.
    fn score(&self, flight: usize) -> Result<Score, TeamError> {
        let (batch, seed) = (flight / self.seeds as usize, (flight % self.seeds as usize) as u64);
        let disturbance = self.disturbances[batch / self.pilots.len()];
        let scenario = disturbance.applied(self.scenario, seed);
        let tree = self.pilots[batch % self.pilots.len()];
        let record = fly(&scenario, Conditions { seed, loss: None, tree }, &mut ())?;
        Ok(Score::of(&scenario, &record))
    }
}
