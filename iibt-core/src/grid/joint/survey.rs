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
    /// How many goals are to be reached; in the end, how many can be.
    need: usize,
    /// The goals counted so far, in the parts of the ground that are done.
    counted: usize,
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
            counted: 0,
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
                Stage::Parts if self.edge.is_empty() || self.holds_all() => self.next_part(network),
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

    /// The fewest steps in which this many robots can be on goals at best.
    pub(super) fn fewest_steps(&self) -> usize {
        self.steps
    }

    /// The first robot that needs this many steps.
    pub(super) fn farthest(&self) -> Option<Cell> {
        self.farthest
    }

    /// Whether no robot and no goal is left outside of the part of the ground.
    fn holds_all(&self) -> bool {
        self.left.union(&self.goals).without(&self.part).is_empty()
    }

    /// Counts what is in the part of the ground that is done, and goes to the next robot.
    fn next_part(&mut self, network: &Network<W>) {
        let robots = self.part.intersection(&self.starts).intersection(network.enterable());
        self.counted += robots.len().min(self.part.intersection(&self.goals).len());
        self.left = self.left.without(&self.part).intersection(network.enterable());
        let seed = self.left.iter().next();
        match seed {
            Some(seed) => self.spread_from([seed].into_iter().collect()),
            None => self.begin_distances(network),
        }
    }

    /// A robot on a closed cell can come to any part beside it: each is counted as one goal more.
    fn begin_distances(&mut self, network: &Network<W>) {
        self.counted += self.starts.without(network.enterable()).len();
        self.need = self.need.min(self.counted).min(self.goals.len());
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

#[cfg(test)]
mod tests {
    use super::super::super::pictures::drawn;
    use super::super::{Errand, Problem, Target};
    use super::*;
    use std::vec::Vec;

    /// Robots `r`, goals `g`, robots on closed cells `c`: how many goals of those needed can be
    /// reached, and in how many steps at best.
    #[track_caller]
    fn check(rows: &[&str], need: usize, expected: (usize, usize)) {
        let cells = rows.concat();
        let all = |sign| cells.match_indices(sign).map(|(cell, _)| Cell(cell as u16)).collect::<Vec<_>>();
        let map = drawn(rows);
        let closed: CellSet<32> = all('c').into_iter().collect();
        let starts = all('r').into_iter().chain(all('c'));
        let errands: Vec<_> = starts.map(|from| Errand { from, target: Target::Any }).collect();
        let problem = Problem { closed, need, ..Problem::new(&map, &errands) };
        let network = Network::of(&problem);
        let goals = all('g').into_iter().collect();
        let mut survey = Survey::begin(problem.starts().collect(), goals, need);
        while survey.work(&network, &mut 1).is_none() {}
        assert_eq!((survey.reachable(), survey.fewest_steps()), expected);
    }

    #[test]
    fn counts_the_goals_of_each_part_of_the_ground() {
        check(&["rr.g"], 2, (1, 2));
        check(&["r.g#r..g"], 2, (2, 3));
        check(&["rr.g#gg"], 2, (1, 2));
        check(&["r#g"], 1, (0, 0));
        check(&["r..g.r"], 1, (1, 2));
    }

    #[test]
    fn a_robot_on_a_closed_cell_can_leave_it() {
        check(&["c.g"], 1, (1, 2));
        check(&["r.c.g"], 2, (1, 2));
    }
}
