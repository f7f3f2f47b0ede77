//! A stranger: a robot that is no member of the team, hears nothing and says nothing.

use crate::random::{Random, Stream};
use crate::scenario::{Floor, MAX_CELLS, Scenario, StrangerSpec, UnknownSpec};
use iibt_core::grid::{Cell, Planner};

/// A robot that goes to a goal of its own, a move a tick, along one of the shortest ways. It sees
/// where robots are, and waits where the next cell is taken.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stranger {
    /// The unknown that says where it goes, by its place in the scenario.
    pub(crate) unknown: u8,
    /// How far it is seen.
    range: Option<u16>,
    pub(crate) cell: Cell,
    to: Cell,
}

impl Stranger {
    /// The strangers of a scenario whose unknowns have these values.
    pub(crate) fn of(scenario: &Scenario, values: &[u8]) -> Vec<Self> {
        let all = (0..).zip(&scenario.unknowns).zip(values);
        let stranger = |((number, unknown), &value): ((_, &UnknownSpec), &u8)| {
            let StrangerSpec { start, range } = unknown.stranger?;
            let to = unknown.cells.iter().find(|place| place.value == value)?.cell;
            Some(Self { unknown: number, range, cell: start, to })
        };
        all.filter_map(stranger).collect()
    }

    /// The draws of the strangers of a flight.
    pub(crate) fn draws(seed: u64) -> Random {
        Random::of(seed, Stream::Stranger)
    }

    /// Whether it is seen from so many cells away, diagonals included.
    pub(crate) fn is_seen_from(&self, distance: u16) -> bool {
        self.range.is_none_or(|range| distance <= range)
    }

    /// The cell on which it stands after this tick. Of several next cells that are as near to its
    /// goal one is drawn.
    pub(crate) fn next(&self, floor: &Floor, taken: &[Cell], random: &mut Random) -> Cell {
        let mut planner = Planner::<MAX_CELLS>::new();
        let Ok(distances) = planner.distances(floor, self.to) else { return self.cell };
        let left = distances.to(self.cell);
        let nearer =
            |&(_, next): &(_, Cell)| distances.to(next).zip(left).is_some_and(|(next, left)| next < left);
        let ways: Vec<Cell> = floor.free_neighbours(self.cell).filter(nearer).map(|(_, next)| next).collect();
        // A number is drawn in any case, so that a way that is taken does not change later draws.
        let drawn = random.below(ways.len().max(1));
        ways.get(drawn).copied().filter(|next| !taken.contains(next)).unwrap_or(self.cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_on_a_shortest_way_and_waits_for_what_is_in_it() {
        let text = "title = 't'\nneed = 1\nmap = '''\n1.G\n.#.\nG..\n2..\n'''\n[[unknown]]\ntakes = [[2], [6]]\n\
                    prior = [0.5, 0.5]\nstart = 8";
        let scenario = Scenario::parse("test", text).unwrap();
        let mut random = Stranger::draws(1);
        let mut stranger = Stranger::of(&scenario, &[1])[0];
        let mut go = |taken: &[Cell]| {
            stranger.cell = stranger.next(&scenario.map, taken, &mut random);
            stranger.cell.0
        };
        assert_eq!((go(&[Cell(7)]), go(&[]), go(&[]), go(&[])), (8, 7, 6, 6));
    }
}
