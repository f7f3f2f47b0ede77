//! The new path of a flow, read off the sets of cells that a search has reached.
//!
//! From the start, each step leads to a reached cell of the next lower layer. Where that is on a
//! path of the flow, the new path takes the rest of it, and the one that it is taken from goes on
//! from the layer at which the search came to it: the two change their upper parts, and the walk
//! goes on there with the sets as they were at that moment. They are not stored: what the search
//! has touched since is taken back, and the layers that it changed are made again.
//!
//! As a walk does not know which cell made which other one reached, it can come to a cell for the
//! second time. All that it did since the first time is then undone.
//!
//! As long as a walk changes no other path, the sets are good for the next robot too, but for the
//! cells of the new path: it walks beside that one if it can.

use super::super::Cell;
use super::execution::{Execution, Timetable};
use super::flow::{Flow, Stage};
use super::prefix::Entry;
use super::table::{NOWHERE, Table, cell, column, set};

/// How often a new path may take the rest of another one.
pub(super) const MOST_CHANGES: usize = 32;

/// A path took the rest of `path` below `layer`; that one goes on from layer `above`.
#[derive(Clone, Copy, Debug)]
struct Change {
    path: u8,
    layer: u8,
    above: u8,
}

/// A path in the making.
#[derive(Clone, Debug)]
pub(super) struct Walk<const L: usize, const N: usize> {
    /// The other paths as they will be; free for other use while there is no walk.
    pub(super) paths: Table<L, N>,
    /// The new path above the layer of the walk.
    tail: [Cell; L],
    /// What was walked since the last change.
    segment: [Cell; L],
    changes: [Change; MOST_CHANGES],
    changed: usize,
    /// The layer of the starts, and where the walk has come to.
    top: usize,
    at: Cell,
    layer: usize,
    /// The place of the robot among those of the flow.
    robot: usize,
    /// Whether the sets of cells are from before the newest path, so that only cells on which no
    /// path is are of use.
    pub(super) is_extra: bool,
    /// Whether a part of what was reached is forgotten.
    pub(super) is_partial: bool,
}

impl<const L: usize, const N: usize> Walk<L, N> {
    pub(super) const fn new() -> Self {
        Self {
            paths: [[Cell(0); N]; L],
            tail: [Cell(0); L],
            segment: [Cell(0); L],
            changes: [Change { path: 0, layer: 0, above: 0 }; MOST_CHANGES],
            changed: 0,
            top: 0,
            at: Cell(0),
            layer: 0,
            robot: 0,
            is_extra: false,
            is_partial: false,
        }
    }

    /// Keeps the steps of the segment below `end`.
    fn keep_segment(&mut self, end: usize) {
        let kept = self.tail.get_mut(self.layer..end).unwrap_or_default();
        for (kept, &at) in kept.iter_mut().zip(self.segment.get(self.layer..end).unwrap_or_default()) {
            *kept = at;
        }
    }

    /// Exchanges the parts of the new path and of another one above a layer.
    fn exchange(&mut self, path: usize, layer: usize) {
        let above = layer + 1..self.top + 1;
        let ours = self.tail.get_mut(above.clone()).unwrap_or_default();
        for (ours, cells) in ours.iter_mut().zip(self.paths.get_mut(above).unwrap_or_default()) {
            if let Some(theirs) = cells.get_mut(path) {
                core::mem::swap(ours, theirs);
            }
        }
    }

    /// Undoes the last change; returns its layer.
    fn undo(&mut self, before: &Table<L, N>) -> Option<usize> {
        self.changed = self.changed.checked_sub(1)?;
        let change = self.changes.get(self.changed).copied()?;
        let (path, layer) = (usize::from(change.path), usize::from(change.layer));
        self.exchange(path, layer);
        for walked_over in layer + 1..usize::from(change.above) {
            set(&mut self.paths, walked_over, path, cell(before, walked_over, path));
        }
        Some(layer)
    }

    /// Goes back to where the new path was on this cell at this layer before.
    fn cut_loop(&mut self, before: &Table<L, N>) -> Option<()> {
        loop {
            let layer = self.undo(before)?;
            if self.layer > layer && self.tail.get(self.layer) == Some(&self.at) {
                return Some(());
            }
        }
    }
}

impl<const W: usize, const L: usize, const N: usize> Flow<W, L, N> {
    /// Begins the path of a robot of the flow where it comes into it.
    pub(super) fn set_out(&mut self, robot: usize, start: Entry) {
        self.walk.robot = robot;
        self.walk.top = self.steps;
        let first = self.layer_of(start);
        if let Some(before) = self.walk.tail.get_mut(first..=self.steps) {
            before.fill(NOWHERE);
        }
        if let Some(first) = self.walk.tail.get_mut(first) {
            *first = start.cell;
        }
        self.walk.changed = 0;
        (self.walk.at, self.walk.layer) = (start.cell, first);
    }

