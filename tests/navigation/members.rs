//! Who decides with whom: teammates that are silent, dead, back, restarted, or too many for the
//! goals.

use super::*;
use iibt_core::navigation::Intention;
use iibt_core::team::rounds::{Answer, Proposal, RoundMessage};
use iibt_core::team::{Envelope, Stamp};

/// A mission in which what one robot may do leaves goals enough for the others.
fn with_goals_to_spare() -> Mission<'static, 2> {
    static GOALS: [Cell; 6] = [Cell(24), Cell(26), Cell(32), Cell(0), Cell(6), Cell(48)];
    Mission { goals: &GOALS, need: Some(3), policies: 1, ..factory() }
}

#[test]
fn one_dead_robot_of_three_is_left_out_and_the_others_arrive() {
    let mut left_out = 0;
    for dead in 0..3 {
        for after in [0, 1, 2, 3, 4] {
            let mission = with_goals_to_spare();
            let mut team = agreed(&mission);
            tick(&mut team, after);
            team.cause(EventEffect::Stop(dead, None));
            let others = [0, 1, 2].into_iter().filter(|&robot| robot != dead);
            let what = format!("the others arrive without robot {dead}, {after} moves after the start");
            fly_until(&mut team, &what, |team| {
                others.clone().all(|robot| team.statuses()[robot] == Status::Success)
            });
            for robot in others.clone() {
                let members = report(&team, robot).members;
                left_out += u32::from(members == View::full(3).without(RobotId(dead as u8)));
                assert!(mission.goals.contains(&team.cells()[robot]));
            }
        }
    }
    assert!(left_out >= 10, "not needed only if its last report was enough: {left_out}");
}

#[test]
fn a_dead_robot_out_of_the_way_does_not_stop_slow_robots() {
    static STARTS: [Cell; 3] = [Cell(0), Cell(42), Cell(28)];
    static GOALS: [Cell; 3] = [Cell(6), Cell(48), Cell(34)];
    let mission = Mission { paces: &[8; 3], policies: 1, ..Mission::new(open_floor(), &STARTS, &GOALS) };
    let mut team = agreed(&mission);
    (0..3).for_each(|robot| team.set_pace(robot, 8));
    tick(&mut team, 3);
    team.cause(EventEffect::Stop(2, None));
    fly_until(&mut team, "the others arrive", |team| team.statuses()[..2] == [Status::Success; 2]);
}

/// A goal that a dead robot may be on is missed, not given up: nobody calls the mission
/// accomplished.
#[test]
fn a_team_whose_last_goal_a_dead_robot_may_hold_is_short_of_it_and_fails_at_the_timeout() {
    static GOALS: [Cell; 2] = [Cell(4), Cell(5)];
    static STARTS: [Cell; 3] = [Cell(14), Cell(28), Cell(3)];
    let mission = Mission { policies: 1, ..Mission::new(open_floor(), &STARTS, &GOALS) };
    let mut team = team(&mission);
    fly_until(&mut team, "all decide", has_decided);
    team.cause(EventEffect::Stop(2, None));
    fly_until(&mut team, "it is left out", |team| !report(team, 0).members.contains(RobotId(2)));
    fly_until(&mut team, "the others have decided", |team| {
        (0..2).all(|robot| protocol(team, robot).has_decided())
    });
    let wall = protocol(&team, 0).proposal().wall(RobotId(2), 3).expect("it is left out").0;
    assert!(GOALS.iter().any(|&goal| wall.contains(goal)), "{wall:?}");
    let mut failed = false;
    for _ in 0..200 {
        team.tick();
        failed |= team.statuses()[0] == Status::Failure;
        assert!(team.statuses()[..2].iter().all(|&status| status != Status::Success));
    }
    assert!(failed);
}

#[test]
fn line_31_what_a_dead_robot_may_be_on_is_a_wall_to_the_members() {
    let mission = factory();
    let mut team = agreed(&mission);
    let path: Vec<Cell> = report(&team, 2).path.cells(&mission.map).collect();
    team.cause(EventEffect::Stop(2, None));
    fly_until(&mut team, "it is left out", |team| {
        !protocol(team, 0).proposal().view.contains(RobotId(2)) && protocol(team, 0).has_decided()
    });
    let wall = protocol(&team, 0).proposal().wall(RobotId(2), 3).expect("it is left out").0;
    assert!(path.iter().all(|&cell| wall.contains(cell)), "{path:?} is in {wall:?}");
    let plans = task(&team, 0).policies();
    let entered = plans
        .iter()
        .flat_map(|plan| plan.paths())
        .flat_map(|path| path.cells(&mission.map).skip_while(|&cell| cell == path.start).collect::<Vec<_>>());
    assert!(entered.into_iter().all(|cell| !wall.contains(cell)));
}

