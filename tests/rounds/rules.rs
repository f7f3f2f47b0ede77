//! The rules one by one, on robots in a corridor or on a square.

use super::grid::Grid;
use super::model::{Action, World};
use super::task::{List, Place, Places};
use super::team::{K, Radio, Robot, Said, Sent, Team, teammates};
use iibt_core::team::rounds::{
    Answer, Event, JointPolicies, Proposal, Protocol, RoundMessage, Rounds, Score, Timing, View, Waiting,
    Want, choose,
};
use iibt_core::team::{Member, RobotId, Stamp};
use std::rc::Rc;

const R0: RobotId = RobotId(0);
const R1: RobotId = RobotId(1);
const R2: RobotId = RobotId(2);

/// Robots on a grid, to which things happen one by one.
struct Stage {
    world: World,
    grid: Grid,
}

impl Stage {
    /// Two robots in a corridor of four, or three of six: all to the left, or all to the right.
    fn corridor(robots: u8) -> Self {
        let targets: [&[u8]; 2] = if robots == 2 { [&[0, 1], &[2, 3]] } else { [&[0, 1, 2], &[3, 4, 5]] };
        let places: Vec<u8> = (1..=robots).collect();
        Self { world: World::new(&places, 99, &[9; 8]), grid: Grid::new(2 * robots, 1, targets) }
    }

    fn act(&mut self, action: Action) {
        self.world.apply(action, &self.grid);
        assert_eq!(self.world.violation(), None);
    }

    /// One robot hears the newest of another, and does what follows.
    fn hear(&mut self, robot: usize, other: usize) {
        self.act(Action::Hear(robot, other, self.world.bodies[other].sent.len() - 1, true));
    }

    /// All hear the newest of all.
    fn hear_all(&mut self) {
        let newest: Vec<usize> = self.world.bodies.iter().map(|body| body.sent.len() - 1).collect();
        for robot in 0..newest.len() {
            for (other, &place) in newest.iter().enumerate().filter(|&(other, _)| other != robot) {
                self.act(Action::Hear(robot, other, place, true));
            }
        }
    }

    /// All hear, score, hear and decide on a policy.
    fn decide(&mut self, policy: usize) {
        self.hear_all();
        self.hear_all();
        for robot in 0..self.world.bodies.len() {
            self.act(Action::Give(robot, policy));
        }
        self.hear_all();
    }

    fn open(&mut self, robot: usize, view: View) {
        self.act(Action::Open(robot, view));
    }

    fn step(&mut self, robot: usize) {
        self.act(Action::Begin(robot));
        self.act(Action::End(robot));
    }

    fn of(&self, robot: usize) -> &Protocol<Place, K> {
        &self.world.bodies[robot].protocol
    }

    fn waiting(&self, robot: usize) -> Option<Waiting> {
        let body = &self.world.bodies[robot];
        body.protocol.waiting(&teammates(&body.heard), &*body.list)
    }

    fn may_move(&self, robot: usize) -> bool {
        let body = &self.world.bodies[robot];
        body.protocol.may_move(&teammates(&body.heard), &*body.list)
    }

    fn wants_list(&self, robot: usize) -> bool {
        self.of(robot).wanted(&teammates(&self.world.bodies[robot].heard)).is_some()
    }

    fn answer(&self, robot: usize) -> &Answer<K> {
        &self.world.bodies[robot].sent.last().expect("something was sent").1.message.answer
    }
}

fn view(robots: &[RobotId]) -> View {
    robots.iter().copied().collect()
}

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
    assert_eq!(next(u32::MAX - 3, R2), Ok(u32::MAX - 1));
    assert_eq!(next(u32::MAX - 1, R0), Ok(u32::MAX));
    assert_eq!([R1, R2].map(|robot| next(u32::MAX - 1, robot)), [Err(Waiting::Rounds); 2]);
    assert_eq!([R0, R1].map(|robot| next(u32::MAX, robot)), [Err(Waiting::Rounds); 2]);
}

/// What a robot of three has heard: one message of one teammate.
fn heard_from(robot: RobotId, epoch: u32, message: RoundMessage<Place, K>) -> Vec<Option<Sent>> {
    let mut heard = vec![None; 3];
    heard[robot.index()] = Some((Stamp { epoch, sequence: 9 }, Rc::new(Said { message, number: 0 })));
    heard
}

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
    assert_eq!(body.protocol.message(&mates, 0, 0).answer, given);
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
            assert_eq!(choose(&Priced, members), expected, "{scores:?}");
            chosen[expected.unwrap_or(3)] += 1;
        }
    }
    assert!(chosen.iter().all(|&count| count > 10), "{chosen:?}");
    assert_eq!(
        choose(&Priced, [(R0, &[Score::default(); 2][..])].into_iter()),
        Some(1),
        "two scores of three"
    );
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

#[test]
fn rule_5_no_policy_is_chosen_that_some_member_cannot_follow() {
    let mut team = corridor_team(2, Radio::new(0.0, 0));
    team.robots[1].scores = [Score::CANNOT; K];
    team.fly(6, |_| false);
    assert_eq!(team.waiting(), [Some(Waiting::Policy); 2]);
    assert_eq!(team.robots[0].events, [Event::Decided(None)]);
}

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
    assert_eq!(rounds(&mut team, Want::Nothing, 40), 0);
    let wished = rounds(&mut team, Want::Better, 40);
    assert!((3..=4).contains(&wished), "{wished} rounds in 40 ticks");
    let needed = rounds(&mut team, Want::Needed, 40);
    assert!(needed > 8, "{needed} rounds in 40 ticks: as often as one is decided");
}

#[test]
fn rule_8_two_that_open_at_once_cost_a_tick() {
    let mut team = arrived();
    team.robots[0].want = Want::Better;
    team.robots[2].want = Want::Better;
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
    team.robots[0].want = Want::Better;
    let limit = u32::from(Timing::DEFAULT.lost_after());
    assert_eq!(team.fly(limit, |team| team.robots[0].rounds.proposal().view != View::full(3)), None);
    assert_eq!(team.waiting()[0], Some(Waiting::Fact(R1)));
    team.fly(15, Team::has_arrived).expect("the others go on");
    assert_eq!(team.robots[0].rounds.proposal().view, view(&[R0, R2]));
    team.robots[1].is_alive = true;
    team.fly(20, Team::has_arrived).expect("it is a member again");
    assert_eq!(team.robots[1].rounds.proposal().view, View::full(3));
}

#[test]
fn rule_8_a_robot_that_is_lost_again_and_again_waits_longer_each_time() {
    let mut team = arrived();
    let mut out = Vec::new();
    for _ in 0..4 {
        team.robots[0].want = Want::Better;
        team.radio.dead = vec![(0, 1), (2, 1)]; // it hears nobody, and is heard
        team.fly(200, |team| team.robots[0].rounds.proposal().view != View::full(3)).expect("it is left out");
        team.radio.dead.clear();
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
        let ticks = team.fly(30, Team::has_arrived);
        assert!(ticks.is_some_and(|ticks| ticks < 15), "robot {robot}: {ticks:?}");
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
    pair.robots[1].want = Want::Needed;
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
