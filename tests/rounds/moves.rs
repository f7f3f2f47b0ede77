//! Rules 6 and 7: when a robot moves, and where it takes its teammates to be.

use super::grid::Grid;
use super::model::{Action, World};
use super::stage::{R0, R1, Stage, heard_from, view};
use super::task::{Place, Places};
use super::team::teammates;
use iibt_core::team::rounds::{View, Waiting};

#[test]
fn rule_6_a_place_is_entered_when_the_one_before_has_reported_that_it_left() {
    let mut stage = Stage::corridor(2);
    stage.decide(1); // 1 to 2, 2 to 3
    assert_eq!(stage.waiting(0), Some(Waiting::Order(R1)));
    stage.act(Action::Begin(1));
    stage.hear(0, 1);
    assert!(!stage.may_move(0), "it has begun, not left");
    stage.act(Action::End(1));
    assert!(!stage.may_move(0), "it has left, and has not been heard");
    stage.hear(0, 1);
    assert!(stage.may_move(0) && stage.waiting(0).is_none());
    stage.step(0);
    assert!(!stage.may_move(0), "its path is done");
}

#[test]
fn rule_6_nobody_moves_while_a_member_is_not_in_the_plan() {
    let mut stage = Stage::corridor(2);
    stage.decide(1);
    assert!(stage.may_move(1));
    stage.act(Action::Restart(0));
    stage.hear(1, 0);
    assert!(!stage.may_move(1));
    assert_eq!(stage.waiting(1), Some(Waiting::Outdated(R0)));
}

#[test]
fn rule_6b_the_last_moves_wait_for_each_other() {
    let mut stage = Stage::corridor(2);
    stage.grid = Grid::new(4, 1, [&[0, 1], &[0, 3]]).together();
    stage.world = World::new(&[2, 3], 9, &[]);
    stage.decide(0); // two moves each, to the left
    stage.step(0);
    assert_eq!(stage.waiting(0), Some(Waiting::Barrier(R1)));
    stage.hear(1, 0);
    stage.step(1);
    stage.hear(0, 1);
    assert!(stage.may_move(0));
    let mut apart = Stage::corridor(2);
    apart.grid = Grid::new(4, 1, [&[0, 1], &[0, 3]]);
    apart.world = World::new(&[2, 3], 9, &[]);
    apart.decide(0);
    apart.step(0);
    assert!(apart.may_move(0), "this plan is not made for arriving together");
}

#[test]
fn rule_7_where_a_teammate_may_be_grows_before_scores_and_shrinks_with_its_reports() {
    let mut stage = Stage::corridor(2);
    stage.decide(0); // so that nobody is anywhere; nobody moves
    stage.open(0, View::full(2));
    stage.hear_all();
    stage.hear_all();
    assert_eq!(stage.of(0).reach(R1), Some(&Places::at(2)), "where it stands in the new round");
    stage.act(Action::Give(0, 1));
    assert_eq!(stage.of(0).reach(R1), Some(&Places(0b1110)), "on any path of the list");
    stage.act(Action::Give(1, 1));
    stage.hear_all();
    assert_eq!(stage.of(0).reach(R1), Some(&Places(0b1100)), "on the path of the plan");
    stage.act(Action::Begin(1));
    stage.act(Action::End(1));
    stage.hear(0, 1);
    assert_eq!(stage.of(0).reach(R1), Some(&Places::at(3)), "at its end");
}

#[test]
fn rule_7_before_the_choice_a_teammate_may_be_on_any_path() {
    let mut stage = Stage::corridor(3);
    stage.decide(0);
    stage.open(0, View::full(3));
    stage.hear_all();
    stage.hear_all();
    stage.act(Action::Give(0, 1));
    stage.act(Action::Give(1, 1));
    stage.hear(0, 1);
    assert_eq!(stage.of(0).policy(), None, "the scores of robot 2 are missing");
    assert_eq!(stage.of(0).reach(R1), Some(&Places(0b1_1110)));
}

#[test]
fn rule_7_what_was_heard_before_scores_narrows_nothing_after_them() {
    let mut stage = Stage::corridor(2);
    stage.decide(0);
    stage.open(0, View::full(2));
    stage.hear(1, 0);
    let newest = stage.world.bodies[1].sent.len() - 1;
    stage.act(Action::Hear(0, 1, newest, false));
    stage.act(Action::Give(0, 1));
    stage.act(Action::Hear(0, 1, newest, true));
    assert_eq!(stage.of(0).reach(R1), Some(&Places(0b1110)), "on any path of the list");
}

#[test]
fn rule_7_a_robot_that_has_started_believes_nothing_that_does_not_answer_its_start() {
    let mut stage = Stage::corridor(2);
    stage.decide(1);
    stage.act(Action::Restart(0));
    stage.hear(0, 1);
    assert_eq!(stage.of(0).reach(R1), None, "the plan of its life before is in it");
    assert_eq!(stage.of(0).may_open(view(&[R0])), Err(Waiting::Unheard(R1)));
    stage.open(0, View::full(2));
    stage.decide(1);
    assert_eq!(stage.of(0).reach(R1), Some(&Places(0b1100)));
    assert!(stage.of(0).may_open(view(&[R0])).is_ok());
}

#[test]
fn rule_7_an_epoch_that_goes_back_is_ignored() {
    let mut stage = Stage::corridor(2);
    stage.decide(1);
    let old = stage.world.bodies[1].sent.len() - 1;
    stage.act(Action::Restart(1));
    stage.hear(0, 1);
    let reach = stage.of(0).reach(R1).copied();
    stage.act(Action::Hear(0, 1, old, true));
    assert_eq!(stage.of(0).reach(R1).copied(), reach);
    assert_eq!(stage.waiting(0), Some(Waiting::Unheard(R1)), "a message of an earlier start is none");
    let mut later = stage.world.bodies[1].sent[0].1.message.clone();
    later.proposal.round = 9;
    let heard = heard_from(R1, 1, later);
    let body = &mut stage.world.bodies[0];
    body.protocol.attend(&Place { at: body.at, errand: 0 }, true, &teammates(&heard), &*body.list);
    assert_eq!(body.protocol.proposal().round, 0, "nor is its round joined");
}
