//! The effects of events and drives on a team.

use super::*;
use host_sim::{FlightEvent, Observer, Snapshot};
use iibt_core::navigation::Stage;

fn factory_with(more: &str) -> Scenario {
    let text = include_str!("../../host-sim/scenarios/factory.toml");
    Scenario::parse("test", &format!("{text}{more}")).expect("sound")
}

fn kinds(record: &Record) -> Vec<u32> {
    let is_it =
        |event: &FlightEvent| matches!(event, FlightEvent::Stopped { .. } | FlightEvent::Resumed { .. });
    record.events.iter().filter(|timed| is_it(&timed.event)).map(|timed| timed.tick).collect()
}

#[test]
fn the_others_go_on_without_a_robot_that_stops_and_it_takes_part_again_when_it_goes_on() {
    let stop = "[[event]]\ntick = 4\nwho = 'R2'\nstop = true\n";
    let record = flown(&factory_with(&format!("{stop}for = 60\n")), 0, 0.0);
    assert!(record.outcome.is_success() && record.collisions.total() == 0, "{:?}", record.outcome);
    assert_eq!(kinds(&record), [4, 64]);
    assert!(record.ticks > 64 && !record.robots[1].stopped);
    let record = flown(&factory_with(stop), 0, 0.0);
    assert!(record.outcome.is_success() && record.robots[1].stopped, "{:?}", record.outcome);
    let goals = [0, 2].map(|robot: usize| record.robots[robot].cell);
    assert!(goals.iter().all(|cell| record.goals.contains(cell)), "{goals:?}");
    assert!(record.ticks < 64, "they need not wait for it");
}

const TWO: &str = "title = 't'\nlimit = 80\nmap = '''\n1.........G\n...........\n2.........G\n'''\n";

#[test]
fn a_team_of_two_waits_for_a_robot_that_stops_and_says_so() {
    let stop = |robot: &str| format!("{TWO}[[event]]\ntick = 4\nwho = '{robot}'\nstop = true\n");
    let record = flown(&Scenario::parse("t", &stop("R1")).expect("sound"), 0, 0.0);
    assert_eq!(record.outcome, Outcome::Unfinished, "R2 alone is no quorum");
    let told = summary(&record, None);
    assert!(told.contains("R1 stands on") && told.contains("it has stopped"), "{told}");
    assert!(told.contains("waiting for R1: it is lost, and the others are no quorum"), "{told}");
    assert!(flown(&Scenario::parse("t", &stop("R2")).expect("sound"), 0, 0.0).outcome.is_success());
}

#[test]
fn a_team_that_is_short_of_a_goal_on_which_a_dead_robot_may_be_says_so() {
    let text = include_str!("../../host-sim/scenarios/factory.toml");
    let (head, _) = text.split_once("[[event]]").expect("an event");
    let text = head.replace("[24, 26, 32]", "[4, 48]").replace("start = 45", "start = 3");
    let stop = "[[event]]\ntick = 3\nwho = 'R3'\nstop = true\n";
    let record = flown(&Scenario::parse("t", &format!("{text}{stop}")).expect("sound"), 0, 0.0);
    assert_eq!(record.outcome, Outcome::Unfinished);
    let told = summary(&record, None);
    let line = "the plan is 1 goal short: R3 may be on what is closed to the others";
    assert!(told.contains(line), "{told}");
}

#[test]
fn a_robot_that_was_left_out_counts_for_nothing_in_the_outcome() {
    let map = "title = 't'\nmap = '''\n1.....G\n2.....G\n3.....G\n.......\n'''\n";
    let stop = "[[event]]\ntick = 4\nwho = 'R2'\nstop = true\n";
    let record = flown(&Scenario::parse("t", &format!("{map}{stop}")).expect("sound"), 0, 0.0);
    assert_eq!(record.outcome, Outcome::Together);
    assert_eq!([0, 1, 2].map(|robot: usize| record.robots[robot].member), [true, false, true]);
    let told = summary(&record, None);
    assert!(told.contains("2 of 3 robots arrived together, at most 1 tick apart"), "{told}");
}

