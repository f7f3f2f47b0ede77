use super::*;

#[test]
fn every_built_in_one_is_accomplished() {
    for name in library::names() {
        let scenario = built_in(name);
        let record = flown(&scenario, 0, 0.0);
        // The last move of a slow robot takes it longer than the others.
        let is_even = scenario.robots.iter().all(|robot| robot.pace == 1);
        assert!(record.outcome.is_success(), "{name}: {:?}", record.outcome);
        assert!(!is_even || record.outcome == Outcome::Together, "{name}: {}", record.spread());
        assert_eq!((record.collisions.total(), record.frames.lost), (0, 0), "{name}");
    }
}

#[test]
fn the_factory_s_robots_reach_three_goals_together() {
    let record = flown(&built_in("factory"), 0, 0.0);
    let ends: BTreeSet<_> = record.robots.iter().map(|robot| robot.cell.0).collect();
    assert_eq!(ends, BTreeSet::from([24, 26, 32]));
    assert!(record.robots.iter().all(|robot| robot.goal == Some(robot.cell)));
    assert!(record.outcome == Outcome::Together && record.spread() <= 1, "{:?}", record.outcome);
    let (tick, cell) = appeared(&record).expect("there is an obstacle");
    let after_obstacle = record.history.iter().skip(tick as usize).flatten();
    assert!(after_obstacle.clone().count() > 0 && after_obstacle.clone().all(|&other| other != cell));
}

/// The first obstacle that appeared.
fn appeared(record: &Record) -> Option<(u32, Cell)> {
    record.events.iter().find_map(|timed| match timed.event {
        host_sim::FlightEvent::Appeared { cell } => Some((timed.tick, cell)),
        _ => None,
    })
}

#[test]
fn the_obstacle_of_the_factory_makes_the_team_choose_again() {
    let record = flown(&built_in("factory"), 0, 0.0);
    let kinds: Vec<_> = record.events.iter().map(|timed| kind(&timed.event)).collect();
    let appeared = kinds.iter().position(|&kind| kind == "appeared").expect("there is an obstacle");
    let agreements = |kinds: &[&str]| kinds.iter().filter(|&&kind| kind == "agreed").count();
    assert_eq!((agreements(&kinds[..appeared]), agreements(&kinds[appeared..])), (1, 1), "{kinds:?}");
}

#[test]
fn the_order_of_the_robots_does_not_matter_for_success() {
    let mut scenario = built_in("factory");
    for _ in 0..scenario.robots.len() {
        scenario.robots.rotate_left(1);
        assert_eq!(flown(&scenario, 0, 0.0).outcome, Outcome::Together, "{:?}", scenario.robots);
    }
}

#[test]
fn a_robot_without_charge_stands_and_the_others_need_not_wait() {
    let mut scenario = built_in("two-goals");
    scenario.robots[1].battery = 5;
    let record = flown(&scenario, 0, 0.0);
    assert_eq!((record.outcome, record.robots[1].status), (Outcome::Unfinished, "away"));
    assert!(record.history.iter().all(|cells| cells[1] == record.history[0][1]));
    assert!(scenario.goals.contains(&record.robots[0].cell), "R1 goes on: {:?}", record.robots[0]);
}

#[test]
fn robots_on_their_goals_have_nothing_to_do() {
    let text = "title = 't'\nmap = '''\n1..\n2..\n'''\ngoals = [0, 3]";
    let scenario = Scenario::parse("there", text).expect("sound");
    let record = flown(&scenario, 0, 0.0);
    assert_eq!((record.outcome, record.robots[0].moves), (Outcome::NothingToDo, 0));
    assert!(summary(&record, None).contains("there: there was nothing to do"));
    let score = host_sim::campaign::Score::of(&scenario, &record);
    assert!(!score.accomplished && !score.together, "{score:?}");
}

#[test]
fn a_localiser_that_errs_once_in_a_hundred_makes_nobody_collide() {
    let mut scenario = built_in("factory");
    scenario.robots.iter_mut().for_each(|robot| robot.localiser = 0.99);
    for seed in 0..10 {
        let record = flown(&scenario, seed, 0.1);
        assert!(record.outcome.is_success(), "seed {seed}: {:?}", record.outcome);
        assert_eq!(record.collisions.total(), 0, "seed {seed}");
    }
}

