//! Strangers: robots that are no members and say nothing. Where they go shows in how they move.

use super::readings::Readings;
use super::unknown::{Effect, MAX_UNKNOWNS, MAX_VALUES, Unknown};
use crate::bounded::up_to;
use crate::grid::{Cell, CellSet, Map};
use crate::math;
use heapless::Vec;

/// The nats by which a move is less likely for each move that it leads away from where a stranger
/// goes.
const GOING: f32 = 1.5;

/// The ticks after which a stranger that stands is an obstacle, for as long as it stands.
const PARKED: u8 = 4;

/// The nats by which one value must be likelier than every other one for a stranger that stands on
/// its cell to count as arrived.
const ARRIVED: f32 = 5.0;

/// Where a robot that is no member is seen in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sighting {
    /// The unknown that says where it goes, by its place in the mission.
    pub unknown: u8,
    /// The cell that it stands on.
    pub at: Cell,
}

/// What a robot has seen of a stranger.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Track {
    /// Where it was in the last tick, if it was seen then.
    at: Option<Cell>,
    /// The ticks for which it has stood there.
    stood: u8,
}

/// What a robot has seen of the strangers of its mission, by their unknowns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Strangers([Track; MAX_UNKNOWNS]);

impl Strangers {
    pub(super) const NONE: Self = Self([Track { at: None, stood: 0 }; MAX_UNKNOWNS]);

    /// Notes where the stranger of an unknown is seen; returns where it was in the tick before, if
    /// it was seen then too.
    pub(super) fn note(&mut self, number: usize, at: Option<Cell>) -> Option<Cell> {
        let track = self.0.get_mut(number)?;
        let before = core::mem::replace(&mut track.at, at);
        track.stood = if at.is_some() && at == before { track.stood.saturating_add(1) } else { 0 };
        before
    }

    /// Where strangers are now, by their unknowns.
    pub(super) fn seen(&self) -> impl Iterator<Item = (usize, Cell)> + '_ {
        self.0.iter().enumerate().filter_map(|(number, track)| Some((number, track.at?)))
    }

    /// Whether a stranger has stood for so long that it is in the way.
    pub(super) fn is_parked(&self, number: usize) -> bool {
        self.0.get(number).is_some_and(|track| track.stood >= PARKED)
    }

    /// The cells on which strangers that are in view may be at the end of this tick: one that has
    /// arrived stays.
    pub(super) fn reach<const W: usize>(
        &self,
        unknowns: &[Unknown<'_>],
        readings: &Readings,
        map: &Map<W>,
    ) -> CellSet<W> {
        let mut cells = CellSet::EMPTY;
        for (number, at) in self.seen() {
            cells.insert(at);
            if !(self.is_parked(number) && has_arrived(unknowns, number, readings, at)) {
                map.free_neighbours(at).for_each(|(_, next)| _ = cells.insert(next));
            }
        }
        cells
    }
}

