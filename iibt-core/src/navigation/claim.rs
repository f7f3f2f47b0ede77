//! The cells that a robot may occupy, as its team is told.

use crate::grid::{Cell, CellSet};
use crate::team::rounds::Claim;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The most bytes of a picture in a frame; one byte each of scale, offset and length come on top.
const BITS: usize = 11;

/// The bytes of a picture beside its bits.
const HEAD: usize = 3;

/// Cells that a robot may be on or come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cells<const W: usize>(pub CellSet<W>);

/// Cells in a frame: one bit for a block of one or more consecutive cells, set if any of them is in
/// the claim.
///
/// Up to 88 cells are sent exactly. Of larger spans the blocks grow, by powers of two.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Blocks {
    /// The binary logarithm of the cells in a block.
    scale: u8,
    /// The number of bytes without any block that are left out before the first.
    skipped: u8,
    /// Eight blocks a byte, the lowest first.
    bits: Vec<u8, BITS>,
}

impl Blocks {
    /// The smallest blocks with which the cells fit `bytes` bytes.
    fn of<const W: usize>(cells: &CellSet<W>, bytes: usize) -> Self {
        let most = bytes.saturating_sub(HEAD).clamp(1, BITS);
        // A byte of the largest scale holds more cells than there are numbers.
        let drawn = (0..=u16::BITS as u8).find_map(|scale| Self::drawn(cells, scale, most));
        drawn.unwrap_or_default()
    }

    /// The bytes that they take in a frame.
    pub(super) fn bytes(&self) -> usize {
        HEAD + self.bits.len()
    }

    fn drawn<const W: usize>(cells: &CellSet<W>, scale: u8, most: usize) -> Option<Self> {
        let byte = |cell: Cell| (u32::from(cell.0) >> scale) / 8;
        let (Some(first), Some(last)) = (cells.iter().next(), cells.iter().last()) else {
            return Some(Self::default());
        };
        let length = (byte(last) - byte(first)) as usize + 1;
        let mut drawn = Self { scale, skipped: u8::try_from(byte(first)).ok()?, bits: Vec::new() };
        drawn.bits.resize(length.min(most + 1), 0).ok().filter(|()| length <= most)?;
        for cell in cells.iter() {
            let block = u32::from(cell.0) >> scale;
            if let Some(bits) = drawn.bits.get_mut((byte(cell) - byte(first)) as usize) {
                *bits |= 1 << (block % 8);
            }
        }
        Some(drawn)
    }

    /// The cells of the blocks, of those numbered below `limit`.
    fn cells(&self, limit: usize) -> impl Iterator<Item = Cell> + '_ {
        let scale = u32::from(self.scale.min(u16::BITS as u8));
        let has = move |block: usize| {
            let byte = (block / 8).checked_sub(self.skipped.into()).and_then(|at| self.bits.get(at));
            byte.is_some_and(|bits| bits >> (block % 8) & 1 == 1)
        };
        (0..limit).filter(move |&cell| has(cell >> scale)).map(|cell| Cell(cell as u16))
    }
}

impl<const W: usize> core::hash::Hash for Cells<W> {
    fn hash<H: core::hash::Hasher>(&self, state: &mut H) {
        self.0.iter().for_each(|cell| cell.hash(state));
    }
}

impl<const W: usize> Claim for Cells<W> {
    type Wire = Blocks;
    // Fourteen bytes each for one or two robots, eleven for three, eight for four of eight.
    const WIRE_BYTES: usize = 33;
    const EMPTY: Self = Self(CellSet::EMPTY);

    fn union(&self, other: &Self) -> Self {
        Self(self.0.union(&other.0))
    }

    fn contains(&self, other: &Self) -> bool {
        other.0.without(&self.0).is_empty()
    }

    fn overlaps(&self, other: &Self) -> bool {
        !self.0.intersection(&other.0).is_empty()
    }

    fn to_wire(&self, left_out: usize) -> Blocks {
        Blocks::of(&self.0, (BITS + HEAD).min(Self::WIRE_BYTES / left_out.max(1)))
    }

    fn from_wire(wire: &Blocks) -> Self {
        Self(wire.cells(32 * W).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn claim<const W: usize>(cells: &[u16]) -> Cells<W> {
        Cells(cells.iter().copied().map(Cell).collect())
    }

    #[test]
    fn small_maps_are_sent_cell_by_cell() {
        for cells in [&[][..], &[0], &[63], &[0, 9, 18, 27, 36, 45, 54, 63], &[7, 15, 23]] {
            for left_out in 1..=3 {
                let claim = claim::<2>(cells);
                assert_eq!(Cells::from_wire(&claim.to_wire(left_out)), claim, "{cells:?}");
            }
        }
        let far = claim::<32>(&[900, 901, 932, 965, 980]);
        assert_eq!(Cells::from_wire(&far.to_wire(1)), far, "what counts is the span");
    }

    #[test]
    fn larger_spans_lose_no_cell_and_fit_the_frame_together() {
        for left_out in 1..=4 {
            for step in 1..40_u16 {
                let cells: std::vec::Vec<u16> = (0..12).map(|index| (index * index * step) % 1024).collect();
                let (claim, wire) = (claim::<32>(&cells), claim::<32>(&cells).to_wire(left_out));
                assert!(Cells::from_wire(&wire).contains(&claim), "{cells:?}");
                let bytes = postcard::to_slice(&wire, &mut [0; 64]).unwrap().len();
                assert!(bytes <= 14 && bytes * left_out <= Cells::<32>::WIRE_BYTES, "{wire:?}");
            }
        }
        let wide = claim::<32>(&[0, 1023]).to_wire(1);
        let sent = Cells::<32>::from_wire(&wide);
        assert!(sent.0.len() <= 32, "two blocks of sixteen: {}", sent.0.len());
    }

    #[test]
    fn any_blocks_are_read_without_fail() {
        let wire = Blocks { scale: u8::MAX, skipped: u8::MAX, bits: [u8::MAX; BITS].into_iter().collect() };
        assert_eq!(Cells::<8>::from_wire(&wire), Cells::EMPTY);
        let wire = Blocks { scale: u8::MAX, skipped: 0, ..wire };
        assert_eq!(Cells::<8>::from_wire(&wire).0.len(), 256);
    }
}
