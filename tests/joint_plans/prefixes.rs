//! Robots that begin with a given path: by a cell where they look, or on to where they can be
//! stopped.

use super::checker::{conflict, fault, timelines};
use super::{Case, List, listed};
use host_sim::Random;
use iibt_core::grid::joint::{JointPlan, Prefix, Problem, ProblemError, Target};
use iibt_core::grid::{Cell, Move, Path};
use std::collections::{BTreeMap, HashSet};

impl Case {
    /// The same with random first moves of some of the robots, which do not get in each other's
    /// way.
    fn with_prefixes(self, random: &mut Random) -> Self {
        loop {
            let robots: Vec<usize> = (0..self.errands.len()).filter(|_| random.below(3) == 0).collect();
            let prefixes = robots.into_iter().map(|robot| self.prefix(robot, random)).collect();
            let case = Self { prefixes, ..self.clone() };
            if case.problem().check(8).is_ok() {
                return case;
            }
        }
    }

    fn prefix(&self, robot: usize, random: &mut Random) -> Prefix {
        let mut path = Path::at(self.errands[robot].from);
        for _ in 0..random.below(7) {
            let steps = self.map.free_neighbours(path.end(&self.map)).map(|(step, _)| step);
            let steps: Vec<Move> = steps.chain([Move::Wait]).collect();
            path.push(steps[random.below(steps.len())]).expect("short");
        }
        Prefix { robot: robot as u8, path }
    }

    fn begins_with_prefixes(&self, plan: &JointPlan<8>) -> bool {
        self.prefixes.iter().all(|prefix| {
            let path = plan.paths()[usize::from(prefix.robot)];
            prefix
                .path
                .cells(&self.map)
                .zip(path.timeline(&self.map))
                .all(|(given, planned)| given == planned)
        })
    }
}

/// Unlike plans for owned targets without prefixes, these never follow.
#[test]
fn plans_begin_with_the_prefixes_and_nobody_follows() {
    let (mut random, mut list) = (Random::new(31), List::new());
    let (mut plans, mut solved, mut prefixes) = (0, 0, 0);
    for number in 0..5_000 {
        let mut case = Case::random(&mut random, 8, 8);
        if number % 2 == 0 {
            case = case.with_everything(&mut random);
        }
        let case = case.with_prefixes(&mut random);
        if case.prefixes.is_empty() {
            continue;
        }
        let (policies, failure, _) = listed(&mut list, &case, 4, u32::MAX);
        if failure.is_some_and(|_| policies[0].steps() == 0) {
            continue;
        }
        for plan in &policies {
            assert_eq!(fault(&case, plan, failure.is_none()), None, "problem {number}: {case:?} {plan:?}");
            assert!(case.begins_with_prefixes(plan), "problem {number}: {case:?} {plan:?}");
            let conflict = conflict(&timelines(&case, plan)).map(|conflict| conflict.what);
            assert_eq!(conflict, None, "problem {number}: {case:?} {plan:?}");
        }
        (plans, solved) = (plans + policies.len(), solved + usize::from(failure.is_none()));
        prefixes += case.prefixes.len();
    }
    println!("{plans} plans of {solved} problems with {prefixes} prefixes");
    assert!(plans > 7_000 && solved > 2_000 && prefixes > 3_500, "{plans} plans of {solved} problems");
}

/// The fewest steps in which enough robots are on goals once all have made their first moves;
/// `None` when they never are.
fn fewest_steps(case: &Case) -> Option<usize> {
    let longest = case.prefixes.iter().map(|prefix| prefix.path.len()).max().unwrap_or(0);
    let is_end =
        |robots: &Vec<Cell>| robots.iter().filter(|cell| case.goals.contains(cell)).count() >= case.need;
    let mut layer: HashSet<Vec<Cell>> =
        HashSet::from([case.errands.iter().map(|errand| errand.from).collect()]);
    let mut seen = HashSet::new();
    for step in 0.. {
        if step >= longest {
            layer = layer
                .into_iter()
                .map(|mut robots| {
                    robots.sort();
                    robots
                })
                .filter(|robots| seen.insert(robots.clone()))
                .collect();
            if layer.iter().any(is_end) {
                return Some(step);
            }
        }
        if layer.is_empty() {
            break;
        }
        let forced = |robot: usize| {
            let of = |prefix: &&Prefix| usize::from(prefix.robot) == robot && step < prefix.path.len();
            let prefix = case.prefixes.iter().find(of)?;
            Some(prefix.path.cell_at(&case.map, step + 1))
        };
        layer = layer.iter().flat_map(|robots| successors(case, robots, forced)).collect();
    }
    None
}

/// Where the robots can be one step later, in their order.
fn successors(case: &Case, robots: &[Cell], forced: impl Fn(usize) -> Option<Cell>) -> Vec<Vec<Cell>> {
    let mut states = vec![Vec::new()];
    for (index, &robot) in robots.iter().enumerate() {
        let free = case.map.free_neighbours(robot).map(|(_, next)| next).chain([robot]);
        let open = |next: &Cell| *next == robot || !robots.contains(next);
        let choices = forced(index).map_or_else(|| free.collect::<Vec<_>>(), |cell| vec![cell]);
        let choices: Vec<Cell> = choices.into_iter().filter(open).collect();
        let with = |state: &Vec<Cell>| {
            let all = choices.iter().filter(|next| !state.contains(next));
            all.map(|&next| [state.as_slice(), &[next]].concat()).collect::<Vec<_>>()
        };
        states = states.iter().flat_map(with).collect();
    }
    states
}

