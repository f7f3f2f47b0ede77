//! Measurements beyond the paper: heterogeneous teams, and preferences learned over missions.
//!
//! Each capability is flown on and off, in the same worlds and on the same seeds.

mod learned;
mod mixed;

pub use learned::{LearnedPreferences, Served};
pub use mixed::{Mixed, Unlike};

use crate::campaign::Score;
use crate::fly::{Conditions, fly};
use crate::scenario::Scenario;

/// Returns the score of one flight.
fn score(scenario: &Scenario, seed: u64) -> Score {
    let conditions = Conditions { seed, ..Conditions::default() };
    let record = fly(scenario, conditions, &mut ()).expect("a sound scenario can be flown");
    Score::of(scenario, &record)
}