#[test]
fn a_robot_that_is_never_heard_is_named_in_the_record_and_in_the_summary() {
    let record = flown(&built_in("two-goals"), 0, 1.0);
    let awaited = record.robots[0].waiting.clone().expect("it waits");
    assert_eq!(awaited.robot.as_deref(), Some("R2"));
    let line = "R1 stands on 28: waiting for R2: it was never heard, so it may be anywhere";
    assert!(summary(&record, None).contains(line), "{}", summary(&record, None));
    let told = |timed: &&host_sim::TimedEvent| matches!(timed.event, host_sim::FlightEvent::Waits { .. });
    let scenario = built_in("two-goals");
    let lines: Vec<_> = record.events.iter().filter(told).map(|timed| timed.line(&scenario)).collect();
    let told = [
        "R1 stands, waiting for R2: it was never heard, so it may be anywhere",
        "R2 stands, waiting for R1: it was never heard, so it may be anywhere",
        // Of two robots only the first may go on alone.
        "R2 stands, waiting for R1: it is lost, and the others are no quorum",
    ];
    assert_eq!(lines.len(), told.len(), "once for each reason: {lines:?}");
    assert!(lines.iter().zip(told).all(|(line, end)| line.ends_with(end)), "{lines:?}");
    let json: serde_json::Value = serde_json::from_str(&record.to_json().unwrap()).unwrap();
    assert_eq!(json["robots"][1]["waiting"]["robot"], "R1");
    assert!(flown(&scenario, 0, 0.0).robots.iter().all(|robot| robot.waiting.is_none()));
}

/// R1's way to the goals is cut off before it has made a move.
const CUT_OFF: &str = "\
title = 't'
limit = 40
map = '''
#####.
1...2G
####.G
'''
[[event]]
tick = 0
block = 7
";

#[test]
fn a_way_that_an_obstacle_cuts_off_ends_at_the_limit_and_says_who_has_none() {
    let record = flown(&Scenario::parse("cut off", CUT_OFF).unwrap(), 0, 0.0);
    assert_eq!((record.outcome, record.collisions.total()), (Outcome::Unfinished, 0));
    assert_eq!((record.ticks, record.history.len()), (39, 41));
    let summary = summary(&record, None);
    assert!(summary.contains("NOT accomplished within 40 ticks"), "{summary}");
    assert!(summary.contains("\n  R1 stands on 6: "), "{summary}");
}

#[test]
fn the_history_has_the_start_and_every_tick() {
    for (name, loss) in [("factory", 0.0), ("factory", 0.3), ("detour", 0.1), ("two-goals", 1.0)] {
        let record = flown(&built_in(name), 2, loss);
        assert_eq!(record.history.len(), record.ticks as usize + 2, "{name}");
        assert!(record.events.iter().all(|timed| timed.tick <= record.ticks), "{name}");
        assert!(record.last_arrival() <= record.ticks || !record.outcome.is_success(), "{name}");
    }
}

fn kind(event: &host_sim::FlightEvent) -> &'static str {
    match event {
        host_sim::FlightEvent::Appeared { .. } => "appeared",
        host_sim::FlightEvent::Cleared { .. } => "cleared",
        host_sim::FlightEvent::Waits { .. } => "waits",
        host_sim::FlightEvent::Found { .. } => "found",
        host_sim::FlightEvent::Chose { .. } => "chose",
        host_sim::FlightEvent::Weighed { .. } => "weighed",
        host_sim::FlightEvent::Believes { .. } => "believes",
        host_sim::FlightEvent::Agreed { .. } => "agreed",
        host_sim::FlightEvent::Arrived { .. } => "arrived",
        host_sim::FlightEvent::Collided { .. } => "collided",
        host_sim::FlightEvent::Asked { .. } => "asked",
        host_sim::FlightEvent::Refused { .. } => "refused",
        host_sim::FlightEvent::Visited { .. } => "visited",
        host_sim::FlightEvent::TookOver { .. } => "took over",
        host_sim::FlightEvent::GaveUp { .. } => "gave up",
        host_sim::FlightEvent::Obstructed { .. } => "obstructed",
        host_sim::FlightEvent::Drained { .. } => "drained",
        host_sim::FlightEvent::Left { .. } => "left",
        host_sim::FlightEvent::Returned { .. } => "returned",
        host_sim::FlightEvent::Stopped { .. } => "stopped",
        host_sim::FlightEvent::Resumed { .. } => "resumed",
        host_sim::FlightEvent::Froze { .. } => "froze",
        host_sim::FlightEvent::Thawed { .. } => "thawed",
        host_sim::FlightEvent::Restarted { .. } => "restarted",
    }
}
