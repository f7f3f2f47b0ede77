//! What each line of Algorithm 1 is in a round.

use super::*;

#[test]
fn line_2_the_node_is_running_until_the_robot_has_arrived() {
    let mission = factory();
    let mut team = team(&mission);
    let mut ticks = 0;
    while !stopped(&team) {
        let arrived = stages(&team).iter().map(|&stage| stage == Stage::Arrived).collect::<Vec<_>>();
        let success: Vec<_> = team.statuses().iter().map(|&status| status == Status::Success).collect();
        assert_eq!(arrived, success);
        assert!(team.statuses().iter().all(|&status| status != Status::Failure));
        team.tick();
        ticks += 1;
        assert!(ticks < 60, "{:?}", stages(&team));
    }
    assert!(ticks > 8, "{ticks}");
}

#[test]
fn lines_3_and_4_what_a_robot_is_for_is_any_goal_unless_it_has_an_errand() {
    let mission = with_chargers();
    let mut team = team(&mission);
    visit(&mut team, 1, 0);
    team.set_charge(2, 10);
    fly_until(&mut team, "all agree", has_decided);
    let purposes = [0, 1, 2].map(|robot| protocol(&team, robot).fact().purpose);
    assert_eq!(purposes, [Purpose::Goal, Purpose::Visit(Cell(0)), Purpose::Charge(Cell(41))]);
}

#[test]
fn line_5_an_obstacle_that_one_robot_has_observed_is_avoided_by_all() {
    let mission = factory();
    let mut team = team(&mission);
    let near_the_first = [Cell(29), Cell(21)];
    near_the_first.into_iter().for_each(|cell| team.cause(EventEffect::Block(cell)));
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    for robot in 0..3 {
        let seen = task(&team, robot).hazards().count();
        assert_eq!(seen, if robot == 0 { 2 } else { 0 }, "robot {robot}");
        let paths = task(&team, robot).policies().iter().flat_map(|plan| plan.paths());
        let mut cells = paths.flat_map(|path| path.cells(&mission.map).collect::<Vec<_>>());
        assert!(cells.all(|cell| !near_the_first.contains(&cell)), "robot {robot}");
    }
}

#[test]
fn line_6_a_robot_announces_where_it_believes_to_be_once_it_is_sure() {
    let mission = factory();
    let mut team = team(&mission);
    team.place(0, Cell(42));
    for _ in 0..6 {
        team.set_reading(0, Reading::Nothing);
        team.tick();
        assert!(task(&team, 0).rounds().is_none() && team.sent(0).is_empty(), "it has nothing true to say");
    }
    team.set_reading(0, Reading::Drawn);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    assert_eq!(protocol(&team, 0).fact().anchor, Cell(42));
}

#[test]
fn line_7_all_build_the_same_candidates_and_none_has_a_conflict() {
    let mission = Mission { policies: 7, ..factory() };
    let team = agreed(&mission);
    let plans = task(&team, 0).policies();
    assert_eq!(plans.len(), 7);
    for plan in plans {
        assert_eq!((plan.conflict(&mission.map), plan.paths().len(), plan.short_by()), (None, 3, 0));
        assert!(plan.paths().iter().all(|path| GOALS.contains(&path.end(&mission.map))));
    }
    assert!([1, 2].iter().all(|&robot| task(&team, robot).policies() == plans), "the list is common");
    let shortest = plans.iter().map(|plan| plan.steps()).min();
    assert_eq!(Some(plans[0].steps()), shortest, "the best one first");
}

#[test]
fn lines_8_to_11_nobody_lists_without_every_fact_nor_decides_without_every_vector() {
    let mission = factory();
    let mut silent = team(&mission);
    silent.silence(2, true);
    tick(&mut silent, 15);
    for robot in 0..2 {
        assert!(task(&silent, robot).policies().is_empty(), "its facts are not complete");
        assert_eq!(report(&silent, robot).waiting, Some(Waiting::Unheard(RobotId(2))));
    }
    assert!(task(&silent, 2).policies().len() > 1, "it has heard the others");
    assert!(!protocol(&silent, 2).has_decided(), "but no vector of theirs");
    assert_eq!(report(&silent, 2).waiting, Some(Waiting::Scores(RobotId(0))));
    silent.silence(2, false);
    fly_until(&mut silent, "all agree", |team| all(team, Stage::Agreed));
}

