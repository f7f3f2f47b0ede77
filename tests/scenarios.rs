//! Whole missions in the simulator: they end well, repeat exactly, and bad input is refused with a
//! reason.

mod accepted;
mod events;
mod json;
mod keys;
mod missions;
mod radio;
mod readme;
mod refused;
mod shift;

use host_sim::show::summary;
use host_sim::{Conditions, Outcome, Record, Scenario, fly, library};
use iibt_core::grid::Cell;
use proptest::prelude::*;
use std::collections::BTreeSet;

fn built_in(name: &str) -> Scenario {
    library::find(name).expect("built in").expect("sound")
}

fn flown(scenario: &Scenario, seed: u64, loss: f64) -> Record {
    fly(scenario, Conditions { seed, loss: Some(loss), ..Conditions::default() }, &mut ())
        .expect("a sound scenario can be flown")
}
