//! Which cells can be left for which ones in a step: the arcs of the flow.
//!
//! The cells are coloured like a chessboard. In the steps of one parity robots enter cells of one
//! colour only, in the others cells of the other colour. In such a step a cell is entered or left
//! and never both, so that no robots follow, swap or rotate whatever paths the flow consists of. A
//! plan is at most one step longer for it: each move of any plan without following can be put off
//! to the next step of its colour without changing the order of the moves.
//!
//! Time runs backwards here: layer 0 is the arrival, layer `T` the start.

use super::super::spread::Spread;
use super::super::{Cell, CellSet, Map};
use super::{Problem, Target};

/// Which cells may be entered in which steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Turn {
    /// Black cells on even layers, white ones on odd layers.
    #[default]
    BlackLast,
    /// White cells on even layers, black ones on odd layers.
    WhiteLast,
    /// All cells at all times: for one robot alone.
    Both,
}

impl Turn {
    /// The other of two colours.
    pub(super) fn other(self) -> Self {
        match self {
            Self::BlackLast => Self::WhiteLast,
            Self::WhiteLast => Self::BlackLast,
            Self::Both => Self::Both,
        }
    }
}

/// The ground of a problem, and the rules of one search on it.
#[derive(Clone, Debug)]
pub(super) struct Network<const W: usize> {
    spread: Spread<W>,
    /// Cells that may be entered; a robot may also stand where it starts.
    enterable: CellSet<W>,
    black: CellSet<W>,
    /// Those that may be entered on even and on odd layers.
    entered: [CellSet<W>; 2],
    /// Those that no robot may come from to layer 0 and to layer 1.
    not_before: [CellSet<W>; 2],
}

impl<const W: usize> Network<W> {
    /// The network of a map without cells.
    pub(super) const NOTHING: Self = Self {
        spread: Spread::NOTHING,
        enterable: CellSet::EMPTY,
        black: CellSet::EMPTY,
        entered: [CellSet::EMPTY; 2],
        not_before: [CellSet::EMPTY; 2],
    };

    pub(super) fn of(problem: &Problem<'_, W>) -> Self {
        let enterable = problem.enterable();
        let movers = problem.errands.iter().filter(|errand| errand.target != Target::Stand);
        let starts = movers.map(|errand| errand.from).collect();
        let spread = Spread::within(problem.map, enterable.union(&starts));
        Self { spread, enterable, black: black_cells(problem.map), ..Self::NOTHING }
    }

    /// Sets the rules of the next search. The cells of `entered_last` are entered in the last two
    /// steps or not at all, and no robot leaves them with its last move, so that none waits for
    /// another there.
    pub(super) fn set_rules(&mut self, turn: Turn, entered_last: CellSet<W>) {
        let black = self.enterable.intersection(&self.black);
        let white = self.enterable.without(&self.black);
        self.entered = match turn {
            Turn::BlackLast => [black, white],
            Turn::WhiteLast => [white, black],
            Turn::Both => [self.enterable; 2],
        };
        self.not_before = [self.entered(&entered_last, 0), entered_last];
    }

    /// The cells on which a robot can be.
    pub(super) fn passable(&self) -> &CellSet<W> {
        self.spread.cells()
    }

    /// The cells that a robot may enter.
    pub(super) fn enterable(&self) -> &CellSet<W> {
        &self.enterable
    }

    /// The cells of a layer that can be entered in the step that leads to it.
    pub(super) fn entered(&self, cells: &CellSet<W>, layer: usize) -> CellSet<W> {
        let [even, odd] = &self.entered;
        cells.intersection(if layer.is_multiple_of(2) { even } else { odd })
    }

    /// The cells from which a step leads into the cells of a layer, waits included.
    pub(super) fn before(&self, cells: &CellSet<W>, layer: usize) -> CellSet<W> {
        let from = self.spread.from(&self.entered(cells, layer)).union(cells);
        self.not_before.get(layer).map_or(from, |closed| from.without(closed))
    }

    /// Whether a robot may stay on a cell in the step that leads to a layer.
    pub(super) fn may_wait(&self, cell: Cell, layer: usize) -> bool {
        self.not_before.get(layer).is_none_or(|closed| !closed.contains(cell))
    }

    /// The cells beside a cell, whether or not they can be entered, in the order of their numbers.
    pub(super) fn beside(&self, cell: Cell) -> impl Iterator<Item = Cell> + Clone {
        self.spread.beside(cell)
    }

    /// The cells from which one move at any time leads into some of these, and these.
    pub(super) fn around(&self, cells: &CellSet<W>) -> CellSet<W> {
        self.spread.from(&cells.intersection(&self.enterable)).union(cells)
    }

