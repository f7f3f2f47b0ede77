//! Algorithm 1 of the paper, line by line, on the robots of section 6.2: tables that fly in the
//! simulator.

use host_sim::manipulation::tables::{
    ELSEWHERE, EMPTY, FREE, GOAL_A, GOAL_B, GOAL_C, HOLD, IDLE, IN_TURN, LOC, MOVE_TO, PICK, PLACE, PUT_DOWN,
    TO_PLACE, TOGETHER,
};
use iibt_core::iibt::rules::Raise;
use iibt_core::iibt::table::{Operator, Remedy, Role, Tables};
use iibt_core::iibt::{InferenceNode, Literal};
use iibt_core::team::RobotId;
use iibt_core::team::rounds::Waiting;
use iibt_core::tree::Status;
use tests::handling::{Bench, Handling, TIMEOUT, idle, ready, said};

static TURNS: Tables = Tables::new(&IN_TURN);
static AT_ONCE: Tables = Tables::new(&TOGETHER);

/// C of a teammate that is to be free, and of a robot that is to hold its object.
const FREED: [f32; 4] = [0.0, 0.0, 0.0, 1.0];
const HELD: [f32; 4] = [0.0, 1.0, 0.0, 0.0];

/// Tables whose robot 1 knows nothing to prefer when a precondition is missing.
static HELPLESS: Tables = Tables::new(&[Role { remedies: &[], ..IN_TURN[0] }, IN_TURN[1]]);

/// Tables whose robot 1 prefers to be at the bottle by a tenth more in each pass.
static HESITANT: Tables = Tables::new(&[
    Role {
        remedies: &[Remedy {
            missing: Literal { variable: 1, value: true },
            state: LOC,
            raise: Raise::By(0.1),
            target: Some(GOAL_A),
        }],
        ..IN_TURN[0]
    },
    IN_TURN[1],
]);

/// Tables whose robot 1 has a habit of picking.
static HABITUAL: Tables = Tables::new(&[Role { operators: &HABITS, ..IN_TURN[0] }, IN_TURN[1]]);

const HABITS: [Operator; 4] = {
    let [go, pick, place, idle] = OPERATORS;
    [go, Operator { habit: 5.0, ..pick }, place, idle]
};

const OPERATORS: [Operator; 4] = match IN_TURN[0].operators.first_chunk() {
    Some(operators) => *operators,
    None => panic!(),
};

/// A robot that has been put where its object is.
fn at_source(tables: &'static Tables<'static>) -> Bench {
    let mut robot = Bench::new(tables, 0);
    robot.put(GOAL_A, LOC);
    robot
}

#[test]
fn line_2_the_task_is_running_from_the_first_tick() {
    assert_eq!(Bench::new(&TURNS, 0).step(Some(idle())), Status::Running);
}

#[test]
fn lines_3_and_4_the_model_and_preferences_are_the_tasks_own_at_every_tick() {
    let mut robot = Bench::new(&TURNS, 0);
    robot.tick(Some(idle()));
    assert_eq!(robot.preferences(), [[2.0, 1.0, 0.0, 0.0], FREED], "raised");
    robot.put(GOAL_A, LOC);
    robot.tick(Some(idle()));
    assert_eq!(robot.preferences(), [HELD, FREED], "its own again");
}

#[test]
fn line_5_observes_before_it_believes() {
    let mut robot = Bench::new(&TURNS, 0);
    robot.readings = [GOAL_B, FREE];
    let before = robot.task.belief(PLACE.into())[usize::from(GOAL_B)];
    robot.step(Some(idle()));
    assert!(robot.task.belief(PLACE.into())[usize::from(GOAL_B)] > before);
}

#[test]
fn line_6_updates_belief_and_logic_from_the_observation() {
    let mut robot = at_source(&TURNS);
    robot.tick(Some(idle()));
    assert_eq!(robot.begun(), Some((PICK, None)), "IsReached holds");
    robot.readings = [GOAL_A, HOLD];
    let statuses: Vec<_> = (0..3).map(|_| robot.step(Some(idle()))).collect();
    assert_eq!(statuses.last(), Some(&Status::Success), "and IsHolding: {statuses:?}");
}

#[test]
fn line_7_builds_its_own_candidates_from_the_belief() {
    let mut robot = Bench::new(&TURNS, 0);
    robot.tick(Some(idle()));
    let decision = robot.task.decision().expect("it has decided");
    assert!(decision.posterior.iter().all(|&p| p > 0.0), "four operators of each robot");
    assert!((decision.posterior.iter().sum::<f32>() - 1.0).abs() < 1e-5);
    assert!(decision.beliefs[0][usize::from(FREE)] > 0.99, "q(s) of its own");
}

#[test]
fn lines_8_to_11_join_the_teammates_intentions() {
    // In turn it keeps still while the teammate acts, though it would like that to be free; at once
    // it goes as well.
    for (operator, in_turn, at_once) in [(MOVE_TO, 12, 0), (PICK, 13, 1), (PUT_DOWN, 14, 2), (IDLE, 3, 3)] {
        for (tables, expected) in [(&TURNS, in_turn), (&AT_ONCE, at_once)] {
            let mut robot = Bench::new(tables, 0);
            robot.tick(Some(said(ELSEWHERE, EMPTY, operator)));
            assert_eq!(robot.decided().0, expected, "what was announced is in the joint policy");
        }
    }
}

