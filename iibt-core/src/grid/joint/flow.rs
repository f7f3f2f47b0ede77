//! A maximum flow in the time-expanded grid: one path for each robot to a cell of a set.
//!
//! Robots that may end on any goal are a flow from their cells to the goals through a network with
//! one node for each cell and step, each of capacity one (Yu and LaValle, Multi-agent Path Planning
//! and Network Flow, WAFR 2012). The nodes that a search reaches are sets of cells, one for each
//! layer, so that a step of the search for all cells of a layer takes a few operations on words.
//!
//! The search for one more path runs from the goals at layer 0 back to the starts at layer `T`:
//! ```text
//! reached[t+1] = (cells from which a step leads into reached[t]) - (cells of paths at t+1)
//! ```
//! A path of the flow that it comes to at layer `t+1` can be led elsewhere from there, so that its
//! cells at all layers below can be given to another robot: they are reached too. `T` grows by one
//! when no start is reached: the flow waits one step more at its starts, and all that is reached
//! stays so. The first `need` paths end on goals, the others on any cell that is left; a path that
//! is led elsewhere never gives its goal up, only to the path that takes its place.
//!
//! How the new path is found in the sets is in [`walk`](super::walk).

use super::super::{Cell, CellSet, Map};
use super::network::Network;
use super::walk::Walk;

/// Where a search has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    /// From the goals to the starts.
    Search,
    /// Along a new path, from its start.
    Walk,
    /// As before, up to the moment at which the path of a robot was come to above a layer.
    Replay { path: usize, layer: usize },
    /// All robots have paths.
    Found,
    /// There are none of at most `latest` steps, or the search outgrew its arena.
    Failed,
}

/// What one search is to find.
#[derive(Clone, Copy, Debug)]
pub(super) struct Query<const W: usize> {
    /// Where the first `need` paths end.
    pub(super) goals: CellSet<W>,
    /// How many paths end on goals.
    pub(super) need: usize,
    /// The fewest steps to try.
    pub(super) first: usize,
    /// The most steps to try.
    pub(super) latest: usize,
}

/// The cells of all robots at every layer or step.
pub(super) type Table<const L: usize, const N: usize> = [[Cell; N]; L];

/// No cell: larger than the number of any cell of a map.
const NOWHERE: Cell = Cell(u16::MAX);

/// One flow of at most `N` robots over `W` words of cells and at most `L - 1` steps.
#[derive(Clone, Debug)]
pub(super) struct Flow<const W: usize, const L: usize, const N: usize> {
    pub(super) network: Network<W>,
    query: Query<W>,
    starts: [Cell; N],
    robots: usize,
    /// The paths of the flow, and from the end of each layer on those that are fixed.
    pub(super) paths: Table<L, N>,
    /// How many paths there are in the flow, and how many fixed ones.
    pub(super) matched: usize,
    fixed: usize,
    /// The number of steps now.
    pub(super) steps: usize,
    reached: [CellSet<W>; L],
    /// The layers below which the cells of each path are reached.
    touched: [usize; N],
    /// The highest layer whose reached cells are known.
    level: usize,
    pub(super) walk: Walk<L, N>,
    stage: Stage,
}

impl<const W: usize, const L: usize, const N: usize> Flow<W, L, N> {
    /// The most steps of a plan.
    pub(super) const LATEST: usize =
        if L > crate::actions::HORIZON { crate::actions::HORIZON } else { L - 1 };

    pub(super) const fn new() -> Self {
        Self {
            network: Network::NOTHING,
            query: Query { goals: CellSet::EMPTY, need: 0, first: 0, latest: 0 },
            starts: [NOWHERE; N],
            robots: 0,
            paths: [[NOWHERE; N]; L],
            matched: 0,
            fixed: 0,
            steps: 0,
            reached: [CellSet::EMPTY; L],
            touched: [0; N],
            level: 0,
            walk: Walk::new(),
            stage: Stage::Failed,
        }
    }

