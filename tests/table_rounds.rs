//! Robots with table tasks that decide in rounds, in flight: firmware robots on simulated hardware
//! and radio.

use firmware::prelude::*;
use host_sim::{Radio, Testbed, settings};
use iibt_core::iibt::table::{MAX_POLICIES, TeamRounds};
use iibt_core::team::rounds::{View, Waiting};

const DOWN: u8 = 0;
const UP: u8 = 1;
const IDLE: u8 = 0;
const LIFT: u8 = 1;

/// A robot that is to lift its load, three ticks of work.
const LIFTER: Role = Role {
    sensors: &[Sensor::even("height", Reads::Factor(0), 0.999)],
    operators: &[Operator::IDLE, LIFT_IT],
    facts: &[Fact::sure("up", 0, &[UP])],
    aims: &[Aim::new("lift", &[0], &[0.0, 1.0])],
    ..Role::of(&[HiddenFactor::known("load", &["down", "up"])])
};

const LIFT_IT: Operator = Operator { forbids: &[0], ..Operator::bringing("lift", UP, 0.9) };

/// Two robots on one supply: while one lifts, the other must not.
static IN_TURN: Tables = Tables::new(&[
    on_supply("first", &[UP_ITSELF, FIRST_SEES_IDLE]),
    on_supply("second", &[UP_ITSELF, SECOND_SEES_IDLE]),
]);

const UP_ITSELF: Fact = Fact::sure("up", 0, &[UP]);
const FIRST_SEES_IDLE: Fact = Fact::doing("the other is idle", 1, &[IDLE]);
const SECOND_SEES_IDLE: Fact = Fact::doing("the other is idle", 0, &[IDLE]);

