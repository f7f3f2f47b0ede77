//! Facts: what a robot tells its team before a joint decision.

use super::claim::Cells;
use super::obstacles::{Announced, MAX_EVIDENCE, is_claim};
use super::readings::AnnouncedReadings;
use super::unknown::MAX_VALUES;
use crate::grid::{Cell, CellSet};
use crate::team::{reading, rounds};
use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeTuple;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

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
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fact<const W: usize> {
    /// The cell that the robot stands on.
    pub anchor: Cell,
    /// What it is for.
    pub purpose: Purpose,
    /// Its evidence about obstacles, in the order of the cells.
    pub evidence: Announced,
    /// What it has read of the unknowns of the mission.
    pub readings: AnnouncedReadings,
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

    // Cells below 2^14 take two bytes at the most. Evidence about obstacles and about unknowns
    // share their room.
    const MAX_BYTES: usize = 2 + (1 + 2) + 1 + NAMED_BYTES;

    fn anchor(&self) -> Cells<W> {
        Cells([self.anchor].into_iter().collect())
    }

    fn read_into<'b>(&mut self, mut bytes: &'b [u8]) -> Option<&'b [u8]> {
        self.anchor = reading::value(&mut bytes)?;
        self.purpose = reading::value(&mut bytes)?;
        let counts = reading::value(&mut bytes)?;
        reading::items(&mut self.evidence, evidence_of(counts), &mut bytes)?;
        reading::items(&mut self.readings, readings_of(counts), &mut bytes)?;
        Some(bytes)
    }
}

/// One byte counts both lists, so that a fact without readings is as short as if there were none:
/// obstacles in its low half, bytes of readings in its high half.
const fn counts(evidence: usize, readings: usize) -> u8 {
    evidence as u8 | (readings as u8) << 4
}

const fn evidence_of(counts: u8) -> u32 {
    (counts & 0xf) as u32
}

const fn readings_of(counts: u8) -> u32 {
    (counts >> 4) as u32
}

impl<const W: usize> Serialize for Fact<W> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() {
            return Named::from(self.clone()).serialize(serializer);
        }
        let (evidence, readings) = (self.evidence.len(), self.readings.len());
        let mut tuple = serializer.serialize_tuple(3 + evidence + readings)?;
        tuple.serialize_element(&self.anchor)?;
        tuple.serialize_element(&self.purpose)?;
        tuple.serialize_element(&counts(evidence, readings))?;
        self.evidence.iter().try_for_each(|known| tuple.serialize_element(known))?;
        self.readings.iter().try_for_each(|halves| tuple.serialize_element(halves))?;
        tuple.end()
    }
}

impl<'de, const W: usize> Deserialize<'de> for Fact<W> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            return Named::deserialize(deserializer).map(Self::from);
        }
        deserializer.deserialize_tuple(3 + MAX_EVIDENCE + MAX_VALUES / 2, FactVisitor)
    }
}

/// A fact by the names of its parts, for people.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Fact", deny_unknown_fields)]
struct Named {
    anchor: Cell,
    purpose: Purpose,
    evidence: Announced,
    readings: AnnouncedReadings,
}

impl<const W: usize> From<Fact<W>> for Named {
    fn from(Fact { anchor, purpose, evidence, readings }: Fact<W>) -> Self {
        Self { anchor, purpose, evidence, readings }
    }
}

impl<const W: usize> From<Named> for Fact<W> {
    fn from(Named { anchor, purpose, evidence, readings }: Named) -> Self {
        Self { anchor, purpose, evidence, readings }
    }
}

/// Reads what a fact writes.
struct FactVisitor<const W: usize>;

impl<'de, const W: usize> Visitor<'de> for FactVisitor<W> {
    type Value = Fact<W>;

    fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("a fact")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut from: A) -> Result<Fact<W>, A::Error> {
        let mut fact = Fact { anchor: next(&mut from)?, purpose: next(&mut from)?, ..Fact::default() };
        let counts = next(&mut from)?;
        for _ in 0..evidence_of(counts) {
            fact.evidence.push(next(&mut from)?).map_err(|_| A::Error::custom("too much evidence"))?;
        }
        for _ in 0..readings_of(counts) {
            fact.readings.push(next(&mut from)?).map_err(|_| A::Error::custom("too many readings"))?;
        }
        Ok(fact)
    }
}

fn next<'de, T: Deserialize<'de>, A: SeqAccess<'de>>(from: &mut A) -> Result<T, A::Error> {
    from.next_element()?.ok_or_else(|| A::Error::custom("a fact ends too early"))
}

/// The most bytes of all that a robot names in a message, as evidence, as readings and as
/// way-points.
pub(super) const NAMED_BYTES: usize = MAX_EVIDENCE * PLACE_BYTES;

/// The bytes that a cell with its evidence takes, and a way-point at the most.
pub(super) const PLACE_BYTES: usize = 3;

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
        Fact { anchor: Cell(anchor), evidence: evidence.collect(), ..Fact::default() }
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
