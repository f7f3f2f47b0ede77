//! Two bays of which one serves almost surely, and a sign that is not worth the way.

use super::hall::{Corridor, Hall};
use super::sketch::{Sketch, UnknownSketch};
use crate::draws::{some, within};
use crate::random::Random;
use crate::scenario::{Floor, MAX_CELLS};
use iibt_core::grid::{Cell, Planner};

/// The least moves from a robot to the sign.
const FAR: u16 = 6;

/// A mission with so many robots.
///
/// A robot that goes to the likelier bay sees it no later than another one could read the sign: so
/// the sign tells nothing that is not known by then.
pub(super) fn sketch(random: &mut Random, robots: usize) -> Option<Sketch> {
    let mut hall = Hall::new(within(random, &(8..=11)) as u16);
    let row = hall.open(random)?.row;
    let bays = [false, true].map(|is_right| Corridor { row, is_right });
    hall.corridors = bays.to_vec();
    let sign = hall.open(random)?.cells()[3];
    let starts = some(random, &hall.cells(), robots)?;
    let (likely, probability) = (random.below(2), within(random, &(80..=95)) as u64);
    let mut prior = vec![100 - probability; 2];
    prior[likely] = probability;
    let map = hall.map()?;
    let to_sign = nearest(&map, &starts, sign)?;
    let to_bay = nearest(&map, &starts, bays[likely].cells()[1])?;
    let groups = bays.map(Corridor::bay).to_vec();
    let unknown = UnknownSketch::serves(groups, prior, Some(sign));
    let subject = "two bays, and a sign that is too far away".to_owned();
    let is_far = to_sign >= FAR && to_bay <= to_sign;
    is_far.then(|| Sketch::of_one_unknown(subject, map, starts, unknown))
}

/// The moves to a cell from the nearest start.
fn nearest(map: &Floor, starts: &[Cell], to: Cell) -> Option<u16> {
    let mut planner = Planner::<MAX_CELLS>::new();
    let distances = planner.distances(map, to).ok()?;
    starts.iter().filter_map(|&start| distances.to(start)).min()
}