#[test]
fn an_obstacle_that_is_taken_away_is_no_longer_in_the_way() {
    let text = |more: &str| {
        let map = "title = 't'\nlimit = 150\nforget = 1\nmap = '''\n1...\n###.\nG...\n'''\n";
        Scenario::parse("t", &format!("{map}[[event]]\ntick = 0\nblock = 7\n{more}")).expect("sound")
    };
    assert_eq!(flown(&text(""), 0, 0.0).outcome, Outcome::Unfinished);
    let record = flown(&text("[[event]]\ntick = 20\nclear = 7"), 0, 0.0);
    let cleared = |timed: &&host_sim::TimedEvent| timed.event == FlightEvent::Cleared { cell: Cell(7) };
    assert_eq!(record.events.iter().find(cleared).map(|timed| timed.tick), Some(20));
    assert_eq!((record.outcome, record.robots[0].cell), (Outcome::Together, Cell(8)));
}

#[test]
fn as_many_goals_as_needed_are_reached_and_owned_ones_by_their_owner() {
    let text = "title = 't'\nneed = 1\nmap = '''\n1.....G\n.......\n2.....G\n'''";
    let record = flown(&Scenario::parse("t", text).expect("sound"), 0, 0.0);
    let held = record.robots.iter().filter(|robot| record.goals.contains(&robot.cell)).count();
    assert!(record.outcome.is_success() && held >= 1, "{:?}", record.outcome);
    let map = "title = 't'\nmap = '''\n1......\n.......\n2......\n'''\n";
    let crossed = format!("{map}[[robot]]\ngoal = 20\n[[robot]]\ngoal = 6");
    let record = flown(&Scenario::parse("t", &crossed).expect("sound"), 0, 0.0);
    assert!(record.outcome.is_success(), "{:?}", record.outcome);
    assert_eq!([0, 1].map(|robot: usize| record.robots[robot].cell), [20, 6].map(Cell));
}

#[test]
fn moves_that_slip_cost_time_and_nothing_else() {
    let (usual, slippery) = (factory_with(""), "[[robot]]\nslip = 0.4\n".repeat(3));
    assert_eq!(usual.robots[0].slip, 0.0);
    let drawn = format!("title = 't'\nmap = '''\n1.....G\n2.....G\n3.....G\n'''\n{slippery}");
    let own = Scenario::parse("own", &drawn).expect("sound");
    let all = Scenario::parse("all", &drawn.replace(&slippery, "slip = 0.4")).expect("sound");
    assert_eq!(own.robots[0].slip, all.robots[2].slip);
    let record = flown(&own, 1, 0.0);
    assert_eq!((record.outcome, record.collisions.total()), (Outcome::Together, 0));
    assert_eq!(record.events, flown(&all, 1, 0.0).events);
    let sure = Scenario::parse("sure", &drawn.replace(&slippery, "")).expect("sound");
    assert!(record.ticks > flown(&sure, 1, 0.0).ticks);
}

/// 1 percent a move: six moves to the charger are possible with 15, and 94 are not.
#[test]
fn a_battery_that_drains_is_charged_in_time() {
    let text = |battery: u8| {
        format!(
            "title = 't'\nmap = '''\n1.....G\n.......\n'''\n[[robot]]\ncharger = 13\nbattery = {battery}\ndrain = 1.0\n"
        )
    };
    let record = flown(&Scenario::parse("t", &text(23)).expect("sound"), 0, 0.0);
    assert_eq!((record.outcome, record.robots[0].charged), (Outcome::Together, 1));
    assert!(record.history.iter().any(|cells| cells[0] == Cell(13)));
    let record = flown(&Scenario::parse("t", &text(3)).expect("sound"), 0, 0.0);
    assert_eq!(
        (record.outcome, record.robots[0].battery, record.robots[0].moves),
        (Outcome::Unfinished, 0, 3)
    );
}

