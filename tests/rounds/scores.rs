//! Rules 4 and 5: when a robot gives its scores, and what all decide from them.

use super::model::{Action, World};
use super::stage::{R0, R1, R2, R3, Stage, heard_from, view};
use super::task::{List, Place, Places};
use super::team::{K, teammates};
use iibt_core::iibt::cheapest_policy;
use iibt_core::team::rounds::{
    Answer, JointPolicies, Proposal, Protocol, RoundMessage, Score, View, Waiting,
};
use iibt_core::team::{Member, RobotId};

#[test]
fn rule_4_scores_are_given_once_for_the_same_facts_of_all() {
    let mut stage = Stage::corridor(2);
    stage.hear(0, 1);
    assert!(stage.wants_list(0) && !stage.wants_list(1));
    stage.act(Action::Give(0, 1));
    assert!(!stage.wants_list(0));
    let given = stage.answer(0).clone();
    let body = &mut stage.world.bodies[0];
    let mates = teammates(&body.heard);
    let digest = body.protocol.digest().unwrap();
    let other = [Score { delay: 9, price: 9 }; K].into_iter().collect();
    assert_eq!(body.protocol.give(digest, other, &*body.list, &mates), Err(Waiting::List));
    assert_eq!(body.protocol.message(&mates, 0, 0.0).answer, given);
}

#[test]
fn rule_4_scores_of_a_list_from_other_facts_are_refused() {
    let mut stage = Stage::corridor(2);
    stage.hear(0, 1);
    let body = &stage.world.bodies[0];
    let old = body.protocol.wanted(&teammates(&body.heard)).expect("all is known");
    stage.act(Action::Restart(1));
    stage.hear(0, 1);
    let body = &mut stage.world.bodies[0];
    let mates = teammates(&body.heard);
    assert!(body.protocol.wanted(&mates).is_some_and(|digest| digest != old));
    let scores = [Score::default(); K].into_iter().collect();
    assert_eq!(body.protocol.give(old, scores, &*body.list, &mates), Err(Waiting::List));
    assert_eq!(body.protocol.digest(), None);
}

#[test]
fn rule_4_every_fact_epoch_and_wall_and_the_mission_are_under_the_digest() {
    let base = Proposal::<Places>::first(2);
    let digest = |mission, round, epoch, place, errand| {
        let member = Member::new(R0, 2).unwrap();
        let mut protocol = Protocol::<Place, K>::new(member, 1, mission, Place::at(0));
        let proposal = Proposal { round, ..base.clone() };
        let fact = Place { errand, ..Place::at(place) };
        let heard = heard_from(R1, epoch, RoundMessage { proposal, fact, answer: Answer::Listing(0) });
        protocol.attend(&Place::at(0), true, &teammates(&heard), &List::default());
        protocol.wanted(&teammates(&heard)).expect("all is known")
    };
    let all = [
        digest(7, 1, 1, 3, 0),
        digest(8, 1, 1, 3, 0),
        digest(7, 3, 1, 3, 0),
        digest(7, 1, 2, 3, 0),
        digest(7, 1, 1, 4, 0),
        digest(7, 1, 1, 3, 1),
    ];
    assert_eq!(digest(7, 1, 1, 3, 0), all[0]);
    for (index, one) in all.iter().enumerate() {
        assert!(all[..index].iter().all(|other| other != one), "number {index}");
    }
}

#[test]
fn rule_4_a_round_that_two_lives_of_a_robot_have_opened_is_void() {
    let mut stage = Stage::corridor(3);
    stage.decide(0);
    stage.open(0, view(&[R0, R1]));
    stage.hear(1, 0);
    stage.act(Action::Restart(0));
    stage.open(0, View::full(3));
    stage.hear(1, 0);
    assert_eq!([0, 1].map(|robot| stage.of(robot).proposal().round), [3, 3]);
    assert!(!stage.wants_list(1));
    assert_eq!(stage.waiting(1), Some(Waiting::Proposal(R0)));
}

#[test]
fn rule_4_two_members_on_one_place_are_not_believed() {
    let mut stage = Stage::corridor(2);
    stage.world = World::new(&[1, 1], 0, &[]);
    let newest = stage.world.bodies[1].sent[0].clone();
    stage.world.bodies[0].heard[1] = Some(newest);
    assert!(!stage.wants_list(0));
    assert_eq!(stage.waiting(0), Some(Waiting::Overlap(R1, R0)));
}