    /// The turn in which a robot at `cell` can move in the first of `steps` steps.
    pub(super) fn turn_of(&self, cell: Cell, steps: usize) -> Turn {
        let enters_black = !self.black.contains(cell);
        let last_layer_is_even = steps.saturating_sub(1).is_multiple_of(2);
        if enters_black == last_layer_is_even { Turn::BlackLast } else { Turn::WhiteLast }
    }
}

/// The cells whose row and column are both even or both odd.
fn black_cells<const W: usize>(map: &Map<W>) -> CellSet<W> {
    let mut black = CellSet::EMPTY;
    let mut cell = 0;
    for row in 0..map.height() {
        for column in 0..map.width() {
            if (row + column) % 2 == 0 {
                black.insert(Cell(cell));
            }
            cell += 1;
        }
    }
    black
}

#[cfg(test)]
mod tests {
    use super::super::super::pictures::drawn;
    use super::super::Errand;
    use super::*;
    use std::vec::Vec;

    fn network(errands: &[Errand], closed: &[u16]) -> Network<32> {
        let map = drawn(&["...", "...", "..."]);
        let closed = closed.iter().copied().map(Cell).collect();
        Network::of(&Problem { closed, ..Problem::new(&map, errands) })
    }

    fn cells(set: &CellSet<32>) -> Vec<u16> {
        set.iter().map(|cell| cell.0).collect()
    }

    fn at(cell: u16) -> CellSet<32> {
        [Cell(cell)].into_iter().collect()
    }

    #[test]
    fn a_cell_is_entered_in_the_steps_of_its_colour() {
        let mut network = network(&[], &[]);
        network.set_rules(Turn::BlackLast, CellSet::EMPTY);
        assert_eq!(cells(&network.before(&at(4), 0)), [1, 3, 4, 5, 7]);
        assert_eq!(cells(&network.before(&at(4), 1)), [4]);
        assert_eq!(cells(&network.before(&at(1), 1)), [0, 1, 2, 4]);
        network.set_rules(Turn::WhiteLast, CellSet::EMPTY);
        assert_eq!(cells(&network.before(&at(4), 0)), [4]);
        network.set_rules(Turn::Both, CellSet::EMPTY);
        assert_eq!(cells(&network.before(&at(4), 0)), [1, 3, 4, 5, 7]);
        assert_eq!(cells(&network.before(&at(4), 1)), [1, 3, 4, 5, 7]);
    }

    #[test]
    fn a_goal_is_entered_in_the_last_step_of_its_colour() {
        let mut network = network(&[], &[]);
        network.set_rules(Turn::BlackLast, at(4).union(&at(1)));
        assert_eq!(cells(&network.before(&at(4), 0)), [1, 3, 5, 7]);
        assert_eq!(cells(&network.before(&at(1), 0)), [1]);
        assert_eq!(cells(&network.before(&at(1), 1)), [0, 2], "nobody leaves 4 with its last move");
        assert_eq!(cells(&network.before(&at(4), 2)), [1, 3, 4, 5, 7]);
        assert!(!network.may_wait(Cell(4), 0) && network.may_wait(Cell(3), 0));
    }

    #[test]
    fn a_closed_cell_is_left_and_not_entered() {
        let errands = [Errand { from: Cell(4), target: Target::Any }];
        let mut network = network(&errands, &[4, 8]);
        network.set_rules(Turn::BlackLast, CellSet::EMPTY);
        assert_eq!(cells(&network.before(&at(1), 1)), [0, 1, 2, 4]);
        assert_eq!(cells(&network.before(&at(4), 0)), [4]);
        assert!(!network.passable().contains(Cell(8)));
    }

    #[test]
    fn a_robot_that_stands_is_a_wall() {
        let errands = [Errand { from: Cell(4), target: Target::Stand }];
        assert_eq!(cells(&network(&errands, &[]).around(&at(1))), [0, 1, 2]);
        assert!(!network(&errands, &[]).enterable().contains(Cell(4)));
    }

    #[test]
    fn the_first_step_is_the_robots_turn() {
        let mut network = network(&[], &[]);
        for (cell, steps) in [(0, 1), (0, 2), (1, 1), (1, 2)] {
            network.set_rules(network.turn_of(Cell(cell), steps), CellSet::EMPTY);
            let next = [Cell(1), Cell(4), Cell(0)].into_iter().collect();
            let before = network.before(&next, steps - 1);
            assert!(network.entered(&next, steps - 1).iter().all(|to| to.0 % 2 != cell % 2), "{cell}");
            assert!(before.contains(Cell(cell)));
        }
    }
}