#[test]
fn line_12_infers_once_everything_is_known() {
    // exp(γ (diag - off) C) per robot, normalised: every column of A has one entropy.
    let mut robot = at_source(&TURNS);
    robot.tick(Some(idle()));
    let e = (0.9f32 / 0.975 - 0.075 / 0.975 / 3.0).exp();
    let (policy, probability) = robot.decided();
    assert_eq!(policy, 7, "(pick, idle)");
    assert!((probability - (e / (e + 3.0)).powi(2)).abs() < 1e-5, "{probability}");
}

#[test]
fn line_12_the_prior_over_policies_counts() {
    let mut robot = at_source(&HABITUAL);
    robot.tick(Some(idle()));
    let e = (0.9f32 / 0.975 - 0.075 / 0.975 / 3.0).exp();
    let expected = e * 5f32.exp() / (e * 5f32.exp() + 3.0) * e / (e + 3.0);
    assert!((robot.decided().1 - expected).abs() < 1e-5, "{:?} is not {expected}", robot.decided());
}

#[test]
fn lines_13_to_15_choosing_to_stop_is_success_and_executes_nothing() {
    let mut robot = Bench::new(&TURNS, 0);
    robot.put(GOAL_A, HOLD);
    assert_eq!(robot.tick(Some(idle())), Status::Success);
    assert_eq!((robot.begun(), robot.task.decision()), (None, None));
}

#[test]
fn line_17_a_precondition_that_holds_is_not_touched() {
    let mut robot = at_source(&TURNS);
    robot.tick(Some(idle()));
    assert_eq!((robot.preferences(), robot.begun()), ([HELD, FREED], Some((PICK, None))));
}

#[test]
fn line_17_what_misses_its_precondition_is_not_executed() {
    let mut robot = Bench::new(&HELPLESS, 0);
    for _ in 0..10 {
        robot.step(Some(idle()));
        assert_eq!((robot.decided().0, robot.begun()), (7, None), "pick is best, and there is no bottle");
    }
}

#[test]
fn lines_18_and_19_raise_the_preference_for_the_missing_evidence_before_the_next_inference() {
    let mut robot = Bench::new(&TURNS, 0);
    robot.put(GOAL_C, FREE);
    robot.task.pursue(TO_PLACE);
    robot.tick(Some(ready()));
    assert_eq!(robot.preferences()[0], [3.0, 2.0, 1.0, 0.0], "each above all before it");
}

#[test]
fn line_20_rebuilds_the_candidates_after_every_raise() {
    let mut robot = Bench::new(&TURNS, 0);
    robot.put(GOAL_C, FREE);
    robot.task.pursue(TO_PLACE);
    robot.tick(Some(ready()));
    assert_eq!(robot.begun(), Some((MOVE_TO, Some(GOAL_A))), "not to goal C, where the aim is");
}

#[test]
fn lines_21_to_24_read_the_intentions_again() {
    let mut robot = Bench::new(&TURNS, 0);
    robot.tick(Some(said(ELSEWHERE, EMPTY, PICK)));
    assert_eq!(robot.preferences(), [[2.0, 1.0, 0.0, 3.0], FREED], "after two raises");
    assert_eq!(robot.decided().0, 13, "the teammate picks in the third inference too");
}

#[test]
fn line_25_infers_again_until_the_precondition_holds() {
    let mut robot = Bench::new(&TURNS, 0);
    robot.tick(Some(idle()));
    assert_eq!((robot.decided().0, robot.begun()), (3, Some((MOVE_TO, Some(GOAL_A)))));
    assert!((robot.decided().1 - 0.2586).abs() < 1e-4);
}

#[test]
fn lines_26_to_28_fail_at_the_timeout_and_not_before() {
    let mut robot = Bench::new(&HELPLESS, 0);
    for tick in 0..TIMEOUT {
        assert_eq!((robot.step(Some(idle())), robot.begun()), (Status::Running, None), "tick {tick}");
    }
    assert_eq!((robot.step(Some(idle())), robot.begun()), (Status::Failure, None));
}

#[test]
fn lines_26_to_28_the_timeout_starts_again_after_it_has_struck_or_the_precondition_held() {
    let mut robot = Bench::new(&HELPLESS, 0);
    let failed: Vec<_> = (0..3 * TIMEOUT).filter(|_| robot.step(Some(idle())) == Status::Failure).collect();
    assert_eq!(failed, [TIMEOUT, 2 * TIMEOUT + 1]);
    let mut robot = Bench::new(&HELPLESS, 0);
    (0..TIMEOUT).for_each(|_| _ = robot.step(Some(idle())));
    robot.readings = [GOAL_A, LOC];
    (0..6).for_each(|_| assert_eq!(robot.step(Some(idle())), Status::Running));
    robot.put(ELSEWHERE, FREE);
    assert_eq!(robot.step(Some(idle())), Status::Running);
}