    /// Begins a search for the robots at `starts`, which keep clear of the fixed paths.
    pub(super) fn begin(&mut self, starts: impl IntoIterator<Item = Cell>, query: Query<W>) {
        self.robots = 0;
        for (slot, start) in self.starts.iter_mut().zip(starts) {
            *slot = start;
            self.robots += 1;
        }
        self.query = query;
        self.query.latest = query.latest.min(Self::LATEST);
        self.steps = query.first;
        self.matched = 0;
        self.stage = if self.steps > self.query.latest { Stage::Failed } else { self.next_search() };
    }

    /// Fixes the path that was found for a robot alone, which ends `rest` steps before the others.
    pub(super) fn fix(&mut self, rest: usize) {
        let fixed = N.saturating_sub(self.fixed + 1);
        for layer in (0..L).rev() {
            let at = cell(&self.paths, layer.saturating_sub(rest).min(self.steps), 0);
            set(&mut self.paths, layer, fixed, at);
        }
        self.fixed += 1;
    }

    /// Forgets the fixed paths from the given one on.
    pub(super) fn unfix(&mut self, from: usize) {
        self.fixed = self.fixed.min(from);
    }

    /// Goes on with the search: `Some(true)` when all robots have paths, `Some(false)` when there
    /// are none, `None` when the budget is used up. Takes one unit for each layer and each walk.
    pub(super) fn work(&mut self, map: &Map<W>, budget: &mut u32) -> Option<bool> {
        loop {
            match self.stage {
                Stage::Found => return Some(true),
                Stage::Failed => return Some(false),
                Stage::Search | Stage::Walk | Stage::Replay { .. } => {}
            }
            *budget = budget.checked_sub(1)?;
            self.stage = match self.stage {
                Stage::Search => self.search(),
                Stage::Walk => self.follow(map),
                Stage::Replay { path, layer } => self.replay(path, layer),
                done => done,
            };
        }
    }

    /// How many paths end on goals when the search has failed.
    pub(super) fn reached_goals(&self) -> usize {
        self.matched.min(self.query.need)
    }

