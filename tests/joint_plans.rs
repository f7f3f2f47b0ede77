//! Joint plans held against what they claim, by a checker of their own.

use checker::{executed, fault, fewest_steps};
use host_sim::Random;
use iibt_core::grid::joint::{
    Errand, Failure, JointPlan, JointPlanner, PolicyList, Prefix, Problem, ProblemError, Target,
};
use iibt_core::grid::{Cell, CellSet, Map};
use std::collections::{BTreeMap, HashSet};

mod checker;
mod images;
mod prefixes;

type List = PolicyList<4, 33, 8, 64, 16>;

/// A problem that owns what [`Problem`] borrows.
#[derive(Clone, Debug)]
struct Case {
    map: Map<4>,
    closed: CellSet<4>,
    errands: Vec<Errand>,
    goals: Vec<Cell>,
    need: usize,
    prefixes: Vec<Prefix>,
}

impl Case {
    fn on(map: Map<4>, errands: Vec<Errand>) -> Self {
        let (goals, prefixes) = (Vec::new(), Vec::new());
        Self { map, closed: CellSet::EMPTY, errands, goals, need: 0, prefixes }
    }

    fn problem(&self) -> Problem<'_, 4> {
        let Self { map, closed, errands, goals, need, prefixes } = self;
        Problem { map, closed: *closed, errands, goals, need: *need, prefixes }
    }

    /// A map of up to `side` x `side` cells of which up to half are blocked, with up to `robots`
    /// robots and goals for all of them, or up to two more.
    fn random(random: &mut Random, side: usize, robots: usize) -> Self {
        loop {
            let (width, height) = (1 + random.below(side) as u16, 1 + random.below(side) as u16);
            let walls = random.below(50);
            let map = Map::new(width, height).expect("64 cells fit four words");
            let map = map.avoiding((0..width * height).map(Cell).filter(|_| random.below(100) < walls));
            let mut free: Vec<Cell> = map.free_cells().iter().collect();
            let robots = 1 + random.below(robots);
            let goals = robots + random.below(3);
            if free.len() < goals {
                continue;
            }
            let starts = draw(random, &mut free.clone(), robots);
            let errands = starts.into_iter().map(|from| Errand { from, target: Target::Any }).collect();
            let goals = draw(random, &mut free, goals);
            return Self { goals, need: robots, ..Self::on(map, errands) };
        }
    }

    /// The same with fewer goals needed, closed cells, robots that stand and up to two that own
    /// their targets.
    fn with_everything(mut self, random: &mut Random) -> Self {
        let free: Vec<Cell> = self.map.free_cells().iter().collect();
        self.need = 1 + random.below(self.need);
        if random.below(4) == 0 {
            self.closed = draw(random, &mut free.clone(), 3.min(free.len())).into_iter().collect();
        }
        let owners = random.below(3).min(free.len());
        for target in draw(random, &mut free.clone(), owners) {
            let robot = random.below(self.errands.len());
            self.errands[robot].target = Target::Own(target);
        }
        if random.below(3) == 0 {
            let robot = random.below(self.errands.len());
            self.errands[robot].target = Target::Stand;
        }
        self
    }
}

fn draw(random: &mut Random, from: &mut Vec<Cell>, count: usize) -> Vec<Cell> {
    (0..count).map(|_| from.swap_remove(random.below(from.len()))).collect()
}

/// The list of up to `count` policies, made with this many work units at a time, and the units that
/// it took.
fn listed(list: &mut List, case: &Case, count: usize, cut: u32) -> (Vec<JointPlan<8>>, Option<Failure>, u64) {
    let mut units = 0;
    list.start();
    loop {
        let mut budget = cut;
        let done = list.work(&case.problem(), count, &mut budget);
        units += u64::from(cut - budget);
        if done {
            return (list.policies().to_vec(), list.failure(), units);
        }
    }
}

fn best(case: &Case) -> (JointPlan<8>, Option<Failure>) {
    let (policies, failure, _) = listed(&mut List::new(), case, 1, u32::MAX);
    (policies[0], failure)
}

