//! Readings of unknowns: what a robot has gathered of each value, and what it announces.
//!
//! Evidence is a log-likelihood, relative to the value for which the readings speak most. Every
//! robot announces its own sums; the team's belief is the prior with the sums of all members, so
//! nothing is counted twice, and a lost frame does no harm. The moves of a stranger are seen by
//! all: of these the sums of one member count.

use super::decider::Counting;
use super::unknown::{Effect, MAX_VALUES, Reading, Says, Unknown};
use crate::bounded::up_to;
use crate::grid::Cell;
use crate::math;
use core::ops::Range;
use heapless::Vec;

/// What a robot announces about the values of all unknowns, in their order: how much less likely
/// its readings are for a value than for the likeliest one of the same unknown, in half nats, two
/// values a byte, the first in the low half. Empty as long as it has read nothing.
pub type AnnouncedReadings = Vec<u8, { MAX_VALUES / 2 }, u8>;

/// Sixteenths of a nat in the half nat that is announced.
const STEP: u8 = 8;

/// The most that all readings of one robot speak against a value, in sixteenths of a nat, so that a
/// few readings can turn it round.
const CAP: u8 = 15 * STEP;

/// The likelihood of a value against which a robot's readings speak as much as they can: exp(-7.5).
pub(super) const LEAST_LIKELIHOOD: f32 = 0.000_553_084_4;

/// What a robot has read of the unknowns of its mission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Readings {
    /// How much less likely they are for each value of each unknown than for the likeliest one, in
    /// sixteenths of a nat.
    against: [u8; MAX_VALUES],
}

impl Readings {
    pub(super) const NONE: Self = Self { against: [0; MAX_VALUES] };

