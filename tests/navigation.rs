//! The lines of Algorithm 1 on real robots: what makes a team decide, wait, decide again, stop and
//! fail.

use host_sim::{EventEffect, Faults, NavigatorFlight, Radio, Reading, reproduce};
use iibt_core::grid::{Cell, Map};
use iibt_core::navigation::{Cause, Mission, NavigationPlan, OBSTACLE, Report, Round, Said, Stage};
use iibt_core::team::{RobotId, Stamp};
use iibt_core::tree::Status;
use tests::judge;
use tests::rig::overhear;

type Team<'m> = NavigatorFlight<'m, 49, 2, 16>;

static STARTS: [Cell; 3] = [Cell(28), Cell(2), Cell(45)];
static GOALS: [Cell; 3] = [Cell(24), Cell(26), Cell(32)];

fn factory() -> Mission<'static, 2> {
    Mission::new(reproduce::map(), &STARTS, &GOALS)
}

fn team<'m>(mission: &'m Mission<'m, 2>) -> Team<'m> {
    Team::over(mission, Faults::default(), 1).expect("a sound mission")
}

fn lossy<'m>(mission: &'m Mission<'m, 2>, loss: f64, seed: u64) -> Team<'m> {
    let faults = Faults { radio: Radio { loss, ..Radio::default() }, ..Faults::default() };
    Team::over(mission, faults, seed).expect("a sound mission")
}

fn stages(team: &Team<'_>) -> Vec<Stage> {
    team.reports().iter().map(|report| report.stage).collect()
}

fn report(team: &Team<'_>, robot: usize) -> Report {
    team.reports()[robot]
}

fn cells(team: &Team<'_>) -> Vec<u16> {
    team.cells().iter().map(|cell| cell.0).collect()
}

fn fly_until(team: &mut Team<'_>, what: &str, reached: impl Fn(&Team<'_>) -> bool) {
    for _ in 0..200 {
        if reached(team) {
            return;
        }
        team.tick();
    }
    panic!("never: {what}; {:?} on {:?}", stages(team), cells(team));
}

fn all(team: &Team<'_>, stage: Stage) -> bool {
    stages(team).iter().all(|&now| now == stage)
}

#[test]
fn the_robots_decide_one_after_another_and_agree() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "robot 1 chooses", |team| stages(team)[0] == Stage::Announced);
    assert_eq!(stages(&team)[1..], [Stage::Deciding, Stage::Deciding]);
    fly_until(&mut team, "robot 2 chooses", |team| stages(team)[1] == Stage::Announced);
    assert_eq!(stages(&team)[2], Stage::Deciding);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    let goals: Vec<_> = team.reports().iter().map(|report| report.goal.expect("a goal").0).collect();
    let lengths: Vec<_> = team.reports().iter().map(|report| report.path.len()).collect();
    assert!(lengths.iter().all(|&length| length == lengths[0]), "they arrive together: {lengths:?}");
    assert_eq!(
        goals.iter().collect::<std::collections::BTreeSet<_>>().len(),
        3,
        "at different goals: {goals:?}"
    );
    assert_eq!(cells(&team), [28, 2, 45], "nobody moves before all agree");
}

#[test]
fn line_2_a_controller_is_running_until_it_has_arrived() {
    let mission = factory();
    let outcome = judge::fly(&mut team(&mission), 100);
    assert!(outcome.arrived.is_some_and(|tick| tick > 10), "{outcome:?}");
}

#[test]
fn line_5_observes_obstacles_and_passes_them_on() {
    let mission = factory();
    let mut team = team(&mission);
    team.cause(EventEffect::Block(Cell(21))); // next to robot 1 only
    for _ in 0..3 {
        team.tick();
    }
    assert!(team.robots().all(|robot| robot.robot().navigation().hazards() == [Cell(21)]));
}

