//! Everything that can happen to a team, as far as the bounds go. Every state is checked, and from
//! some of them the team flies on undisturbed and must arrive: whole, and without a robot that
//! dies.
//!
//! A move begins and ends by actions of its own, and the robot is in both places in between; so it
//! takes as long as the exploration likes, and a pace of one, two or three ticks is inside. The
//! team that flies on has such paces, a draw for each robot.
//!
//! The bounds are those of a minute. `IIBT_ROUNDS` multiplies states and walks.

use super::grid::Grid;
use super::model::{Action, World};
use super::team::{Radio, Random, Robot, Team};
use iibt_core::team::rounds::{Rounds, Timing};
use std::collections::HashSet;
use std::rc::Rc;

/// How many messages come back that are older than what a robot had heard before it started again.
const KEPT: usize = 1;

/// How a state came about.
struct Step {
    action: Action,
    before: Option<Rc<Step>>,
}

/// What an exploration has seen.
#[derive(Debug, Default)]
struct Seen {
    states: usize,
    transitions: usize,
    depth: usize,
    is_complete: bool,
    continued: usize,
    deaths: usize,
    /// Deaths of a robot for which others wait before their last moves.
    deaths_before_barrier: usize,
    /// Walks in which a robot that has started took the others' word for where one left out is.
    vouched: usize,
}

impl Seen {
    /// Flies on from a state: whole, and if one of a team that has not started again may die,
    /// without it.
    fn fly_on(
        &mut self,
        world: &World,
        grid: &Rc<Grid>,
        draw: u64,
        dies: bool,
        trace: impl Fn() -> Vec<Action>,
    ) {
        self.continued += 1;
        fly_on(world, grid, draw, &[], &trace);
        let robots = 0..world.bodies.len();
        let before_barrier = robots.clone().find(|&robot| world.bodies[robot].is_before_barrier());
        let dead = before_barrier.unwrap_or((draw / 2) as usize % robots.len());
        if dies && world.can_lose(dead) {
            self.deaths += 1;
            self.deaths_before_barrier += usize::from(before_barrier.is_some());
            fly_on(world, grid, draw, &[dead], trace);
        }
    }
}

fn scale() -> usize {
    std::env::var("IIBT_ROUNDS").map_or(1, |scale| scale.parse().expect("IIBT_ROUNDS is a number"))
}

/// Explores breadth-first until nothing is new or `limit` states are known; flies on from one state
/// in `sample`. Where no robot may start again, some die.
fn explore(grid: &Rc<Grid>, start: World, limit: usize, sample: u64) -> Seen {
    let mut known = HashSet::from([start.number()]);
    let dies = start.restarts.iter().all(|&restarts| restarts == 0);
    let mut layer: Vec<(World, Option<Rc<Step>>)> = vec![(start, None)];
    let mut seen = Seen::default();
    while !layer.is_empty() && known.len() < limit {
        let mut next = Vec::new();
        for (world, before) in &layer {
            for action in world.actions(grid) {
                seen.transitions += 1;
                for after in world.after(action, grid, KEPT) {
                    let number = after.number();
                    if known.insert(number) {
                        let step = Some(Rc::new(Step { action, before: before.clone() }));
                        check(&after, || trace(&step));
                        if number.is_multiple_of(sample) {
                            seen.fly_on(&after, grid, number / sample, dies, || trace(&step));
                        }
                        next.push((after, step));
                    }
                }
            }
        }
        seen.depth += 1;
        layer = next;
    }
    let seen = Seen { states: known.len(), is_complete: layer.is_empty(), ..seen };
    println!("{seen:?}");
    seen
}

fn check(world: &World, trace: impl FnOnce() -> Vec<Action>) {
    if let Some(violation) = world.violation() {
        panic!("{violation} after{}", told(&trace()));
    }
}

fn trace(step: &Option<Rc<Step>>) -> Vec<Action> {
    let steps = std::iter::successors(step.as_ref(), |step| step.before.as_ref());
    let mut actions: Vec<Action> = steps.map(|step| step.action).collect();
    actions.reverse();
    actions
}

