//! A checker of plans that shares no code with the planner: it looks at every cell, searches over
//! joint states for the fewest steps, and executes plans with messages in the air.

use super::Case;
use iibt_core::grid::joint::{Errand, JointPlan, Target};
use iibt_core::grid::{Cell, Map};
use std::collections::{BTreeSet, HashSet};

/// The cells of every robot at every step, one step past the end.
pub(super) fn timelines(case: &Case, plan: &JointPlan<8>) -> Vec<Vec<Cell>> {
    plan.paths().iter().map(|path| path.timeline(&case.map).take(plan.steps() + 2).collect()).collect()
}

/// What is wrong with a plan: moves, cells, conflicts, ends. Of plans for a part of the targets
/// only, the owned ones are not asked for.
pub(super) fn fault(case: &Case, plan: &JointPlan<8>, is_for_all: bool) -> Option<String> {
    let robots = timelines(case, plan);
    if robots.len() != case.errands.len() {
        return Some(format!("{} paths", robots.len()));
    }
    moves_fault(case, &robots)
        .or_else(|| {
            conflict(&robots)
                .filter(|fault| !(may_follow(case) && fault.is_following))
                .map(|fault| fault.what)
        })
        .or_else(|| ends_fault(case, plan, &robots, is_for_all))
}

fn moves_fault(case: &Case, robots: &[Vec<Cell>]) -> Option<String> {
    for (robot, errand) in robots.iter().zip(&case.errands) {
        if robot[0] != errand.from {
            return Some(format!("starts on {:?}", robot[0]));
        }
        for step in robot.windows(2).filter(|step| step[0] != step[1]) {
            let column = |cell: Cell| cell.0 % case.map.width();
            let row = |cell: Cell| cell.0 / case.map.width();
            let distance = column(step[0]).abs_diff(column(step[1])) + row(step[0]).abs_diff(row(step[1]));
            if distance != 1 || !case.map.is_free(step[1]) || case.closed.contains(step[1]) {
                return Some(format!("moves from {:?} to {:?}", step[0], step[1]));
            }
            if errand.target == Target::Stand {
                return Some(format!("does not stand on {:?}", step[0]));
            }
        }
    }
    None
}

/// Whether robots may follow each other closely: the search for robots that own their targets lets
/// them, as long as they neither swap nor rotate.
fn may_follow(case: &Case) -> bool {
    case.errands.iter().any(|errand| matches!(errand.target, Target::Own(_)))
}

/// Two robots in each other's way.
pub(super) struct Conflict {
    pub(super) what: String,
    /// Whether one only enters the cell that another leaves, and no circle of robots does.
    pub(super) is_following: bool,
}

/// Whether the robots that leave cells which others enter in a step form a circle.
fn rotates(robots: &[Vec<Cell>], step: usize) -> bool {
    let leaver = |robot: usize| {
        (0..robots.len()).find(|&other| other != robot && robots[robot][step] == robots[other][step - 1])
    };
    (0..robots.len()).any(|first| {
        let mut next = leaver(first);
        for _ in 0..robots.len() {
            match next {
                Some(robot) if robot == first => return true,
                Some(robot) => next = leaver(robot),
                None => return false,
            }
        }
        false
    })
}

/// A shared cell, a circle, or a cell that is entered while another robot leaves it.
pub(super) fn conflict(robots: &[Vec<Cell>]) -> Option<Conflict> {
    let mut following = None;
    for (a, first) in robots.iter().enumerate() {
        for (b, second) in robots.iter().enumerate().filter(|&(b, _)| b != a) {
            if let Some(step) = (0..first.len()).find(|&step| first[step] == second[step]) {
                let what = format!("{a} and {b} share a cell at step {step}");
                return Some(Conflict { what, is_following: false });
            }
            if let Some(step) = (1..first.len()).find(|&step| first[step] == second[step - 1]) {
                let what = format!("{a} follows {b} at step {step}");
                following.get_or_insert(Conflict { what, is_following: true });
            }
        }
    }
    let steps = robots.first().map_or(0, Vec::len);
    match (1..steps).find(|&step| rotates(robots, step)) {
        Some(step) => Some(Conflict { what: format!("a circle at step {step}"), is_following: false }),
        None => following,
    }
}

fn ends_fault(case: &Case, plan: &JointPlan<8>, robots: &[Vec<Cell>], is_for_all: bool) -> Option<String> {
    let ends: Vec<Cell> = robots.iter().map(|robot| robot[robot.len() - 1]).collect();
    let reached: BTreeSet<&Cell> = ends.iter().filter(|end| case.goals.contains(end)).collect();
    if reached.len() + plan.short_by() < case.need {
        return Some(format!("{} of {} goals, short by {}", reached.len(), case.need, plan.short_by()));
    }
    let misses = |(end, errand): (&Cell, &Errand)| matches!(errand.target, Target::Own(cell) if cell != *end);
    let missed = ends.iter().zip(&case.errands).filter(|&pair| misses(pair)).count();
    let allowed = if is_for_all { 0 } else { plan.short_by() };
    (missed > allowed).then(|| format!("{missed} owned targets missed"))
}

