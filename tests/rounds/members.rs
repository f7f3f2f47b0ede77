//! Rules 1 to 3: how a robot starts, joins a round and opens one.

use super::model::Action;
use super::stage::{R0, R1, R2, Stage, heard_from, view};
use super::task::{List, Place, Places};
use super::team::{K, teammates};
use iibt_core::team::rounds::{Answer, Proposal, Protocol, RoundMessage, View, Waiting};
use iibt_core::team::{Member, RobotId};

#[test]
fn rule_1_a_robot_starts_with_the_whole_team_and_knows_nothing() {
    let stage = Stage::corridor(3);
    let robot = stage.of(1);
    assert_eq!(robot.proposal(), &Proposal::first(3));
    assert!((0..3).all(|other| robot.reach(RobotId(other)).is_none()));
    assert_eq!(stage.waiting(1), Some(Waiting::Unheard(R0)));
    assert_eq!(robot.may_open(view(&[R0, R1])), Err(Waiting::Unheard(R2)), "it was never heard");
    assert_eq!(robot.may_open(View::full(3)), Ok(1), "that leaves nobody out");
}

#[test]
fn rule_2_a_robot_joins_the_newest_round_standing_and_freezes_its_fact() {
    let mut stage = Stage::corridor(2);
    stage.decide(1);
    stage.act(Action::Begin(1));
    stage.open(0, View::full(2));
    stage.hear(1, 0);
    assert_eq!(stage.of(1).proposal().round, 0, "it is between two places");
    stage.act(Action::End(1));
    assert_eq!(stage.of(1).proposal().round, 2);
    assert_eq!((stage.of(1).fact(), stage.of(1).digest()), (&Place::at(3), None));
    assert!(!stage.may_move(1), "it stands until the new plan is known");
    let body = &mut stage.world.bodies[1];
    body.protocol.attend(&Place { errand: 7, ..Place::at(3) }, true, &teammates(&body.heard), &*body.list);
    assert_eq!(body.protocol.fact(), &Place::at(3), "what it learns later waits for the next round");
}

#[test]
fn rule_2_a_robot_that_is_left_out_joins_and_does_nothing_more() {
    let mut stage = Stage::corridor(3);
    stage.decide(0);
    stage.open(0, view(&[R0, R1]));
    stage.hear(2, 0);
    assert_eq!(stage.of(2).proposal().round, 3);
    assert_eq!(stage.waiting(2), Some(Waiting::Members));
    assert!(!stage.wants_list(2));
}

#[test]
fn rule_3_who_opens_is_a_member_of_a_quorum_and_knows_where_the_others_are() {
    let mut stage = Stage::corridor(3);
    stage.hear_all();
    let robot = stage.of(1);
    assert_eq!(robot.may_open(view(&[R0, R2])), Err(Waiting::Members));
    assert_eq!(robot.may_open(view(&[R1])), Err(Waiting::Quorum(R0)));
    assert_eq!(robot.may_open(view(&[R0, R1])), Err(Waiting::Unheard(R2)), "nothing answers this start yet");
    stage.decide(0);
    assert_eq!(stage.of(1).may_open(view(&[R0, R1])), Ok(1));
    stage.open(1, view(&[R0, R1]));
    let walls: Vec<_> = stage.of(1).proposal().left_out(3).collect();
    assert_eq!(walls, [(R2, Places(0b1100))], "from where it stands to where the plan leads it");
}

#[test]
fn rule_3_every_robot_opens_rounds_of_its_own_numbers_until_none_are_left() {
    let message = |round| RoundMessage::<Place, K> {
        proposal: Proposal { round, ..Proposal::first(3) },
        fact: Place::at(5),
        answer: Answer::Listing(0),
    };
    let next = |round, robot: RobotId| {
        let member = Member::new(robot, 3).unwrap();
        let mut protocol = Protocol::<Place, K>::new(member, 1, 7, Place::at(0));
        let heard = heard_from(RobotId((robot.0 + 1) % 3), 1, message(round));
        protocol.attend(&Place::at(0), true, &teammates(&heard), &List::default());
        assert_eq!(protocol.proposal().round, round);
        protocol.may_open(View::full(3))
    };
    assert_eq!([R0, R1, R2].map(|robot| next(7, robot)), [Ok(9), Ok(10), Ok(8)]);
    let many = u32::from(u16::MAX);
    assert_eq!([many - 1, many].map(|round| next(round, R1)), [Ok(many + 1); 2], "more than a u16 holds");
    assert_eq!(next(u32::MAX - 3, R2), Ok(u32::MAX - 1));
    assert_eq!(next(u32::MAX - 1, R0), Ok(u32::MAX));
    assert_eq!([R1, R2].map(|robot| next(u32::MAX - 1, robot)), [Err(Waiting::Rounds); 2]);
    assert_eq!([R0, R1].map(|robot| next(u32::MAX, robot)), [Err(Waiting::Rounds); 2]);
}
