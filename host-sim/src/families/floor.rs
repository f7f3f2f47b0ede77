//! An open floor on which a few cells may be blocked.

use super::sketch::{Sketch, UnknownSketch};
use crate::draws::some;
use crate::random::Random;
use crate::scenario::Floor;
use iibt_core::grid::Cell;

/// The columns and rows.
const SIDE: u16 = 8;

/// The cells that may be blocked.
const CELLS: usize = 3;

/// A mission with so many robots, and as many goals.
pub(super) fn sketch(random: &mut Random, robots: usize) -> Option<Sketch> {
    let map = Floor::new(SIDE, SIDE).ok()?;
    let all: Vec<Cell> = map.free_cells().iter().collect();
    let mut starts = some(random, &all, 2 * robots + CELLS)?;
    let mut goals = starts.split_off(robots);
    let cells = goals.split_off(robots);
    goals.sort_unstable();
    let unknowns = cells.into_iter().map(|cell| UnknownSketch::blocks(cell, 50)).collect();
    let subject = format!("an open floor with {CELLS} cells that may be blocked");
    Some(Sketch { subject, map, starts, goals, unknowns })
}