#[test]
fn a_way_point_that_an_obstacle_has_taken_is_refused() {
    let more = "[[event]]\nrobot = 'R1'\nat = 29\nwho = 'R1'\nvisit = 22\n";
    let blocked = format!("[[event]]\ntick = 0\nblock = 22\n{more}");
    let refused = |record: &Record| {
        record.events.iter().any(|timed| matches!(timed.event, FlightEvent::Refused { robot: 0, .. }))
    };
    let record = flown(&factory_with(&blocked), 0, 0.0);
    assert!(refused(&record) && record.outcome == Outcome::Together);
    let record = flown(&factory_with(more), 0, 0.0);
    assert!(!refused(&record) && record.robots[0].visited == [Cell(22)]);
}

/// R1 is to visit a cell on which an obstacle appears before it gets there.
fn obstructed_errand(settings: &str, more: &str) -> Record {
    let map = "title = 't'\nlimit = 300\nmap = '''\n1.....G\n.......\n.......\n'''\n";
    let errand = "[[event]]\ntick = 0\nwho = 'R1'\nvisit = 17\n[[event]]\ntick = 1\nblock = 17\n";
    flown(&Scenario::parse("t", &format!("{settings}{map}{errand}{more}")).expect("sound"), 0, 0.0)
}

#[test]
fn a_way_point_that_is_not_visited_because_of_an_obstacle_is_named() {
    let scenario = Scenario::parse("t", "title = 't'\nmap = '''\n1.G\n'''").expect("sound");
    let is_named = |timed: &&host_sim::TimedEvent| {
        timed.event.line(&scenario) == "R1 does not visit 17: an obstacle is on it"
    };
    let record = obstructed_errand("", "");
    assert_eq!(record.events.iter().filter(is_named).count(), 1);
    assert_eq!((record.outcome, record.robots[0].cell), (Outcome::Unfinished, Cell(6)), "it is on its goal");
    let told = summary(&record, None);
    let line = "\n  R1 stands on 6: it does not visit 17, because an obstacle is on it";
    assert!(told.contains(line), "{told}");
    // Once the obstacle is gone, and the robot takes the cell for free again.
    let record = obstructed_errand("forget = 1\n", "[[event]]\ntick = 40\nclear = 17\n");
    assert!(record.outcome.is_success(), "{:?}", record.outcome);
    assert!(record.events.iter().any(|timed| is_named(&timed)));
    assert_eq!(record.robots[0].visited, [Cell(17)]);
}

/// The ticks in which robots were stuck, and the goals that they were said to have chosen then.
#[derive(Default)]
struct Stuck {
    ticks: u32,
    chosen: u32,
}

impl Observer for Stuck {
    fn observe(&mut self, snapshot: &Snapshot<'_>) {
        let is_stuck = |robot: usize| snapshot.reports[robot].stage == Stage::Stuck;
        self.ticks += (0..snapshot.reports.len()).filter(|&robot| is_stuck(robot)).count() as u32;
        let chose =
            |event: &FlightEvent| matches!(event, FlightEvent::Chose { robot, .. } if is_stuck(*robot));
        self.chosen += snapshot.events.iter().filter(|timed| chose(&timed.event)).count() as u32;
    }
}

/// R1 is on its goal when it gets a way-point, and its localiser freezes there: it stands, and its
/// team decides without it, on a cell that it reads as its goal.
#[test]
fn a_robot_that_does_not_get_on_is_not_said_to_have_chosen_a_goal() {
    let text = "title = 't'\nlimit = 80\nmap = '''\n1.....\n......\n......\n2.....\n'''\ngoals = [0, 23]\n\
                [[event]]\ntick = 14\nwho = 'R1'\nvisit = 15\n\
                [[event]]\ntick = 15\nwho = 'R1'\nfreeze = 'localiser'\n";
    let scenario = Scenario::parse("t", text).expect("it is sound");
    let mut stuck = Stuck::default();
    fly(&scenario, Conditions::default(), &mut stuck).expect("it is sound");
    assert!(stuck.ticks > 40 && stuck.chosen == 0, "{} in {} ticks", stuck.chosen, stuck.ticks);
}