#[test]
fn lines_17_to_30_an_obstacle_on_the_way_is_avoided_by_another_joint_plan() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    let second = report(&team, 1);
    let blocked = second.path.cell_at(&mission.map, second.path.len() - 2);
    team.cause(EventEffect::Block(blocked));
    fly_until(&mut team, "a new round", |team| team.reports().iter().all(|report| report.round > Round(0)));
    fly_until(&mut team, "all agree again", |team| all(team, Stage::Agreed));
    for (robot, report) in team.robots().zip(team.reports()) {
        let path = report.path;
        assert!(path.cells(&mission.map).all(|cell| cell != blocked), "{path:?} avoids {blocked:?}");
        assert!(!robot.robot().navigation().logic(NavigationPlan::Follow).is(OBSTACLE));
    }
    fly_until(&mut team, "all arrive", |team| all(team, Stage::Arrived));
}

#[test]
fn lines_18_and_33_the_raise_avoids_the_obstacle_and_leaves_no_trace() {
    let mission = factory();
    let mut team = team(&mission);
    let before: Vec<u32> = preference(&team);
    let shortest = [Cell(29), Cell(21)]; // both ways out of the corner but one
    shortest.into_iter().for_each(|cell| team.cause(EventEffect::Block(cell)));
    fly_until(&mut team, "robot 1 chooses", |team| stages(team)[0] == Stage::Announced);
    let path = report(&team, 0).path;
    assert!(path.cells(&mission.map).all(|cell| !shortest.contains(&cell)), "{path:?}");
    assert_eq!(preference(&team), before, "C is what it was, to the last bit");
}

fn preference(team: &Team<'_>) -> Vec<u32> {
    team.robot(0).robot().preference().values().map(f32::to_bits).to_vec()
}

#[test]
fn lines_26_to_28_a_robot_that_is_walled_in_fails_at_the_timeout() {
    let mut map = Map::new(7, 7).expect("49 cells fit two words");
    assert!([Cell(41), Cell(47)].iter().all(|&cell| map.block(cell)), "the neighbours of the corner 48");
    static STARTS: [Cell; 2] = [Cell(48), Cell(0)];
    static GOALS: [Cell; 2] = [Cell(24), Cell(26)];
    let mission = Mission::new(map, &STARTS, &GOALS);
    let mut team = team(&mission);
    let failed = (0..400).any(|_| {
        team.tick();
        team.statuses()[0] == Status::Failure
    });
    assert!(failed, "robot 1 fails; {:?}", stages(&team));
    assert_eq!(cells(&team)[0], 48);
}

#[test]
fn lines_31_to_36_the_team_waits_for_a_robot_that_is_silent_and_goes_on_when_it_is_back() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    team.tick();
    team.silence(2, true);
    for _ in 0..20 {
        team.tick();
    }
    let standing = cells(&team);
    for _ in 0..20 {
        team.tick();
    }
    assert_eq!(cells(&team), standing, "nobody moves without the third robot");
    team.silence(2, false);
    fly_until(&mut team, "all arrive", |team| all(team, Stage::Arrived));
}

#[test]
fn a_low_battery_takes_a_robot_out_of_the_team_until_it_is_charged() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    team.set_charge(0, 10);
    fly_until(&mut team, "robot 1 is away", |team| stages(team)[0] == Stage::Away);
    for _ in 0..5 {
        team.tick();
    }
    let standing = cells(&team);
    for _ in 0..20 {
        team.tick();
    }
    assert_eq!(cells(&team), standing, "the others wait");
    team.set_charge(0, 50);
    team.tick();
    assert_eq!(stages(&team)[0], Stage::Away, "half full is not full");
    team.set_charge(0, 95);
    fly_until(&mut team, "all arrive", |team| all(team, Stage::Arrived));
}

#[test]
fn lines_37_and_38_all_stop_in_the_same_tick_and_stay_stopped() {
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
    assert!(arrivals[0].is_some() && arrivals.iter().all(|&arrival| arrival == arrivals[0]), "{arrivals:?}");
    assert!(team.statuses().iter().all(|&status| status == Status::Success));
}

#[test]
fn a_robot_that_is_unsure_where_it_is_stands_still() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    let standing = team.cells()[0];
    for tick in 0..12 {
        // Its readings jump about.
        team.set_reading(0, Reading::Cell(Cell(if tick % 2 == 0 { 6 } else { 42 })));
        team.tick();
    }
    assert_eq!(team.cells()[0], standing);
    team.set_reading(0, Reading::Drawn);
    fly_until(&mut team, "all arrive", |team| all(team, Stage::Arrived));
}