    /// Executes the flow and the fixed paths with a barrier before the last moves.
    pub(super) fn execution(&mut self) -> Option<Execution> {
        let mut timetable = Timetable::new(&mut self.walk.paths, self.steps);
        let all = (0..self.matched).chain(N.saturating_sub(self.fixed)..N);
        all.for_each(|path| timetable.add(column(&self.paths, self.steps, path)));
        timetable.run::<W>(true)
    }

    /// Walks to an open end or to a path of the flow.
    pub(super) fn follow(&mut self) -> Stage {
        let mut end = self.walk.layer;
        while let Some(below) = self.walk.layer.checked_sub(1) {
            let Some(next) = self.step_to(below) else { return self.no_step() };
            (self.walk.at, self.walk.layer) = (next, below);
            if let Some(slot) = self.walk.segment.get_mut(below) {
                *slot = next;
            }
            if let Some(path) = self.path_on(next, below) {
                self.walk.keep_segment(end);
                return self.take_back(path, below);
            }
            if self.walk.changed > 0 && self.is_crossed(next, below) {
                if self.walk.cut_loop(&self.paths).is_none() {
                    return Stage::Failed; // never: it was there before
                }
                end = below;
            }
        }
        self.walk.keep_segment(end);
        self.add_path()
    }

    /// Whether one of the other paths, as they will be, is on a cell at a layer.
    fn is_crossed(&self, at: Cell, layer: usize) -> bool {
        let others = self.walk.paths.get(layer).and_then(|cells| cells.get(..self.matched));
        others.is_some_and(|others| others.contains(&at))
    }

    /// Takes the rest of a path; the walk goes on for that one.
    pub(super) fn lead_elsewhere(&mut self, path: usize, layer: usize, above: usize) -> Stage {
        if self.walk.changed == 0 {
            self.walk.paths = self.paths;
        }
        let change = Change { path: path as u8, layer: layer as u8, above: above as u8 };
        let Some(slot) = self.walk.changes.get_mut(self.walk.changed) else { return Stage::Failed };
        *slot = change;
        self.walk.changed += 1;
        self.walk.exchange(path, layer);
        (self.walk.at, self.walk.layer) = (self.walk.tail.get(above).copied().unwrap_or_default(), above);
        Stage::Walk
    }

    /// The cell of the next lower layer: the same if possible, else the first neighbour that is on
    /// no path, else the first one.
    fn step_to(&self, below: usize) -> Option<Cell> {
        let (at, reached, occupied) = (self.walk.at, self.passed(below), self.occupied(below));
        let may_be_on_path = !self.walk.is_extra;
        if reached.contains(at)
            && self.network.may_wait(at, below)
            && (may_be_on_path || !occupied.contains(at))
        {
            return Some(at);
        }
        let entered = self.network.entered(&reached, below);
        let mut beside = self.network.beside(at).filter(|&next| entered.contains(next));
        let free = beside.clone().find(|&next| !occupied.contains(next));
        free.or_else(|| beside.next().filter(|_| may_be_on_path))
    }

    /// A walk beside the newest path may come to an end: the robot then needs a search of its own.
    fn no_step(&mut self) -> Stage {
        if self.walk.is_extra { self.next_walk() } else { Stage::Failed }
    }

    /// Goes on with another robot whose start is reached, beside the newest path.
    fn next_walk(&mut self) -> Stage {
        let Some((robot, start)) = self.start_reached(self.walk.robot + 1) else { return self.next_search() };
        self.set_out(robot, start);
        self.walk.is_extra = true;
        Stage::Walk
    }

    fn add_path(&mut self) -> Stage {
        if self.walk.changed > 0 {
            self.vacate_all();
            self.paths = self.walk.paths;
        }
        let new = self.paths.iter_mut().zip(&self.walk.tail).zip(&mut self.occupied);
        for ((cells, &at), occupied) in new.take(self.steps + 1) {
            if let Some(cell) = cells.get_mut(self.matched) {
                *cell = at;
            }
            occupied.insert(at);
        }
        self.matched += 1;
        if self.walk.changed > 0 {
            (0..=self.steps).for_each(|layer| self.occupy(layer));
        }
        let ends_change = self.matched == self.query.need;
        if ends_change || self.walk.is_partial { self.next_search() } else { self.next_walk() }
    }
}