#[test]
fn half_of_a_team_without_robot_1_waits_with_a_name_for_it_and_fails_at_the_timeout() {
    let mission = Mission::new(reproduce::map(), &STARTS[..2], &GOALS[..2]);
    let mut team = agreed(&mission);
    team.set_pace(0, 8);
    team.cause(EventEffect::Stop(0, None));
    fly_until(&mut team, "robot 2 knows", |team| {
        report(team, 1).waiting == Some(Waiting::Quorum(RobotId(0)))
    });
    assert_eq!(
        report(&team, 1).waiting.map(|waiting| waiting.to_string()).as_deref(),
        Some("waiting for robot 0: it is lost, and the others are no quorum")
    );
    let standing = cells(&team);
    tick(&mut team, 200);
    assert_eq!(cells(&team), standing);
    assert_eq!(report(&team, 1).waiting, Some(Waiting::Quorum(RobotId(0))));
}

#[test]
fn half_of_a_team_with_robot_1_goes_on() {
    let mission = Mission { starts: &STARTS[..2], need: Some(2), ..with_goals_to_spare() };
    let mut team = agreed(&mission);
    team.cause(EventEffect::Stop(1, None));
    fly_until(&mut team, "robot 1 arrives", |team| team.statuses()[0] == Status::Success);
    assert_eq!(report(&team, 0).members, View::full(1));
}

#[test]
fn a_robot_that_was_left_out_returns_standing_and_gets_a_goal() {
    let mission = with_goals_to_spare();
    let mut team = agreed(&mission);
    team.cause(EventEffect::Stop(2, Some(150)));
    fly_until(&mut team, "it is left out", |team| !report(team, 0).members.contains(RobotId(2)));
    fly_until(&mut team, "it is back", |team| report(team, 0).members == View::full(3));
    fly_until(&mut team, "all stop", stopped);
    assert!(on_goals(&team, &mission));
}

#[test]
fn a_team_with_a_robot_that_is_not_heard_goes_on_without_it_and_takes_it_back_when_it_speaks() {
    let mission = with_goals_to_spare();
    let mut team = agreed(&mission);
    tick(&mut team, 1);
    team.silence(2, true);
    fly_until(&mut team, "the others arrive", |team| team.statuses()[..2] == [Status::Success; 2]);
    assert!(!report(&team, 0).members.contains(RobotId(2)));
    team.silence(2, false);
    fly_until(&mut team, "all stop", |team| stopped(team) && report(team, 0).members == View::full(3));
    assert!(on_goals(&team, &mission));
}

/// Ticks a team with a radio of the test's own, which carries frames over these links alone, until
/// it stops.
fn fly_over(team: &mut Team<'_>, carries: impl Fn(usize, usize) -> bool) {
    let size = team.cells().len();
    for _ in 0..400 {
        if stopped(team) {
            return;
        }
        team.tick();
        for sender in 0..size {
            let frames = team.sent(sender).concat();
            let receivers = (0..size).filter(|&receiver| receiver != sender && carries(sender, receiver));
            receivers.for_each(|receiver| team.deliver(receiver, &frames));
        }
    }
    panic!("not all stop: {:?}", team.reports());
}

#[test]
fn a_robot_that_never_hears_a_teammate_hears_of_it_by_way_of_the_others() {
    let mission = factory();
    let mut team = lossy(&mission, 1.0, 1);
    fly_over(&mut team, |sender, receiver| (sender, receiver) != (0, 1));
    assert!(on_goals(&team, &mission));
    assert!(team.ticks() < 40, "{}", team.ticks());
}

#[test]
fn four_robots_of_which_each_hears_one_arrive() {
    static STARTS: [Cell; 4] = [Cell(28), Cell(2), Cell(45), Cell(6)];
    static GOALS: [Cell; 4] = [Cell(24), Cell(26), Cell(32), Cell(48)];
    let mission = Mission::new(open_floor(), &STARTS, &GOALS);
    let mut team = lossy(&mission, 1.0, 1);
    fly_over(&mut team, |sender, receiver| (sender + 1) % 4 == receiver);
    assert!(on_goals(&team, &mission));
}

#[test]
fn a_robot_that_restarts_where_it_began_has_the_team_decide_again() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "robot 3 has given its vector", |team| stages(team)[2] == Stage::Announced);
    assert_eq!(cells(&team)[2], STARTS[2].0);
    team.restart(2).expect("a sound mission");
    fly_until(&mut team, "a new round", |team| report(team, 2).round > 0);
    fly_until(&mut team, "all stop", stopped);
    assert!(on_goals(&team, &mission));
}

