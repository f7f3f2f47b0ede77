//! Rule 8: when a robot opens a round, and how long it bears with others.

use super::grid::Grid;
use super::stage::{R0, R1, R2, view};
use super::task::Place;
use super::team::{K, Radio, Robot, Team};
use iibt_core::team::rounds::{Event, Rounds, Score, Timing, View, Waiting, Want};
use iibt_core::team::{Member, RobotId};
use std::rc::Rc;

#[test]
fn rule_5_no_policy_is_chosen_that_some_member_cannot_follow() {
    let mut team = corridor_team(2, Radio::new(0.0, 0));
    team.robots[1].scores = [Score::CANNOT; K];
    team.fly(6, |_| false);
    assert_eq!(team.waiting(), [Some(Waiting::Policy); 2]);
    assert_eq!(team.robots[0].events, [Event::Decided(None)]);
}

fn corridor_team(robots: u8, radio: Radio) -> Team {
    let targets: [&[u8]; 2] = if robots == 2 { [&[0, 1], &[2, 3]] } else { [&[0, 1, 2], &[3, 4, 5]] };
    let grid = Grid::new(2 * robots, 1, targets);
    let places: Vec<u8> = (1..=robots).collect();
    Team::new(&places, Rc::new(move |proposal, facts| grid.list(proposal, facts)), radio)
}

/// Three robots that have arrived at the left end of a corridor of six.
fn arrived() -> Team {
    let mut team = corridor_team(3, Radio::new(0.0, 0));
    team.fly(50, Team::has_arrived).expect("nothing is in the way");
    team
}

fn opened(team: &Team) -> usize {
    let events = team.robots.iter().flat_map(|robot| &robot.events);
    events.filter(|event| matches!(event, Event::Opened(_))).count()
}

#[test]
fn rule_8_a_robot_does_not_want_two_rounds_within_the_refractory_time() {
    let mut team = arrived();
    let rounds = |team: &mut Team, want, ticks| {
        let before = opened(team);
        for _ in 0..ticks {
            team.robots[0].want = want;
            team.tick();
        }
        opened(team) - before
    };
    assert_eq!(rounds(&mut team, None, 40), 0);
    let wished = rounds(&mut team, Some(Want::Better), 40);
    assert!((3..=4).contains(&wished), "{wished} rounds in 40 ticks");
    let needed = rounds(&mut team, Some(Want::Needed), 40);
    assert!((8..=14).contains(&needed), "{needed} rounds in 40 ticks: as often as one is decided");
}

#[test]
fn rule_8_two_that_open_at_once_cost_a_tick() {
    let mut team = arrived();
    team.robots[0].want = Some(Want::Better);
    team.robots[2].want = Some(Want::Better);
    let ticks = team.fly(20, |team| {
        let newest = team.robots.iter().map(|robot| robot.rounds.proposal().round).max();
        team.robots.iter().all(|robot| {
            let protocol = robot.rounds.protocol();
            protocol.has_decided() && Some(protocol.proposal().round) == newest && newest > Some(0)
        })
    });
    assert!(ticks <= Some(4), "{ticks:?}");
}

#[test]
fn rule_8_who_blocks_in_silence_is_left_out_and_taken_in_again() {
    let mut team = arrived();
    team.robots[1].is_alive = false;
    team.robots[0].want = Some(Want::Better);
    let limit = u32::from(Timing::DEFAULT.lost_after());
    assert_eq!(team.fly(limit, |team| team.robots[0].rounds.proposal().view != View::full(3)), None);
    assert_eq!(team.waiting()[0], Some(Waiting::Fact(R1)));
    team.fly(15, Team::has_arrived).expect("the others go on");
    assert_eq!(team.robots[0].rounds.proposal().view, view(&[R0, R2]));
    team.robots[1].is_alive = true;
    team.fly(20, Team::has_arrived).expect("it is a member again");
    assert_eq!(team.robots[1].rounds.proposal().view, View::full(3));
}

/// Ticks until robot 1 is left out of a round, which robot 0 wants, when it can be heard no more,
/// or when it is the one that hears nothing.
fn left_out_after(team: &mut Team, dead: &[(usize, usize)]) -> u32 {
    team.robots[0].want = Some(Want::Better);
    team.radio.dead = dead.to_vec();
    let ticks = team.fly(200, |team| team.robots[0].rounds.proposal().view != View::full(3));
    team.radio.dead.clear();
    ticks.expect("it blocks the others")
}

const UNHEARD: [(usize, usize); 2] = [(1, 0), (1, 2)];
const DEAF: [(usize, usize); 2] = [(0, 1), (2, 1)];

#[test]
fn rule_8_who_was_silent_long_and_came_back_is_waited_for_longer() {
    let after = |silence: u32, dead: &[_]| {
        let mut team = arrived();
        team.radio.dead = UNHEARD.to_vec();
        team.fly(silence, |_| false);
        team.radio.dead.clear();
        team.fly(3, |_| false);
        left_out_after(&mut team, dead)
    };
    let usual = after(0, &UNHEARD);
    assert!((20..30).contains(&usual), "{usual}");
    assert_eq!(after(5, &UNHEARD), usual, "as without bursts");
    let longer = [10, 15, 100].map(|silence| after(silence, &UNHEARD) - usual);
    assert_eq!(longer, [10, 25, 60], "thrice the silence, within four times the usual");
    assert_eq!(after(15, &DEAF) - after(0, &DEAF), 50, "twice as many if it is heard");
}

