//! Campaigns of a task file at several levels of disturbance.

use super::flight::Flown;
use super::mission::{TaskError, Trouble};
use super::read::TableMission;
use crate::parallel::parallel_map;
use crate::statistics::{Distribution, Share};
use serde::Serialize;
use std::num::NonZeroUsize;

/// The share of wrong readings and of failed actions of each level.
pub const LEVELS: [f64; 4] = [0.0, 0.1, 0.2, 0.3];

/// The result of the flights at one level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Level {
    /// The share of readings that are wrong and of actions that fail.
    pub level: f64,
    /// The share of flights that truly accomplished the task.
    pub success: Share,
    /// The share of flights in which the robots wrongly believed so.
    pub mistaken: Share,
    /// The ticks of the flights that succeeded.
    pub ticks: Distribution,
    /// Their actions.
    pub actions: Distribution,
}

impl TableMission<'_> {
    /// Flies `seeds` seeds from zero on at every level, on as many threads as there are cores if
    /// that is left open; the figures do not depend on how many.
    ///
    /// # Errors
    /// [`TaskError`] when the simulator has no room for the task.
    pub fn campaign(&self, seeds: u32, threads: Option<NonZeroUsize>) -> Result<Vec<Level>, TaskError> {
        LEVELS.into_iter().map(|level| self.level(level, seeds, threads)).collect()
    }

    fn level(&self, level: f64, seeds: u32, threads: Option<NonZeroUsize>) -> Result<Level, TaskError> {
        let trouble = Trouble { wrong: Some(level), fails: Some(level), loss: None };
        let flights = parallel_map(seeds as usize, threads, |seed| self.fly(seed as u64, trouble));
        let flights: Vec<Flown> = flights.into_iter().collect::<Result<_, _>>()?;
        let of = |number: fn(&Flown) -> f64| {
            Distribution::of(flights.iter().filter(|flown| flown.success).map(number))
        };
        Ok(Level {
            level,
            success: Share::of(&flights, |flown| flown.success),
            mistaken: Share::of(&flights, |flown| flown.believed && !flown.success),
            ticks: of(|flown| f64::from(flown.ticks)),
            actions: of(|flown| flown.operated.len() as f64),
        })
    }
}

/// The levels as a table.
#[must_use]
pub fn level_table(levels: &[Level]) -> String {
    let line = |of: &Level| {
        let [low, high] = of.success.interval.map(|bound| 100.0 * bound);
        let [soon, late] = of.ticks.interval;
        let (ticks, actions) = match of.success.count {
            0 => ("-".to_owned(), "-".to_owned()),
            _ => {
                (format!("{:.2} ({soon:.2} to {late:.2})", of.ticks.mean), format!("{:.2}", of.actions.mean))
            }
        };
        format!(
            "{:<5}  {:<22}  {:<10.2}  {ticks:<24}  {actions}\n",
            of.level,
            format!("{:.1} ({low:.1} to {high:.1})", 100.0 * of.success.ratio),
            100.0 * of.mistaken.ratio
        )
    };
    let head =
        format!("{:<5}  {:<22}  {:<10}  {:<24}  actions\n", "level", "success %", "mistaken %", "ticks");
    head + &levels.iter().map(line).collect::<String>()
        + "In brackets: 95 % intervals. The level is the share of readings that are wrong and of actions that fail.\n"
        + "Ticks and actions are means of the flights that succeeded.\n"
}
