//! What a navigating robot announces: its fact, its scores, and the plan that it follows.

use super::fact::{Fact, PLACE_BYTES};
use super::frame_size::{READINGS_IN_PLACE, places};
use super::handover::PendingWaypoints;
use super::obstacles::MAX_EVIDENCE;
use super::unknown::{Unknown, values};
use crate::team::rounds::{Answer, Proposal, RoundMessage};
use crate::team::{Invalid, Message, reading};
use serde::{Deserialize, Serialize};

/// A navigating robot's message, on a map of `W` words with up to `K` joint policies.
///
/// It is complete: a lost one costs time and nothing else. From it and the mission anybody can
/// compute the joint plan: its facts give the list of policies, and the choice is a number in that
/// list with its posterior probability.
#[doc(alias = "plan sharing")]
#[doc(alias = "commitment")]
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Intention<const W: usize, const K: usize> {
    /// Its part of the rounds.
    pub rounds: RoundMessage<Fact<W>, K>,
    /// The way-points that it has yet to visit, in their order, beside one that its fact names:
    /// no more than leave room for the evidence.
    pub waypoints: PendingWaypoints,
}

impl<const W: usize, const K: usize> AsRef<RoundMessage<Fact<W>, K>> for Intention<W, K> {
    fn as_ref(&self) -> &RoundMessage<Fact<W>, K> {
        &self.rounds
    }
}

impl<const W: usize, const K: usize> Message for Intention<W, K> {
    const SCHEMA: &'static str = "navigation 4: round u32; view u8; walls sequence scale u8 skipped u8 bits \
        sequence u8; anchor cell u16; purpose Goal, Visit cell u16, Charge cell u16, Stand; counts u8; evidence \
        cell u16 weight i8; readings u8; answer Listing u8, Scored digest 4 u8 scores sequence delay u8 price u8, Decided \
        digest 4 u8 option scores option policy u8 probability u8 step u16; waypoints sequence cell u16";

    // A way-point takes no more bytes than the evidence in whose place it is.
    const MAX_BYTES: usize =
        RoundMessage::<Fact<W>, K>::MAX_BYTES + 1 - PLACE_BYTES * (MAX_EVIDENCE - Self::PLACES);

    fn read(bytes: &[u8]) -> Option<(Self, &[u8])> {
        let rounds =
            RoundMessage { proposal: Proposal::first(0), fact: Fact::default(), answer: Answer::Listing(0) };
        let mut message = Self { rounds, waypoints: PendingWaypoints::new() };
        let rest = message.read_into(bytes)?;
        Some((message, rest))
    }

    #[inline(never)] // it is called in two places
    fn read_into<'b>(&mut self, bytes: &'b [u8]) -> Option<&'b [u8]> {
        let mut rest = self.rounds.read_into(bytes)?;
        reading::list(&mut self.waypoints, &mut rest)?;
        Some(rest)
    }

    fn validate(&self) -> Result<(), Invalid> {
        let Fact { evidence, readings, .. } = &self.rounds.fact;
        let named = evidence.len() + self.waypoints.len();
        if named <= Self::places_beside(readings.len()) { Ok(()) } else { Err(Self::TOO_MANY) }
    }
}

impl<const W: usize, const K: usize> Intention<W, K> {
    /// The most cells that the message names as evidence and as way-points together.
    pub const PLACES: usize = places(K);

    /// A cell is outside the map.
    pub const OUTSIDE: Invalid = Invalid("a cell is outside this robot's map");

    /// The number of way-points for which the message has room beside evidence and readings.
    pub(super) fn room(fact: &Fact<W>) -> usize {
        Self::places_beside(fact.readings.len()).saturating_sub(fact.evidence.len())
    }

    /// The number of cells for which the message has room beside so many bytes of readings.
    pub(super) const fn places_beside(readings: usize) -> usize {
        Self::PLACES.saturating_sub(readings.div_ceil(READINGS_IN_PLACE))
    }

    /// Whether the message has room for what is read of these.
    pub(super) fn has_room_for(unknowns: &[Unknown<'_>]) -> bool {
        values(unknowns).div_ceil(2) <= Self::PLACES * READINGS_IN_PLACE
    }

    /// There are more way-points than the evidence leaves room for.
    pub const TOO_MANY: Invalid = Invalid("there are more way-points than the frame has room for");

    /// Checks the message against a team of `team` robots on a map of `cells` cells.
    ///
    /// # Errors
    /// [`Invalid`] with the first value that does not fit.
    #[inline(never)] // what is only passed by reference is copied as a whole
    pub fn check(&self, team: usize, cells: usize) -> Result<(), Invalid> {
        self.rounds.validate(team)?;
        let are_inside = self.waypoints.iter().all(|cell| cell.index() < cells);
        if are_inside && self.rounds.fact.fits(cells) { Ok(()) } else { Err(Self::OUTSIDE) }
    }
}

#[cfg(feature = "defmt")]
impl<const W: usize, const K: usize> defmt::Format for Intention<W, K> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "{} way-points {}", self.rounds, self.waypoints);
    }
}
