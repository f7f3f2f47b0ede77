//! Joint plans held against what they claim: a checker of its own looks at every cell of every
//! plan, a search over joint states knows the fewest steps, and another simulation executes them.

use firmware::bench::joint_plans;
use host_sim::Random;
use iibt_core::grid::joint::{
    Errand, Failure, JointPlan, JointPlanner, LookOut, PolicyList, Prefix, Problem, ProblemError, Target,
};
use iibt_core::grid::{Cell, CellSet, Map};
use std::collections::{BTreeMap, BTreeSet, HashSet};
use tests::budgets::assert_within;
use tests::qemu::{Robot, image, number, printed_on_riscv};

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
    look_outs: Vec<LookOut>,
}

impl Case {
    fn on(map: Map<4>, errands: Vec<Errand>) -> Self {
        let (goals, prefixes, look_outs) = (Vec::new(), Vec::new(), Vec::new());
        Self { map, closed: CellSet::EMPTY, errands, goals, need: 0, prefixes, look_outs }
    }

    fn problem(&self) -> Problem<'_, 4> {
        let Self { map, closed, errands, goals, need, prefixes, look_outs } = self;
        Problem { map, closed: *closed, errands, goals, need: *need, prefixes, look_outs }
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

/// The cells of every robot at every step, one step past the end.
fn timelines(case: &Case, plan: &JointPlan<8>) -> Vec<Vec<Cell>> {
    plan.paths().iter().map(|path| path.timeline(&case.map).take(plan.steps() + 2).collect()).collect()
}

/// What is wrong with a plan: moves, cells, conflicts, ends. Of plans for a part of the targets
/// only, the owned ones are not asked for.
fn fault(case: &Case, plan: &JointPlan<8>, is_for_all: bool) -> Option<String> {
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
struct Conflict {
    what: String,
    /// Whether one only enters the cell that another leaves, and no circle of robots does.
    is_following: bool,
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
fn conflict(robots: &[Vec<Cell>]) -> Option<Conflict> {
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
fn fewest_steps(case: &Case) -> Option<usize> {
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
fn executed(case: &Case, plan: &JointPlan<8>) -> Option<Vec<usize>> {
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
    for _ in 0..3_000 {
        let case = Case::random(&mut random, 8, 8);
        assert_executed_as_listed(&mut list, &case);
        let run = list.policies()[0].execution(&case.map).expect("no standstill");
        together += usize::from(list.policies()[0].is_together() && run.is_together());
        barriers += usize::from(list.policies()[0].is_together() && !run.is_together());
    }
    println!("{together} of 3000 plans arrive together, {barriers} more have a barrier");
    assert!(together > 2_500 && barriers > 0, "{together} arrive together, {barriers} more have a barrier");
    for _ in 0..1_000 {
        let case = Case::random(&mut random, 8, 8).with_everything(&mut random);
        assert_executed_as_listed(&mut list, &case);
    }
}

/// Executes the policies of a problem, and compares with what the planner and its list say.
fn assert_executed_as_listed(list: &mut List, case: &Case) {
    let (policies, _, _) = listed(list, case, 4, u32::MAX);
    for (plan, listed) in policies.iter().zip(list.executions()) {
        let ends = executed(case, plan).unwrap_or_else(|| panic!("a standstill: {case:?} {plan:?}"));
        let simulated = plan.execution(&case.map).expect("no standstill");
        let (first, last) = (ends.iter().min(), ends.iter().max());
        let ticks = usize::from(simulated.ticks);
        assert_eq!(ticks, last.map_or(0, |last| last + 1), "{case:?} {plan:?}");
        let spread = usize::from(simulated.spread);
        assert_eq!(spread, last.zip(first).map_or(0, |(last, first)| last - first), "{case:?} {plan:?}");
        // One that sets out later is listed with its first waits.
        let waits = usize::from(listed.ticks) - ticks;
        assert!(waits == 0 || plan.steps() == policies[0].steps() + waits, "{listed:?}: {case:?} {plan:?}");
        assert_eq!(listed.spread, simulated.spread, "{case:?} {plan:?}");
    }
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
            plan.execution(&case.map),
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

/// An image of the release profile, 200 problems of each size on 64 cells with a fifth of them
/// blocked: one plan, and a decision among four.
#[test]
fn plans_on_the_chip_are_those_of_the_host() {
    let mut robot = Robot::boot_counting(&image("joint_plans"));
    let (mut planner, mut list) = (joint_plans::Planner::new(), Box::new(joint_plans::List::new()));
    for robots in [2, 4, 8] {
        let plans = joint_plans::plan_all(robots, |problem| (problem.plan(&mut planner), 0));
        check_image(&mut robot, "plans", robots, &plans);
        let decisions = joint_plans::plan_all(robots, |problem| (problem.decide(&mut list), 0));
        check_image(&mut robot, "decisions", robots, &decisions);
        let hardest = robot.wait_for(&format!("hardest of {robots} robots: took")).message;
        let instructions = u64::from(number(&hardest, "took ")) * 1000 / 168;
        assert_within("joint_plans", &format!("plans_{robots}_of_20000"), instructions);
    }
}

/// Those that are planned on the chip are the hardest, by work units.
#[test]
fn no_problem_of_twenty_thousand_is_harder_than_the_hardest() {
    let mut planner = joint_plans::Planner::new();
    for robots in [2, 4, 8] {
        let mut problems = joint_plans::Problems::new(2026);
        let (mut solved, mut hard, mut others) = (0, Vec::new(), 0);
        for draw in 0.. {
            let planned = problems.next(robots).and_then(|problem| problem.plan(&mut planner));
            let Some((_, units)) = planned else { continue };
            if joint_plans::hardest(robots).contains(&draw) {
                hard.push(units);
            } else {
                others = others.max(units);
            }
            solved += 1;
            if solved == joint_plans::SEARCHED {
                break;
            }
        }
        println!("{robots} robots: {hard:?} units, {others} of all others");
        assert!(hard.iter().max() >= Some(&others), "{robots} robots: {hard:?}, {others} of another problem");
    }
}

fn check_image(robot: &mut Robot, what: &str, robots: usize, on_the_host: &joint_plans::Plans) {
    let line = robot.wait_for(&format!("{what} of {robots} robots: took")).message;
    let instructions = |before| u64::from(number(&line, before)) * 1000 / 168;
    let expected = format!("{} units, digest {:08x}", on_the_host.units, on_the_host.digest);
    assert!(line.ends_with(&expected), "{line}; on the host {expected}");
    assert_within("joint_plans", &format!("{what}_{robots}"), instructions("took "));
    assert_within("joint_plans", &format!("{what}_{robots}_worst"), instructions("worst "));
}

/// A processor of another make, without a floating-point unit.
#[test]
fn plans_on_risc_v_are_those_of_the_host() {
    let (mut planner, mut list) = (joint_plans::Planner::new(), Box::new(joint_plans::List::new()));
    let mut expected = String::new();
    for robots in [2, 4, 8] {
        let plans = joint_plans::plan_all(robots, |problem| (problem.plan(&mut planner), 0));
        let decisions = joint_plans::plan_all(robots, |problem| (problem.decide(&mut list), 0));
        for (what, plans) in [("plans", plans), ("decisions", decisions)] {
            let joint_plans::Plans { units, digest, .. } = plans;
            expected += &format!("{what} of {robots} robots: {units} units, digest {digest:08x}\n");
        }
    }
    assert_eq!(printed_on_riscv("joint_plans_riscv"), expected);
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