#[test]
fn a_plan_after_prefixes_has_few_steps_more_than_the_fewest() {
    let (mut random, mut list, mut more) = (Random::new(32), List::new(), BTreeMap::new());
    let (mut solved, mut missed) = (0, 0);
    while solved < 500 {
        let case = Case::random(&mut random, 6, 4).with_prefixes(&mut random);
        if case.map.free_cells().len() > 20 || case.prefixes.is_empty() {
            continue;
        }
        let (policies, failure, _) = listed(&mut list, &case, 2, u32::MAX);
        let is_whole = failure.is_none() && policies[0].short_by() == 0;
        let fewest = fewest_steps(&case);
        assert!(!is_whole || fewest.is_some(), "{case:?}");
        let Some(fewest) = fewest else { continue };
        if !is_whole {
            missed += 1;
            continue;
        }
        solved += 1;
        let shortest = policies.iter().map(JointPlan::steps).min().expect("a policy");
        let longest = case.prefixes.iter().map(|prefix| prefix.path.len()).max().unwrap_or(0);
        *more.entry(shortest.max(longest) - fewest).or_insert(0) += 1;
    }
    println!("steps more than the fewest: {more:?}; {missed} missed");
    assert!(missed == 0 && more.keys().all(|&more| more <= 1), "{missed} missed, {more:?}");
}

/// Plans for problems of their own, as a team makes them that may look first.
#[test]
fn a_list_takes_the_soonest_plan_of_each_problem_once_and_nobody_waits_at_its_end() {
    let (mut random, mut list) = (Random::new(33), List::new());
    let (mut asked, mut by) = (0, 0);
    for number in 0..500 {
        let mut case = Case::random(&mut random, 8, 8);
        let free: Vec<Cell> = case.map.free_cells().iter().collect();
        let robot = random.below(case.errands.len()) as u8;
        list.start_extending();
        let mut ways = vec![None];
        ways.extend((0..4).map(|_| Prefix::by(&case.problem(), robot, free[random.below(free.len())], 0)));
        for way in &ways {
            case.prefixes = way.iter().copied().collect();
            let before = list.policies().len();
            while !list.extend(&case.problem(), &mut 3) {}
            for plan in &list.policies()[before..] {
                assert_eq!(fault(&case, plan, true), None, "problem {number}: {case:?} {plan:?}");
                assert!(!plan.is_together(), "problem {number}");
                let begins = |way: &Prefix| {
                    let path = plan.paths()[usize::from(robot)];
                    path.cells(&case.map).zip(way.path.cells(&case.map)).all(|(one, other)| one == other)
                };
                assert!(way.as_ref().is_none_or(begins), "problem {number}");
            }
            asked += usize::from(way.is_some());
            by += usize::from(way.is_some() && list.policies().len() > before);
        }
        let plans = list.policies();
        let is_twin = |at: usize| plans[..at].iter().any(|plan| plan.paths() == plans[at].paths());
        assert!((0..plans.len()).all(|at| !is_twin(at)), "problem {number}");
    }
    println!("{by} of {asked} ways");
    assert!(by * 2 > asked, "{by} of {asked}");
}

#[test]
fn prefixes_that_make_no_sense_are_named() {
    let mut case = super::drawn(&["1.2.", "....", "..GG"], &[]);
    let prefix = |robot, cells: &[u16]| {
        let cells: Vec<Cell> = cells.iter().copied().map(Cell).collect();
        Prefix { robot, path: Path::through(&case.map, &cells).expect("neighbours") }
    };
    let check = |prefixes: &[Prefix]| Problem { prefixes, ..case.problem() }.check(8);
    assert_eq!(check(&[prefix(0, &[0, 1, 5]), prefix(1, &[2, 2, 2, 1])]), Ok(()));
    let unusable = |robot| Err(ProblemError::UnusablePrefix { robot });
    assert_eq!(check(&[prefix(1, &[3, 2])]), unusable(1), "not where it stands");
    assert_eq!(check(&[prefix(2, &[3, 2])]), unusable(2), "no such robot");
    assert_eq!(check(&[prefix(0, &[0]), prefix(0, &[0])]), unusable(0), "a second one");
    let off_the_map = Prefix { robot: 0, path: Path { start: Cell(0), ..prefix(1, &[7, 3]).path } };
    assert_eq!(check(&[off_the_map]), unusable(0), "off the map");
    let crossing = |robot| Err(ProblemError::CrossingPrefixes { robot });
    assert_eq!(check(&[prefix(0, &[0, 1]), prefix(1, &[2, 1])]), crossing(1), "one cell");
    assert_eq!(check(&[prefix(1, &[2, 3]), prefix(0, &[0, 1, 2])]), Ok(()));
    assert_eq!(check(&[prefix(0, &[0, 1, 2]), prefix(1, &[2, 2, 3])]), crossing(1), "following");
    case.errands[0].target = Target::Stand;
    let standing = Problem { prefixes: &[Prefix { robot: 0, path: Path::at(Cell(0)) }], ..case.problem() };
    assert_eq!(standing.check(8), unusable(0), "it stands");
}