#[test]
fn a_robot_put_elsewhere_finds_out_and_the_team_decides_again() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    team.place(0, Cell(42));
    fly_until(&mut team, "a new round", |team| report(team, 0).round > Round(0));
    assert_eq!(report(&team, 0).path.start, team.cells()[0]);
    fly_until(&mut team, "all arrive", |team| all(team, Stage::Arrived));
}

#[test]
fn robots_that_stand_on_their_goals_stop_at_once() {
    for count in 1..=3 {
        let mission = Mission::new(reproduce::map(), &GOALS[..count], &GOALS);
        let mut team = team(&mission);
        fly_until(&mut team, "all stop", |team| stopped(team, count));
        for _ in 0..5 {
            team.tick();
            assert!(stopped(&team, count), "they stay stopped");
        }
    }
}

fn stopped(team: &Team<'_>, count: usize) -> bool {
    team.statuses() == vec![Status::Success; count]
}

#[test]
fn a_robot_that_restarts_on_its_goal_finds_out_that_it_has_arrived() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all stop", |team| stopped(team, 3));
    let goals = cells(&team);
    team.restart(1).expect("a sound mission");
    team.tick();
    assert!(!stopped(&team, 3));
    fly_until(&mut team, "all stop again", |team| stopped(team, 3));
    assert_eq!(cells(&team), goals);
}

#[test]
fn any_number_of_goals_serves_a_team() {
    static FAR: [Cell; 4] = [Cell(24), Cell(26), Cell(32), Cell(0)];
    for (robots, goals) in [(1, 1), (1, 4), (2, 4), (3, 4)] {
        let mission = Mission::new(reproduce::map(), &STARTS[..robots], &FAR[..goals]);
        let outcome = judge::fly(&mut team(&mission), 200);
        assert!(outcome.arrived.is_some() && outcome.collisions == 0, "{robots}, {goals}: {outcome:?}");
    }
}

#[test]
fn the_robot_that_is_left_without_a_goal_fails_and_the_others_arrive() {
    let mission = Mission::new(reproduce::map(), &STARTS, &GOALS[..2]);
    let mut team = team(&mission);
    fly_until(&mut team, "two arrive", |team| {
        stages(team).iter().filter(|&&stage| stage == Stage::Arrived).count() == 2
    });
    fly_until(&mut team, "the third fails", |team| team.statuses().contains(&Status::Failure));
}

#[test]
fn eight_robots_arrive_together() {
    static STARTS: [Cell; 8] = [Cell(0), Cell(2), Cell(4), Cell(6), Cell(42), Cell(44), Cell(46), Cell(48)];
    static GOALS: [Cell; 8] =
        [Cell(15), Cell(16), Cell(17), Cell(18), Cell(29), Cell(30), Cell(31), Cell(32)];
    let mission = Mission::new(Map::new(7, 7).expect("49 cells fit two words"), &STARTS, &GOALS);
    let outcome = judge::fly(&mut team(&mission), 400);
    assert!(outcome.arrived.is_some() && outcome.collisions == 0, "{outcome:?}");
}

/// The localiser is silent just when a move fails: nothing says that the robot has moved.
#[test]
fn a_move_that_nothing_confirms_is_not_announced() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    team.set_slip(0, 1.0);
    team.set_reading(0, Reading::Nothing);
    for _ in 0..10 {
        team.tick();
        assert_eq!(report(&team, 0).step, 0);
    }
    team.set_slip(0, 0.0);
    team.set_reading(0, Reading::Drawn);
    fly_until(&mut team, "all arrive", |team| all(team, Stage::Arrived));
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
    fly_until(&mut team, "all arrive", |team| all(team, Stage::Arrived));
    assert_eq!(report(&team, 0).round, Round(0), "no other plan was needed");
}

#[test]
fn nobody_plans_with_a_teammate_that_speaks_of_another_map() {
    let mission = factory();
    let mut team = team(&mission);
    team.silence(2, true);
    for tick in 0..20 {
        let mut message = team.robot(2).robot().navigation().intention();
        message.path.start = Cell(900);
        let stamp = Stamp { epoch: 9, sequence: tick };
        overhear(&mut team, &mission, &Said { sender: RobotId(2), stamp, message });
        team.tick();
    }
    assert_eq!(team.robot(0).link_report().received.foreign, 20, "it was heard and refused");
    assert!(all(&team, Stage::Deciding));
}