#[test]
fn a_robot_that_restarts_on_its_goal_finds_out_that_it_has_arrived() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all stop", stopped);
    let goals = cells(&team);
    team.restart(1).expect("a sound mission");
    team.tick();
    assert!(!stopped(&team));
    fly_until(&mut team, "all stop again", stopped);
    assert_eq!(cells(&team), goals);
}

#[test]
fn robots_that_stand_on_their_goals_stop_without_a_move() {
    for count in 1..=3 {
        let mission = Mission::new(reproduce::map(), &GOALS[..count], &GOALS);
        let mut team = team(&mission);
        fly_until(&mut team, "all stop", stopped);
        for _ in 0..5 {
            team.tick();
            assert!(
                stopped(&team)
                    && cells(&team) == GOALS[..count].iter().map(|goal| goal.0).collect::<Vec<_>>()
            );
        }
    }
}

#[test]
fn any_number_of_goals_serves_a_team() {
    static FAR: [Cell; 4] = [Cell(24), Cell(26), Cell(32), Cell(0)];
    for (robots, goals) in [(1, 1), (1, 4), (2, 4), (3, 4), (2, 1), (3, 1), (3, 2)] {
        let mission = Mission::new(reproduce::map(), &STARTS[..robots], &FAR[..goals]);
        let mut team = team(&mission);
        let outcome = judge::fly(&mut team, 200);
        assert!(outcome.arrived.is_some() && outcome.collisions == 0, "{robots}, {goals}: {outcome:?}");
        let held = mission.goals.iter().filter(|goal| team.cells().contains(goal)).count();
        assert_eq!(held, robots.min(goals), "{robots} robots, {goals} goals");
    }
}

#[test]
fn a_mission_that_needs_fewer_goals_than_robots_ends_when_they_are_held() {
    for need in 1..=3 {
        let mission = Mission { need: Some(need), ..factory() };
        let mut team = team(&mission);
        fly_until(&mut team, "all stop", stopped);
        let held = team.cells().iter().filter(|cell| GOALS.contains(cell)).count();
        let moved = cells(&team).iter().zip(&STARTS).filter(|&(&cell, start)| cell != start.0).count();
        assert_eq!(held, usize::from(need));
        assert!(moved >= held, "{:?}", cells(&team));
    }
}

#[test]
fn robots_with_goals_of_their_own_reach_them_and_no_others() {
    // The nearest goal of each robot is owned by another one.
    static OWN: [Option<Cell>; 3] = [Some(Cell(4)), Some(Cell(46)), None];
    static GOALS: [Cell; 3] = [Cell(4), Cell(46), Cell(30)];
    let mission = Mission { own_goals: &OWN, goals: &GOALS, ..factory() };
    let mut team = team(&mission);
    fly_until(&mut team, "all stop", stopped);
    assert_eq!(cells(&team), [4, 46, 30]);
}

#[test]
fn two_robots_in_a_corridor_with_a_bay_exchange_their_goals() {
    let mut map = open_floor();
    assert!(
        (7..49).filter(|&cell| cell != 10).all(|cell| map.block(Cell(cell))),
        "a row, and a bay below its middle"
    );
    static STARTS: [Cell; 2] = [Cell(1), Cell(5)];
    static OWN: [Option<Cell>; 2] = [Some(Cell(5)), Some(Cell(1))];
    static GOALS: [Cell; 2] = [Cell(1), Cell(5)];
    let mission = Mission { own_goals: &OWN, ..Mission::new(map, &STARTS, &GOALS) };
    let mut team = team(&mission);
    fly_until(&mut team, "all stop", stopped);
    assert_eq!(cells(&team), [5, 1]);
}

#[test]
fn eight_robots_arrive_within_a_tick_where_the_plan_is_together() {
    static STARTS: [Cell; 8] = [Cell(0), Cell(2), Cell(4), Cell(6), Cell(42), Cell(44), Cell(46), Cell(48)];
    static GOALS: [Cell; 8] =
        [Cell(15), Cell(16), Cell(17), Cell(18), Cell(29), Cell(30), Cell(31), Cell(32)];
    let mission = Mission::new(open_floor(), &STARTS, &GOALS);
    let mut team = team(&mission);
    let tracks = fly_to_the_end(&mut team);
    assert!(on_goals(&team, &mission));
    let entered =
        |track: &[u16]| track.iter().rposition(|cell| track.last() != Some(cell)).expect("it moves");
    let entered: Vec<_> = tracks.iter().map(|track| entered(track)).collect();
    let plans = task(&team, 0).policies();
    let is_together = plans[report(&team, 0).policy.expect("a choice")].is_together();
    assert!(
        !is_together || entered.iter().max().expect("eight") - entered.iter().min().expect("eight") <= 1,
        "{entered:?}"
    );
}