#[test]
fn line_12_all_choose_the_joint_policy_that_costs_the_team_least() {
    let mission = factory();
    let team = agreed(&mission);
    let chosen = report(&team, 0).policy.expect("a choice");
    for robot in 0..3 {
        let weighed = task(&team, robot).weighed();
        let probabilities: Vec<f32> =
            (0..task(&team, robot).policies().len()).map(|policy| weighed.probability(policy)).collect();
        assert_eq!(report(&team, robot).policy, Some(chosen));
        assert!((probabilities.iter().sum::<f32>() - 1.0).abs() < 1e-4, "{probabilities:?}");
        assert!(probabilities.iter().all(|&p| p <= probabilities[chosen]), "{probabilities:?}");
        assert_eq!(report(&team, robot).probability.to_bits(), report(&team, 0).probability.to_bits());
    }
}

/// What only one robot knows decides for all: its goal serves it less often than others.
#[test]
fn line_12_what_a_policy_costs_one_robot_counts_for_the_team() {
    let mission = Mission { policies: 16, precision: 0.1, ..factory() };
    let usual = agreed(&mission);
    let end = |team: &Team<'_>| report(team, 0).goal.expect("a goal");
    let disliked = GOALS.iter().position(|&goal| goal == end(&usual)).expect("a goal of the mission");
    let mut values = [1.0; MAX_GOALS];
    values[disliked] = 0.01;
    let mut team = team(&mission);
    team.robot_mut(0).robot_mut().navigation_mut().set_goal_preferences(&values);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    assert_ne!(end(&team), end(&usual));
    let policies: Vec<_> = team.reports().iter().map(|report| report.policy).collect();
    assert!(policies[0].is_some() && policies.iter().all(|&policy| policy == policies[0]), "{policies:?}");
}

#[test]
fn lines_13_to_15_who_has_arrived_commands_nothing() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all stop", stopped);
    for _ in 0..30 {
        team.tick();
        assert!(stopped(&team) && team.commands().iter().all(Option::is_none));
    }
}

#[test]
fn line_17_an_obstacle_on_any_part_of_the_plan_opens_a_round() {
    let mission = factory();
    let mut team = agreed(&mission);
    let second = report(&team, 1).path;
    let ahead = second.cell_at(&mission.map, second.len() - 2);
    team.cause(EventEffect::Block(ahead));
    fly_until(&mut team, "all agree again", |team| decided_after(team, 0));
    assert!(team.reports().iter().any(|report| report.cause == Some(Cause::Obstacle)));
    for robot in 0..3 {
        let path = report(&team, robot).path;
        assert!(path.cells(&mission.map).all(|cell| cell != ahead), "{path:?} avoids {ahead:?}");
    }
    fly_until(&mut team, "all stop", stopped);
}

#[test]
fn line_17_a_robot_put_elsewhere_finds_out_and_the_team_decides_again() {
    let mission = factory();
    let mut team = agreed(&mission);
    team.place(0, Cell(42));
    fly_until(&mut team, "a new round", |team| decided_after(team, 0));
    assert!(team.reports().iter().any(|report| report.cause == Some(Cause::Position)));
    assert_eq!(protocol(&team, 0).fact().anchor, Cell(42));
    fly_until(&mut team, "all stop", stopped);
    assert!(on_goals(&team, &mission));
}

