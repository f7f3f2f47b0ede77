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
//! cells at all layers below can be given to another robot: they are reached too. When the search
//! has come to the top it begins again at the lowest layer that this has changed. `T` grows by one
//! when no start is reached: the flow waits one step more at its starts, and all that is reached
//! stays so. The first `need` paths end on goals, the others on any cell that is left; a path that
//! is led elsewhere never gives its goal up, only to the path that takes its place.
//!
//! A robot with a prefix comes into the network on a later layer than the top. The cells of
//! prefixes are closed around the time at which they are visited, and the search begins again with
//! every `T`, since they lie on other layers then.
//!
//! How the new path is found in the sets is in [`walk`](super::walk).

use super::super::{Cell, CellSet};
use super::Problem;
use super::network::Network;
use super::prefix::{self, Entry};
use super::table::{Table, cell, column, set};
use super::walk::Walk;

/// Where a search has come to. The first stage is all zeros, so that a new flow is cleared memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Stage {
    /// From the goals to the starts.
    Search,
    /// Along a new path.
    Walk,
    /// As the first search was at the moment at which it came to a path at the layer `above`.
    TakeBack { path: usize, layer: usize, above: usize },
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

/// A search came to a path, whose cells it had reached below the layer `from` before.
#[derive(Clone, Copy, Debug)]
struct Touch {
    path: u8,
    from: u8,
}

/// One flow of at most `N` robots over `W` words of cells and at most `L - 1` steps.
#[derive(Clone, Debug)]
pub(super) struct Flow<const W: usize, const L: usize, const N: usize> {
    pub(super) network: Network<W>,
    pub(super) query: Query<W>,
    starts: [Entry; N],
    robots: usize,
    has_prefixes: bool,
    /// The paths of the flow, and from the end of each layer on those that are fixed.
    pub(super) paths: Table<L, N>,
    /// How many paths there are in the flow, and how many fixed ones.
    pub(super) matched: usize,
    pub(super) fixed: usize,
    /// The number of steps now.
    pub(super) steps: usize,
    reached: [CellSet<W>; L],
    /// The cells of the paths of the flow, and those closed around fixed paths and prefixes.
    pub(super) occupied: [CellSet<W>; L],
    /// The layers below which the cells of each path are reached, and how that came about.
    touched: [usize; N],
    touches: [[Touch; N]; L],
    touch_count: usize,
    /// The layer that the search has come to, and the lowest one that has changed since.
    level: usize,
    changed: usize,
    /// Whether a layer has changed since the search went on from it.
    is_new: [bool; L],
    pub(super) walk: Walk<L, N>,
    stage: Stage,
}

impl<const W: usize, const L: usize, const N: usize> Flow<W, L, N> {
    /// The most steps of a plan.
    pub(super) const LATEST: usize =
        if L > crate::actions::HORIZON { crate::actions::HORIZON } else { L.saturating_sub(1) };

    /// Memory in which a search is to be [begun](Self::begin).
    pub(super) const fn new() -> Self {
        Self {
            network: Network::NOTHING,
            query: Query { goals: CellSet::EMPTY, need: 0, first: 0, latest: 0 },
            starts: [Entry { cell: Cell(0), step: 0 }; N],
            robots: 0,
            has_prefixes: false,
            paths: [[Cell(0); N]; L],
            matched: 0,
            fixed: 0,
            steps: 0,
            reached: [CellSet::EMPTY; L],
            occupied: [CellSet::EMPTY; L],
            touched: [0; N],
            touches: [[Touch { path: 0, from: 0 }; N]; L],
            touch_count: 0,
            level: 0,
            changed: 0,
            is_new: [false; L],
            walk: Walk::new(),
            stage: Stage::Search,
        }
    }