#[test]
fn no_plan_of_twenty_thousand_problems_has_a_conflict() {
    let (mut random, mut list) = (Random::new(11), List::new());
    let (mut plans, mut failures, mut different) = (0, BTreeMap::new(), 0);
    for number in 0..20_000 {
        let mut case = Case::random(&mut random, 8, 8);
        if number % 2 == 0 {
            case = case.with_everything(&mut random);
        }
        let (policies, failure, _) = listed(&mut list, &case, 4, u32::MAX);
        for policy in &policies {
            let fault = fault(&case, policy, failure.is_none());
            assert_eq!(fault, None, "problem {number}: {case:?} {policy:?}");
            plans += 1;
        }
        let paths: HashSet<_> = policies.iter().map(|policy| policy.paths().to_vec()).collect();
        assert_eq!(paths.len(), policies.len(), "problem {number}: two policies are alike");
        different += usize::from(policies.len() == 4);
        *failures.entry(failure.map(|failure| failure.to_string())).or_insert(0) += 1;
    }
    println!("{plans} plans, {different} full lists, {failures:?}");
    assert!(plans > 60_000 && different > 12_000, "{plans} plans, {different} full lists");
    assert!(failures[&None] > 17_000, "{failures:?}");
}

#[test]
fn a_plan_has_at_most_one_step_more_than_the_fewest() {
    let (mut random, mut list, mut more) = (Random::new(12), List::new(), BTreeMap::new());
    let (mut together, mut solved) = (BTreeMap::new(), 0);
    while solved < 1_500 {
        let case = Case::random(&mut random, 6, 4);
        if case.map.free_cells().len() > 20 {
            continue;
        }
        let (policies, failure, _) = listed(&mut list, &case, 2, u32::MAX);
        let is_whole = failure.is_none() && policies[0].short_by() == 0;
        let fewest = fewest_steps(&case);
        assert_eq!(is_whole, fewest.is_some(), "{case:?} {failure:?}");
        let Some(fewest) = fewest else { continue };
        solved += 1;
        let shortest = policies.iter().map(JointPlan::steps).min().expect("a policy");
        *more.entry(shortest - fewest).or_insert(0) += 1;
        *together.entry(policies[0].steps() - fewest).or_insert(0) += 1;
        assert!(policies[0].steps() <= fewest + 1 || policies[0].is_together(), "{case:?}");
    }
    println!("steps more than the fewest: {more:?}; of the best, which arrives together: {together:?}");
    assert!(more.keys().all(|&more| more <= 1), "{more:?}");
    assert!(together.keys().all(|&more| more <= 5), "{together:?}");
    assert!(more[&0] > 1_300 && together[&0] > 1_300, "{more:?} {together:?}");
}

#[test]
fn what_is_left_of_the_budget_changes_no_plan() {
    let (mut random, mut list) = (Random::new(13), List::new());
    for number in 0..1_000 {
        let case = Case::random(&mut random, 8, 8).with_everything(&mut random);
        let at_once = listed(&mut list, &case, 16, u32::MAX);
        for cut in [1, 7, 100] {
            assert_eq!(listed(&mut list, &case, 16, cut), at_once, "problem {number}, {cut} units at a time");
        }
    }
}

#[test]
fn a_plan_is_executed_as_it_was_simulated_and_listed() {
    let (mut random, mut list) = (Random::new(14), List::new());
    let (mut together, mut barriers) = (0, 0);
    for number in 0..4_000 {
        let mut case = Case::random(&mut random, 8, 8);
        if number % 4 == 0 {
            case = case.with_everything(&mut random);
        }
        let (policies, _, _) = listed(&mut list, &case, 4, u32::MAX);
        policies.iter().for_each(|plan| assert_executed_as_listed(&case, plan, &policies[0]));
        let is_barrier = policies[0].is_together();
        together += usize::from(is_barrier && policies[0].execution().is_together());
        barriers += usize::from(is_barrier && !policies[0].execution().is_together());
    }
    println!("{together} of 4000 plans arrive together, {barriers} more have a barrier");
    assert!(together > 3_000 && barriers > 0, "{together} arrive together, {barriers} more have a barrier");
}

/// Executes a policy, and compares with what the planner and its list say.
fn assert_executed_as_listed(case: &Case, plan: &JointPlan<8>, best: &JointPlan<8>) {
    let ends = executed(case, plan).unwrap_or_else(|| panic!("a standstill: {case:?} {plan:?}"));
    let (first, last) = (ends.iter().min(), ends.iter().max());
    let simulated = plan.execute(&case.map).expect("no standstill");
    assert_eq!(usize::from(simulated.ticks), last.map_or(0, |last| last + 1), "{case:?} {plan:?}");
    let spread = last.zip(first).map_or(0, |(last, first)| last - first);
    assert_eq!(usize::from(simulated.spread), spread, "{case:?} {plan:?}");
    // One that begins later is listed with its first waits.
    let waits = plan.execution().ticks - simulated.ticks;
    assert!(waits == 0 || plan.steps() == best.steps() + usize::from(waits), "{case:?} {plan:?}");
    assert_eq!(plan.execution().spread, simulated.spread, "{case:?} {plan:?}");
}