#[test]
fn rule_4_a_member_that_knows_more_refuses_the_walls_and_both_are_united() {
    let mut stage = Stage::corridor(3);
    stage.decide(0);
    stage.open(0, view(&[R0, R1])); // with the rest of the path of robot 2: places 2 and 3
    stage.hear(1, 0);
    stage.hear(0, 1);
    stage.act(Action::Give(0, 0));
    assert_eq!(stage.of(1).reach(R2), Some(&Places(0b1100)));
    // Robot 2 has heard nothing of this and goes on; robot 1 hears of a later start of it.
    stage.act(Action::Restart(2));
    stage.world.bodies[2].at = Places::at(4);
    stage.act(Action::Restart(2));
    stage.hear(1, 2);
    assert_eq!(stage.of(1).reach(R2), Some(&Places::at(4)));
    assert_eq!(stage.waiting(1), Some(Waiting::Wall(R2)));
    stage.open(1, view(&[R0, R1]));
    assert_eq!(stage.of(1).proposal().wall(R2, 3), Some(Places(0b1_1100)));
    stage.hear(0, 1);
    stage.act(Action::Give(0, 0));
    assert_eq!(stage.of(0).reach(R2), Some(&Places(0b1_1100)), "what it has accepted it remembers");
}

/// The first three of four robots, which have decided before, in a round that one of them has
/// opened without robot 3; one has started again since, and all know each other's facts.
fn without_robot_3(opens: usize, starts: usize) -> Stage {
    let mut stage = Stage::corridor(4);
    stage.decide(0);
    stage.open(opens, view(&[R0, R1, R2]));
    let all_hear = |stage: &mut Stage| {
        let pairs = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)];
        pairs.into_iter().for_each(|(robot, other)| stage.hear(robot, other));
    };
    all_hear(&mut stage);
    stage.act(Action::Restart(starts));
    all_hear(&mut stage);
    all_hear(&mut stage);
    stage
}

#[test]
fn rule_4e_a_robot_that_has_started_takes_the_word_of_a_quorum_that_has_scored() {
    let mut stage = without_robot_3(0, 1);
    assert!(!stage.wants_list(1));
    assert_eq!(stage.waiting(1), Some(Waiting::Unheard(R3)));
    stage.act(Action::Give(0, 0));
    stage.hear(1, 0);
    assert!(!stage.wants_list(1), "one that remembers is no quorum");
    stage.act(Action::Give(2, 0));
    stage.hear(1, 2);
    assert!(stage.wants_list(1), "two of four, with robot 0");
    stage.act(Action::Give(1, 0));
    let wall = stage.of(1).proposal().wall(R3, 4);
    assert!(stage.of(1).has_decided() && wall == Some(Places(0b1_1000)));
    assert_eq!(stage.of(1).reach(R3).copied(), wall);
    assert!(!stage.of(1).has_answered(R3) && stage.of(1).may_open(view(&[R0, R1, R2])).is_ok());
    // A recording, or a message that was long on its way: robot 3 has gone on since.
    stage.act(Action::Hear(1, 3, 0, true));
    assert_eq!(stage.of(1).reach(R3).copied(), wall, "it does not answer this start");
}

#[test]
fn rule_4e_the_half_of_a_team_without_robot_0_gives_nobody_its_word() {
    let mut stage = without_robot_3(1, 0);
    [1, 2].into_iter().for_each(|robot| stage.act(Action::Give(robot, 0)));
    [1, 2].into_iter().for_each(|other| stage.hear(0, other));
    assert!(!stage.wants_list(0), "robots 0 and 3 may have decided something else");
    assert_eq!(stage.waiting(0), Some(Waiting::Unheard(R3)));
}

#[test]
fn rule_4e_a_robot_that_knows_more_takes_nobodys_word() {
    let mut stage = Stage::corridor(4);
    stage.decide(0);
    for robot in 0..4 {
        stage.step(robot);
        (robot + 1..4).for_each(|next| stage.hear(next, robot));
    }
    [0, 2].into_iter().for_each(|robot| stage.hear(robot, 3));
    stage.open(0, view(&[R0, R1, R2])); // with the end of robot 3's path: place 3
    [(1, 0), (2, 0), (0, 1), (0, 2), (2, 1)].into_iter().for_each(|(robot, other)| stage.hear(robot, other));
    [0, 2].into_iter().for_each(|robot| stage.act(Action::Give(robot, 0)));
    [0, 2].into_iter().for_each(|other| stage.hear(1, other));
    assert!(!stage.wants_list(1));
    assert_eq!(stage.waiting(1), Some(Waiting::Wall(R3)), "it has not heard that place 4 is left");
}

#[test]
fn rule_4_scores_of_other_facts_make_the_round_void() {
    let mut stage = Stage::corridor(3);
    stage.hear_all();
    stage.act(Action::Give(0, 0));
    stage.act(Action::Restart(2));
    stage.hear(1, 2);
    stage.act(Action::Give(1, 0));
    stage.hear(0, 1);
    assert_eq!(stage.waiting(0), Some(Waiting::Outdated(R1)), "it has scored with another start of robot 2");
}

#[test]
fn rule_4c_scores_under_an_epoch_that_is_over_are_taken_back() {
    let mut stage = Stage::corridor(2);
    stage.hear(0, 1);
    stage.act(Action::Give(0, 1));
    let old = stage.of(0).digest().expect("it has given");
    stage.act(Action::Restart(1));
    stage.hear(0, 1);
    assert!(stage.of(0).digest().is_none() && stage.wants_list(0));
    stage.act(Action::Give(0, 0));
    assert_ne!(stage.of(0).digest(), Some(old));
    stage.hear(1, 0);
    stage.act(Action::Give(1, 0));
    stage.hear_all();
    assert_eq!([0, 1].map(|robot| stage.of(robot).policy()), [Some(0); 2], "in the same round");
    assert_eq!(stage.of(0).proposal().round, 0);
}