/// Lets a team fly on from a state, undisturbed but for the radio and for robots that die now: the
/// others must arrive, together in one view.
fn fly_on(world: &World, grid: &Rc<Grid>, seed: u64, dead: &[usize], trace: impl FnOnce() -> Vec<Action>) {
    let loss = if seed.is_multiple_of(2) { 0.0 } else { 0.3 };
    let mut random = Random(seed);
    let lists = grid.clone();
    let robots = world.bodies.iter().map(|body| {
        let mut robot = Robot::new(Rounds::of(body.protocol.clone(), Timing::DEFAULT), body.stamp.epoch);
        (robot.list, robot.heard, robot.stamp) = (body.list.clone(), body.heard.clone(), body.stamp);
        (robot.at, robot.is_moving) = (body.at, body.is_moving);
        robot.pace = 1 + random.below(3) as u32;
        robot.centre();
        robot
    });
    let mut team = Team {
        robots: robots.collect(),
        generate: Rc::new(move |proposal, facts| lists.list(proposal, facts)),
        radio: Radio::new(loss, seed),
        ticks: 0,
    };
    for &robot in dead {
        team.robots[robot].is_alive = false;
    }
    if team.fly(2000, Team::has_arrived).is_none() {
        panic!(
            "does not arrive at a loss of {loss}, {dead:?} dead: {:?}, after {:#?}",
            team.waiting(),
            trace()
        );
    }
}

/// Lets anything happen, in any order; also returns whether a robot has taken the others' word.
fn walk(grid: &Rc<Grid>, mut world: World, steps: usize, random: &mut Random) -> (World, Vec<Action>, bool) {
    let (mut trace, mut is_vouched) = (Vec::new(), false);
    for _ in 0..steps {
        let mut actions = world.actions(grid);
        let weights: Vec<usize> = actions.iter().map(|action| world.weight(*action)).collect();
        let mut left = random.below(weights.iter().sum::<usize>().max(1));
        let chosen =
            weights.iter().position(|&weight| left.checked_sub(weight).map(|less| left = less).is_none());
        let Some(chosen) = chosen else { break };
        let mut action = actions.swap_remove(chosen);
        if let Action::Hear(.., attends) = &mut action {
            *attends = random.below(4) > 0;
        }
        trace.push(action);
        let mut worlds = world.after(action, grid, 8);
        world = worlds.swap_remove(random.below(worlds.len()));
        check(&world, || trace.clone());
        is_vouched |= world.has_vouched();
    }
    (world, trace, is_vouched)
}

fn square() -> (Grid, [u8; 2]) {
    (Grid::new(2, 2, [&[3, 0], &[1, 2]]), [0, 3])
}

fn corridor() -> (Grid, [u8; 2]) {
    (Grid::new(4, 1, [&[0, 1], &[2, 3]]), [1, 2])
}

#[test]
fn two_robots_open_twice() {
    for (grid, start) in [square(), corridor()] {
        let seen = explore(&Rc::new(grid), World::new(&start, 2, &[]), usize::MAX, 200);
        assert!(seen.is_complete && seen.states > 50_000, "{seen:?}");
        assert!(seen.continued > 100 && seen.deaths > 20, "{seen:?}");
    }
}

#[test]
fn two_robots_that_arrive_together_open_twice() {
    let ((square, start), (corridor, _)) = (square(), corridor());
    for (grid, start) in [(square, start), (corridor, [2, 3])] {
        let seen = explore(&Rc::new(grid.together()), World::new(&start, 2, &[]), usize::MAX, 50);
        assert!(seen.is_complete && seen.states > 50_000, "{seen:?}");
        assert!(seen.continued > 100 && seen.deaths_before_barrier > 20, "{seen:?}");
    }
}

#[test]
fn two_robots_open_once_and_one_starts_again() {
    for restarts in [[1, 0], [0, 1]] {
        let (grid, start) = corridor();
        let limit = 250_000 * scale();
        let seen = explore(&Rc::new(grid), World::new(&start, 1, &restarts), limit, 1000);
        assert!(seen.is_complete || seen.states >= limit, "{seen:?}");
    }
}

