//! Ticks from a fact to the first and to the last move.

use super::task::{Joint, List, Place, Places};
use super::team::{Radio, Team};
use iibt_core::team::RobotId;
use iibt_core::team::rounds::{Proposal, Want};
use std::rc::Rc;

/// Robots on ways of their own, each from one place to another and back.
fn there_and_back(_: &Proposal<Places>, facts: &[(RobotId, Place)]) -> Rc<List> {
    let mut paths = vec![Vec::new(); 8];
    for (robot, fact) in facts {
        paths[robot.index()] = vec![fact.at, Places(fact.at.0.rotate_left(8))];
    }
    Rc::new(List(vec![Joint { paths, cost: 8, is_together: false }]))
}

/// The ticks from robot 0's fact to the first and the last move.
fn ticks(robots: u8, loss: f64, seed: u64) -> (u32, u32) {
    let places: Vec<u8> = (0..robots).collect();
    let mut team = Team::new(&places, Rc::new(there_and_back), Radio::new(loss, seed));
    team.fly(1000, Team::has_arrived).expect("the first round comes about");
    let before = team.robots[0].rounds.proposal().round;
    team.robots[0].want = Some(Want::Better);
    let mut moved = vec![None; team.robots.len()];
    for tick in 0..200 {
        team.tick();
        for (robot, moved) in team.robots.iter().zip(&mut moved) {
            if robot.is_moving && robot.rounds.proposal().round > before {
                moved.get_or_insert(tick);
            }
        }
    }
    let moved = || moved.iter().map(|tick| tick.expect("every robot moves"));
    (moved().min().unwrap(), moved().max().unwrap())
}

fn mean(robots: u8, loss: f64, seeds: u64) -> (f64, f64) {
    let (first, last) = (0..seeds)
        .map(|seed| ticks(robots, loss, seed))
        .fold((0, 0), |(first, last), (one, other)| (first + one, last + other));
    (f64::from(first) / seeds as f64, f64::from(last) / seeds as f64)
}

#[test]
fn two_or_three_ticks_without_loss() {
    assert_eq!(ticks(2, 0.0, 0), (2, 3));
    for robots in 3..=8 {
        assert_eq!(ticks(robots, 0.0, 0), (3, 3), "{robots} robots");
    }
}

#[test]
fn at_most_seven_and_ten_ticks_at_thirty_percent_loss() {
    let (first, last) = mean(8, 0.3, 500);
    println!("8 robots, 30 % lost, 500 seeds: first {first:.2}, last {last:.2}");
    assert!(first <= 7.0 && last <= 10.0, "first {first}, last {last}");
    assert!(first >= 3.0 && last > 3.0, "the radio loses frames");
}
