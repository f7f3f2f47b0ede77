//! Facts: what a robot tells its team before a joint decision.

use super::claim::Cells;
use super::obstacles::{Announced, MAX_EVIDENCE, is_claim};
use crate::grid::{Cell, CellSet};
use crate::team::{reading, rounds};
use serde::{Deserialize, Serialize};

/// What a robot is for until the next decision.
#[doc(alias = "errand")]
#[doc(alias = "intention")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Purpose {
    /// To reach its own goal, or any goal if it owns none.
    #[default]
    Goal,
    /// To visit a way-point.
    Visit(Cell),
    /// To charge its battery there.
    Charge(Cell),
    /// To stay where it stands.
    Stand,
}

impl Purpose {
    /// Returns the cell that the purpose names.
    #[must_use]
    pub const fn cell(self) -> Option<Cell> {
        match self {
            Self::Visit(cell) | Self::Charge(cell) => Some(cell),
            Self::Goal | Self::Stand => None,
        }
    }
}

/// What all robots of a round know about one of them, on a map of `W` words.
///
/// A fact is frozen when its robot joins a round; what the robot learns later waits for the next
/// round, so that all compute the same plans.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fact<const W: usize> {
    /// The cell that the robot stands on.
    pub anchor: Cell,
    /// What it is for.
    pub purpose: Purpose,
    /// Its evidence about obstacles, in the order of the cells.
    pub evidence: Announced,
}

impl<const W: usize> Fact<W> {
    /// Returns whether every cell that the fact names is one of the first `cells`.
    #[must_use]
    pub fn fits(&self, cells: usize) -> bool {
        let evidence = self.evidence.iter().map(|known| known.cell);
        let named = [self.anchor].into_iter().chain(self.purpose.cell()).chain(evidence);
        named.into_iter().all(|cell| cell.index() < cells)
    }
}

impl<const W: usize> rounds::Fact for Fact<W> {
    type Claim = Cells<W>;

    // Cells below 2^14 take two bytes at the most.
    const MAX_BYTES: usize = 2 + (1 + 2) + 1 + MAX_EVIDENCE * (2 + 1);

    fn anchor(&self) -> Cells<W> {
        Cells([self.anchor].into_iter().collect())
    }

    fn read_into<'b>(&mut self, mut bytes: &'b [u8]) -> Option<&'b [u8]> {
        self.anchor = reading::value(&mut bytes)?;
        self.purpose = reading::value(&mut bytes)?;
        reading::list(&mut self.evidence, &mut bytes)?;
        Some(bytes)
    }
}

/// The most cells of a map, so that a fact fits its frame.
pub(super) const MAX_CELLS: usize = 1 << 14;

/// Returns the cells that count as blocked after the evidence of all facts, and those that a robot
/// claims; those on which a robot stands do not.
pub(super) fn blocked<'a, const W: usize>(facts: impl Iterator<Item = &'a Fact<W>> + Clone) -> CellSet<W> {
    let evidence = facts.clone().flat_map(|fact| fact.evidence.iter());
    let of = |cell: Cell| evidence.clone().filter(move |known| known.cell == cell).map(|known| known.weight);
    let sum = |cell: Cell| of(cell).fold(0_i16, |sum, weight| sum.saturating_add(weight.into()));
    let cells = evidence.clone().map(|known| known.cell);
    let is_blocked = |&cell: &Cell| of(cell).any(is_claim) || super::obstacles::is_blocked(sum(cell));
    let blocked: CellSet<W> = cells.filter(is_blocked).collect();
    blocked.without(&facts.map(|fact| fact.anchor).collect())
}

#[cfg(test)]
mod tests {
    use super::super::obstacles::CellEvidence;
    use super::*;

    fn fact(anchor: u16, evidence: &[(u16, i8)]) -> Fact<1> {
        let evidence = evidence.iter().map(|&(cell, weight)| CellEvidence { cell: Cell(cell), weight });
        Fact { anchor: Cell(anchor), purpose: Purpose::Goal, evidence: evidence.collect() }
    }

    #[test]
    fn evidence_adds_up_over_the_members_and_nobody_stands_in_an_obstacle() {
        let facts = [
            fact(1, &[(5, 64), (6, 20), (7, 64), (8, 64)]),
            fact(2, &[(5, 64), (6, 20), (7, -48)]),
            fact(8, &[]),
        ];
        let blocked: CellSet<1> = blocked(facts.iter());
        assert!(blocked.iter().map(|cell| cell.0).eq([5, 6]));
    }

    #[test]
    fn a_fact_that_names_a_cell_outside_does_not_fit() {
        assert!(fact(3, &[(4, 1)]).fits(5) && !fact(5, &[]).fits(5) && !fact(3, &[(5, 1)]).fits(5));
        let visit = Fact { purpose: Purpose::Visit(Cell(5)), ..fact(0, &[]) };
        assert!(!visit.fits(5) && visit.fits(6));
    }
}
