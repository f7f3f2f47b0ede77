//! Alleys with gates that may be shut, and a way around that is open.

use super::sketch::{Sketch, UnknownSketch};
use crate::draws::{some, within};
use crate::random::Random;
use crate::scenario::Floor;
use iibt_core::grid::Cell;

/// The rows below the alleys, in which the robots start.
const BELOW: u16 = 2;

/// The least columns from the way around to the nearest alley.
const APART: usize = 3;

/// A mission with so many robots.
///
/// Columns are counted from the way around, which is at the left or at the right border.
pub(super) fn sketch(random: &mut Random, robots: usize) -> Option<Sketch> {
    let alleys = within(random, &(2..=3));
    let (width, above) = (within(random, &(9..=11)), within(random, &(1..=2)) as u16);
    let length = within(random, &(4..=6)) as u16;
    // A wall is between alleys.
    let span = 2 * alleys - 1;
    let first = within(random, &(APART..=width - span));
    let is_left = random.bernoulli(0.5);
    let cell = |row: u16, column: usize| {
        let column = if is_left { column } else { width - 1 - column };
        Cell(row * width as u16 + column as u16)
    };
    let columns: Vec<usize> = (first..first + span).step_by(2).collect();
    let mut map = Floor::new(width as u16, above + length + BELOW).ok()?;
    for row in above..above + length {
        for column in (1..width).filter(|column| !columns.contains(column)) {
            map.block(cell(row, column));
        }
    }
    let goal = cell(0, within(random, &(first..=first + span - 1)));
    let below = above + length..above + length + BELOW;
    // The robots start nearer to the alleys than to the way around.
    let places: Vec<Cell> =
        below.flat_map(|row| (first - 1..width).map(move |column| cell(row, column))).collect();
    let starts = some(random, &places, robots)?;
    let middle = usize::from(above) + 1..=usize::from(above + length) - 2;
    let mut gate = |&column: &usize| {
        let row = within(random, &middle) as u16;
        UnknownSketch::blocks(cell(row, column), within(random, &(20..=80)) as u64)
    };
    let unknowns = columns.iter().map(&mut gate).collect();
    let subject = format!("{alleys} alleys with gates that may be shut, and a way around");
    Some(Sketch { subject, map, starts, goals: vec![goal], unknowns })
}