#[test]
fn rule_4_a_robot_that_has_started_again_leaves_nobody_out() {
    let mut stage = Stage::corridor(3);
    stage.decide(0);
    stage.open(0, view(&[R0, R2]));
    stage.hear(2, 0);
    stage.hear(1, 2); // where robot 2 stands in a round in which it may yet drive
    stage.hear(0, 2);
    stage.act(Action::Give(0, 1));
    stage.act(Action::Give(2, 1));
    stage.hear(2, 0);
    stage.act(Action::Restart(0));
    stage.open(1, view(&[R0, R1]));
    stage.hear(0, 1);
    stage.hear(1, 0);
    assert!(stage.may_move(2) && stage.of(0).proposal().round == stage.of(1).proposal().round);
    assert!(!stage.wants_list(0));
    assert_eq!(stage.waiting(0), Some(Waiting::Unheard(R2)));
}

/// All triples of scores over a few values: the choice is that of an exhaustive comparison.
#[test]
fn rule_5_the_choice_is_the_least_sum_with_the_largest_delay() {
    struct Priced;
    impl JointPolicies for Priced {
        type Claim = ();
        fn len(&self) -> usize {
            3
        }
        fn cost(&self, policy: usize) -> u16 {
            [u16::MAX, 8, 9][policy]
        }
        fn habit(&self, policy: usize) -> u16 {
            [0, 3, 0][policy]
        }
        fn needs(&self, policy: usize, robot: RobotId) -> bool {
            policy != usize::from(robot.0)
        }
        fn claim(&self, _: usize, _: RobotId, _: u16) {}
        fn moves(&self, _: usize, _: RobotId) -> u16 {
            0
        }
        fn is_clear(&self, _: usize, _: RobotId, _: u16, _: RobotId, _: u16) -> bool {
            true
        }
        fn choose<'s>(&self, members: impl Iterator<Item = (RobotId, &'s [Score])> + Clone) -> Option<usize> {
            cheapest_policy(self, members)
        }
    }
    let values = [(0, 0), (3, 0), (0, 4), (254, 254), (255, 0), (0, 255)];
    let all = || values.map(|(delay, price)| Score { delay, price }).into_iter();
    let mut chosen = [0; 4];
    for (a, b) in all().flat_map(|a| all().map(move |b| (a, b))) {
        for (c, d) in all().flat_map(|c| all().map(move |d| (c, d))) {
            let scores = [[a, b, c], [d, a, b]];
            let cost = |policy: usize| -> u64 {
                let column = || [scores[0][policy], scores[1][policy]].into_iter().zip(0..);
                let delays = || column().filter(|(_, robot)| *robot != policy).map(|(score, _)| score.delay);
                let impossible =
                    column().any(|(score, _)| score.price == 255) || delays().any(|delay| delay == 255);
                let common = u64::from(Priced.cost(policy)) + u64::from(Priced.habit(policy));
                let private: u64 = column().map(|(score, _)| u64::from(score.price)).sum();
                if impossible { u64::MAX } else { common + private + u64::from(delays().max().unwrap_or(0)) }
            };
            let least = (0..3).map(cost).min().unwrap();
            let expected = (0..3).find(|&policy| cost(policy) == least).filter(|_| least != u64::MAX);
            let members = [R0, R1].into_iter().zip(scores.iter().map(|scores| &scores[..]));
            assert_eq!(Priced.choose(members), expected, "{scores:?}");
            chosen[expected.unwrap_or(3)] += 1;
        }
    }
    assert!(chosen.iter().all(|&count| count > 10), "{chosen:?}");
    assert_eq!(Priced.choose([(R0, &[Score::default(); 2][..])].into_iter()), Some(1), "two scores of three");
}

#[test]
fn rule_5_all_who_know_all_scores_decide_alike() {
    let mut stage = Stage::corridor(3);
    stage.hear_all();
    stage.act(Action::Give(0, 0));
    stage.act(Action::Give(1, 1));
    stage.act(Action::Give(2, 1));
    stage.hear(0, 1);
    assert_eq!((stage.of(0).policy(), stage.waiting(0)), (None, Some(Waiting::Scores(R2))));
    stage.hear_all();
    assert_eq!([0, 1, 2].map(|robot| stage.of(robot).policy()), [Some(1); 3]);
    assert!(matches!(stage.answer(0), Answer::Decided { scores: Some(_), .. }), "not all have said so");
    stage.hear_all();
    stage.hear_all();
    let bare = |robot| matches!(stage.answer(robot), Answer::Decided { scores: None, choice: Some(_), .. });
    assert!([0, 1, 2].into_iter().all(bare), "two bytes a policy are saved from here on");
}