#[test]
fn a_robot_that_restarts_where_it_began_has_the_team_decide_again() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    assert_eq!(cells(&team)[2], STARTS[2].0);
    team.restart(2).expect("a sound mission");
    fly_until(&mut team, "a new round", |team| report(team, 2).round > Round(0));
    fly_until(&mut team, "all arrive", |team| all(team, Stage::Arrived));
}

/// Whether the cells a robot stood in, tick by tick, pass over these in their order.
fn passed(cells: &[u16], points: &[u16]) -> bool {
    let mut left = cells.iter();
    points.iter().all(|point| left.any(|cell| cell == point))
}

/// Flies until all have stopped; returns the cells of every robot, tick by tick.
fn fly_to_the_end(team: &mut Team<'_>, robots: usize) -> Vec<Vec<u16>> {
    let mut tracks = vec![vec![]; robots];
    fly_until_and(team, "all stop", |team| {
        for (track, cell) in tracks.iter_mut().zip(cells(team)) {
            track.push(cell);
        }
        stopped(team, robots)
    });
    tracks
}

fn fly_until_and(team: &mut Team<'_>, what: &str, mut reached: impl FnMut(&Team<'_>) -> bool) {
    for _ in 0..600 {
        team.tick();
        if reached(team) {
            return;
        }
    }
    panic!("never: {what}; {:?} on {:?}", stages(team), cells(team));
}

#[test]
fn a_robot_on_its_way_visits_its_way_points_in_order_and_the_team_arrives_together() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    let before = preference(&team);
    team.robot_mut(0).robot_mut().navigation_mut().visit(Cell(42)).expect("it is free");
    team.robot_mut(0).robot_mut().navigation_mut().visit(Cell(4)).expect("it is free");
    fly_until(&mut team, "all agree again", |team| {
        all(team, Stage::Agreed) && report(team, 0).round > Round(0)
    });
    assert_eq!(report(&team, 0).cause, Some(Cause::WayPoint));
    let lengths: Vec<_> = team.reports().iter().map(|report| report.path.len()).collect();
    assert!(lengths.iter().all(|&length| length == lengths[0]), "they arrive together: {lengths:?}");
    let tracks = fly_to_the_end(&mut team, 3);
    assert!(passed(&tracks[0], &[42, 4]), "{:?}", tracks[0]);
    assert!(team.robot(0).robot().navigation().waypoints().is_empty());
    assert_eq!(preference(&team), before, "C is what it was, to the last bit");
}

#[test]
fn two_robots_with_way_points_of_their_own_come_to_one_plan_within_a_round_each() {
    for (loss, rounds) in [(0.0, 8), (0.3, 8)] {
        for seed in 0..20 {
            let mission = factory();
            let mut team = lossy(&mission, loss, seed);
            fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
            team.robot_mut(0).robot_mut().navigation_mut().visit(Cell(4)).expect("it is free");
            team.robot_mut(2).robot_mut().navigation_mut().visit(Cell(42)).expect("it is free");
            fly_until(&mut team, "all agree again", |team| {
                all(team, Stage::Agreed) && report(team, 0).round > Round(0)
            });
            let round = report(&team, 0).round;
            assert!(round <= Round(rounds), "loss {loss}, seed {seed}: {round:?}");
            let tracks = fly_to_the_end(&mut team, 3);
            assert!(passed(&tracks[0], &[4]) && passed(&tracks[2], &[42]), "loss {loss}, seed {seed}");
        }
    }
}

#[test]
fn a_robot_that_has_arrived_sets_out_again_for_a_way_point() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all stop", |team| stopped(team, 3));
    team.robot_mut(1).robot_mut().navigation_mut().visit(Cell(0)).expect("it is free");
    let tracks = fly_to_the_end(&mut team, 3);
    assert!(passed(&tracks[1], &[0]));
}

