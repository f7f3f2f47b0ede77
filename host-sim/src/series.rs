//! Series: the same mission flown several times in a row by robots that learn preferences for
//! goals.

use crate::fly::{Conditions, Observer, fly_preferring};
use crate::random::{Random, Stream};
use crate::record::Record;
use crate::scenario::Scenario;
use crate::team::TeamError;
use crate::world::World;
use iibt_core::grid::Cell;
use iibt_core::navigation::Experience;
use serde::Serialize;

/// A series from its first to its last mission.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// Whether the robots learned.
    pub learning: bool,
    /// The missions in order.
    pub missions: Vec<SeriesMission>,
}

/// One mission of a series.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SeriesMission {
    /// The flight.
    pub record: Record,
    /// Whether each robot was served at its last goal; `None` for one that stood at no goal.
    pub served: Vec<Option<bool>>,
}

impl SeriesMission {
    /// Returns the share of the team that was served.
    #[must_use]
    pub fn share(&self) -> f64 {
        let served = self.served.iter().filter(|&&served| served == Some(true)).count();
        served as f64 / self.served.len().max(1) as f64
    }
}

/// Flies a scenario's missions in a row, with or without learning which goals serve.
///
/// Every mission begins at the robots' starts.
///
/// # Errors
/// As [`fly`](crate::fly).
///
/// ```
/// use host_sim::{Conditions, Scenario, fly_series, library};
///
/// let scenario = library::find("deliveries").expect("it is built in")?;
/// let twice = Scenario { missions: 2, ..scenario };
/// let series = fly_series(&twice, Conditions::default(), true, &mut ())?;
/// assert_eq!(series.missions.len(), 2);
/// assert!(series.missions.iter().all(|mission| (0.0..=1.0).contains(&mission.share())));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fly_series(
    scenario: &Scenario,
    conditions: Conditions,
    learning: bool,
    observer: &mut dyn Observer,
) -> Result<Series, TeamError> {
    let mut experience = vec![Experience::default(); scenario.robots.len()];
    let mut random = Random::of(conditions.seed, Stream::Service);
    let mut missions = Vec::new();
    for number in 0..u64::from(scenario.missions) {
        let values: Vec<_> = experience.iter().map(Experience::values).collect();
        let preferences = if learning { values.as_slice() } else { &[] };
        let seed = conditions.seed.wrapping_add(number << 32);
        let record = fly_preferring(scenario, Conditions { seed, ..conditions }, preferences, observer)?;
        // One draw for every goal, so that the outcome does not depend on which robot stands where.
        let serves = scenario.serves.iter().map(|&serves| random.bernoulli(serves));
        let world = World::new(scenario, seed);
        let is_useless = |goal: &Cell| world.useless().contains(goal);
        let serves: Vec<bool> =
            serves.zip(&scenario.goals).map(|(serves, goal)| serves && !is_useless(goal)).collect();
        let goal_of = |cell: Cell| scenario.goals.iter().position(|&goal| goal == cell);
        let stands: Vec<Option<usize>> = record.robots.iter().map(|robot| goal_of(robot.cell)).collect();
        for (experience, goal) in experience.iter_mut().zip(&stands) {
            goal.map(|goal| experience.learn(goal, serves[goal]));
        }
        let served = stands.iter().map(|goal| goal.map(|goal| serves[goal])).collect();
        missions.push(SeriesMission { record, served });
    }
    Ok(Series { learning, missions })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::team::Pilot;

    #[test]
    fn a_goal_that_an_unknown_leaves_out_serves_nobody() {
        let served = |real: u8| {
            let text = format!(
                "title = 't'\nlimit = 20\nneed = 1\nmap = '1.G....G'\n[[unknown]]\nserves = [[2], [7]]\n\
                 prior = [0.5, 0.5]\nbeside = 1.0\nreal = {real}"
            );
            let scenario = Scenario::parse("t", &text).unwrap();
            // It goes to the nearest goal whether that serves or not.
            let conditions = Conditions { tree: Pilot::Conventional, ..Conditions::default() };
            fly_series(&scenario, conditions, true, &mut ()).unwrap().missions.remove(0).served
        };
        assert_eq!((served(0), served(1)), (vec![Some(true)], vec![Some(false)]));
    }
}
