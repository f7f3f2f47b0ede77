//! The earliest joint arrival of a team at different goals: a bottleneck assignment.

use super::MAX_GOALS;
use crate::team::MAX_TEAM;

/// The moves from each robot to each goal, `None` where no way leads.
pub(super) type Moves = [[Option<u16>; MAX_GOALS]; MAX_TEAM];

/// Returns the fewest moves within which each of the first `team` robots can reach a goal of its
/// own, the value of the bottleneck assignment; `None` when there is no assignment.
///
/// Costs at most `team * MAX_GOALS` matchings of `team * MAX_GOALS * team` steps each.
pub(super) fn earliest_together(moves: &Moves, team: usize) -> Option<u16> {
    let robots = moves.get(..team)?;
    let limits = robots.iter().flatten().flatten().copied();
    limits.filter(|&limit| all_matched(robots, limit)).min()
}

/// Returns whether every robot can have a goal of its own within `limit` moves.
fn all_matched(robots: &[[Option<u16>; MAX_GOALS]], limit: u16) -> bool {
    let mut owner = [None; MAX_GOALS];
    (0..robots.len()).all(|robot| {
        let mut tried = [false; MAX_GOALS];
        find_goal(robots, limit, robot, &mut owner, &mut tried)
    })
}

/// Gives `robot` a goal, moving other robots to other goals where needed; at most [`MAX_TEAM`]
/// deep, because every level marks another goal as tried.
fn find_goal(
    robots: &[[Option<u16>; MAX_GOALS]],
    limit: u16,
    robot: usize,
    owner: &mut [Option<usize>; MAX_GOALS],
    tried: &mut [bool; MAX_GOALS],
) -> bool {
    let Some(row) = robots.get(robot) else { return false };
    for (goal, moves) in row.iter().enumerate() {
        let near = moves.is_some_and(|moves| moves <= limit);
        let new = near && tried.get_mut(goal).is_some_and(|tried| !core::mem::replace(tried, true));
        if !new {
            continue;
        }
        let holder = owner.get(goal).copied().flatten();
        if holder.is_none_or(|holder| find_goal(robots, limit, holder, owner, tried)) {
            if let Some(place) = owner.get_mut(goal) {
                *place = Some(robot);
            }
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moves(rows: &[&[u16]]) -> Moves {
        let entry =
            |robot: usize, goal: usize| rows.get(robot)?.get(goal).copied().filter(|&moves| moves < 99);
        core::array::from_fn(|robot| core::array::from_fn(|goal| entry(robot, goal)))
    }

    #[test]
    fn the_slowest_of_the_best_assignment_counts() {
        let cases: [(&[&[u16]], Option<u16>); 6] = [
            (&[&[4, 6], &[4, 6]], Some(6)),
            (&[&[1, 2], &[1, 9]], Some(2)),
            (&[&[5]], Some(5)),
            (&[&[3], &[3]], None),
            (&[&[1, 99], &[1, 99]], None),
            (&[&[1, 5, 9], &[1, 2, 9], &[1, 2, 3]], Some(3)),
        ];
        for (rows, expected) in cases {
            assert_eq!(earliest_together(&moves(rows), rows.len()), expected, "{rows:?}");
        }
    }
}
