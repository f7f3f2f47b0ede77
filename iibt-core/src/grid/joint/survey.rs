//! What can be known of a problem before any path is searched: on how many goals robots can end at
//! all, and how many moves that takes at least.

use super::super::{Cell, CellSet};
use super::network::Network;

/// Spreads over the ground, one layer of equal distance for each work unit.
#[derive(Clone, Debug)]
pub(super) struct Survey<const W: usize> {
    starts: CellSet<W>,
    goals: CellSet<W>,
    stage: Stage,
    /// The cells spread over since the last seed, and those of them that are new.
    part: CellSet<W>,
    edge: CellSet<W>,
    /// The robots that no part has been searched for yet.
    left: CellSet<W>,
    need: usize,
    reachable: usize,
    steps: usize,
    farthest: Option<Cell>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// From a robot of each part of the ground.
    Parts,
    /// From the goals, up to as many robots as are needed.
    Distances,
    Done,
}

impl<const W: usize> Survey<W> {
    /// Begins for robots of which `need` are to end on goals.
    pub(super) const fn begin(starts: CellSet<W>, goals: CellSet<W>, need: usize) -> Self {
        Self {
            starts,
            goals,
            stage: Stage::Parts,
            part: CellSet::EMPTY,
            edge: CellSet::EMPTY,
            left: starts,
            need,
            reachable: 0,
            steps: 0,
            farthest: None,
        }
    }

    /// Goes on; `Some` when it is done, `None` when the budget is used up.
    pub(super) fn work(&mut self, network: &Network<W>, budget: &mut u32) -> Option<()> {
        while self.stage != Stage::Done {
            *budget = budget.checked_sub(1)?;
            self.edge = network.around(&self.edge).without(&self.part);
            self.part = self.part.union(&self.edge);
            match self.stage {
                Stage::Parts if self.edge.is_empty() => self.next_part(network),
                Stage::Distances => self.measure(),
                Stage::Parts | Stage::Done => {}
            }
        }
        Some(())
    }

    /// How many of the needed goals robots can end on at most.
    pub(super) fn reachable(&self) -> usize {
        self.need
    }

    /// The fewest steps in which so many robots can be on goals at best.
    pub(super) fn fewest_steps(&self) -> usize {
        self.steps
    }

    /// The first robot that needs so many steps.
    pub(super) fn farthest(&self) -> Option<Cell> {
        self.farthest
    }

    /// Counts what is in the part of the ground that is done, and goes to the next robot.
    fn next_part(&mut self, network: &Network<W>) {
        let robots = self.part.intersection(&self.starts).intersection(network.enterable());
        self.reachable += robots.len().min(self.part.intersection(&self.goals).len());
        self.left = self.left.without(&self.part).intersection(network.enterable());
        let seed = self.left.iter().next();
        match seed {
            Some(seed) => self.spread_from([seed].into_iter().collect()),
            None => self.begin_distances(network),
        }
    }

    /// A robot on a closed cell can come to any part beside it: each is counted as one goal more.
    fn begin_distances(&mut self, network: &Network<W>) {
        self.reachable += self.starts.without(network.enterable()).len();
        self.need = self.need.min(self.reachable).min(self.goals.len());
        self.stage = Stage::Distances;
        self.spread_from(self.goals);
        self.steps = 0;
        self.measure();
    }

    fn spread_from(&mut self, cells: CellSet<W>) {
        (self.part, self.edge) = (cells, cells);
    }

    fn measure(&mut self) {
        let near = self.part.intersection(&self.starts).len();
        if near >= self.need || self.edge.is_empty() {
            self.need = self.need.min(near);
            self.farthest = self.edge.intersection(&self.starts).iter().next();
            self.stage = Stage::Done;
        } else {
            self.steps += 1;
        }
    }
}