    /// Counts a reading that was taken at a cell. One of which the mission says nothing counts for
    /// nothing.
    pub(super) fn count(&mut self, unknowns: &[Unknown<'_>], reading: Reading, at: Cell, counting: Counting) {
        let number = usize::from(reading.unknown);
        let Some(unknown) = unknowns.get(number) else { return };
        let Some(sight) = unknown.sight(at, reading.says.tells()) else { return };
        let nats = math::ln(sight.right) - math::ln(sight.wrong(unknown.values()));
        let (value, speaks_for) = match reading.says {
            Says::Value(value) | Says::Is(value) => (value, nats > 0.0),
            Says::IsNot(value) => (value, nats <= 0.0),
        };
        // A cast saturates, and what is no number becomes zero.
        let weight = (16.0 * nats.abs() + 0.5).min(CAP.into()) as u8;
        let Some(against) = self.against.get_mut(places_of(unknowns, number)) else { return };
        if counting != Counting::Sums {
            return take_as_fact(against, (value, speaks_for), counting == Counting::First);
        }
        for (place, sum) in (0..).zip(against.iter_mut()) {
            if (place == value) != speaks_for {
                *sum = sum.saturating_add(weight);
            }
        }
        level(against);
    }

    /// Counts what was seen of an unknown by its log-likelihood for each value, in nats.
    pub(super) fn add(&mut self, unknowns: &[Unknown<'_>], number: usize, nats: &[f32]) {
        let Some(against) = self.against.get_mut(places_of(unknowns, number)) else { return };
        let most = nats.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        for (sum, nats) in against.iter_mut().zip(nats) {
            // A cast saturates, and what is no number becomes zero.
            *sum = sum.saturating_add((16.0 * (most - nats) + 0.5).min(CAP.into()) as u8);
        }
        level(against);
    }

    /// How much speaks against a value of an unknown, in nats.
    pub(super) fn against(&self, unknowns: &[Unknown<'_>], number: usize, value: u8) -> f32 {
        let of = self.against.get(places_of(unknowns, number)).unwrap_or_default();
        of.get(usize::from(value)).map_or(0.0, |&sum| f32::from(sum) / 16.0)
    }

    /// How much more speaks against every other value of an unknown than against this one, in nats.
    pub(super) fn lead(&self, unknowns: &[Unknown<'_>], number: usize, value: u8) -> f32 {
        let values = unknowns.get(number).map_or(0, Unknown::values);
        let others = (0..values).filter(|&other| other != value);
        let least = others.map(|other| self.against(unknowns, number, other)).fold(f32::INFINITY, f32::min);
        least - self.against(unknowns, number, value)
    }

    /// What to announce of them in a mission whose unknowns have so many values.
    pub(super) fn announced(&self, values: usize) -> AnnouncedReadings {
        let halves = |pair: &[u8]| {
            let half = |at: usize| pair.get(at).map_or(0, |&sum| (sum + STEP / 2) / STEP);
            half(0) | half(1) << 4
        };
        let sums = self.against.get(..values).unwrap_or(&self.against);
        if sums.iter().all(|&sum| sum < STEP / 2) {
            AnnouncedReadings::new()
        } else {
            up_to(sums.chunks(2).map(halves))
        }
    }
}

/// Takes a reading of a value, and whether it speaks for it, for a fact. One that contradicts
/// earlier ones is ignored where these stay, and takes their place else.
fn take_as_fact(against: &mut [u8], (value, speaks_for): (u8, bool), stays: bool) {
    let is_against = |place: u8| (place == value) != speaks_for;
    let fits = (0..).zip(against.iter()).any(|(place, sum)| !is_against(place) && *sum < CAP);
    if stays && !fits {
        return;
    }
    for (place, sum) in (0..).zip(against.iter_mut()) {
        if is_against(place) {
            *sum = CAP;
        } else if !fits {
            *sum = 0;
        }
    }
}

/// Lets the value against which least speaks have nothing against it.
fn level(against: &mut [u8]) {
    let least = against.iter().copied().min().unwrap_or(0);
    against.iter_mut().for_each(|sum| *sum = (*sum - least).min(CAP));
}

/// The places of the values of an unknown among those of all.
pub(super) fn places_of(unknowns: &[Unknown<'_>], number: usize) -> Range<usize> {
    let first = unknowns.iter().take(number).map(|other| other.prior.len()).sum();
    first..first + unknowns.get(number).map_or(0, |unknown| unknown.prior.len())
}

/// How much evidence speaks against a value, in half nats, by its place among those of all
/// unknowns.
fn halves_against(evidence: &AnnouncedReadings, place: usize) -> u8 {
    evidence.get(place / 2).map_or(0, |byte| byte >> (4 * (place % 2)) & 0xf)
}

/// What these robots have read together, in nats for each value of each unknown.
///
/// Readings of robots add up. But all see the same moves of a stranger: of these those of one robot
/// count, that whose evidence says most, the first of equals.
pub(super) fn evidence<'e>(
    unknowns: &[Unknown<'_>],
    of: impl Iterator<Item = &'e AnnouncedReadings> + Clone,
) -> impl Fn(usize, usize) -> f32 {
    move |number, value| {
        let places = places_of(unknowns, number);
        let against = |told: &AnnouncedReadings| halves_against(told, places.start + value);
        let says = |told: &AnnouncedReadings| {
            places.clone().map(|place| u16::from(halves_against(told, place))).sum::<u16>()
        };
        let takes = unknowns.get(number).is_some_and(|unknown| unknown.effect == Effect::Takes);
        let halves: u16 = if takes {
            let most = of.clone().reduce(|most, told| if says(told) > says(most) { told } else { most });
            most.map_or(0, |told| against(told).into())
        } else {
            of.clone().map(|told| u16::from(against(told))).sum()
        };
        -0.5 * f32::from(halves)
    }
}

#[cfg(test)]
mod tests {
    use super::super::unknown::{Sight, Tells};
    use super::*;

    const SIGHTS: [Sight; 2] = [
        Sight { from: Cell(1), tells: Tells::Value, right: 0.9 },
        Sight { from: Cell(2), tells: Tells::Whether(2), right: 1.0 },
    ];

    fn unknowns() -> [Unknown<'static>; 2] {
        let of = |prior| Unknown { effect: Effect::Serves, cells: &[], prior, sights: &SIGHTS };
        [of(&[0.5, 0.5]), of(&[0.4, 0.3, 0.3])]
    }

    fn after(says: &[(u8, Says)]) -> [f32; 5] {
        let mut readings = Readings::NONE;
        says.iter().for_each(|&(unknown, says)| {
            readings.count(&unknowns(), Reading { unknown, says }, Cell(1), Counting::Sums);
        });
        let evidence = readings.announced(5);
        [0, 1, 2, 3, 4].map(|place| 0.5 * f32::from(halves_against(&evidence, place)))
    }

    #[test]
    fn readings_add_up_by_value_and_are_announced_in_half_nats() {
        assert_eq!(after(&[]), [0.0; 5]);
        // ln 9 = 2.2 for two values, ln 18 = 2.9 for three.
        assert_eq!(after(&[(0, Says::Value(1))]), [2.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(after(&[(1, Says::Value(0)); 2]), [0.0, 0.0, 0.0, 6.0, 6.0]);
        assert_eq!(after(&[(0, Says::Value(1)), (0, Says::Value(0))]), [0.0; 5]);
    }

    #[test]
    fn a_reading_that_is_never_wrong_is_as_sure_as_can_be() {
        assert_eq!(after(&[(1, Says::IsNot(2))]), [0.0, 0.0, 0.0, 0.0, 7.5]);
        assert_eq!(after(&[(1, Says::Is(2)); 3]), [0.0, 0.0, 7.5, 7.5, 0.0]);
    }

    /// What two robots that have seen this of an unknown with an effect tell together.
    fn together(effect: Effect, seen: [[f32; 3]; 2]) -> [f32; 3] {
        let unknowns = [Unknown { effect, cells: &[], prior: &[0.4, 0.3, 0.3], sights: &[] }];
        let told = seen.map(|nats| {
            let mut readings = Readings::NONE;
            readings.add(&unknowns, 0, &nats);
            readings.announced(3)
        });
        let together = evidence(&unknowns, told.iter());
        [0, 1, 2].map(|value| together(0, value))
    }

    #[test]
    fn what_all_see_counts_once_and_what_each_reads_adds_up() {
        let (seen, more) = ([0.0, -2.0, -1.0], [-3.0, 0.0, -1.0]);
        assert_eq!(together(Effect::Takes, [seen; 2]), seen);
        assert_eq!(together(Effect::Takes, [seen, more]), more, "it says more");
        assert_eq!(together(Effect::Takes, [more, seen]), more);
        assert_eq!(together(Effect::Serves, [seen; 2]), [0.0, -4.0, -2.0]);
        assert_eq!(together(Effect::Serves, [seen, more]), [-3.0, -2.0, -2.0]);
    }

    #[test]
    fn facts_stay_or_give_way() {
        let [cap, none] = [CAP, 0];
        let after = |readings: &[(u8, bool)], stays: bool| {
            let mut against = [0; 3];
            readings.iter().for_each(|&reading| take_as_fact(&mut against, reading, stays));
            against
        };
        let (not_first, second, first) = ((0, false), (1, true), (0, true));
        assert_eq!(after(&[not_first, second], true), [cap, none, cap], "they go together");
        assert_eq!(after(&[not_first, second, first], true), [cap, none, cap]);
        assert_eq!(after(&[not_first, second, first], false), [none, cap, cap]);
    }

    #[test]
    fn what_the_mission_does_not_have_counts_for_nothing() {
        assert_eq!(after(&[(2, Says::Value(0)), (0, Says::Is(1)), (1, Says::Is(1))]), [0.0; 5]);
    }
}
