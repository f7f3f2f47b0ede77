//! The benefit of preferences learned over missions.

use crate::fly::Conditions;
use crate::parallel::parallel_map;
use crate::scenario::Scenario;
use crate::series::{Series, fly_series};
use crate::statistics::{Difference, Distribution};
use crate::{Outcome, campaign};
use serde::Serialize;

/// Series of missions by teams that learn preferences for goals and by teams that do not, on the
/// same seeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LearnedPreferences {
    /// The series of the teams that learn, seed by seed.
    pub learning: Vec<Served>,
    /// The series of the teams that do not learn.
    pub not: Vec<Served>,
}

/// The figures of one series.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Served {
    /// The share of the team that was served in each mission.
    pub shares: Vec<f64>,
    /// The ticks that each mission took.
    pub ticks: Vec<f64>,
    /// The missions in which all arrived together.
    pub together: usize,
    /// The missions with a collision of any kind, by the validator of campaigns.
    pub collided: usize,
}

impl LearnedPreferences {
    /// Flies `seeds` series of a scenario with both teams.
    #[must_use]
    pub fn fly(scenario: &Scenario, seeds: u32) -> Self {
        let flown = |learning| {
            parallel_map(seeds as usize, None, |seed| {
                let conditions = Conditions { seed: seed as u64, ..Conditions::default() };
                let series = fly_series(scenario, conditions, learning, &mut ()).expect("a sound scenario");
                Served::of(scenario, &series)
            })
        };
        Self { learning: flown(true), not: flown(false) }
    }

    /// The share of robots that was served in the last third of the missions, over all series.
    #[must_use]
    pub fn last_third(series: &[Served]) -> Distribution {
        Distribution::of(series.iter().map(|served| late(&served.shares)))
    }

    /// The gain of learning: the difference in the share of robots served in the last third.
    #[must_use]
    pub fn gain(&self) -> Difference {
        let pairs = self.learning.iter().zip(&self.not);
        Difference::of(pairs.map(|(learning, not)| late(&learning.shares) - late(&not.shares)))
    }

    /// The share of robots that was served in each mission, the mean over all series.
    #[must_use]
    pub fn curve(series: &[Served]) -> Vec<f64> {
        let missions = series.first().map_or(0, |served| served.shares.len());
        let mean = |mission| series.iter().map(|served| served.shares[mission]).sum::<f64>();
        (0..missions).map(|mission| mean(mission) / series.len() as f64).collect()
    }

    /// The ticks of a mission in the last third, over all series.
    #[must_use]
    pub fn ticks(series: &[Served]) -> Distribution {
        Distribution::of(series.iter().map(|served| late(&served.ticks)))
    }
}

impl Served {
    fn of(scenario: &Scenario, series: &Series) -> Self {
        let records = || series.missions.iter().map(|mission| &mission.record);
        let collided = |record| campaign::Score::of(scenario, record).has_collided();
        Self {
            shares: series.missions.iter().map(crate::series::SeriesMission::share).collect(),
            ticks: records().map(|record| f64::from(record.last_arrival())).collect(),
            together: records().filter(|record| record.outcome == Outcome::Together).count(),
            collided: records().filter(|record| collided(record)).count(),
        }
    }
}

/// The mean of the last third.
fn late(values: &[f64]) -> f64 {
    let last = &values[values.len() - values.len().div_ceil(3)..];
    last.iter().sum::<f64>() / last.len().max(1) as f64
}
