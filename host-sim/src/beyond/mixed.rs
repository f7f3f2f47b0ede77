//! Heterogeneous teams: the benefit of knowing the differences.

use super::score;
use crate::campaign::Score;
use crate::parallel::parallel_map;
use crate::random::{Random, Stream};
use crate::scenario::Scenario;
use crate::statistics::{Difference, Distribution, Share};
use iibt_core::grid::Cell;
use serde::Serialize;

/// The property in which the robots of a team differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unlike {
    /// In their paces and in their sensors, as the scenario has them.
    Both,
    /// In their paces; all localisers are right.
    Paces,
    /// In their sensors; all are as fast as the fastest.
    Sensors,
}

/// A team that knows the differences between its robots against one that ignores them: missions
/// with starts and goals drawn for each seed on the same map, the same for both.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mixed {
    /// The property that differs.
    pub unlike: Unlike,
    /// The scores of the teams that know, seed by seed.
    #[serde(skip)]
    pub known: Vec<Score>,
    /// The scores of the teams that ignore the differences, seed by seed.
    #[serde(skip)]
    pub alike: Vec<Score>,
}

impl Unlike {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Both, Self::Paces, Self::Sensors];

    /// The scenario with only these differences left.
    fn only(self, scenario: &Scenario) -> Scenario {
        let mut left = scenario.clone();
        for robot in &mut left.robots {
            if self == Self::Paces {
                (robot.localiser, robot.sensor, robot.view) = (1.0, None, 1);
            }
            if self == Self::Sensors {
                robot.pace = 1;
            }
        }
        left
    }
}

impl Mixed {
    /// Flies `seeds` missions like those of a scenario, with both teams.
    #[must_use]
    pub fn fly(scenario: &Scenario, unlike: Unlike, seeds: u32) -> Self {
        let scenario = unlike.only(scenario);
        let flown = |alike: bool| {
            parallel_map(seeds as usize, None, |seed| {
                let mut drawn = drawn(&scenario, seed as u64);
                drawn.inference.alike = alike;
                score(&drawn, seed as u64)
            })
        };
        Self { unlike, known: flown(false), alike: flown(true) }
    }

    /// The ticks after which all robots stood at their goals, in the flights of a team that got
    /// there.
    #[must_use]
    pub fn ticks(scores: &[Score]) -> Distribution {
        let done = scores.iter().filter(|score| score.accomplished);
        Distribution::of(done.map(|score| f64::from(score.ticks)))
    }

    /// The share of missions that were accomplished.
    #[must_use]
    pub fn accomplished(scores: &[Score]) -> Share {
        Share::of(scores, |score| score.accomplished)
    }

    /// The ticks that knowing saves: the difference in missions that both teams accomplished.
    #[must_use]
    pub fn saved(&self) -> Difference {
        let pairs = self.known.iter().zip(&self.alike);
        let both = pairs.filter(|(known, alike)| known.accomplished && alike.accomplished);
        Difference::of(both.map(|(known, alike)| f64::from(alike.ticks) - f64::from(known.ticks)))
    }
}

/// The scenario with other starts and other goals, as many as it has.
fn drawn(scenario: &Scenario, seed: u64) -> Scenario {
    let mut random = Random::of(seed, Stream::Place);
    let mut free: Vec<Cell> =
        (0..scenario.map.len() as u16).map(Cell).filter(|&cell| scenario.map.is_free(cell)).collect();
    let mut draw = || free.swap_remove(random.below(free.len()));
    let mut drawn = scenario.clone();
    drawn.robots.iter_mut().for_each(|robot| robot.start = draw());
    drawn.goals.iter_mut().for_each(|goal| *goal = draw());
    drawn
}