/// Robots `1` to `8` of a drawing, and its goals `G` or those given.
fn drawn(rows: &[&str], goals: &[u16]) -> Case {
    let cells = rows.concat();
    let all = |sign| cells.match_indices(sign).map(|(cell, _)| Cell(cell as u16)).collect::<Vec<_>>();
    let map = Map::new(rows[0].len() as u16, rows.len() as u16).expect("128 cells").avoiding(all('#'));
    let errands: Vec<Errand> =
        ('1'..='8').flat_map(all).map(|from| Errand { from, target: Target::Any }).collect();
    let goals: Vec<Cell> = goals.iter().copied().map(Cell).chain(all('G')).collect();
    Case { need: errands.len().min(goals.len()), goals, ..Case::on(map, errands) }
}

/// Missions in which robots that chose one by one stood still for ever, or took turns for a hundred
/// ticks.
#[test]
fn missions_in_which_robots_were_stuck_have_short_plans() {
    #[rustfmt::skip]
    let missions: [(&str, &[&str], &[u16], usize); 9] = [
        ("into a dead end", &["1.#####", ".....GG", "2.#####"], &[], 8),
        ("four in a line", &["1234...GGGG"], &[], 10),
        ("past each other around a corner", &["#2#..", "4GG#G", "1.G.3"], &[], 3),
        ("two change their goals", &["32##..", ".GGG.1"], &[], 3),
        ("a connector", &["#1#", "2.#", "#..", "##.", "##."], &[14, 11], 6),
        ("a string", &["3.#", "#.1", "..#", "#.#", "2.#"], &[7, 6, 10], 5),
        ("a tree", &[".", "2", "1", "3"], &[1, 3, 0], 3),
        ("a tunnel", &["2#", ".1", ".#", ".#", ".#", ".#"], &[10, 8], 6),
        ("a warehouse", &[
            "1..............G", "..##.##.##.##..G", "2.##.##.##.##..G", "..##.##.##.##...",
            "3.##.##.##.##..G", "..##.##.##.##..G", "4..............G", "5..............6",
        ], &[], 18),
    ];
    for (name, rows, goals, steps) in missions {
        let case = drawn(rows, goals);
        let (plan, failure) = best(&case);
        assert_eq!((failure, fault(&case, &plan, true)), (None, None), "{name}: {plan:?}");
        println!(
            "{name}: {} steps, {:?}, together {}",
            plan.steps(),
            plan.execute(&case.map),
            plan.is_together()
        );
        assert!(plan.steps() <= steps, "{name}: {} steps", plan.steps());
        assert_eq!(plan.short_by(), 0, "{name}");
    }
}

#[test]
fn two_robots_change_the_ends_of_a_corridor_by_its_niche() {
    let mut case = drawn(&["1......2", "###.####"], &[0, 7]);
    case.need = 0;
    case.errands[0].target = Target::Own(Cell(7));
    case.errands[1].target = Target::Own(Cell(0));
    let (plan, failure) = best(&case);
    assert_eq!((failure, fault(&case, &plan, true)), (None, None), "{plan:?}");
    assert!(plan.steps() <= 14, "{} steps", plan.steps());
}

/// The way-points lie behind each other: no plan serves both at once.
#[test]
fn where_two_targets_exclude_each_other_they_are_served_one_after_the_other() {
    let mut case = drawn(&[".1..2.G", "G######"], &[]);
    let mut way_points = [Some(Cell(5)), Some(Cell(0))];
    let (mut rounds, mut steps) = (0, 0);
    while way_points != [None; 2] || rounds == 0 {
        for (errand, way_point) in case.errands.iter_mut().zip(way_points) {
            errand.target = way_point.map_or(Target::Any, Target::Own);
        }
        case.need = way_points.iter().flatten().count().abs_diff(2);
        let (plan, failure) = best(&case);
        assert_eq!(failure.is_some(), rounds == 0, "round {rounds}: {failure:?}");
        assert_eq!(fault(&case, &plan, failure.is_none()), None, "round {rounds}: {plan:?}");
        assert_eq!(plan.short_by(), usize::from(rounds == 0));
        for ((errand, way_point), path) in case.errands.iter_mut().zip(&mut way_points).zip(plan.paths()) {
            errand.from = path.end(&case.map);
            *way_point = way_point.filter(|&cell| cell != errand.from);
        }
        (rounds, steps) = (rounds + 1, steps + plan.steps());
    }
    assert!(rounds == 2 && steps < 17, "{rounds} rounds, {steps} steps");
}