#[test]
fn nobody_plans_with_a_teammate_that_speaks_of_another_map() {
    let mission = factory();
    let mut team = team(&mission);
    let context = context(task(&team, 0));
    team.silence(2, true);
    let fact = Fact { anchor: Cell(900), ..Fact::default() };
    let rounds = RoundMessage { proposal: Proposal::first(3), fact, answer: Answer::Listing(0) };
    let message = Intention { rounds, waypoints: Default::default() };
    for sequence in 0..20 {
        let stamp = Stamp { epoch: 9, sequence };
        overhear(
            &mut team,
            context,
            &Envelope::<Intention<2, POLICIES>> { sender: RobotId(2), stamp, message: message.clone() },
        );
        team.tick();
    }
    assert_eq!(team.robot(0).link_report().received.foreign, 20, "it was heard and refused");
    assert!(stages(&team)[..2].iter().all(|&stage| stage == Stage::Deciding));
}

/// The localiser is silent just when a move fails: nothing says that the robot has moved.
#[test]
fn a_move_that_nothing_confirms_is_not_announced() {
    let mission = factory();
    let mut team = agreed(&mission);
    team.set_slip(0, 1.0);
    team.set_reading(0, Reading::Nothing);
    for _ in 0..10 {
        team.tick();
        assert_eq!(protocol(&team, 0).step(), 0);
    }
    team.set_slip(0, 0.0);
    team.set_reading(0, Reading::Drawn);
    fly_until(&mut team, "all stop", stopped);
}

/// A localiser that lags makes a move look as if it had failed; made once more it would lead off
/// the path.
#[test]
fn one_late_reading_does_not_have_a_move_made_twice() {
    let mission = factory();
    let mut team = team(&mission);
    let start = STARTS[0];
    fly_until(&mut team, "robot 1 moves", |team| team.cells()[0] != start);
    let moved = team.cells()[0];
    team.set_reading(0, Reading::Cell(start));
    team.tick();
    team.set_reading(0, Reading::Drawn);
    assert_eq!(team.cells()[0], moved);
    fly_until(&mut team, "all stop", stopped);
    assert_eq!(round(&team), 0, "no other plan was needed");
}

#[test]
fn a_robot_that_is_unsure_where_it_is_stands_still() {
    let mission = factory();
    let mut team = agreed(&mission);
    let mut standing = Cell(0);
    for tick in 0..12 {
        // Its readings jump about; at first it may be sure by what it knew before.
        team.set_reading(0, Reading::Cell(Cell(11 * tick % 49)));
        team.tick();
        if tick == 2 {
            standing = team.cells()[0];
        }
        assert!(tick < 2 || team.cells()[0] == standing, "tick {tick}");
    }
    assert_eq!(report(&team, 0).stage, Stage::Agreed);
    assert!(report(&team, 0).confidence < 0.9995);
    team.set_reading(0, Reading::Drawn);
    fly_until(&mut team, "all stop", stopped);
}

/// Robots on rows of their own: no move of one waits for the other.
#[test]
fn robots_whose_link_is_gone_stand_before_their_plans_are_done_and_go_on_once_it_is_back() {
    static STARTS: [Cell; 3] = [Cell(0), Cell(14), Cell(28)];
    static GOALS: [Cell; 3] = [Cell(6), Cell(20), Cell(34)];
    let mission = Mission { paces: &[8; 3], policies: 1, ..Mission::new(open_floor(), &STARTS, &GOALS) };
    let mut team = agreed(&mission);
    (0..3).for_each(|robot| team.set_pace(robot, 8));
    tick(&mut team, 8);
    (0..3).for_each(|robot| team.silence(robot, true));
    tick(&mut team, 20 + 8 + 2);
    let standing = cells(&team);
    tick(&mut team, 100);
    assert_eq!(cells(&team), standing);
    for (robot, &cell) in standing.iter().enumerate() {
        assert!(!mission.goals.contains(&Cell(cell)));
        assert!(
            matches!(report(&team, robot).waiting, Some(Waiting::Quorum(_))),
            "{:?}",
            report(&team, robot)
        );
    }
    (0..3).for_each(|robot| team.silence(robot, false));
    fly_until(&mut team, "all arrive", |team| team.statuses() == [Status::Success; 3]);
}