/// Whether a stranger stands on the cell to which it goes, as far as its moves tell.
fn has_arrived(unknowns: &[Unknown<'_>], number: usize, readings: &Readings, at: Cell) -> bool {
    let places = unknowns.get(number).map_or(&[][..], |unknown| unknown.cells);
    let value = places.iter().find(|place| place.cell == at).map(|place| place.value);
    value.is_some_and(|value| readings.lead(unknowns, number, value) >= ARRIVED)
}

/// The log-likelihood of what a stranger has done in a tick for each value of its unknown, in nats:
/// P(move | value) ∝ exp(-1.5 × what it adds to the way), over the moves that its cell allows; it
/// stands where it would go to a cell on which a member is.
///
/// `None` where that says nothing. One that stands says something beside a member, and on a cell to
/// which it may go: elsewhere something may hold it up that is not known.
///
/// Costs one distance table on the stack for each value.
#[inline(never)] // its table is on the stack only while it is made
pub(super) fn likelihoods<const S: usize, const W: usize>(
    unknown: &Unknown<'_>,
    map: &Map<W>,
    (from, to): (Cell, Cell),
    members: &CellSet<W>,
) -> Option<Vec<f32, MAX_VALUES>> {
    let held_up_by =
        || map.free_neighbours(from).map(|(_, next)| next).filter(|next| members.contains(*next));
    let is_at_place = || unknown.cells.iter().any(|place| place.cell == to);
    let stands = from == to && (held_up_by().next().is_some() || is_at_place());
    let moves = map.free_neighbours(from).any(|(_, next)| next == to);
    if unknown.effect != Effect::Takes || !(stands || moves) {
        return None;
    }
    let mut distances = [u8::MAX; S];
    let nats = (0..unknown.values()).map(|value| {
        map.distances(&unknown.cells_of(value).collect(), &CellSet::EMPTY, &mut distances);
        let distance = |cell: Cell| distances.get(cell.index()).copied().map_or(0.0, f32::from);
        let weight = |next: Cell| math::exp(-GOING * (distance(next) - distance(from)));
        let all: f32 = map.free_neighbours(from).map(|(_, next)| weight(next)).sum();
        let held_up: f32 = held_up_by().filter(|_| stands).map(weight).sum();
        math::ln(weight(to) + held_up) - math::ln(1.0 + all)
    });
    Some(up_to(nats))
}

#[cfg(test)]
mod tests {
    use super::super::unknown::Place;
    use super::*;

    /// Three goals: in two corners, and at the end of a dead end.
    const MAP: &str =
        "....#....\n....#....\n....#....\n.........\n.........\n.........\n...#.#...\n...#.#...\n...#.#...";
    const PLACES: [Place; 3] = [Place::new(Cell(0), 0), Place::new(Cell(8), 1), Place::new(Cell(76), 2)];
    const UNKNOWN: Unknown<'_> =
        Unknown { effect: Effect::Takes, cells: &PLACES, prior: &[1.0 / 3.0; 3], sights: &[] };

    fn map() -> Map<3> {
        Map::drawn(MAP).unwrap()
    }

    /// The belief after the stranger has been on these cells in successive ticks.
    fn belief(cells: &[u16]) -> [f32; 3] {
        belief_beside(&[], cells)
    }

    /// The same with members on some cells.
    fn belief_beside(members: &[u16], cells: &[u16]) -> [f32; 3] {
        let members = members.iter().copied().map(Cell).collect();
        let mut readings = Readings::NONE;
        for pair in cells.windows(2) {
            let way = (Cell(pair[0]), Cell(pair[1]));
            if let Some(nats) = likelihoods::<81, 3>(&UNKNOWN, &map(), way, &members) {
                readings.add(&[UNKNOWN], 0, &nats);
            }
        }
        let mut belief = [0, 1, 2].map(|value| -readings.against(&[UNKNOWN], 0, value));
        math::softmax(&mut belief);
        belief
    }

    #[test]
    fn each_move_speaks_for_where_it_leads() {
        let [left, right, down] = belief(&[40, 49]);
        assert!(down > 0.9 && left < 0.05 && (left - right).abs() < 0.01, "{left} {right} {down}");
        let [left, right, down] = belief(&[40, 31]);
        assert!((left - right).abs() < 0.01 && down < 0.06, "{left} {right} {down}");
        let [left, right, down] = belief(&[40, 39]);
        assert!(left > 0.85 && right < 0.07 && down < 0.1, "{left} {right} {down}");
    }

    /// On the way to each goal, over all shortest ways: 77 % after one move, 97 % after two.
    #[test]
    fn two_moves_are_enough_where_ways_part_early() {
        let left = [&[40, 39, 38], &[40, 39, 30], &[40, 31, 30], &[40, 31, 30]];
        let right = [&[40, 41, 42], &[40, 41, 32], &[40, 31, 32], &[40, 31, 32]];
        let mean = |moves: usize| {
            let of = |ways: [&[u16; 3]; 4], goal: usize| {
                ways.map(|way| belief(&way[..=moves])[goal]).iter().sum::<f32>() / 4.0
            };
            (of(left, 0) + of(right, 1) + of([&[40, 49, 58]; 4], 2)) / 3.0
        };
        let means = [0, 1, 2].map(mean);
        let expected = [0.333, 0.766, 0.973];
        assert!(means.iter().zip(expected).all(|(mean, p)| (mean - p).abs() < 0.01), "{means:?}");
    }

    #[test]
    fn one_that_stands_says_something_only_where_it_may_have_come_to_its_end() {
        assert_eq!(belief(&[40, 40, 40]), [1.0 / 3.0; 3]);
        assert!(belief(&[8, 8, 8])[1] > 0.9);
        assert_eq!(belief(&[40, 42]), [1.0 / 3.0; 3], "no single move");
        let blocks = Unknown { effect: Effect::Blocks, ..UNKNOWN };
        assert!(likelihoods::<81, 3>(&blocks, &map(), (Cell(40), Cell(41)), &CellSet::EMPTY).is_none());
    }

    #[test]
    fn one_that_stands_beside_a_member_would_go_where_that_is() {
        let [left, right, down] = belief_beside(&[49], &[40, 40, 40]);
        assert!(down > 0.9 && (left - right).abs() < 0.01, "{left} {right} {down}");
        assert!(belief_beside(&[7], &[8, 8, 8])[1] > 0.5, "it may have come to its end");
    }

    #[test]
    fn a_stranger_may_be_wherever_a_move_takes_it_until_it_has_arrived() {
        let (mut strangers, mut readings) = (Strangers::NONE, Readings::NONE);
        let reach = |strangers: &Strangers, readings: &Readings| {
            strangers
                .reach(&[UNKNOWN], readings, &map())
                .iter()
                .map(|cell| cell.0)
                .collect::<std::vec::Vec<_>>()
        };
        assert_eq!(strangers.note(0, Some(Cell(0))), None);
        assert_eq!(reach(&strangers, &readings), [0, 1, 9]);
        for _ in 0..PARKED {
            assert!(!strangers.is_parked(0));
            strangers.note(0, Some(Cell(0)));
        }
        assert!(strangers.is_parked(0));
        assert_eq!(reach(&strangers, &readings), [0, 1, 9], "it may go on");
        readings.add(&[UNKNOWN], 0, &[0.0, -6.0, -6.0]);
        assert_eq!(reach(&strangers, &readings), [0]);
        assert_eq!(strangers.note(0, None), Some(Cell(0)));
        assert!(reach(&strangers, &readings).is_empty() && !strangers.is_parked(0));
    }
}