#[test]
fn a_lost_robot_is_a_wall_and_its_goal_drops_out() {
    let mut case = drawn(&["1.....G", "2.....G", "3.....G", "......."], &[]);
    case.errands.remove(1);
    case.need = 2;
    case.closed = (7..14).map(Cell).collect();
    let (plan, failure) = best(&case);
    assert_eq!((failure, fault(&case, &plan, true), plan.short_by()), (None, None, 0));
    assert!(plan.is_together() && plan.steps() <= 7, "{plan:?}");
    case.need = 3;
    assert_eq!(best(&case).0.short_by(), 1);
}

#[test]
fn short_no_way_and_not_found_are_different() {
    let walled = drawn(&["1.#G", "2G##"], &[]);
    let (plan, failure) = best(&walled);
    assert_eq!((failure, plan.short_by(), fault(&walled, &plan, true)), (None, 1, None));
    let (plan, failure) = best(&drawn(&["1.#G", "2.#G"], &[]));
    assert_eq!((failure, plan.steps(), plan.short_by()), (Some(Failure::NoWay), 0, 2));
    let long = format!("1{}G", ".".repeat(40));
    let (plan, failure) = best(&drawn(&[&long], &[]));
    assert_eq!((failure, plan.steps()), (Some(Failure::NotFound), 0));
    let near = format!("1{}G2G", ".".repeat(40));
    let case = drawn(&[&near], &[]);
    let (plan, failure) = best(&case);
    assert_eq!((failure, plan.short_by(), fault(&case, &plan, true)), (None, 1, None), "{plan:?}");
    let mut crowded = drawn(&["12G"], &[]);
    crowded.errands[1].from = Cell(0);
    let (plan, failure) = best(&crowded);
    let shared = ProblemError::SharedStart { cell: Cell(0) };
    assert_eq!((failure, plan.steps(), plan.paths().len()), (Some(Failure::Invalid(shared)), 0, 2));
}

#[test]
fn robots_without_a_goal_make_room_and_end_anywhere() {
    let mut case = drawn(&["12.G", "####"], &[]);
    case.errands[1].target = Target::Any;
    let (plan, _) = best(&case);
    assert_eq!((fault(&case, &plan, true), plan.short_by()), (None, 0));
    case.errands[1].target = Target::Stand;
    let (plan, failure) = best(&case);
    assert_eq!((failure, plan.steps()), (Some(Failure::NoWay), 0), "a wall that stays");
    case.errands = vec![case.errands[1]];
    case.need = 1;
    let (plan, failure) = best(&case);
    assert_eq!((failure, plan.steps(), plan.short_by()), (None, 0, 1), "nobody may move");
}

#[test]
fn the_words_of_a_set_of_cells_change_no_plan() {
    let mut random = Random::new(15);
    let (mut small, mut large) = (JointPlanner::<2, 33, 8, 64>::new(), JointPlanner::<4, 33, 8, 64>::new());
    for _ in 0..500 {
        let case = Case::random(&mut random, 8, 8);
        let map: Map<2> = Map::new(case.map.width(), case.map.height()).expect("64 cells");
        let walls = (0..case.map.len() as u16).map(Cell).filter(|&cell| !case.map.is_free(cell));
        let map = map.avoiding(walls.collect::<Vec<_>>());
        let Case { errands, goals, need, .. } = &case;
        let problem = Problem { goals, need: *need, ..Problem::new(&map, errands) };
        small.start();
        large.start();
        assert_eq!(
            small.work(&problem, &mut u32::MAX.clone()),
            large.work(&case.problem(), &mut u32::MAX.clone())
        );
    }
}

/// The digests tell generators apart whose plans differ.
#[test]
fn a_digest_names_the_sizes() {
    let digests = [
        List::digest(4),
        List::digest(16),
        PolicyList::<2, 33, 8, 64, 16>::digest(4),
        PolicyList::<4, 65, 8, 64, 16>::digest(4),
        PolicyList::<4, 33, 6, 64, 16>::digest(4),
        PolicyList::<4, 33, 8, 128, 16>::digest(4),
        PolicyList::<4, 33, 8, 64, 12>::digest(4),
    ];
    assert_eq!(digests.iter().collect::<HashSet<_>>().len(), digests.len());
}
