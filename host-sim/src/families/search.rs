//! Corners of which one serves, and nothing that tells but to go there.

use super::prior::skewed;
use super::sketch::{Sketch, UnknownSketch};
use crate::draws::{one, some, within};
use crate::missions::{Ground, largest_part};
use crate::random::Random;
use crate::scenario::Floor;
use iibt_core::grid::{Cell, Move};

/// A mission with so many robots.
pub(super) fn sketch(random: &mut Random, robots: usize) -> Option<Sketch> {
    let count = within(random, &(6..=12));
    let map = Ground::Drawn { width: 10..=12, height: 8..=10, walls: 0.1..=0.25 }.draw(random)?;
    let part = largest_part(&map);
    let mut left: Vec<Cell> = part.iter().copied().filter(|&cell| is_corner(&map, cell)).collect();
    let mut corners = Vec::new();
    for _ in 0..count {
        let corner = one(random, &left)?;
        // No cell is beside two of them.
        left.retain(|&cell| map.manhattan(cell, corner) > 2);
        corners.push(corner);
    }
    corners.sort_unstable();
    let places: Vec<Cell> = part.into_iter().filter(|cell| !corners.contains(cell)).collect();
    let starts = some(random, &places, robots)?;
    let groups = corners.into_iter().map(|corner| vec![corner]).collect();
    let unknown = UnknownSketch::serves(groups, skewed(random, count), None);
    let subject = format!("one of {count} corners serves");
    Some(Sketch::of_one_unknown(subject, map, starts, unknown))
}

/// Whether a free cell is the end of a dead end, or has two free neighbours at a right angle.
fn is_corner(map: &Floor, cell: Cell) -> bool {
    let moves: Vec<Move> = map.free_neighbours(cell).map(|(step, _)| step).collect();
    matches!(moves[..], [_] | [Move::Up | Move::Down, Move::Left | Move::Right])
}