/// The factory with the paper's chargers.
fn with_chargers() -> Mission<'static, 2> {
    static CHARGERS: [Option<Cell>; 3] = [Some(Cell(13)), Some(Cell(27)), Some(Cell(41))];
    Mission { chargers: &CHARGERS, ..factory() }
}

#[test]
fn a_robot_with_a_low_battery_drives_to_its_charger_while_the_others_stand_and_then_all_decide_anew() {
    let mission = with_chargers();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    team.set_charge(0, 10);
    fly_until(&mut team, "robot 1 has left", |team| report(team, 0).cause == Some(Cause::Battery));
    fly_until(&mut team, "robot 1 moves", |team| team.cells()[0] != Cell(28));
    let (left, standing) = (report(&team, 0).round, cells(&team)[1..].to_vec());
    fly_until(&mut team, "robot 1 is on its charger", |team| {
        assert_eq!(cells(team)[1..], standing, "the others wait");
        assert_eq!(stages(team)[0], Stage::Away);
        team.cells()[0] == Cell(13)
    });
    fly_until(&mut team, "all decide anew", |team| all(team, Stage::Agreed));
    assert!(report(&team, 0).round > left);
    assert_eq!(report(&team, 0).cause, Some(Cause::Charged));
    assert_eq!((cells(&team)[0], cells(&team)[1..].to_vec()), (13, standing));
    fly_until(&mut team, "all stop", |team| stopped(team, 3));
}

#[test]
fn robots_that_are_low_at_once_charge_one_after_another() {
    let mission = with_chargers();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    (0..3).for_each(|robot| team.set_charge(robot, 10));
    let mut before = cells(&team);
    for _ in 0..150 {
        team.tick();
        let now = cells(&team);
        let moved = now.iter().zip(&before).filter(|(now, before)| now != before).count();
        let charged = (0..3).all(|robot| team.charge(robot) >= 90);
        assert!(moved <= 1 || charged, "one drives at a time: {before:?} {now:?}");
        before = now;
    }
    fly_until(&mut team, "all stop", |team| stopped(team, 3));
}

/// Nothing leads to the charger in the corner 6 but cells that have become blocked.
#[test]
fn a_robot_without_a_way_to_its_charger_stands_with_its_leaf_running_and_the_team_waits() {
    static CHARGERS: [Option<Cell>; 1] = [Some(Cell(6))];
    let mission = Mission { chargers: &CHARGERS, ..factory() };
    let mut team = team(&mission);
    [5, 13].into_iter().for_each(|cell| team.cause(EventEffect::Block(Cell(cell))));
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    team.set_charge(0, 10);
    for _ in 0..100 {
        team.tick();
    }
    let (standing, rounds) = (cells(&team), report(&team, 0).round);
    for _ in 0..50 {
        team.tick();
        assert_eq!(cells(&team), standing);
        assert_eq!(team.robot(0).robot().activity(), Some("Recharge"));
        assert_eq!(team.statuses()[0], Status::Running);
    }
    assert_eq!(report(&team, 0).round, rounds, "it does not call round after round");
    team.set_charge(0, 95);
    fly_until(&mut team, "all stop", |team| stopped(team, 3));
}

/// A corridor with the charger at its closed end, where a teammate stands.
#[test]
fn a_teammate_that_stands_in_the_way_to_a_charger_steps_aside() {
    let mut map = Map::new(7, 7).expect("49 cells fit two words");
    assert!((7..=12).all(|cell| map.block(Cell(cell))), "a wall below the first row");
    static STARTS: [Cell; 2] = [Cell(28), Cell(2)];
    static GOALS: [Cell; 2] = [Cell(24), Cell(26)];
    static CHARGERS: [Option<Cell>; 1] = [Some(Cell(0))];
    let mission = Mission { chargers: &CHARGERS, ..Mission::new(map, &STARTS, &GOALS) };
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Stage::Agreed));
    team.set_charge(0, 10);
    fly_until(&mut team, "robot 2 steps aside", |team| report(team, 1).cause == Some(Cause::Room));
    fly_until(&mut team, "robot 1 is on its charger", |team| team.cells()[0] == Cell(0));
    fly_until(&mut team, "all stop", |team| stopped(team, 2));
}
