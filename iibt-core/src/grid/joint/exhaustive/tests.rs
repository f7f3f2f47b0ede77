//! The search over all states on small teams, against every sequence of moves that they can make.

use super::super::super::pictures::Random;
use super::super::teams::{Answer, Trial, finish, own, random_map};
use super::super::{JointPlanner, Target};
use super::*;
use std::boxed::Box;
use std::collections::HashSet;
use std::vec::Vec;

fn answer<const M: usize>(trial: &Trial, slice: u32) -> Answer {
    let mut search = Box::new(Exhaustive::<2, 8, M>::new(u32::MAX));
    finish(slice, |budget| search.work(&trial.problem(), &trial.targets(), budget)).0
}

/// The fewest moves, one at a time.
fn fewest_moves(trial: &Trial) -> Option<usize> {
    let start: Vec<Cell> = trial.errands.iter().map(|errand| errand.from).collect();
    let targets = &trial.targets()[..start.len()];
    let (mut seen, mut layer) = (HashSet::from([start.clone()]), std::vec![start]);
    for moves in 0.. {
        if layer.is_empty() || layer.iter().any(|state| state == targets) {
            return (!layer.is_empty()).then_some(moves);
        }
        let steps = layer.iter().flat_map(|state| (0..state.len()).map(move |robot| (state, robot)));
        let next = steps.flat_map(|(state, robot)| {
            let free = trial.map.free_neighbours(state[robot]).map(|(_, to)| to);
            free.filter(|to| !state.contains(to)).map(move |to| {
                let mut next = state.clone();
                next[robot] = to;
                next
            })
        });
        layer = next.filter(|state| seen.insert(state.clone())).collect();
    }
    None
}

#[test]
fn finds_the_fewest_moves_or_proves_that_there_is_no_plan() {
    let mut random = Random(16);
    let (mut solved, mut impossible) = (0, 0);
    while solved < 600 {
        let map = random_map(4, &mut random);
        let trial = Trial::on(map, 1 + random.below(4), &mut random);
        let Some(trial) = trial.filter(|_| map.free_cells().len() < 12) else { continue };
        match (answer::<64>(&trial, 100_000), fewest_moves(&trial)) {
            (Ok(plan), Some(fewest)) => {
                assert!(!trial.check(&plan), "nobody follows: {plan:?}");
                let moves = plan.paths().iter().flat_map(|path| path.moves());
                assert_eq!(moves.filter(|&step| step != Move::Wait).count(), fewest, "{plan:?}");
                solved += 1;
            }
            (Err(Failure::Impossible), None) => impossible += 1,
            (answer, fewest) => panic!("{answer:?} where {fewest:?} moves do: {:?}", trial.errands),
        }
    }
    assert!(impossible > 50, "{impossible} impossible");
}

#[test]
fn moves_that_need_not_wait_are_made_at_once() {
    let trial = Trial::drawn(&["1...a", "#####", "2..b.", "#####", "c...3"]);
    let plan = answer::<4096>(&trial, u32::MAX).unwrap();
    assert_eq!((trial.check(&plan), plan.steps()), (false, 4));
}

#[test]
fn the_plan_does_not_depend_on_how_the_work_was_cut() {
    let trial = Trial::drawn(&["1a.b2", "##.##"]);
    let whole = answer::<64>(&trial, u32::MAX);
    assert!(whole.is_ok(), "{whole:?}");
    for slice in [1, 7, 100] {
        assert_eq!(answer::<64>(&trial, slice), whole);
    }
}

#[test]
fn a_table_that_is_too_small_has_nothing_to_say() {
    // Six places for two robots: thirty states. One node has 160 marks, so that three robots fit
    // too.
    let check = |robots: usize, expected: Result<(), Failure>| {
        let mut trial = Trial::drawn(&["1234..", "....ab", "cd...."]);
        trial.errands.truncate(robots);
        assert_eq!(answer::<2>(&trial, u32::MAX).map(|_| ()), expected, "{robots} robots");
    };
    check(1, Ok(()));
    check(2, Ok(()));
    check(3, Err(Failure::NotFound));
}

#[test]
fn a_robot_that_stands_is_a_wall_and_a_closed_cell_is_only_left() {
    let mut trial = Trial::drawn(&["1.2a", "...b"]);
    trial.errands[1].target = Target::Stand;
    trial.closed = [Cell(0)].into_iter().collect();
    let plan = answer::<64>(&trial, u32::MAX).unwrap();
    assert_eq!((trial.check(&plan), plan.steps()), (false, 5));
    // The way back is closed, and the only one past the other robot.
    trial.errands = std::vec![own(Cell(0), Cell(0)), own(Cell(1), Cell(3))];
    let plan = answer::<64>(&trial, u32::MAX).unwrap();
    assert_eq!((trial.check(&plan), plan.paths()[0].len(), plan.steps()), (false, 0, 2));
    let mut trial = Trial::drawn(&["b1a2"]);
    trial.closed = [Cell(3)].into_iter().collect();
    assert_eq!(answer::<64>(&trial, u32::MAX).map(|_| ()), Err(Failure::Impossible));
}

#[test]
fn the_arena_takes_no_more_memory_than_the_other_searches() {
    let sizes = [size_of::<Exhaustive<2, 8, 64>>(), size_of::<JointPlanner<2, 33, 8, 64>>()];
    assert!(sizes[0] < 3000 && sizes[1] <= 3300, "{sizes:?}");
}