#[test]
fn lines_26_to_28_the_timeout_survives_a_wrap_of_the_clock() {
    let mut robot = Bench::new(&HELPLESS, 0);
    robot.now = u32::MAX - 4;
    (0..TIMEOUT).for_each(|_| assert_eq!(robot.step(Some(idle())), Status::Running));
    assert_eq!(robot.step(Some(idle())), Status::Failure);
}

#[test]
fn lines_17_to_30_do_bounded_work_in_a_tick_and_go_on_in_the_next() {
    let mut robot = Bench::new(&HESITANT, 0);
    robot.step(Some(idle()));
    let raised = robot.node.raised().expect("the loop is not done").rows[0].values()[usize::from(LOC)];
    assert!((raised - 0.1 * InferenceNode::<Handling>::PASSES as f32).abs() < 1e-6, "{raised}");
    assert_eq!(robot.begun(), None);
    robot.step(Some(idle()));
    assert!(robot.node.raised().is_none(), "what was raised is kept, and is enough now");
    let begins = (0..4).find(|_| (robot.step(Some(idle())), robot.begun().is_some()).1);
    assert!(begins.is_some(), "and the team waits for no other tick");
}

#[test]
fn lines_31_and_32_execute_when_the_whole_team_is_connected() {
    let mut robot = Bench::new(&TURNS, 0);
    robot.tick(Some(idle()));
    assert_eq!(robot.begun(), Some((MOVE_TO, Some(GOAL_A))));
}

#[test]
fn line_33_rolls_the_preference_back_exactly_after_executing() {
    let mut robot = Bench::new(&TURNS, 0);
    robot.tick(Some(idle()));
    assert_eq!(robot.preferences()[0], [2.0, 1.0, 0.0, 0.0], "raised for the choice");
    assert!(robot.begun().is_some() && robot.node.raised().is_none(), "executed and rolled back");
    let bits = |rows: [[f32; 4]; 2]| rows.map(|row| row.map(f32::to_bits));
    robot.put(GOAL_A, LOC);
    robot.tick(Some(idle()));
    assert_eq!(bits(robot.preferences()), bits([HELD, FREED]));
}

#[test]
fn lines_34_to_36_wait_while_a_teammate_is_missing() {
    let mut alone = Bench::new(&AT_ONCE, 0);
    for _ in 0..4 {
        assert_eq!((alone.step(None), alone.begun()), (Status::Running, None), "never heard");
        assert_eq!(alone.decided().0, 3, "it knows what it would do");
        assert_eq!(alone.task.rounds().waiting(), Some(Waiting::Unheard(RobotId(1))));
    }
    alone.tick(Some(idle()));
    assert_eq!(alone.begun(), Some((MOVE_TO, Some(GOAL_A))), "connected");
}

#[test]
fn lines_34_to_36_a_teammate_that_never_speaks_fails_the_node_at_the_timeout_and_is_named() {
    let mut alone = Bench::new(&AT_ONCE, 0);
    (0..TIMEOUT).for_each(|_| assert_eq!(alone.step(None), Status::Running));
    assert_eq!((alone.step(None), alone.begun()), (Status::Failure, None));
    let waiting = alone.task.rounds().waiting().map(|waiting| waiting.to_string());
    assert_eq!(waiting.as_deref(), Some("waiting for robot 1: it was never heard, so it may be anywhere"));
}

#[test]
fn lines_37_and_38_the_last_step_promotes_stopping_and_the_next_tick_succeeds() {
    let mut robot = at_source(&TURNS);
    assert_eq!(robot.tick(Some(idle())), Status::Running);
    robot.busy = true;
    assert_eq!(robot.step(Some(idle())), Status::Running);
    robot.busy = false;
    robot.put(GOAL_A, HOLD);
    assert_eq!(robot.step(Some(idle())), Status::Success);
}

#[test]
fn lines_37_and_38_any_other_step_promotes_nothing() {
    let mut robot = Bench::new(&TURNS, 0);
    robot.tick(Some(idle()));
    robot.put(GOAL_A, LOC);
    assert_eq!(robot.step(Some(idle())), Status::Running);
}

#[test]
fn lines_40_and_41_the_node_stays_running_while_the_policy_is_under_way() {
    let mut robot = Bench::new(&TURNS, 0);
    robot.tick(Some(idle()));
    robot.busy = true;
    for _ in 0..2 * TIMEOUT {
        assert_eq!((robot.step(Some(idle())), robot.begun()), (Status::Running, None));
    }
    assert_eq!(robot.task.announcement().operator(), MOVE_TO);
}

#[test]
fn a_halted_node_waits_and_takes_back_what_it_raised() {
    let mut robot = Bench::new(&HESITANT, 0);
    robot.step(Some(idle()));
    assert!(robot.node.raised().is_some());
    robot.node.halt(&mut robot.task);
    assert!(robot.node.raised().is_none());
    let mut robot = at_source(&TURNS);
    robot.tick(Some(idle()));
    assert!(robot.begun().is_some());
    robot.node.halt(&mut robot.task);
    assert_eq!(robot.begun(), None);
}
