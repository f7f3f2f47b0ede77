//! The lines of Algorithm 1 on real robots: what makes a team decide, wait, decide again, stop and fail.

use host_sim::reproduce;
use iibt_core::grid::{Cell, Map};
use iibt_core::iibt::Mission;
use iibt_core::iibt::navigation::{OBSTACLE, Plan};
use iibt_core::team::{Round, Status};
use tests::team::{Hardship, Team};

static STARTS: [Cell; 3] = [Cell(28), Cell(2), Cell(45)];
static GOALS: [Cell; 3] = [Cell(24), Cell(26), Cell(32)];

fn factory() -> Mission<'static, 2> {
    Mission::new(reproduce::map(), &STARTS, &GOALS)
}

fn team<'m>(mission: &'m Mission<'m, 2>) -> Team<'m> {
    Team::new(mission, Hardship::default(), 1)
}

fn statuses(team: &Team<'_>) -> Vec<Status> {
    team.robots.iter().map(|robot| robot.report().status).collect()
}

fn cells(team: &Team<'_>) -> Vec<u16> {
    team.robots.iter().map(|robot| robot.hardware().cell.0).collect()
}

fn fly_until(team: &mut Team<'_>, what: &str, reached: impl Fn(&Team<'_>) -> bool) {
    for _ in 0..200 {
        if reached(team) {
            return;
        }
        team.tick();
    }
    panic!("never: {what}; {:?} on {:?}", statuses(team), cells(team));
}

fn all(team: &Team<'_>, status: Status) -> bool {
    statuses(team).iter().all(|&now| now == status)
}

#[test]
fn the_robots_decide_one_after_another_and_agree() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "robot 1 chooses", |team| statuses(team)[0] == Status::Announced);
    assert_eq!(statuses(&team)[1..], [Status::Deciding, Status::Deciding]);
    fly_until(&mut team, "robot 2 chooses", |team| statuses(team)[1] == Status::Announced);
    assert_eq!(statuses(&team)[2], Status::Deciding);
    fly_until(&mut team, "all agree", |team| all(team, Status::Agreed));
    let goals: Vec<_> = team.robots.iter().map(|robot| robot.report().goal.expect("a goal").0).collect();
    let lengths: Vec<_> = team.robots.iter().map(|robot| robot.report().path.len()).collect();
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
    let outcome = team(&mission).fly(100);
    assert!(outcome.arrived.is_some_and(|tick| tick > 10), "{outcome:?}");
}

#[test]
fn line_5_observes_obstacles_and_passes_them_on() {
    let mission = factory();
    let mut team = team(&mission);
    team.map.block(Cell(21)); // next to robot 1 only
    for _ in 0..3 {
        team.tick();
    }
    assert!(team.robots.iter().all(|robot| robot.navigation().hazards() == [Cell(21)]));
}

#[test]
fn lines_17_to_30_an_obstacle_on_the_way_is_avoided_by_another_joint_plan() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Status::Agreed));
    let report = team.robots[1].report();
    let blocked = report.path.cell_at(&mission.map, report.path.len() - 2);
    team.map.block(blocked);
    fly_until(&mut team, "a new round", |team| {
        team.robots.iter().all(|robot| robot.report().round > Round(0))
    });
    fly_until(&mut team, "all agree again", |team| all(team, Status::Agreed));
    for robot in &team.robots {
        let path = robot.report().path;
        assert!(path.cells(&mission.map).all(|cell| cell != blocked), "{path:?} avoids {blocked:?}");
        assert!(!robot.navigation().logic(Plan::Follow).is(OBSTACLE));
    }
    fly_until(&mut team, "all arrive", |team| all(team, Status::Arrived));
}

#[test]
fn lines_18_and_33_the_raise_avoids_the_obstacle_and_leaves_no_trace() {
    let mission = factory();
    let mut team = team(&mission);
    let before: Vec<u32> = preference(&team);
    let shortest = [Cell(29), Cell(21)]; // both ways out of the corner but one
    assert!(shortest.iter().all(|&cell| team.map.block(cell)));
    fly_until(&mut team, "robot 1 chooses", |team| statuses(team)[0] == Status::Announced);
    let path = team.robots[0].report().path;
    assert!(path.cells(&mission.map).all(|cell| !shortest.contains(&cell)), "{path:?}");
    assert_eq!(preference(&team), before, "C is what it was, to the last bit");
}

fn preference(team: &Team<'_>) -> Vec<u32> {
    (0..49).map(|cell| team.robots[0].navigation().preference().get(cell).to_bits()).collect()
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
        team.last_statuses()[0] == iibt_core::tree::Status::Failure
    });
    assert!(failed, "robot 1 fails; {:?}", statuses(&team));
    assert_eq!(cells(&team)[0], 48);
}

#[test]
fn lines_31_to_36_the_team_waits_for_a_robot_that_is_silent_and_goes_on_when_it_is_back() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Status::Agreed));
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
    fly_until(&mut team, "all arrive", |team| all(team, Status::Arrived));
}

#[test]
fn a_low_battery_takes_a_robot_out_of_the_team_until_it_is_charged() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Status::Agreed));
    team.robots[0].hardware_mut().charge = 10;
    fly_until(&mut team, "robot 1 is away", |team| statuses(team)[0] == Status::Away);
    for _ in 0..5 {
        team.tick();
    }
    let standing = cells(&team);
    for _ in 0..20 {
        team.tick();
    }
    assert_eq!(cells(&team), standing, "the others wait");
    team.robots[0].hardware_mut().charge = 50;
    team.tick();
    assert_eq!(statuses(&team)[0], Status::Away, "half full is not full");
    team.robots[0].hardware_mut().charge = 95;
    fly_until(&mut team, "all arrive", |team| all(team, Status::Arrived));
}