const fn on_supply(name: &'static str, facts: &'static [Fact<'static>]) -> Role<'static> {
    Role { name, facts, operators: &[Operator::IDLE, Operator { requires: &[1], ..LIFT_IT }], ..LIFTER }
}

/// Two robots at one table: the first knows that it falls if one side alone is lifted.
static TOGETHER: Tables = Tables::new(&[
    Role {
        name: "first",
        outcome: Some(JointOutcome {
            names: &["even", "falls"],
            preference: &[0.0, -3.0],
            table: &[0, 1, 1, 0],
            possible: None,
        }),
        ..LIFTER
    },
    Role { name: "second", ..LIFTER },
]);

/// Three robots with four operators each, so 64 joint policies: more than a round has.
static THREE: Tables = Tables::new(&[choosy("one"), choosy("two"), choosy("three")]);

const fn choosy(name: &'static str) -> Role<'static> {
    const OPERATORS: &[Operator<'static>] = &[
        Operator::IDLE,
        LIFT_IT,
        Operator { name: "shake", success: 0.5, brings: Postcondition::State(UP, 0.5), ..LIFT_IT },
        Operator { name: "look", ..Operator::bringing("look", DOWN, 1.0) },
    ];
    Role { name, operators: OPERATORS, ..LIFTER }
}

/// A robot with no teammate.
static ALONE: Tables = Tables::new(&[Role { name: "lone", ..LIFTER }]);

static TREE: Tree<TaskLeaf<()>, 1> = tree! { Inference(TaskLeaf::Aim(0)) };

const TIMEOUT: u32 = 60;

/// The load of one robot, and the tool that lifts it.
#[derive(Clone, Debug, Default)]
struct Load {
    height: u8,
    working: u8,
    /// The lifts that slip.
    slips: u8,
    /// Its radio is dead, and so is all else of it.
    is_dead: bool,
    begun: Vec<u8>,
}

impl Equipment for Load {
    fn read(&mut self, _: usize) -> Option<u8> {
        Some(self.height)
    }
    fn is_busy(&mut self) -> bool {
        self.working > 0
    }
    fn begin(&mut self, command: Command) {
        self.begun.push(command.operator);
        self.working = 3;
    }
}

type Lifter<const P: usize, const N: usize> = TableRobot<'static, Load, (), Memory<1>, 2, N, P>;

/// A robot that can die.
struct Mortal<const P: usize, const N: usize>(Lifter<P, N>, bool);

impl<const P: usize, const N: usize> Robot<Load> for Mortal<P, N> {
    type Message = TableMessage;

    fn mission(&self) -> u64 {
        Robot::<Load>::mission(&self.0)
    }
    fn accepts(&self, message: &TableMessage) -> Result<(), Invalid> {
        Robot::<Load>::accepts(&self.0, message)
    }
    fn sense(&mut self, load: &mut Load, now: Instant) {
        self.1 = load.is_dead;
        self.0.sense(load, now);
    }
    fn tick(&mut self, peers: Peers<'_, TableMessage>, now: Instant) -> Status {
        if self.1 { Status::Running } else { Robot::<Load>::tick(&mut self.0, peers, now) }
    }
    fn act(&mut self, load: &mut Load) {
        if !self.1 {
            self.0.act(load);
        }
    }
    fn message(&self) -> Option<TableMessage> {
        Robot::<Load>::message(&self.0).filter(|_| !self.1)
    }
}

/// A team in flight.
struct Team<const P: usize, const N: usize> {
    testbed: Testbed<Mortal<P, N>, Load>,
    statuses: Vec<Status>,
}

impl<const P: usize, const N: usize> Team<P, N> {
    fn new(tables: &'static Tables<'static>, loss: f64, seed: u64) -> Self {
        let robot = |robot| {
            let settings = settings(RobotId(robot), N).expect("a team");
            let mind = Lifter::new(tables, &settings, &TREE, (), Duration(TIMEOUT)).expect("it fits");
            (Mortal(mind, false), Load::default())
        };
        let radio = Radio { loss, ..Radio::default() };
        let testbed = Testbed::new((0..N as u8).map(robot), radio, seed).expect("a team");
        Self { testbed, statuses: vec![Status::Running; N] }
    }

    fn tick(&mut self) {
        for robot in 0..N {
            let load = self.testbed.parts_mut(robot);
            if load.working == 1 {
                (load.height, load.slips) =
                    (u8::from(load.slips == 0).max(load.height), load.slips.saturating_sub(1));
            }
            load.working = load.working.saturating_sub(1);
        }
        self.statuses = self.testbed.tick();
    }

    fn load(&self, robot: usize) -> &Load {
        self.testbed.parts(robot)
    }

    fn begun(&self) -> Vec<usize> {
        (0..N).map(|robot| self.load(robot).begun.len()).collect()
    }

    fn rounds(&self, robot: usize) -> &TeamRounds<'static, N> {
        self.testbed.robots().nth(robot).expect("a robot").0.task().rounds()
    }

    fn is_lifted(&self) -> bool {
        (0..N).all(|robot| self.load(robot).height == UP)
    }

    /// The round of each robot that has decided, with its choice.
    fn choices(&self) -> Vec<(u32, Option<u16>)> {
        let of = |robot| (self.rounds(robot).state().proposal().round, self.rounds(robot).policy());
        let decided = |&robot: &usize| self.rounds(robot).state().protocol().has_decided();
        (0..N).filter(decided).map(of).collect()
    }

    /// Flies until something holds, looking after every tick.
    fn fly(
        &mut self,
        ticks: u32,
        mut look: impl FnMut(&Self),
        reached: impl Fn(&Self) -> bool,
    ) -> Option<u32> {
        for tick in 0..ticks {
            if reached(self) {
                return Some(tick);
            }
            self.tick();
            look(self);
        }
        None
    }
}

/// The joint policies of a list as the operators of both robots.
fn pairs(rounds: &TeamRounds<'_, 2>) -> Vec<[u16; 2]> {
    rounds.listed().iter().map(|&policy| [policy / 2, policy % 2]).collect()
}

#[test]
fn line_7_all_list_the_same_joint_policies_which_the_facts_of_all_allow() {
    let mut team = Team::<4, 2>::new(&IN_TURN, 0.0, 1);
    team.fly(10, |_| (), |team| team.choices().len() == 2).expect("they decide");
    let lists = [0, 1].map(|robot| pairs(team.rounds(robot)));
    assert_eq!(lists[0], lists[1]);
    assert_eq!(lists[0], [[0, 1], [1, 0], [0, 0]], "not both at once; last, all as it is");
    let mut team = Team::<4, 2>::new(&TOGETHER, 0.0, 1);
    team.fly(10, |_| (), |team| team.choices().len() == 2).expect("they decide");
    assert_eq!(pairs(team.rounds(0)), [[0, 1], [1, 0], [1, 1], [0, 0]]);
}

#[test]
fn line_7_a_list_has_what_most_robots_intend_when_there_is_no_room_for_all() {
    let mut team = Team::<64, 3>::new(&THREE, 0.0, 1);
    let lifted = team.fly(60, |_| (), |team| team.is_lifted()).expect("all are lifted");
    assert!(lifted < 20, "{lifted}");
    assert!((0..3).all(|robot| team.rounds(robot).listed().len() <= MAX_POLICIES));
    assert!((0..3).all(|robot| team.load(robot).begun.iter().all(|&operator| operator == LIFT)));
}

#[test]
fn lines_8_to_11_no_robot_decides_without_the_facts_and_the_scores_of_all_members() {
    let mut team = Team::<4, 2>::new(&TOGETHER, 0.0, 1);
    team.testbed.parts_mut(1).is_dead = true;
    team.fly(15, |_| (), |team| !team.choices().is_empty() || !team.rounds(0).listed().is_empty());
    assert!(team.choices().is_empty() && team.rounds(0).listed().is_empty(), "a fact is missing");
    team.testbed.parts_mut(1).is_dead = false;
    let mut ticks = 0;
    while team.choices().is_empty() {
        // Its first message has the fact, and only the next one its scores.
        assert!(team.begun() == [0, 0] && ticks < 5);
        team.tick();
        ticks += 1;
    }
    assert!(ticks >= 2, "{ticks}");
}

#[test]
fn line_12_all_who_decide_in_a_round_decide_on_the_same_joint_policy_whatever_is_lost() {
    let mut decided = 0;
    for seed in 0..60 {
        let mut team = Team::<64, 3>::new(&THREE, 0.4, seed);
        (0..3).for_each(|robot| team.testbed.parts_mut(robot).slips = (seed as usize % (robot + 2)) as u8);
        let mut known: Vec<(u32, Option<u16>)> = Vec::new();
        let look = |team: &Team<64, 3>| {
            for choice in team.choices() {
                match known.iter().find(|(round, _)| *round == choice.0) {
                    Some(other) => assert_eq!(*other, choice, "seed {seed}"),
                    None => known.push(choice),
                }
            }
        };
        assert!(team.fly(300, look, |team| team.is_lifted()).is_some(), "seed {seed}: {:?}", team.begun());
        decided += known.len();
    }
    assert!(decided > 120, "{decided}");
}

#[test]
fn line_12_what_only_one_robot_knows_counts_for_the_team() {
    // By itself the second would lift at once; the first knows that the table falls then.
    let mut team = Team::<4, 2>::new(&TOGETHER, 0.0, 1);
    team.testbed.parts_mut(0).height = UP;
    team.fly(10, |_| (), |team| team.begun() != [0, 0]);
    assert_eq!(team.begun()[1], 1, "with the first side up, the second follows");
    let mut team = Team::<4, 2>::new(&TOGETHER, 0.0, 1);
    let begun = team.fly(10, |_| (), |team| team.begun() == [1, 1]).expect("both lift");
    assert_eq!(team.rounds(0).policy(), Some(3), "(lift, lift)");
    assert!(begun <= 4, "{begun}");
    let weighed = team.rounds(0).weighed();
    assert!((weighed.posterior().iter().sum::<f32>() - 1.0).abs() < 1e-5);
    assert!(
        weighed.costs()[0].price > weighed.costs()[2].price,
        "one alone is dearer: {:?}",
        weighed.costs()
    );
}

#[test]
fn line_17_robots_that_exclude_each_other_never_act_at_once() {
    let mut ticks = 0;
    for seed in 0..100 {
        let mut team = Team::<4, 2>::new(&IN_TURN, if seed % 2 == 0 { 0.0 } else { 0.4 }, seed);
        team.testbed.parts_mut(0).slips = (seed % 3) as u8;
        let look = |team: &Team<4, 2>| {
            assert!(team.load(0).working == 0 || team.load(1).working == 0, "seed {seed}");
        };
        ticks += team.fly(200, look, |team| team.is_lifted()).expect("one after the other");
    }
    assert!(ticks < 100 * 40, "{ticks}");
}

#[test]
fn line_31_no_operator_begins_before_every_member_has_given_its_scores() {
    for seed in 0..40 {
        let mut team = Team::<4, 2>::new(&TOGETHER, 0.6, seed);
        team.fly(100, |_| (), |team| team.begun() != [0, 0]).expect("it begins");
        let digests = [0, 1].map(|robot| team.rounds(robot).state().protocol().digest());
        assert!(digests[0].is_some() && digests[0] == digests[1], "seed {seed}");
    }
}

#[test]
fn line_31_a_robot_that_is_lost_is_left_out_and_the_others_go_on() {
    for lost in 0..3 {
        let mut team = Team::<64, 3>::new(&THREE, 0.0, 1);
        team.testbed.parts_mut((lost + 1) % 3).slips = 4;
        team.fly(20, |_| (), |team| team.begun().iter().all(|&begun| begun > 0)).expect("all begin");
        team.testbed.parts_mut(lost).is_dead = true;
        let up = |robot: usize, team: &Team<64, 3>| robot == lost || team.load(robot).height == UP;
        let done = team.fly(200, |_| (), |team| (0..3).all(|robot| up(robot, team)));
        assert!(done.is_some(), "without robot {lost}: {:?}", team.begun());
        let view = team.rounds((lost + 1) % 3).state().proposal().view;
        assert_eq!(view, View::full(3).without(RobotId(lost as u8)));
    }
}

#[test]
fn line_32_each_robot_begins_its_own_part_of_the_choice_once() {
    for seed in 0..40 {
        let mut team = Team::<64, 3>::new(&THREE, 0.3, seed);
        let mut begun = [(u32::MAX, 0); 3];
        let look = |team: &Team<64, 3>| {
            for (robot, before) in begun.iter_mut().enumerate() {
                let (round, count) =
                    (team.rounds(robot).state().proposal().round, team.load(robot).begun.len());
                assert!(count == before.1 || count == before.1 + 1 && before.0 != round, "seed {seed}");
                *before = if count > before.1 { (round, count) } else { *before };
            }
        };
        assert!(team.fly(200, look, |team| team.is_lifted()).is_some(), "seed {seed}");
        assert_eq!(team.begun(), [1; 3], "nothing slips, so once is enough");
    }
}

#[test]
fn lines_34_to_36_where_no_quorum_remains_a_robot_waits_and_names_the_one_that_is_lost() {
    let mut team = Team::<4, 2>::new(&TOGETHER, 0.0, 1);
    team.testbed.parts_mut(1).slips = 9;
    team.fly(20, |_| (), |team| team.begun() == [1, 1]).expect("both begin");
    team.testbed.parts_mut(0).is_dead = true;
    let failed = team.fly(200, |_| (), |team| team.statuses[1] == Status::Failure);
    assert!(failed.is_some_and(|ticks| ticks >= TIMEOUT), "{failed:?}");
    assert_eq!(team.rounds(1).waiting(), Some(Waiting::Quorum(RobotId(0))));
    assert_eq!(team.begun(), [1, 1], "it does nothing alone");
    assert!(
        team.rounds(1)
            .waiting()
            .is_some_and(|waiting| waiting.to_string().starts_with("waiting for robot 0: "))
    );
}

#[test]
fn lines_37_and_38_an_effect_or_a_failure_is_a_new_fact_and_opens_a_round() {
    let mut team = Team::<4, 2>::new(&IN_TURN, 0.0, 1);
    // The second begins, and the first would like to.
    team.testbed.parts_mut(1).slips = 1;
    let mut rounds = Vec::new();
    let look = |team: &Team<4, 2>| {
        let round = team.rounds(0).state().proposal().round;
        if rounds.last() != Some(&round) {
            rounds.push(round);
        }
    };
    team.fly(60, look, |team| team.statuses == [Status::Success; 2]).expect("both are up");
    assert_eq!(team.begun(), [1, 2], "{rounds:?}");
    assert!(rounds.len() >= 4, "a failure and two effects after the first round: {rounds:?}");
    let settled = rounds.len();
    let round = team.rounds(0).state().proposal().round;
    (0..30).for_each(|_| team.tick());
    assert_eq!(team.rounds(0).state().proposal().round, round, "nothing new after {settled} rounds, so none");
}

#[test]
fn a_robot_that_is_alone_decides_in_the_tick_in_which_it_is_sure() {
    let mut team = Team::<2, 1>::new(&ALONE, 0.0, 1);
    team.tick();
    assert_eq!(team.begun(), [1]);
    assert!(team.rounds(0).listed().is_empty() && team.rounds(0).waiting().is_none(), "without a round");
}

#[test]
fn a_team_decides_in_the_tick_in_which_the_others_hear_of_an_effect() {
    let mut team = Team::<4, 2>::new(&IN_TURN, 0.0, 1);
    // The facts are out after the first tick and the scores after the second; three ticks of work;
    // what has come of it is sensed and scored, and heard by the other in the tick after that.
    assert_eq!(starts(&mut team, 40), [(2, 1), (2 + 3 + 1, 0)]);
}

/// The ticks in which robots begin something, with the robots.
fn starts<const P: usize, const N: usize>(team: &mut Team<P, N>, ticks: usize) -> Vec<(usize, usize)> {
    let mut starts = Vec::new();
    for tick in 0..ticks {
        let before = team.begun();
        team.tick();
        let begun = team.begun().into_iter().zip(before).enumerate();
        starts.extend(begun.filter(|(_, (after, before))| after > before).map(|(robot, _)| (tick, robot)));
    }
    starts
}

/// Two robots that have nothing to do with each other.
static APART: Tables = Tables::new(&[Role { name: "first", ..LIFTER }, Role { name: "second", ..LIFTER }]);

/// A team whose robot `robot` slips when it lifts, while the load of the other is up if it
/// `is_done`.
fn slipping(tables: &'static Tables<'static>, robot: usize, slips: u8, is_done: bool) -> Team<4, 2> {
    let mut team = Team::<4, 2>::new(tables, 0.0, 1);
    team.testbed.parts_mut(robot).slips = slips;
    team.testbed.parts_mut(1 - robot).height = u8::from(is_done);
    team
}

#[test]
fn a_robot_goes_on_without_a_round_where_the_others_are_content_and_nothing_ties_them_to_it() {
    /// The rounds in which a robot begins, tick by tick.
    fn rounds(mut team: Team<4, 2>, robot: usize) -> Vec<u32> {
        let mut rounds = Vec::new();
        for _ in 0..40 {
            let before = team.begun();
            team.tick();
            let round = team.rounds(robot).state().proposal().round;
            rounds.extend((team.begun()[robot] > before[robot]).then_some(round));
        }
        rounds
    }
    // The other opens a round when it has found out that its load is up.
    for robot in [0, 1] {
        let apart = rounds(slipping(&APART, robot, 3, true), robot);
        let is_same = apart.len() == 4 && apart[1] == apart[2] && apart[1] == apart[3];
        assert!(is_same, "again in the round in which it has failed: {apart:?}");
    }
    // The first could lift as soon as the second is idle; the first knows of an outcome of both.
    for tables in [&IN_TURN, &TOGETHER] {
        let tied = rounds(slipping(tables, 1, 3, false), 1);
        assert!(tied.len() == 4 && tied[0] < tied[1], "with the consent of the other: {tied:?}");
    }
}

#[test]
fn a_robot_that_goes_on_stops_where_a_teammate_is_silent() {
    let mut team = slipping(&APART, 0, 9, true);
    team.fly(12, |_| (), |team| team.begun() == [2, 0]).expect("it begins again");
    team.testbed.parts_mut(1).is_dead = true;
    let last = starts(&mut team, 18).into_iter().map(|(tick, _)| tick).max();
    assert!(last.is_some_and(|tick| tick <= 8), "a frame is fresh for eight ticks: {last:?}");
}