#[test]
fn lines_18_to_25_every_unmet_precondition_names_why_the_round_was_opened() {
    let chargers = with_chargers();
    let mut team = agreed(&chargers);
    visit(&mut team, 0, 42);
    fly_until(&mut team, "a round for the way-point", |team| decided_after(team, 0));
    assert_eq!(report(&team, 0).cause, Some(Cause::WayPoint));
    assert_eq!(protocol(&team, 0).fact().purpose, Purpose::Visit(Cell(42)));
    let opened = round(&team);
    team.set_charge(0, 10);
    fly_until(&mut team, "a round for the battery", |team| decided_after(team, opened));
    assert_eq!(report(&team, 0).cause, Some(Cause::Battery));
    assert_eq!(protocol(&team, 0).fact().purpose, Purpose::Charge(Cell(13)));
    let (opened, path) = (round(&team), report(&team, 0).path);
    assert_eq!(path.end(&chargers.map), Cell(13), "the candidates are rebuilt");
    team.set_charge(0, 95);
    fly_until(&mut team, "a round for the way-point again", |team| decided_after(team, opened));
    assert_eq!(protocol(&team, 0).fact().purpose, Purpose::Visit(Cell(42)));
    let tracks = fly_to_the_end(&mut team);
    assert!(passed(&tracks[0], &[42]));
    assert_eq!(report(&team, 0).cause, Some(Cause::Free), "the last round is for a goal");
}

#[test]
fn lines_26_to_28_a_team_short_of_a_goal_fails_at_the_timeout_and_says_why() {
    let mut map = open_floor();
    assert!([Cell(41), Cell(47)].iter().all(|&cell| map.block(cell)), "the neighbours of the corner 48");
    static STARTS: [Cell; 2] = [Cell(48), Cell(0)];
    static GOALS: [Cell; 2] = [Cell(24), Cell(26)];
    let mission = Mission::new(map, &STARTS, &GOALS);
    let mut team = team(&mission);
    fly_until(&mut team, "robot 2 is on a goal", |team| GOALS.contains(&team.cells()[1]));
    let mut failed = [None; 2];
    fly_watching(
        &mut team,
        "all fail",
        |team| {
            for (failed, &status) in failed.iter_mut().zip(team.statuses()) {
                assert_ne!(status, Status::Success, "a goal is missed");
                *failed = failed.or_else(|| (status == Status::Failure).then(|| team.ticks()));
            }
        },
        |team| team.ticks() >= 300,
    );
    assert!(failed.iter().all(|failed| failed.is_some_and(|tick| tick > 100)), "{failed:?}");
    assert_eq!(cells(&team)[0], 48);
    let plan = &task(&team, 0).policies()[report(&team, 0).policy.expect("a choice")];
    assert!(plan.short_by() == 1 || report(&team, 0).failure.is_some(), "{:?}", report(&team, 0));
}

#[test]
fn lines_26_to_28_a_robot_whose_teammate_never_speaks_fails_at_the_timeout_and_names_it() {
    let mission = factory();
    let mut team = team(&mission);
    team.silence(2, true);
    let mut failures = [vec![], vec![]];
    for _ in 0..350 {
        team.tick();
        for (robot, failures) in failures.iter_mut().enumerate() {
            if team.statuses()[robot] == Status::Failure {
                failures.push(team.ticks());
            }
            if team.ticks() > 1 {
                assert_eq!(report(&team, robot).waiting, Some(Waiting::Unheard(RobotId(2))));
            }
        }
    }
    for failures in failures {
        assert!(failures.len() == 3 && failures[0] > 100, "every hundred ticks: {failures:?}");
    }
    assert_eq!(cells(&team), [28, 2, 45], "it may be anywhere");
}

#[test]
fn line_31_no_move_is_commanded_before_all_members_have_given_their_vectors() {
    for seed in 0..40 {
        let mission = factory();
        let mut team = lossy(&mission, 0.5, seed);
        let mut given = [false; 3];
        while cells(&team) == [28, 2, 45] {
            team.tick();
            given = [0, 1, 2].map(|robot| {
                task(&team, robot).rounds().is_some_and(|rounds| rounds.protocol().digest().is_some())
            });
            assert!(team.ticks() < 200);
        }
        assert_eq!(given, [true; 3], "seed {seed}");
    }
}