    /// Begins a search for the robots at `starts`, which keep clear of the prefixes of a problem
    /// and of the fixed paths.
    pub(super) fn begin(
        &mut self,
        problem: &Problem<'_, W>,
        starts: impl IntoIterator<Item = Entry>,
        query: Query<W>,
    ) {
        self.robots = 0;
        for (slot, start) in self.starts.iter_mut().zip(starts) {
            *slot = start;
            self.robots += 1;
        }
        self.query = query;
        self.query.latest = query.latest.min(Self::LATEST);
        self.has_prefixes = !problem.prefixes.is_empty();
        self.steps = query.first.max(problem.longest_prefix());
        self.matched = 0;
        self.stage = Stage::Failed;
        if self.steps <= self.query.latest {
            let is_closed = self.has_prefixes || self.fixed > 0;
            for layer in 0..=self.steps {
                let around = || prefix::closed_around(problem, self.steps - layer);
                let closed =
                    if is_closed { around().union(&self.fixed_cells(layer)) } else { CellSet::EMPTY };
                self.close(layer, closed);
            }
            self.stage = self.next_search();
        }
    }

    /// Begins a search in the other turn for a plan of `steps` steps, one less than of the plan
    /// that was found: the paths that are on goals before its last step are good there too. Only
    /// without prefixes and fixed paths.
    pub(super) fn begin_shorter(&mut self, steps: usize) {
        self.stage = Stage::Failed;
        if steps < self.query.first || steps + 1 != self.steps {
            return; // a plan in the one turn has at most one step more than the best in the other
        }
        self.paths.copy_within(1..L, 0);
        let mut kept = 0;
        for path in 0..self.matched {
            let end = cell(&self.paths, 0, path);
            if kept < self.query.need && self.query.goals.contains(end) {
                for layer in 0..self.steps {
                    let at = cell(&self.paths, layer, path);
                    set(&mut self.paths, layer, kept, at);
                }
                kept += 1;
            }
        }
        (self.matched, self.steps, self.query.latest) = (kept, steps, steps);
        for layer in 0..=self.steps {
            self.close(layer, CellSet::EMPTY);
            self.occupy(layer);
        }
        self.stage = self.next_search();
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
    pub(super) fn work(&mut self, budget: &mut u32) -> Option<bool> {
        loop {
            match self.stage {
                Stage::Found => return Some(true),
                Stage::Failed => return Some(false),
                Stage::Search | Stage::Walk | Stage::TakeBack { .. } => {}
            }
            *budget = budget.checked_sub(1)?;
            self.stage = match self.stage {
                Stage::Search => self.search(),
                Stage::Walk => self.follow(),
                Stage::TakeBack { path, layer, above } => self.rebuild(path, layer, above),
                done => done,
            };
        }
    }

    /// How many paths end on goals when the search has failed.
    pub(super) fn reached_goals(&self) -> usize {
        self.matched.min(self.query.need)
    }

    /// The path of the table that is the fixed one with this number.
    pub(super) fn row_of_fixed(&self, number: usize) -> usize {
        N.saturating_sub(number + 1)
    }

    /// The cells of a path at every step from the start on.
    pub(super) fn cells_of(&self, path: usize) -> impl Iterator<Item = Cell> + '_ {
        column(&self.paths, self.steps, path)
    }

    /// The layer at whose cell `entry.cell` a robot comes into the flow.
    pub(super) fn layer_of(&self, entry: Entry) -> usize {
        self.steps.saturating_sub(entry.step.into())
    }

    /// Puts the prefix of a robot before its path.
    pub(super) fn begin_with(&mut self, path: usize, cells: impl Iterator<Item = Cell>) {
        for (layer, at) in (0..=self.steps).rev().zip(cells) {
            set(&mut self.paths, layer, path, at);
        }
    }

    /// Whether a failed search has come to all that it ever can: no step more reaches more.
    pub(super) fn is_exhausted(&self) -> bool {
        let before = self.steps.checked_sub(1).map(|before| self.reached(before));
        before == Some(self.reached(self.steps))
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
        self.touch_count = 0;
        let ends = self.open_ends();
        self.is_new = [false; L];
        if let Some((arrival, is_new)) = self.reached.first_mut().zip(self.is_new.first_mut()) {
            (*arrival, *is_new) = (ends, true);
        }
        self.touched = [0; N];
        (self.level, self.changed) = (0, usize::MAX);
    }

    /// The path of the flow that is on a cell at a layer.
    pub(super) fn path_on(&self, at: Cell, layer: usize) -> Option<usize> {
        if !self.occupied(layer).contains(at) {
            return None;
        }
        self.flow_at(layer).iter().position(|&other| other == at)
    }

    /// The cells reached at a layer.
    pub(super) fn reached(&self, layer: usize) -> CellSet<W> {
        self.reached.get(layer).copied().unwrap_or(CellSet::EMPTY)
    }

