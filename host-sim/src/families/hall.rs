//! A hall of three columns, with corridors of four cells to its sides.

use super::sketch::map_of;
use crate::draws::one;
use crate::random::Random;
use crate::scenario::Floor;
use iibt_core::grid::Cell;

/// The columns of the map; those of the hall are 4 to 6.
const WIDTH: u16 = 11;

/// A hall with its corridors.
pub(super) struct Hall {
    height: u16,
    pub corridors: Vec<Corridor>,
}

/// A corridor, which ends at the border of the map.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Corridor {
    pub row: u16,
    pub is_right: bool,
}

impl Corridor {
    /// Its cells from the hall to its end.
    pub(super) fn cells(self) -> [Cell; 4] {
        let column = |step: u16| if self.is_right { 7 + step } else { 3 - step };
        [0, 1, 2, 3].map(|step| Cell(self.row * WIDTH + column(step)))
    }

    /// The last two cells, from left to right.
    pub(super) fn bay(self) -> Vec<Cell> {
        let [_, _, mut bay @ ..] = self.cells();
        bay.sort_unstable();
        bay.to_vec()
    }
}

impl Hall {
    /// A hall of so many rows, without corridors.
    pub(super) const fn new(height: u16) -> Self {
        Self { height, corridors: Vec::new() }
    }

    /// Adds one of the corridors for which there is room; `None` where there is none.
    pub(super) fn open(&mut self, random: &mut Random) -> Option<Corridor> {
        let corridor = one(random, &self.possible())?;
        self.corridors.push(corridor);
        Some(corridor)
    }

    /// The corridors that would touch none of those there are.
    pub(super) fn possible(&self) -> Vec<Corridor> {
        let all = [false, true]
            .into_iter()
            .flat_map(|is_right| (0..self.height).map(move |row| Corridor { row, is_right }));
        let touch = |one: Corridor, other: Corridor| {
            one.is_right == other.is_right && one.row.abs_diff(other.row) <= 1
        };
        all.filter(|&one| !self.corridors.iter().any(|&other| touch(one, other))).collect()
    }

    /// The cells of the hall, row by row.
    pub(super) fn cells(&self) -> Vec<Cell> {
        (0..self.height).flat_map(|row| [4, 5, 6].map(|column| Cell(row * WIDTH + column))).collect()
    }

    /// The map; `None` for a hall that is too long.
    pub(super) fn map(&self) -> Option<Floor> {
        let corridors = self.corridors.iter().flat_map(|corridor| corridor.cells());
        let free: Vec<Cell> = self.cells().into_iter().chain(corridors).collect();
        map_of(WIDTH, self.height, &free)
    }
}
