//! What random missions of every kind are drawn with.

use crate::random::Random;
use crate::scenario::Floor;
use iibt_core::grid::Cell;
use std::ops::RangeInclusive;

/// The most draws for one mission.
pub(crate) const DRAWS: u32 = 10_000;

/// A number of a range that is not empty.
pub(crate) fn within(random: &mut Random, range: &RangeInclusive<usize>) -> usize {
    range.start() + random.below(range.end() + 1 - range.start())
}

/// One of several; `None` of none.
pub(crate) fn one<T: Copy>(random: &mut Random, all: &[T]) -> Option<T> {
    all.get(random.below(all.len())).copied()
}

/// So many different cells of several, in any order; `None` when there are fewer.
pub(crate) fn some(random: &mut Random, all: &[Cell], count: usize) -> Option<Vec<Cell>> {
    let mut left = all.to_vec();
    let is_enough = count <= left.len();
    is_enough.then(|| (0..count).map(|_| left.swap_remove(random.below(left.len()))).collect())
}

/// The entry `map` of a scenario file, with robots on their starts and a `G` on each other goal
/// that is given.
pub(crate) fn map_entry(map: &Floor, starts: &[Cell], goals: &[Cell]) -> String {
    let mark = |cell: Cell| match starts.iter().position(|&start| start == cell) {
        Some(robot) => (b'1' + robot as u8).into(),
        None if goals.contains(&cell) => 'G',
        None if map.is_free(cell) => '.',
        None => '#',
    };
    let mut text = "map = \"\"\"\n".to_owned();
    for cell in (0..map.len() as u16).map(Cell) {
        text.push(mark(cell));
        if (cell.0 + 1).is_multiple_of(map.width()) {
            text.push('\n');
        }
    }
    text + "\"\"\"\n"
}
