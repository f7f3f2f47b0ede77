//! The assignment of goals: Min(Sum(Policy 1, Policy 2)) of the paper's figure 8, for any number of
//! robots.

use iibt_core::navigation::MAX_GOALS;
use iibt_core::team::MAX_TEAM;

/// The moves from each robot to each goal; `None` where no way leads.
pub(super) type Moves = [[Option<u16>; MAX_GOALS]; MAX_TEAM];

/// The cost of a robot without a path to its goal: more than the longest plan.
const NO_WAY: u32 = 1000;

/// The search for the best assignment.
struct Search<'m> {
    moves: &'m Moves,
    settled: &'m [Option<usize>; MAX_TEAM],
    robots: usize,
    goals: usize,
    chosen: [usize; MAX_TEAM],
    best: Option<(AssignmentCost, [usize; MAX_TEAM])>,
}

/// The sum of all moves, then the longest way: of two equal sums, the one that brings the team
/// together earlier.
type AssignmentCost = (u32, u32);

/// The goal of each robot, by its index, with the least sum of moves; among equals the one with the
/// shortest longest path, then the first. Robots that are `settled` keep the goal they have. `None`
/// when there are more robots than goals.
///
/// Cost: at most the number of assignments, pruned where a sum is larger than the least so far.
pub(super) fn least_sum(
    moves: &Moves,
    settled: &[Option<usize>; MAX_TEAM],
    robots: usize,
    goals: usize,
) -> Option<[usize; MAX_TEAM]> {
    let mut search = Search { moves, settled, robots, goals, chosen: [usize::MAX; MAX_TEAM], best: None };
    search.assign(0, (0, 0));
    search.best.map(|(_, chosen)| chosen)
}

impl Search<'_> {
    fn assign(&mut self, robot: usize, cost: AssignmentCost) {
        if self.best.is_some_and(|(best, _)| cost >= best) {
            return;
        }
        if robot == self.robots {
            self.best = Some((cost, self.chosen));
            return;
        }
        for goal in 0..self.goals {
            let is_settled = self.settled[robot].is_some_and(|settled| settled != goal);
            let is_taken = self.chosen[..robot].contains(&goal);
            let is_promised = self.settled[robot].is_none() && self.settled.contains(&Some(goal));
            if is_settled || is_taken || is_promised {
                continue;
            }
            let moves = self.moves[robot][goal].map_or(NO_WAY, u32::from);
            self.chosen[robot] = goal;
            self.assign(robot + 1, (cost.0 + moves, cost.1.max(moves)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn goals(rows: &[[u16; 3]], settled: [Option<usize>; 3]) -> Option<Vec<usize>> {
        let (mut moves, mut kept) = ([[None; MAX_GOALS]; MAX_TEAM], [None; MAX_TEAM]);
        for (to, from) in moves.iter_mut().zip(rows) {
            to.iter_mut().zip(from).for_each(|(to, &from)| *to = (from < 99).then_some(from));
        }
        kept[..3].copy_from_slice(&settled);
        least_sum(&moves, &kept, rows.len(), 3).map(|goals| goals[..rows.len()].to_vec())
    }

    #[test]
    fn the_sum_of_the_ways_is_least() {
        assert_eq!(goals(&[[4, 6, 9], [2, 6, 9]], [None; 3]), Some(vec![1, 0]), "6 + 2 < 4 + 6");
        assert_eq!(goals(&[[1, 99, 99], [1, 2, 9], [1, 2, 9]], [None; 3]), Some(vec![0, 1, 2]));
        assert_eq!(goals(&[[5, 5, 5], [5, 5, 5]], [None; 3]), Some(vec![0, 1]), "the first of equal ones");
        assert_eq!(goals(&[[4, 2, 9], [6, 4, 9]], [None; 3]), Some(vec![0, 1]), "the shorter longest way");
    }

    #[test]
    fn who_is_settled_keeps_its_goal() {
        assert_eq!(goals(&[[4, 6, 9], [2, 6, 9]], [Some(0), None, None]), Some(vec![0, 1]));
        assert_eq!(goals(&[[4, 6, 9], [2, 6, 9]], [None, Some(2), None]), Some(vec![0, 2]));
    }

    #[test]
    fn every_robot_needs_a_goal() {
        assert_eq!(goals(&[[1, 1, 1]; 4], [None; 3]), None);
    }
}
