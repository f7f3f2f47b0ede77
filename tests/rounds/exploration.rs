//! Everything that can happen to a team, as far as the bounds go. Every state is checked, and from
//! some of them the team flies on undisturbed and must arrive.
//!
//! The bounds are those of a minute. `IIBT_ROUNDS` multiplies states and walks.

use super::grid::Grid;
use super::model::{Action, Body, World};
use super::team::{Radio, Random, Robot, Team};
use iibt_core::team::RobotId;
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
}

fn scale() -> usize {
    std::env::var("IIBT_ROUNDS").map_or(1, |scale| scale.parse().expect("IIBT_ROUNDS is a number"))
}

/// Explores breadth-first until nothing is new or `limit` states are known; flies on from one state
/// in `sample`.
fn explore(grid: &Rc<Grid>, start: World, limit: usize, sample: u64) -> Seen {
    let mut known = HashSet::from([start.number()]);
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
                            seen.continued += 1;
                            fly_on(&after, grid, number / sample, &[], || trace(&step));
                        }
                        next.push((after, step));
                    }
                }
            }
        }
        seen.depth += 1;
        layer = next;
    }
    println!("{:?}", Seen { states: known.len(), is_complete: layer.is_empty(), ..seen });
    Seen { states: known.len(), is_complete: layer.is_empty(), ..seen }
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
    let lists = grid.clone();
    let robots = world.bodies.iter().map(|body| {
        let mut robot = Robot::new(Rounds::of(body.protocol.clone(), Timing::DEFAULT), body.stamp.epoch);
        (robot.list, robot.heard, robot.stamp) = (body.list.clone(), body.heard.clone(), body.stamp);
        (robot.at, robot.is_moving) = (body.at, body.is_moving);
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

/// Lets anything happen, in any order.
fn walk(grid: &Rc<Grid>, mut world: World, steps: usize, random: &mut Random) -> (World, Vec<Action>) {
    let mut trace = Vec::new();
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
    }
    (world, trace)
}

fn square() -> (Rc<Grid>, [u8; 2]) {
    (Rc::new(Grid::new(2, 2, [&[3, 0], &[1, 2]])), [0, 3])
}

fn corridor() -> (Rc<Grid>, [u8; 2]) {
    (Rc::new(Grid::new(4, 1, [&[0, 1], &[2, 3]])), [1, 2])
}

#[test]
fn two_robots_open_twice() {
    for (grid, start) in [square(), corridor()] {
        let seen = explore(&grid, World::new(&start, 2, &[]), usize::MAX, 200);
        assert!(seen.is_complete && seen.states > 50_000 && seen.continued > 100, "{seen:?}");
    }
}

#[test]
fn two_robots_open_once_and_one_starts_again() {
    for restarts in [[1, 0], [0, 1]] {
        let (grid, start) = corridor();
        let limit = 250_000 * scale();
        let seen = explore(&grid, World::new(&start, 1, &restarts), limit, 1000);
        assert!(seen.is_complete || seen.states >= limit, "{seen:?}");
    }
}

#[test]
fn two_robots_open_twice_and_one_starts_again() {
    for restarts in [[1, 0], [0, 1]] {
        let (grid, start) = square();
        let limit = 250_000 * scale();
        let seen = explore(&grid, World::new(&start, 2, &restarts), limit, 1000);
        assert!(seen.is_complete || seen.states >= limit, "{seen:?}");
    }
}

#[test]
fn three_robots_open_once() {
    let grid = square_of_six();
    let limit = 150_000 * scale();
    let seen = explore(&grid, World::new(&[0, 4, 2], 1, &[]), limit, 1000);
    assert!(seen.is_complete || seen.states >= limit, "{seen:?}");
}

fn square_of_six() -> Rc<Grid> {
    Rc::new(Grid::new(3, 2, [&[5, 3, 1], &[2, 0, 4]]))
}

/// Walks of three robots with eight openings and these restarts; at the end a robot may die, if
/// the others know where it can be.
fn walks(restarts: &[u8], dies: bool) {
    let grid = square_of_six();
    let count = 1500 * scale();
    let (mut moves, mut deaths) = (0, 0);
    for seed in 0..count as u64 {
        let mut random = Random(seed);
        let (world, trace) = walk(&grid, World::new(&[0, 4, 2], 8, restarts), 300, &mut random);
        moves += trace.iter().filter(|action| matches!(action, Action::Begin(_))).count();
        let dead = random.below(3);
        let is_known = |body: &Body| body.protocol.reach(RobotId(dead as u8)).is_some();
        let others = world.bodies.iter().enumerate().filter(|&(robot, _)| robot != dead);
        let dead: &[usize] = if dies && others.map(|(_, body)| body).all(is_known) { &[dead] } else { &[] };
        deaths += dead.len();
        fly_on(&world, &grid, seed, dead, || trace);
    }
    println!("{moves} moves in {count} walks, {deaths} deaths");
    assert!(moves > 5 * count && (deaths > count / 4 || !dies), "{moves} moves, {deaths} deaths in {count}");
}

#[test]
fn three_robots_at_random() {
    walks(&[], true);
}

#[test]
fn three_robots_that_start_again_at_random() {
    walks(&[1, 1, 1], false);
}

/// One action a line.
fn told(actions: &[Action]) -> String {
    actions.iter().map(|action| format!("\n{action:?}")).collect()
}
