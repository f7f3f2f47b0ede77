//! Missions that images carry in flash.

use iibt_core::grid::{Cell, Map, Path, words};
use iibt_core::navigation::Mission;

/// The cells of the paper's grid, seven rows of seven.
pub const CELLS: usize = 49;

/// The words of a map of [`CELLS`].
pub const WORDS: usize = words(7, 7);

/// The steps of a plan in images, its start included.
pub const LAYERS: usize = 33;

/// The nodes of a search in images.
pub const NODES: usize = 64;

/// The joint policies that are weighed in images.
pub const POLICIES: usize = 16;

/// The paths that a page may give all robots together in images.
pub const ALL_PATHS: usize = 8;

/// The paths of each robot in [`SECTION_5_1`].
const PATHS: usize = 4;

/// The paper's section 5.1: two robots, goals 24 and 26, and four candidate paths each.
///
/// Robot 1 (index 0) starts on 28 with paths A to D, robot 2 on 2 with paths b, a, c, d: the short
/// one first, which is the order of the paper's numbers, not of its text.
pub static SECTION_5_1: Mission<'static, WORDS> = Mission {
    paths: Some(&[&FIRST, &SECOND]),
    ..Mission::new(MAP, &[Cell(28), Cell(2)], &[Cell(24), Cell(26)])
};

const MAP: Map<WORDS> = match Map::new(7, 7) {
    Ok(map) => map,
    Err(_) => panic!("the map has a word for every 32 cells"),
};

static FIRST: [Path; PATHS] = [
    through(&[28, 29, 30, 31, 24]),
    through(&[28, 35, 36, 37, 38, 31, 24]),
    through(&[28, 29, 30, 31, 32, 33, 26]),
    through(&[28, 35, 36, 37, 38, 39, 40, 41, 34, 27, 26]),
];

static SECOND: [Path; PATHS] = [
    through(&[2, 3, 10, 17, 24]),
    through(&[2, 1, 8, 15, 22, 23, 24]),
    through(&[2, 3, 4, 11, 18, 25, 26]),
    through(&[2, 3, 4, 5, 12, 19, 26]),
];

const fn through<const N: usize>(numbers: &[u16; N]) -> Path {
    let mut cells = [Cell(0); N];
    let mut index = 0;
    while index < N {
        cells[index] = Cell(numbers[index]);
        index += 1;
    }
    match Path::through(&MAP, &cells) {
        Some(path) => path,
        None => panic!("the cells of a path are neighbours"),
    }
}