#[test]
fn line_32_robots_keep_the_order_of_the_plan_however_late_one_is() {
    let mut map = open_floor();
    // One corridor: the first row, with the goals at its far end.
    assert!((7..49).all(|cell| map.block(Cell(cell))));
    static STARTS: [Cell; 3] = [Cell(0), Cell(1), Cell(2)];
    static GOALS: [Cell; 3] = [Cell(4), Cell(5), Cell(6)];
    let mission = Mission::new(map, &STARTS, &GOALS);
    let mut team = team(&mission);
    // The first of the queue makes every second move. One that makes every fifth is often stuck
    // here: when its moves, if they were made, would have led to the end of the corridor and three
    // times into the wall there, it cannot tell its drive from a localiser that has frozen.
    team.set_slip(2, 0.5);
    team.set_pace(1, 4);
    fly_watching(
        &mut team,
        "all stop",
        |team| assert!(cells(team).is_sorted_by(|one, other| one < other), "{:?}", cells(team)),
        stopped,
    );
    assert_eq!(cells(&team), [4, 5, 6]);
}

#[test]
fn line_33_what_was_raised_is_gone_once_the_plan_has_served_it() {
    let mission = factory();
    let mut team = agreed(&mission);
    visit(&mut team, 0, 42);
    fly_until(&mut team, "the errand is announced", |team| decided_after(team, 0));
    assert_eq!(protocol(&team, 0).fact().purpose, Purpose::Visit(Cell(42)));
    fly_until(&mut team, "the way-point is reached", |team| team.cells()[0] == Cell(42));
    fly_until(&mut team, "a goal again", |team| {
        protocol(team, 0).has_decided() && protocol(team, 0).fact().purpose == Purpose::Goal
    });
    assert!(report(&team, 0).goal.is_some() && task(&team, 0).waypoints().is_empty());
    fly_until(&mut team, "all stop", stopped);
}

#[test]
fn lines_34_to_36_a_robot_stands_while_the_next_cell_is_not_left_or_the_barrier_is_not_reached() {
    let mission = factory();
    let mut team = agreed(&mission);
    team.set_slip(1, 1.0); // robot 2 does not get on
    let rest: Vec<usize> = team.reports().iter().map(|report| report.path.len()).collect();
    tick(&mut team, 15);
    for robot in [0, 2] {
        let report = report(&team, robot);
        assert!(report.step < rest[robot], "robot {robot} waits before its goal");
        assert!(
            matches!(report.waiting, Some(Waiting::Barrier(RobotId(1)) | Waiting::Order(RobotId(1)))),
            "{report:?}"
        );
    }
    team.set_slip(1, 0.0);
    fly_until(&mut team, "all stop", stopped);
}

#[test]
fn lines_37_and_38_all_stop_within_a_tick_and_stay_stopped() {
    let mission = factory();
    let mut team = team(&mission);
    let mut arrivals = vec![None; 3];
    for tick in 0..60 {
        team.tick();
        for (arrival, status) in arrivals.iter_mut().zip(team.statuses().to_vec()) {
            if status == Status::Success {
                arrival.get_or_insert(tick);
            }
        }
    }
    let arrivals: Vec<i32> = arrivals.into_iter().map(|arrival| arrival.expect("it stops")).collect();
    let apart = arrivals.iter().max().expect("three") - arrivals.iter().min().expect("three");
    assert!(apart <= 1, "who is last hears of it a tick before the others: {arrivals:?}");
    assert!(stopped(&team));
}

#[test]
fn lines_40_and_41_the_node_stays_running_while_a_move_is_under_way() {
    let mission = factory();
    let mut team = agreed(&mission);
    (0..3).for_each(|robot| team.set_pace(robot, 8));
    fly_until(&mut team, "a move", |team| team.entering().any(|to| to.is_some()));
    let standing = cells(&team);
    while cells(&team) == standing {
        assert!(team.statuses().iter().all(|&status| status == Status::Running));
        team.tick();
    }
}