#[test]
fn rule_8_the_silence_before_a_new_start_is_none_from_which_a_robot_came_back() {
    let usual = left_out_after(&mut arrived(), &UNHEARD);
    let mut team = arrived();
    team.robots[1].is_alive = false;
    team.fly(100, |_| false);
    let member = Member::new(R1, 3).unwrap();
    let place = Place { at: team.robots[1].at, errand: 0 };
    team.robots[1] = Robot::new(Rounds::new(member, 2, 7, place, Timing::DEFAULT), 2);
    team.fly(30, Team::has_arrived).expect("it is answered");
    let after = left_out_after(&mut team, &UNHEARD);
    assert!(after.abs_diff(usual) <= 2, "{after} ticks, {usual} without the start");
}

#[test]
fn rule_8_a_robot_that_is_lost_again_and_again_waits_longer_each_time() {
    let mut team = arrived();
    let mut out = Vec::new();
    for _ in 0..4 {
        left_out_after(&mut team, &DEAF);
        // It must not drive in between, which would show that it works again.
        out.push(
            team.fly(400, |team| team.robots[0].rounds.proposal().view == View::full(3)).expect("it is back"),
        );
    }
    assert!(out[0] < 20 && out[1] > 15 && out[2] > out[1] && out[3] > out[2], "{out:?}");
}

#[test]
fn rule_8_a_robot_that_starts_again_is_answered_by_another_round() {
    for robot in 0..3 {
        let mut team = arrived();
        let member = Member::new(RobotId(robot), 3).unwrap();
        let place = Place { at: team.robots[usize::from(robot)].at, errand: 0 };
        team.robots[usize::from(robot)] = Robot::new(Rounds::new(member, 2, 7, place, Timing::DEFAULT), 2);
        let before = opened(&team);
        let ticks = team.fly(30, Team::has_arrived);
        assert!(ticks.is_some_and(|ticks| ticks < 15), "robot {robot}: {ticks:?}");
        let one = team.robots[usize::from(robot)].events.len();
        assert_eq!(opened(&team), before.max(1), "robot {robot}, {one}: one of them opens a round");
    }
}

#[test]
fn rule_8_without_a_quorum_or_before_all_were_heard_the_state_has_a_name() {
    let mut team = corridor_team(3, Radio::new(0.0, 0));
    team.robots[2].is_alive = false;
    team.fly(60, |_| false);
    assert_eq!(team.waiting()[..2], [Some(Waiting::Unheard(R2)); 2], "it never spoke");
    let mut pair = corridor_team(2, Radio::new(0.0, 0));
    pair.fly(20, Team::has_arrived).expect("nothing is in the way");
    pair.robots[0].is_alive = false;
    pair.robots[1].want = Some(Want::Needed);
    pair.fly(60, |_| false);
    assert_eq!(pair.waiting()[1], Some(Waiting::Quorum(R0)));
}

#[test]
fn a_robot_that_thinks_long_is_not_taken_for_one_that_is_stuck() {
    let mut team = corridor_team(3, Radio::new(0.0, 0));
    team.robots[1].listing = 60;
    team.fly(100, Team::has_arrived).expect("it does think");
    assert_eq!(opened(&team), 0);
}

#[test]
fn a_robot_of_another_pace_is_waited_for() {
    for pace in 1..=3 {
        let mut team = corridor_team(3, Radio::new(0.0, 0));
        team.robots[0].pace = pace;
        team.robots[0].listing = pace;
        team.fly(60, Team::has_arrived).expect("the order is kept");
        assert_eq!(opened(&team), 0);
    }
}

#[test]
fn a_death_before_the_barrier_is_survived() {
    for ticks in 0..8 {
        let grid = Rc::new(Grid::new(6, 1, [&[0, 1, 2], &[0, 1, 2]]).together());
        let lists = move |proposal: &_, facts: &_| grid.list(proposal, facts);
        let mut team = Team::new(&[3, 4, 5], Rc::new(lists), Radio::new(0.0, 0));
        team.fly(3 + ticks, |_| false);
        assert!(!team.has_arrived(), "it dies on its way");
        team.robots[2].is_alive = false;
        team.fly(200, Team::has_arrived).unwrap_or_else(|| panic!("death {ticks}: {:?}", team.waiting()));
    }
}

/// Two robots on corridors of their own: no move of one waits for the other.
#[test]
fn rule_8_a_robot_that_hears_nobody_does_not_drive_its_plan_to_the_end() {
    let lengths: [&[u8]; 2] = [&[7, 15]; 2];
    let grid = Grid::new(8, 2, lengths);
    let mut team = Team::new(
        &[0, 8],
        Rc::new(move |proposal: &_, facts: &_| grid.list(proposal, facts)),
        Radio::new(0.0, 0),
    );
    team.robots.iter_mut().for_each(|robot| robot.pace = 8);
    team.fly(8, |_| false);
    team.radio.dead = vec![(0, 1), (1, 0)];
    let steps = |team: &Team| team.robots[1].rounds.protocol().step();
    let lost_after = u32::from(Timing::DEFAULT.lost_after());
    let has_stopped = |team: &Team| team.waiting()[1] == Some(Waiting::Quorum(R0));
    team.fly(lost_after + 8, has_stopped).expect("it tells for whom it waits");
    team.fly(8, |_| false);
    let standing = steps(&team);
    assert!(!team.robots[1].has_arrived());
    team.fly(200, |team| team.robots[0].has_arrived()).expect("the other one is a quorum");
    assert_eq!(steps(&team), standing);
    team.radio.dead.clear();
    team.fly(200, Team::has_arrived).expect("it goes on once the link is back");
}