    /// The cells reached at a layer on which a robot can be that was on its way before.
    pub(super) fn passed(&self, layer: usize) -> CellSet<W> {
        let mut cells = self.reached(layer);
        if self.has_prefixes {
            let entries = self.starts.iter().take(self.robots);
            for entry in entries.filter(|entry| entry.step > 0 && self.layer_of(**entry) == layer) {
                cells.remove(entry.cell);
            }
        }
        cells
    }

    /// The cells at a layer that are on a path of the flow or closed.
    pub(super) fn occupied(&self, layer: usize) -> CellSet<W> {
        self.occupied.get(layer).copied().unwrap_or(CellSet::EMPTY)
    }

    /// Adds the cells of the flow at a layer.
    pub(super) fn occupy(&mut self, layer: usize) {
        if let Some((cells, occupied)) = self.paths.get(layer).zip(self.occupied.get_mut(layer)) {
            cells.iter().take(self.matched).for_each(|&at| _ = occupied.insert(at));
        }
    }

    /// Takes the cells of the flow out at all layers.
    pub(super) fn vacate_all(&mut self) {
        let is_closed = self.has_prefixes || self.fixed > 0;
        for layer in 0..=self.steps {
            if is_closed {
                self.vacate(layer);
            } else {
                self.close(layer, CellSet::EMPTY);
            }
        }
    }

    /// Takes the cells of the flow out at a layer.
    fn vacate(&mut self, layer: usize) {
        let cells: CellSet<W> = self.flow_at(layer).iter().copied().collect();
        self.close(layer, self.occupied(layer).without(&cells));
    }

    fn close(&mut self, layer: usize, cells: CellSet<W>) {
        if let Some(occupied) = self.occupied.get_mut(layer) {
            *occupied = cells;
        }
    }

    /// The cells of the paths of the flow at a layer, in their order.
    fn flow_at(&self, layer: usize) -> &[Cell] {
        self.paths.get(layer).and_then(|cells| cells.get(..self.matched)).unwrap_or_default()
    }

    /// Where one more path may end.
    fn open_ends(&self) -> CellSet<W> {
        let ends = if self.matched < self.query.need { &self.query.goals } else { self.network.passable() };
        ends.without(&self.occupied(0))
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
        self.skip_old_layers();
        if self.level < self.steps && !self.sweep() {
            return Stage::Failed; // never: there is room for all touches
        }
        self.skip_old_layers();
        if self.level < self.steps {
            return Stage::Search;
        }
        match self.start_reached(0) {
            Some((robot, start)) => {
                self.set_out(robot, start);
                (self.walk.is_extra, self.walk.is_partial) = (false, false);
                Stage::Walk
            }
            None if self.changed < self.steps => {
                (self.level, self.changed) = (self.changed, usize::MAX);
                Stage::Search
            }
            None if self.steps >= self.query.latest => Stage::Failed,
            None => self.lengthen(),
        }
    }

    /// Forgets all that was reached since the search came to a path for the first time above a
    /// layer, that included.
    pub(super) fn take_back(&mut self, path: usize, layer: usize) -> Stage {
        self.walk.is_partial = true;
        self.level = self.steps;
        while let Some(last) = self.touch_count.checked_sub(1) {
            let Some(&touch) = self.touches.as_flattened().get(last) else { break };
            let (touched, from) = (usize::from(touch.path), usize::from(touch.from));
            let Some(slot) = self.touched.get_mut(touched) else { break };
            let above = core::mem::replace(slot, from);
            let at = cell(&self.paths, from, touched);
            if let Some(reached) = self.reached.get_mut(from) {
                reached.remove(at);
            }
            self.touch_count = last;
            self.level = self.level.min(from);
            if touched == path && from <= layer {
                return self.rebuild(path, layer, above);
            }
        }
        Stage::Failed // never: the search came to the path before
    }

