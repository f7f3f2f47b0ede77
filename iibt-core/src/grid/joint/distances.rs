//! How far every cell is from one.

use super::super::spread::Spread;
use super::super::{Cell, Map};

/// The moves from every cell to one target, in twelve bits each: 48 bytes a word of the map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Distances<const W: usize> {
    low: [[u8; 32]; W],
    /// Of two cells a byte.
    high: [[u8; 16]; W],
}

/// The distance of a cell from which there is no way. No way on 4,096 cells is as long.
pub(super) const UNREACHED: u16 = 0xfff;

impl<const W: usize> Distances<W> {
    /// Those that are not measured yet.
    pub(super) const EMPTY: Self = Self { low: [[0; 32]; W], high: [[0; 16]; W] };

    /// Measures the distances to a target over the free cells of a map. Unless a robot stands
    /// there, nothing is near a target that is not free.
    pub(super) fn measure(&mut self, map: &Map<W>, target: Cell, is_start: bool) {
        self.low.as_flattened_mut().fill(0xff);
        self.high.as_flattened_mut().fill(0xff);
        if map.is_free(target) || is_start {
            Spread::over(map).flood(target, |cell, distance| self.set(cell, distance.min(UNREACHED)));
        }
    }

    pub(super) fn from(&self, cell: Cell) -> u16 {
        let (index, shift) = place(cell);
        let low = self.low.as_flattened().get(index).copied().map(u16::from);
        let high = self.high.as_flattened().get(index / 2).copied().map(u16::from);
        low.zip(high).map_or(UNREACHED, |(low, high)| (high >> shift & 0xf) << 8 | low)
    }

    fn set(&mut self, cell: Cell, distance: u16) {
        let (index, shift) = place(cell);
        let [low, high] = distance.to_le_bytes();
        if let Some(slot) = self.low.as_flattened_mut().get_mut(index) {
            *slot = low;
        }
        if let Some(slot) = self.high.as_flattened_mut().get_mut(index / 2) {
            *slot = *slot & !(0xf << shift) | high << shift;
        }
    }
}

/// The place of a cell among the low bits, and that of its high bits in their byte.
fn place(cell: Cell) -> (usize, u32) {
    (cell.index(), 4 * u32::from(cell.0 % 2))
}

#[cfg(test)]
mod tests {
    use super::super::super::pictures::drawn;
    use super::*;

    #[test]
    fn holds_distances_of_more_than_a_byte() {
        // A way that winds through 32 x 32 cells, in rows of 31.
        let row = |number: usize| match number % 4 {
            0 | 2 => ".".repeat(31),
            1 => std::format!("{}.", "#".repeat(30)),
            _ => std::format!(".{}", "#".repeat(30)),
        };
        let rows: std::vec::Vec<_> = (0..31).map(row).collect();
        let map = drawn(&rows.iter().map(std::string::String::as_str).collect::<std::vec::Vec<_>>());
        let mut distances = Distances::EMPTY;
        distances.measure(&map, Cell(0), true);
        assert_eq!([0, 30, 61, 92, 62].map(|cell| distances.from(Cell(cell))), [0, 30, 31, 32, 62]);
        assert_eq!([30, 0].map(|column| distances.from(Cell(30 * 31 + column))), [480, 510]);
        assert_eq!([31, 5000].map(|cell| distances.from(Cell(cell))), [UNREACHED; 2]);
    }
}