    /// The cells of a robot of the flow at every step from the start on, when it has a path.
    pub(super) fn path_from(&self, start: Cell) -> Option<impl Iterator<Item = Cell> + '_> {
        Some(self.cells_of(self.path_on(start, self.steps)?))
    }

    /// The cells of a fixed path at every step.
    pub(super) fn fixed_path(&self, number: usize) -> impl Iterator<Item = Cell> + '_ {
        self.cells_of(N.saturating_sub(number + 1))
    }

    fn cells_of(&self, path: usize) -> impl Iterator<Item = Cell> + '_ {
        (0..=self.steps).rev().map(move |layer| cell(&self.paths, layer, path))
    }

    /// Whether a failed search has come to all that it ever can: no step more reaches more.
    pub(super) fn is_exhausted(&self) -> bool {
        let before = self.steps.checked_sub(1).map(|before| self.reached(before));
        before == Some(self.reached(self.steps))
    }

    /// A table that no search needs once it has ended.
    pub(super) fn scratch(&mut self) -> &mut Table<L, N> {
        self.walk.scratch()
    }

    /// Looks for one more path.
    pub(super) fn next_search(&mut self) -> Stage {
        if self.matched == self.robots {
            return Stage::Found;
        }
        self.restart();
        Stage::Search
    }

    /// Forgets what was reached.
    pub(super) fn restart(&mut self) {
        for layer in self.reached.iter_mut().take(self.steps + 1) {
            *layer = CellSet::EMPTY;
        }
        let ends = self.open_ends().without(&self.fixed_cells(0));
        if let Some(arrival) = self.reached.first_mut() {
            *arrival = ends;
        }
        self.touched = [0; N];
        self.level = 0;
    }

    /// The path of the flow that is on a cell at a layer.
    pub(super) fn path_on(&self, at: Cell, layer: usize) -> Option<usize> {
        self.flow_at(layer).iter().position(|&other| other == at)
    }

    /// The cells reached at a layer.
    pub(super) fn reached(&self, layer: usize) -> CellSet<W> {
        self.reached.get(layer).copied().unwrap_or(CellSet::EMPTY)
    }

    /// The cells of the flow at a layer.
    fn flow_at(&self, layer: usize) -> &[Cell] {
        self.paths.get(layer).and_then(|cells| cells.get(..self.matched)).unwrap_or_default()
    }

    /// Where one more path may end.
    fn open_ends(&self) -> CellSet<W> {
        let ends = if self.matched < self.query.need { &self.query.goals } else { self.network.passable() };
        ends.without(&self.flow_at(0).iter().copied().collect())
    }

    /// The cells that the fixed paths leave to no other robot at a layer: where they are one step
    /// before, then, and one step after.
    fn fixed_cells(&self, layer: usize) -> CellSet<W> {
        let mut closed = CellSet::EMPTY;
        if self.fixed == 0 {
            return closed;
        }
        for cells in self.paths.iter().take(layer + 2).skip(layer.saturating_sub(1)) {
            for &at in cells.iter().rev().take(self.fixed) {
                closed.insert(at);
            }
        }
        closed
    }

    fn search(&mut self) -> Stage {
        if self.level < self.steps {
            self.sweep(None);
        }
        if self.level < self.steps {
            return Stage::Search;
        }
        match self.start_reached() {
            Some(start) => {
                self.set_out(start);
                Stage::Walk
            }
            None if self.steps >= self.query.latest => Stage::Failed,
            None => self.lengthen(),
        }
    }

    fn replay(&mut self, path: usize, layer: usize) -> Stage {
        if self.level >= self.steps {
            return Stage::Failed; // never: the same search came to the path before
        }
        match self.sweep(Some((path, layer))) {
            Some(at) => self.lead_elsewhere(path, layer, at),
            None => Stage::Replay { path, layer },
        }
    }

    /// The first robot without a path whose start is reached.
    fn start_reached(&self) -> Option<Cell> {
        let reached = self.reached(self.steps);
        let mut starts = self.starts.iter().take(self.robots).copied();
        starts.find(|&start| reached.contains(start) && self.path_on(start, self.steps).is_none())
    }

    /// One step more, in which all robots wait at their starts.
    fn lengthen(&mut self) -> Stage {
        let last = self.steps;
        self.steps += 1;
        for path in 0..self.matched {
            let start = cell(&self.paths, last, path);
            set(&mut self.paths, last + 1, path, start);
        }
        if let Some(layer) = self.reached.get_mut(last + 1) {
            *layer = CellSet::EMPTY;
        }
        Stage::Search
    }

    /// Reaches from the highest known layer to the next one. Returns that one when a path is come
    /// to there which is to stop the search above a layer.
    fn sweep(&mut self, stop: Option<(usize, usize)>) -> Option<usize> {
        let next = self.level + 1;
        let from = self.network.before(&self.reached(self.level), self.level);
        let mut taken = self.fixed_cells(next);
        let mut lowest = next;
        let paths = self.paths.get(next).copied().unwrap_or([NOWHERE; N]);
        for (path, &at) in paths.iter().enumerate().take(self.matched) {
            if !from.contains(at) {
                continue;
            }
            taken.insert(at);
            let above = self.touched.get(path).copied().unwrap_or(next);
            if above < next {
                if stop.is_some_and(|(stop, layer)| stop == path && next > layer) {
                    return Some(next);
                }
                self.touch(path, above, next);
                lowest = lowest.min(above);
            }
        }
        if let Some(layer) = self.reached.get_mut(next) {
            *layer = layer.union(&from.without(&taken));
        }
        self.level = lowest;
        None
    }

    /// Reaches the cells of a path from one layer to below another.
    fn touch(&mut self, path: usize, from: usize, layer: usize) {
        if let Some(touched) = self.touched.get_mut(path) {
            *touched = layer;
        }
        for (cells, reached) in self.paths.iter().zip(&mut self.reached).take(layer).skip(from) {
            reached.insert(cells.get(path).copied().unwrap_or(NOWHERE));
        }
    }
}

/// The cell of a path at a layer or step.
pub(super) fn cell<const L: usize, const N: usize>(table: &Table<L, N>, at: usize, path: usize) -> Cell {
    table.get(at).and_then(|cells| cells.get(path)).copied().unwrap_or(NOWHERE)
}

/// Sets the cell of a path.
pub(super) fn set<const L: usize, const N: usize>(table: &mut Table<L, N>, at: usize, path: usize, to: Cell) {
    if let Some(slot) = table.get_mut(at).and_then(|cells| cells.get_mut(path)) {
        *slot = to;
    }
}