    /// Reaches the cells of the next layer again, with what is left of the touches.
    fn rebuild(&mut self, path: usize, layer: usize, above: usize) -> Stage {
        let next = self.level + 1;
        if next >= above {
            return self.lead_elsewhere(path, layer, above);
        }
        let from = self.network.before(&self.passed(self.level), self.level);
        let mut reached = from.without(&self.occupied(next));
        for (&at, _) in self.flow_at(next).iter().zip(&self.touched).filter(|&(_, &below)| next < below) {
            reached.insert(at);
        }
        if let Some(slot) = self.reached.get_mut(next) {
            *slot = reached;
        }
        self.level = next;
        Stage::TakeBack { path, layer, above }
    }

    /// The first robot from a place on that has no path and whose start is reached.
    pub(super) fn start_reached(&self, first: usize) -> Option<(usize, Entry)> {
        let top = self.reached(self.steps).without(&self.occupied(self.steps));
        let starts = self.starts.get(first..self.robots)?;
        let place = starts.iter().position(|entry| {
            let layer = self.layer_of(*entry);
            let below =
                || self.reached(layer).contains(entry.cell) && !self.occupied(layer).contains(entry.cell);
            if entry.step == 0 { top.contains(entry.cell) } else { below() }
        })?;
        Some((first + place, *starts.get(place)?))
    }

    /// One step more, in which all robots wait at their starts.
    fn lengthen(&mut self) -> Stage {
        let last = self.steps;
        self.steps += 1;
        if self.has_prefixes {
            return self.lengthen_after_prefixes();
        }
        for path in 0..self.matched {
            let start = cell(&self.paths, last, path);
            set(&mut self.paths, last + 1, path, start);
        }
        if let Some(layer) = self.reached.get_mut(last + 1) {
            *layer = CellSet::EMPTY;
        }
        self.close(last + 1, self.fixed_cells(last + 1));
        self.occupy(last + 1);
        Stage::Search
    }

    /// The same with prefixes: what is closed around them moves to the next layers, without fixed
    /// paths, and the search begins with the first path.
    fn lengthen_after_prefixes(&mut self) -> Stage {
        let mut closed = CellSet::EMPTY;
        for layer in 0..=self.steps {
            self.vacate(layer);
            let below = core::mem::replace(&mut closed, self.occupied(layer));
            self.close(layer, below);
        }
        self.matched = 0;
        self.next_search()
    }

    /// Goes up to the next layer from which there is anything new to reach.
    fn skip_old_layers(&mut self) {
        while self.level < self.steps && self.is_new.get(self.level) == Some(&false) {
            self.level += 1;
        }
    }

    /// Reaches from the highest known layer to the next one; returns whether there was room to note
    /// the paths that it came to.
    fn sweep(&mut self) -> bool {
        let next = self.level + 1;
        let from = self.network.before(&self.passed(self.level), self.level);
        let taken = from.intersection(&self.occupied(next));
        if let Some(is_new) = self.is_new.get_mut(self.level) {
            *is_new = false;
        }
        self.level = next;
        // Where a path has been touched above a layer, its cell there is reached.
        let untouched = taken.without(&self.reached(next));
        let has_room = untouched.is_empty() || self.touch_all(&untouched, next).is_some();
        let open = from.without(&taken);
        if let Some((layer, is_new)) = self.reached.get_mut(next).zip(self.is_new.get_mut(next)) {
            let with_open = layer.union(&open);
            *is_new |= with_open != *layer;
            *layer = with_open;
        }
        has_room
    }

    /// Reaches the cells that the paths on some cells of a layer have below it; returns whether
    /// there was room to note them.
    fn touch_all(&mut self, taken: &CellSet<W>, layer: usize) -> Option<()> {
        let Self { paths, touched, reached, is_new, touches, .. } = self;
        let cells = paths.get(layer)?;
        let all = cells.iter().zip(touched).take(self.matched).enumerate();
        for (path, (_, below)) in all.filter(|(_, (at, below))| **below < layer && taken.contains(**at)) {
            let from = core::mem::replace(below, layer);
            let (cells, reached) = (paths.get(from..layer)?, reached.get_mut(from..layer)?);
            for ((cells, reached), is_new) in cells.iter().zip(reached).zip(is_new.get_mut(from..layer)?) {
                *is_new |= reached.insert(*cells.get(path)?);
            }
            self.changed = self.changed.min(from);
            *touches.as_flattened_mut().get_mut(self.touch_count)? =
                Touch { path: path as u8, from: from as u8 };
            self.touch_count += 1;
        }
        Some(())
    }
}
