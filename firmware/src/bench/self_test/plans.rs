//! Joint plans for random problems of two, four and eight robots, and decisions among several.

use super::{Area, Bits, Vector};
use crate::bench::joint_plans::{Instance, LISTED, Planner, Problems};
use iibt_core::grid::joint::{JointPlan, PolicyList};

/// The sizes of the teams.
const TEAMS: [usize; 3] = [2, 4, 8];

/// The problems of each size, each planned and decided.
const PROBLEMS: u32 = 40;

pub(super) fn run(tell: &mut dyn FnMut(Vector)) {
    plan(tell);
    decide(tell);
}

#[inline(never)]
fn plan(tell: &mut dyn FnMut(Vector)) {
    let mut planner = Planner::new();
    each(0, &mut |problem| problem.plan(&mut planner), tell);
}

#[inline(never)]
fn decide(tell: &mut dyn FnMut(Vector)) {
    let mut list = PolicyList::<2, 33, 8, 64, LISTED>::new();
    each(PROBLEMS * TEAMS.len() as u32, &mut |problem| problem.decide(&mut list), tell);
}

/// Tells a result of every problem, in numbers from `first` on.
fn each(
    first: u32,
    solve: &mut dyn FnMut(&Instance) -> Option<(JointPlan<8>, u32)>,
    tell: &mut dyn FnMut(Vector),
) {
    for (team, robots) in (0..).zip(TEAMS) {
        let mut problems = Problems::new(2026);
        for draw in 0..PROBLEMS {
            let mut bits = Bits::NONE;
            if let Some(problem) = problems.next(robots)
                && let Some((plan, units)) = solve(&problem)
            {
                bits.add(problem.hash(&plan));
                bits.add(units);
            }
            tell(bits.of(Area::Plans, first + team * PROBLEMS + draw));
        }
    }
}
