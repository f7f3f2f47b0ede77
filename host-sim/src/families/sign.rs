//! A hall with bays, and a sign that tells which of them serves.

use super::hall::Hall;
use super::prior::skewed;
use super::sketch::{Sketch, UnknownSketch};
use crate::draws::{one, some, within};
use crate::random::Random;

/// A mission with so many robots.
pub(super) fn sketch(random: &mut Random, robots: usize) -> Option<Sketch> {
    let bays = within(random, &(2..=4));
    let mut hall = Hall::new(within(random, &(5..=11)) as u16);
    for _ in 0..bays {
        hall.open(random)?;
    }
    hall.corridors.sort_unstable();
    let starts = some(random, &hall.cells(), robots)?;
    let niches = hall.possible().into_iter().map(|corridor| corridor.cells()[0]);
    let places: Vec<_> =
        hall.cells().into_iter().chain(niches).filter(|cell| !starts.contains(cell)).collect();
    let sign = one(random, &places)?;
    let mut map = hall.map()?;
    map.clear(sign);
    let groups = hall.corridors.iter().map(|corridor| corridor.bay()).collect();
    let unknown = UnknownSketch::serves(groups, skewed(random, bays), Some(sign));
    let subject = format!("one of {bays} bays serves, a sign tells which");
    Some(Sketch::of_one_unknown(subject, map, starts, unknown))
}
