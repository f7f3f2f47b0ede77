//! Drawing support for the tests of this module: maps in, paths out, and repeatable random numbers.

use super::{Cell, Map, Path, words};
use std::string::{String, ToString};
use std::vec::Vec;

/// A map of up to 1024 cells: `#` is blocked, every other sign a free cell, so that a picture can
/// mark some.
pub(super) fn drawn(rows: &[&str]) -> Map<32> {
    let free = |sign| if sign == '#' { '#' } else { '.' };
    let drawing: String =
        rows.join("\n").chars().map(|sign| if sign == '\n' { sign } else { free(sign) }).collect();
    Map::drawn(&drawing).unwrap()
}

/// The cell marked with a sign.
pub(super) fn marked(rows: &[&str], sign: char) -> Cell {
    Cell(rows.concat().find(sign).unwrap() as u16)
}

/// The paper's 7 x 7 grid with some obstacles.
pub(super) fn paper(obstacles: &[u16]) -> Map<{ words(7, 7) }> {
    Map::new(7, 7).unwrap().avoiding(obstacles.iter().copied().map(Cell))
}

/// A path drawn on its map: at each cell the step (0 to 9, then a, b, ...) at which it was entered
/// last, so that a wait shows as a gap between neighbours.
pub(super) fn picture<const W: usize>(map: &Map<W>, path: &Path) -> Vec<String> {
    let mut signs: Vec<char> = (0..map.len() as u16).map(|cell| sign(map, Cell(cell))).collect();
    let mut before = None;
    for (step, cell) in path.cells(map).enumerate() {
        if before.replace(cell) != Some(cell) {
            signs[cell.index()] = char::from_digit(step as u32, 36).unwrap_or('+');
        }
    }
    signs.chunks(map.width().into()).map(|row| row.iter().collect()).collect()
}

/// Robots on a map at every step, one string per step, rows separated by blanks.
pub(super) fn frames<const W: usize>(map: &Map<W>, robots: &[(char, Path)]) -> Vec<String> {
    let last = robots.iter().map(|(_, path)| path.len()).max().unwrap();
    let frame = |step| {
        let mut signs: Vec<char> = (0..map.len() as u16).map(|cell| sign(map, Cell(cell))).collect();
        for (name, path) in robots {
            signs[path.cell_at(map, step).index()] = *name;
        }
        let rows: Vec<String> = signs.chunks(map.width().into()).map(|row| row.iter().collect()).collect();
        rows.join(" ")
    };
    (0..=last).map(frame).collect()
}

/// The path of the robot `name` in such frames, in which `x` is a cell with all robots.
pub(super) fn moving(frames: &[&str], name: char) -> Path {
    let rows: Vec<&str> = frames[0].split(' ').collect();
    let at = |frame: &&str| Cell(frame.replace(' ', "").find([name, 'x']).unwrap() as u16);
    let cells: Vec<Cell> = frames.iter().map(at).collect();
    Path::through(&Map::<32>::new(rows[0].len() as u16, rows.len() as u16).unwrap(), &cells).unwrap()
}

/// Fails with both pictures, line by line.
#[track_caller]
pub(super) fn assert_picture(shown: &[String], expected: &[&str]) {
    assert!(shown == expected, "shown:\n{}\nexpected:\n{}", shown.join("\n"), expected.join("\n"));
}

fn sign<const W: usize>(map: &Map<W>, cell: Cell) -> char {
    if map.is_free(cell) { '.' } else { '#' }
}

/// Marsaglia's 32-bit xorshift: the same numbers on every machine.
pub(super) struct Random(pub(super) u32);

impl Random {
    pub(super) fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0 as usize % limit
    }

    /// A map of exactly this size, blocked in about `percent` of its cells.
    pub(super) fn map<const W: usize>(&mut self, width: u16, height: u16, percent: usize) -> Map<W> {
        let map = Map::new(width, height).unwrap();
        map.avoiding((0..map.len() as u16).map(Cell).filter(|_| self.below(100) < percent))
    }

    pub(super) fn cell<const W: usize>(&mut self, map: &Map<W>) -> Cell {
        Cell(self.below(map.len()) as u16)
    }
}

#[test]
fn a_picture_shows_when_each_cell_was_entered() {
    let rows = ["S.#", "..."];
    let map = drawn(&rows);
    assert_eq!(marked(&rows, 'S'), Cell(0));
    let path = moving(&["a.. ...", ".a. ...", ".a. ...", "... .a."], 'a');
    assert_picture(&picture(&map, &path), &["01#", ".3."]);
    assert_eq!(frames(&map, &[('a', path)])[3].to_string(), "..# .a.");
}