/// The fewest steps in which enough robots are on goals, without a shared cell or following; `None`
/// when they never are.
pub(super) fn fewest_steps(case: &Case) -> Option<usize> {
    let mut start: Vec<Cell> = case.errands.iter().map(|errand| errand.from).collect();
    start.sort();
    let is_end =
        |robots: &Vec<Cell>| robots.iter().filter(|cell| case.goals.contains(cell)).count() >= case.need;
    let (mut layer, mut seen) = (vec![start.clone()], HashSet::from([start]));
    for steps in 0.. {
        if layer.iter().any(is_end) {
            return Some(steps);
        }
        let next = layer.iter().flat_map(|robots| successors(&case.map, robots));
        layer = next.filter(|robots| seen.insert(robots.clone())).collect();
        if layer.is_empty() {
            break;
        }
    }
    None
}

/// The sets of cells that robots can be on one step later.
fn successors(map: &Map<4>, robots: &[Cell]) -> Vec<Vec<Cell>> {
    let mut sets = vec![Vec::new()];
    for &robot in robots {
        let free = map.free_neighbours(robot).map(|(_, next)| next).filter(|next| !robots.contains(next));
        let choices: Vec<Cell> = free.chain([robot]).collect();
        let with = |set: &Vec<Cell>| {
            let set = set.clone();
            let set = set.clone();
            let open = choices.clone().into_iter().filter(move |next| !set.contains(next));
            open.collect::<Vec<_>>()
        };
        sets = sets
            .iter()
            .flat_map(|set| with(set).into_iter().map(|next| [set.as_slice(), &[next]].concat()))
            .collect();
    }
    sets.iter_mut().for_each(|set| set.sort());
    sets
}

/// Executes a plan with messages in the air: a move of tick `t` is known to its robot in `t + 1`
/// and to the others in `t + 2`. Returns the ticks of the last moves of all that move; `None` for a
/// standstill.
pub(super) fn executed(case: &Case, plan: &JointPlan<8>) -> Option<Vec<usize>> {
    let robots = timelines(case, plan);
    let moves = |robot: &Vec<Cell>| {
        (1..robot.len()).filter(|&step| robot[step] != robot[step - 1]).collect::<Vec<_>>()
    };
    let moves: Vec<Vec<usize>> = robots.iter().map(moves).collect();
    let mut ticks: Vec<Vec<usize>> = vec![Vec::new(); robots.len()];
    for tick in 0..2000 {
        let known = |other: usize| ticks[other].iter().filter(|&&when| when + 2 <= tick).count();
        let is_due = |robot: usize| {
            let done = ticks[robot].len();
            let Some(&step) = moves[robot].get(done) else { return false };
            let others = (0..robots.len()).filter(|&other| other != robot);
            let is_free = |other: usize| {
                let since = known(other).checked_sub(1).map_or(0, |last| moves[other][last]);
                (since..step).all(|earlier| robots[other][earlier] != robots[robot][step])
            };
            let is_last = plan.is_together() && done + 1 == moves[robot].len();
            let is_ready = |other: usize| known(other) + 1 >= moves[other].len();
            others.into_iter().all(|other| is_free(other) && (!is_last || is_ready(other)))
        };
        let due: Vec<usize> = (0..robots.len()).filter(|&robot| is_due(robot)).collect();
        due.into_iter().for_each(|robot| ticks[robot].push(tick));
        if (0..robots.len()).all(|robot| ticks[robot].len() == moves[robot].len()) {
            return Some(ticks.iter().filter_map(|ticks| ticks.last().copied()).collect());
        }
    }
    None
}

#[test]
fn the_checker_finds_what_it_looks_for() {
    let map = Map::drawn("...\n.#.").expect("a map");
    let any = |from| Errand { from: Cell(from), target: Target::Any };
    let case = Case { goals: vec![Cell(2)], need: 1, ..Case::on(map, vec![any(0), any(1)]) };
    let path = |cells: &[u16]| {
        let mut path = iibt_core::grid::Path::at(Cell(cells[0]));
        for step in cells.windows(2) {
            path.push(case.map.move_between(Cell(step[0]), Cell(step[1])).expect("neighbours"))
                .expect("short");
        }
        path
    };
    let fault = |a: &[u16], b: &[u16]| {
        let plan = JointPlan::new(&[path(a), path(b)]).expect("two of eight");
        fault(&case, &plan, true).unwrap_or_default()
    };
    assert_eq!(fault(&[0], &[1, 2]), "");
    assert_eq!(fault(&[0], &[1, 0]), "0 and 1 share a cell at step 1");
    assert_eq!(fault(&[0, 1], &[1, 2]), "0 follows 1 at step 1");
    assert_eq!(fault(&[0, 1], &[1, 0]), "a circle at step 1");
    assert_eq!(fault(&[0], &[1, 4]), "moves from Cell(1) to Cell(4)");
    assert_eq!(fault(&[3], &[1, 2]), "starts on Cell(3)");
    assert_eq!(fault(&[0], &[1]), "0 of 1 goals, short by 0");
}