#[test]
fn lines_37_and_38_all_stop_in_the_same_tick_and_stay_stopped() {
    let mission = factory();
    let mut team = team(&mission);
    let mut arrivals = vec![None; 3];
    for tick in 0..60 {
        team.tick();
        for (arrival, status) in arrivals.iter_mut().zip(team.last_statuses()) {
            if status == iibt_core::tree::Status::Success {
                arrival.get_or_insert(tick);
            }
        }
    }
    assert!(arrivals[0].is_some() && arrivals.iter().all(|&arrival| arrival == arrivals[0]), "{arrivals:?}");
    assert!(team.last_statuses().iter().all(|&status| status == iibt_core::tree::Status::Success));
}

#[test]
fn a_robot_that_is_unsure_where_it_is_stands_still() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Status::Agreed));
    let standing = team.robots[0].hardware().cell;
    for tick in 0..12 {
        // Its readings jump about.
        team.misread(0, Some(Cell(if tick % 2 == 0 { 6 } else { 42 })));
        team.tick();
    }
    assert_eq!(team.robots[0].hardware().cell, standing);
    team.misread(0, None);
    fly_until(&mut team, "all arrive", |team| all(team, Status::Arrived));
}

#[test]
fn a_robot_put_elsewhere_finds_out_and_the_team_decides_again() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Status::Agreed));
    team.robots[0].hardware_mut().cell = Cell(42);
    fly_until(&mut team, "a new round", |team| team.robots[0].report().round > Round(0));
    assert_eq!(team.robots[0].report().path.start, team.robots[0].hardware().cell);
    fly_until(&mut team, "all arrive", |team| all(team, Status::Arrived));
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
    team.last_statuses() == vec![iibt_core::tree::Status::Success; count]
}

#[test]
fn a_robot_that_restarts_on_its_goal_finds_out_that_it_has_arrived() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all stop", |team| stopped(team, 3));
    let goals = cells(&team);
    team.restart(1);
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
        let outcome = team(&mission).fly(200);
        assert!(outcome.arrived.is_some() && outcome.collisions == 0, "{robots}, {goals}: {outcome:?}");
    }
}

#[test]
fn the_robot_that_is_left_without_a_goal_fails_and_the_others_arrive() {
    let mission = Mission::new(reproduce::map(), &STARTS, &GOALS[..2]);
    let mut team = team(&mission);
    fly_until(&mut team, "two arrive", |team| {
        statuses(team).iter().filter(|&&status| status == Status::Arrived).count() == 2
    });
    fly_until(&mut team, "the third fails", |team| {
        team.last_statuses().contains(&iibt_core::tree::Status::Failure)
    });
}

#[test]
fn eight_robots_arrive_together() {
    static STARTS: [Cell; 8] = [Cell(0), Cell(2), Cell(4), Cell(6), Cell(42), Cell(44), Cell(46), Cell(48)];
    static GOALS: [Cell; 8] =
        [Cell(15), Cell(16), Cell(17), Cell(18), Cell(29), Cell(30), Cell(31), Cell(32)];
    let mission = Mission::new(Map::new(7, 7).expect("49 cells fit two words"), &STARTS, &GOALS);
    let outcome = team(&mission).fly(400);
    assert!(outcome.arrived.is_some() && outcome.collisions == 0, "{outcome:?}");
}

/// The localiser is silent just when a move fails: nothing says that the robot has moved.
#[test]
fn a_move_that_nothing_confirms_is_not_announced() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Status::Agreed));
    let body = team.robots[0].hardware_mut();
    (body.stuck, body.blind) = (true, true);
    for _ in 0..10 {
        team.tick();
        assert_eq!(team.robots[0].report().step, 0);
    }
    team.robots[0].hardware_mut().stuck = false;
    team.robots[0].hardware_mut().blind = false;
    fly_until(&mut team, "all arrive", |team| all(team, Status::Arrived));
}

/// A localiser that lags makes a move look as if it had failed; made once more it would lead off the path.
#[test]
fn one_late_reading_does_not_have_a_move_made_twice() {
    let mission = factory();
    let mut team = team(&mission);
    let start = STARTS[0];
    fly_until(&mut team, "robot 1 moves", |team| team.robots[0].hardware().cell != start);
    let moved = team.robots[0].hardware().cell;
    team.misread(0, Some(start));
    team.tick();
    team.misread(0, None);
    assert_eq!(team.robots[0].hardware().cell, moved);
    fly_until(&mut team, "all arrive", |team| all(team, Status::Arrived));
    assert_eq!(team.robots[0].report().round, Round(0), "no other plan was needed");
}

#[test]
fn nobody_plans_with_a_teammate_that_speaks_of_another_map() {
    let mission = factory();
    let mut team = team(&mission);
    team.silence(2, true);
    for tick in 0..20 {
        let mut odd = team.robots[2].navigation().intention();
        (odd.epoch, odd.sequence, odd.path.start) = (9, tick, Cell(900));
        team.overhear(&odd);
        team.tick();
    }
    assert!(team.robots[0].report().received.accepted > 20, "it was heard");
    assert!(all(&team, Status::Deciding));
}

#[test]
fn a_robot_that_restarts_where_it_began_has_the_team_decide_again() {
    let mission = factory();
    let mut team = team(&mission);
    fly_until(&mut team, "all agree", |team| all(team, Status::Agreed));
    assert_eq!(cells(&team)[2], STARTS[2].0);
    team.restart(2);
    fly_until(&mut team, "a new round", |team| team.robots[2].report().round > Round(0));
    fly_until(&mut team, "all arrive", |team| all(team, Status::Arrived));
}