#[test]
fn two_robots_open_twice_and_one_starts_again() {
    for restarts in [[1, 0], [0, 1]] {
        let (grid, start) = square();
        let limit = 250_000 * scale();
        let seen = explore(&Rc::new(grid.together()), World::new(&start, 2, &restarts), limit, 1000);
        assert!(seen.is_complete || seen.states >= limit, "{seen:?}");
    }
}

#[test]
fn three_robots_open_once() {
    for (grid, limit) in [(square_of_six(), 150_000), (square_of_six().together(), 50_000)] {
        let limit = limit * scale();
        let seen = explore(&Rc::new(grid), World::new(&THREE, 1, &[]), limit, 1000);
        assert!(seen.is_complete || seen.states >= limit, "{seen:?}");
    }
}

const THREE: [u8; 3] = [0, 4, 2];

fn square_of_six() -> Grid {
    Grid::new(3, 2, [&[5, 3, 1], &[2, 0, 4]])
}

/// Walks of robots from these places, of up to 300 actions, with eight openings and these restarts.
/// At the end all fly on; where none starts again, a robot may die, if the others know where it can
/// be.
fn walks(grid: Grid, places: &[u8], restarts: &[u8], count: usize) -> Seen {
    let (grid, mut seen, mut lengths) = (Rc::new(grid), Seen::default(), [0; 4]);
    let count = count * scale();
    for seed in 0..count as u64 {
        let mut random = Random(seed);
        let steps = 40 + random.below(260);
        let (world, trace, is_vouched) = walk(&grid, World::new(places, 8, restarts), steps, &mut random);
        seen.vouched += usize::from(is_vouched);
        seen.transitions += trace.len();
        lengths_of_moves(&trace).for_each(|length| lengths[length.min(3)] += 1);
        seen.fly_on(&world, &grid, seed, restarts.is_empty(), || trace.clone());
    }
    println!("{seen:?}, moves in which the robot heard so many messages: {lengths:?}");
    assert!(lengths.iter().sum::<usize>() > 3 * count && lengths.iter().all(|&moves| moves > count / 10));
    seen
}

/// How many messages a robot heard in each of its moves.
fn lengths_of_moves(trace: &[Action]) -> impl Iterator<Item = usize> + '_ {
    let begun = trace.iter().enumerate().filter_map(|(at, action)| match action {
        Action::Begin(robot) => Some((at, *robot)),
        _ => None,
    });
    begun.map(|(at, robot)| {
        let during =
            trace[at..].iter().take_while(|action| !matches!(action, Action::End(one) if *one == robot));
        during.filter(|action| matches!(action, Action::Hear(one, ..) if *one == robot)).count()
    })
}

#[test]
fn three_robots_at_random() {
    let seen = walks(square_of_six(), &THREE, &[], 1500);
    assert!(seen.deaths > seen.continued / 4, "{seen:?}");
}

#[test]
fn three_robots_that_arrive_together_at_random() {
    let seen = walks(square_of_six().together(), &THREE, &[], 1500);
    assert!(seen.deaths_before_barrier > seen.continued / 50, "{seen:?}");
}

#[test]
fn three_robots_that_start_again_at_random() {
    walks(square_of_six(), &THREE, &[1, 1, 1], 1500);
}

/// One that starts again may take the word of two others for where the fourth is.
#[test]
fn four_robots_that_start_again_at_random() {
    let grid = Grid::new(4, 2, [&[7, 4, 3, 0], &[2, 1, 6, 5]]);
    let seen = walks(grid, &[0, 3, 4, 7], &[1, 1, 1, 1], 500);
    assert!(seen.vouched > seen.continued / 50, "{seen:?}");
}

/// One action a line.
fn told(actions: &[Action]) -> String {
    actions.iter().map(|action| format!("\n{action:?}")).collect()
}
