//! How far every cell is from one.

use super::super::spread::Spread;
use super::super::{Cell, Map};

/// The moves from every cell to one target: 64 bytes a word of the map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Distances<const W: usize> {
    moves: [[u16; 32]; W],
}

/// The distance of a cell from which there is no way.
pub(super) const UNREACHED: u16 = u16::MAX;

impl<const W: usize> Distances<W> {
    pub(super) const EMPTY: Self = Self { moves: [[UNREACHED; 32]; W] };

    /// Measures the distances to a target over the free cells of a map. Unless a robot stands there,
    /// nothing is near a target that is not free.
    pub(super) fn measure(&mut self, map: &Map<W>, target: Cell, is_start: bool) {
        let moves = self.moves.as_flattened_mut();
        moves.fill(UNREACHED);
        if !map.is_free(target) && !is_start {
            return;
        }
        Spread::over(map).flood(target, |cell, distance| {
            if let Some(slot) = moves.get_mut(cell.index()) {
                *slot = distance;
            }
        });
    }

    pub(super) fn from(&self, cell: Cell) -> u16 {
        self.moves.as_flattened().get(cell.index()).copied().unwrap_or(UNREACHED)
    }
}
