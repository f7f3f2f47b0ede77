//! What goes beyond the paper, measured: teams of unlike robots, and preferences learned from one mission to the next.
//!
//! Each is flown with the capability on and off in the same worlds, on the same seeds.

mod learned;
mod mixed;

pub use learned::{Learned, Served};
pub use mixed::{Mixed, Unlike};

use crate::campaign::Score;
use crate::fly::{Conditions, fly};
use crate::scenario::Scenario;

/// What came of one flight.
fn score(scenario: &Scenario, seed: u64) -> Score {
    let conditions = Conditions { seed, ..Conditions::default() };
    let record = fly(scenario, conditions, &mut ()).expect("a sound scenario can be flown");
    Score::of(scenario, &record)
}
