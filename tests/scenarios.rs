//! Whole missions in the simulator: they end well, repeat exactly, and bad input is refused with a
//! reason.

use host_sim::show::summary;
use host_sim::{Conditions, Outcome, Record, Scenario, fly, library};
use iibt_core::grid::Cell;
use proptest::prelude::*;
use std::collections::BTreeSet;

fn built_in(name: &str) -> Scenario {
    library::find(name).expect("built in").expect("sound")
}

fn flown(scenario: &Scenario, seed: u64, loss: f64) -> Record {
    fly(scenario, Conditions { seed, loss: Some(loss), ..Conditions::default() }, &mut ())
        .expect("a sound scenario can be flown")
}

mod missions {
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
    fn the_factory_s_robots_reach_three_goals_in_the_same_tick() {
        let record = flown(&built_in("factory"), 0, 0.0);
        let ends: BTreeSet<_> = record.robots.iter().map(|robot| robot.cell.0).collect();
        assert_eq!(ends, BTreeSet::from([24, 26, 32]));
        assert!(record.robots.iter().all(|robot| robot.goal == Some(robot.cell)));
        assert_eq!((record.outcome, record.spread()), (Outcome::Together, 0));
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
        assert_eq!(lines.len(), 2, "once for each robot: {lines:?}");
        let line = "R1 stands, waiting for R2: it was never heard, so it may be anywhere";
        assert!(lines[0].ends_with(line), "{lines:?}");
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
            host_sim::FlightEvent::Agreed { .. } => "agreed",
            host_sim::FlightEvent::Arrived { .. } => "arrived",
            host_sim::FlightEvent::Collided { .. } => "collided",
            host_sim::FlightEvent::Asked { .. } => "asked",
            host_sim::FlightEvent::Refused { .. } => "refused",
            host_sim::FlightEvent::Visited { .. } => "visited",
            host_sim::FlightEvent::Drained { .. } => "drained",
            host_sim::FlightEvent::Left { .. } => "left",
            host_sim::FlightEvent::Returned { .. } => "returned",
            host_sim::FlightEvent::Stopped { .. } => "stopped",
            host_sim::FlightEvent::Resumed { .. } => "resumed",
        }
    }
}

/// Section 6.1 of the paper, phase by phase.
mod shift {
    use super::*;
    use host_sim::{FlightEvent, Phase};
    use iibt_core::navigation::Cause;

    /// The rounds to which all agreed.
    fn agreed(record: &Record) -> Vec<&Phase> {
        record.phases.iter().filter(|phase| phase.agreed.is_some()).collect()
    }

    /// The tick of the first events of this kind.
    fn tick_of(record: &Record, is_it: impl Fn(&FlightEvent) -> bool) -> u32 {
        record.events.iter().find(|timed| is_it(&timed.event)).expect("it happens").tick
    }

    /// The ways of all robots in a plan, on the map without obstacles.
    fn paths(phase: &Phase) -> Vec<Vec<u16>> {
        let path = |chosen: &host_sim::Chosen| chosen.path.iter().map(|cell| cell.0).collect();
        phase.choices.iter().flatten().map(path).collect()
    }

    fn has_three_goals(phase: &Phase) -> bool {
        let goals: BTreeSet<_> = phase.choices.iter().flatten().filter_map(|chosen| chosen.goal).collect();
        goals.len() == 3
    }

    /// Whether no robot shares a cell with a teammate at any step, or swaps with it.
    fn is_clear(phase: &Phase) -> bool {
        let paths = paths(phase);
        // A robot stays on the last cell of its path.
        let at = |path: &[u16], step: usize| path.get(step).or(path.last()).copied();
        let steps = paths.iter().map(Vec::len).max().unwrap_or(0);
        (1..steps).all(|step| {
            (0..paths.len()).all(|one| {
                (0..one).all(|other| {
                    let (a, b) = (&paths[one], &paths[other]);
                    let swaps = at(a, step) == at(b, step - 1) && at(b, step) == at(a, step - 1);
                    at(a, step) != at(b, step) && !swaps
                })
            })
        })
    }

    fn cells(phase: &Phase) -> Vec<u16> {
        phase.obstacles.iter().map(|cell| cell.0).collect()
    }

    fn causes(record: &Record, cause: Cause) -> usize {
        record.phases.iter().filter(|phase| phase.cause == Some(cause)).count()
    }

    /// The obstacles that appeared, in their order, and when.
    fn obstacles(record: &Record) -> Vec<(u32, Cell)> {
        let appeared = |timed: &host_sim::TimedEvent| match timed.event {
            FlightEvent::Appeared { cell } => Some((timed.tick, cell)),
            _ => None,
        };
        record.events.iter().filter_map(appeared).collect()
    }

    /// Everything that section 6.1 tells happens, whatever its order.
    fn check(record: &Record, case: &str) {
        assert!(record.outcome.is_success(), "{case}: {:?}", record.outcome);
        assert_eq!(record.collisions.total(), 0, "{case}");
        for plan in agreed(record) {
            assert!(is_clear(plan), "{case}: {plan:?}");
        }
        assert_eq!(obstacles(record).len(), 2, "{case}");
        assert_eq!(
            [0, 1, 2].map(|robot| record.robots[robot].visited.clone()),
            [vec![Cell(4)], vec![], vec![Cell(39)]],
            "{case}"
        );
        assert_eq!([0, 1, 2].map(|robot| record.robots[robot].charged), [1, 0, 1], "{case}");
    }

    /// Everything happens phase by phase.
    fn check_order(record: &Record) {
        let plans = agreed(record);
        let [(first, one), (second, other)] = obstacles(record)[..] else { panic!("two obstacles") };
        for plan in &plans {
            assert!(paths(plan).iter().flatten().all(|cell| !cells(plan).contains(cell)), "{plan:?}");
        }
        let known: Vec<_> = plans.iter().map(|plan| plan.obstacles.clone()).collect();
        let both = BTreeSet::from([one, other]).into_iter().collect();
        assert_eq!(known[..3], [vec![], vec![one], both]);
        assert!(paths(plans[0]).iter().any(|path| path.contains(&one.0)), "it is in the way of a robot");
        assert!(paths(plans[1]).iter().any(|path| path.contains(&other.0)), "so is the second one");
        let after = |tick: u32| plans.iter().find_map(|plan| plan.agreed.filter(|&agreed| agreed > tick));
        let at = |is_it: fn(&FlightEvent) -> bool| tick_of(record, is_it);
        let asked = at(|event| matches!(event, FlightEvent::Asked { robot: 0, cell: Cell(4) }));
        let order = [
            plans[0].agreed.expect("agreed"),
            first,
            after(first).expect("another plan"),
            second,
            after(second).expect("another plan"),
            asked,
            after(asked).expect("another plan"),
            at(|event| matches!(event, FlightEvent::Visited { robot: 0, cell: Cell(4) })),
            at(|event| matches!(event, FlightEvent::Left { robot: 0, .. })),
            at(|event| matches!(event, FlightEvent::Returned { robot: 0, .. })),
            at(|event| matches!(event, FlightEvent::Left { robot: 2, .. })),
            at(|event| matches!(event, FlightEvent::Returned { robot: 2, .. })),
            plans.last().and_then(|plan| plan.agreed).expect("agreed"),
        ];
        assert!(order.is_sorted(), "{order:?}");
        assert!(has_three_goals(plans.last().expect("there are plans")));
        let least = [(Cause::Obstacle, 2), (Cause::WayPoint, 1), (Cause::Battery, 2), (Cause::Free, 1)];
        for (cause, least) in least {
            assert!(causes(record, cause) >= least, "{cause:?}: {}", causes(record, cause));
        }
    }

    #[test]
    fn all_five_phases_happen_in_their_order_and_the_team_arrives_together() {
        let record = flown(&built_in("shift"), 0, 0.0);
        check(&record, "no loss");
        check_order(&record);
        assert_eq!(record.outcome, Outcome::Together);
    }

    #[test]
    fn all_five_phases_happen_whatever_the_radio_loses() {
        let scenario = built_in("shift");
        for seed in 0..=200 {
            check(&flown(&scenario, seed, 0.3), &format!("seed {seed}"));
        }
    }

    /// When a robot left to charge, and when it came back.
    fn away(record: &Record, robot: usize) -> [usize; 2] {
        let left =
            |event: &FlightEvent| matches!(event, FlightEvent::Left { robot: who, .. } if *who == robot);
        let back =
            |event: &FlightEvent| matches!(event, FlightEvent::Returned { robot: who, .. } if *who == robot);
        [tick_of(record, left) as usize, tick_of(record, back) as usize]
    }

    /// The ticks in which a robot moved that does not charge, so many ticks or more after another left
    /// to charge.
    fn moves_beside(record: &Record, after: usize) -> Vec<usize> {
        let absent = [0, 2].map(|robot: usize| (robot, away(record, robot)));
        let is_away = |robot: usize, tick: usize, after: usize| {
            let is_within = |&(who, [left, back]): &(usize, [usize; 2])| {
                (robot == usize::MAX || who == robot) && (left + after..=back).contains(&tick)
            };
            absent.iter().any(is_within)
        };
        let moved =
            |tick: usize, robot: usize| record.history[tick][robot] != record.history[tick + 1][robot];
        let ticks = (0..record.history.len() - 1).filter(|&tick| is_away(usize::MAX, tick, after));
        ticks.filter(|&tick| (0..3).any(|robot| moved(tick, robot) && !is_away(robot, tick, 0))).collect()
    }

    #[test]
    fn the_others_stand_while_a_robot_charges() {
        // A move that was agreed on before may still be made while the frames travel.
        for (loss, after) in [(0.0, 1), (0.3, 8)] {
            for seed in 0..10 {
                let record = flown(&built_in("shift"), seed, loss);
                assert_eq!(moves_beside(&record, after), [0; 0], "{loss}, seed {seed}");
                for (robot, charger) in [(0, Cell(13)), (2, Cell(41))] {
                    let [left, back] = away(&record, robot);
                    assert!(record.history[left..=back].iter().any(|cells| cells[robot] == charger));
                }
            }
        }
    }

    #[test]
    fn the_others_go_on_where_the_team_does_not_wait_for_charging() {
        let text = |waits: bool| {
            format!(
                "title = 't'\nwait_for_charging = {waits}\nmap = '''\n1.....G\n.......\n2.....G\n'''\n\
                 [[robot]]\ncharger = 13\nbattery = 15\ncharging = 2"
            )
        };
        let [(waiting, back), (going_on, later)] = [true, false].map(|waits| {
            let record = flown(&Scenario::parse("t", &text(waits)).expect("sound"), 0, 0.0);
            assert!(record.outcome.is_success() && record.robots[0].charged == 1, "{:?}", record.outcome);
            (record.robots[1].arrived as usize, away(&record, 0)[1])
        });
        assert!(waiting > back && going_on < later, "{waiting}, {back}; {going_on}, {later}");
    }

    #[test]
    fn every_robot_is_sure_of_its_cell_when_its_localiser_is_right() {
        let record = flown(&built_in("shift"), 0, 0.0);
        assert_eq!(record.certainty.len() + 1, record.history.len());
        let sure = record.certainty.iter().flatten().filter(|&&p| p > 0.99).count();
        assert!(sure * 10 > record.certainty.len() * 3 * 9, "{sure} of {}", record.certainty.len() * 3);
    }
}

/// The effects of events and drives on a team.
mod events {
    use super::*;
    use host_sim::FlightEvent;

    fn factory_with(more: &str) -> Scenario {
        let text = include_str!("../host-sim/scenarios/factory.toml");
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
}

mod radio {
    use super::*;

    /// Whether no robot has moved for twenty ticks.
    fn stands_still(record: &Record) -> bool {
        let last = record.history.iter().rev().take(20).collect::<Vec<_>>();
        last.len() == 20 && last.windows(2).all(|pair| pair[0] == pair[1])
    }

    #[test]
    fn losing_three_frames_in_ten_makes_nobody_collide() {
        let scenario = built_in("factory");
        for seed in 0..10 {
            let record = flown(&scenario, seed, 0.3);
            assert_eq!(record.collisions.total(), 0, "seed {seed}");
            assert!(record.frames.lost > 0, "seed {seed}");
            assert!(record.outcome.is_success() || stands_still(&record), "seed {seed}: {record:?}");
        }
    }

    #[test]
    fn losing_half_of_them_makes_nobody_collide_anywhere() {
        for name in library::names() {
            for seed in 0..3 {
                let record = flown(&built_in(name), seed, 0.5);
                assert_eq!(record.collisions.total(), 0, "{name}, seed {seed}");
            }
        }
    }

    #[test]
    fn without_it_everybody_stays() {
        let record = flown(&built_in("two-goals"), 0, 1.0);
        assert_eq!(record.outcome, Outcome::Unfinished);
        assert!(record.history.iter().all(|cells| *cells == record.history[0]));
        assert_eq!((record.frames.delivered, record.frames.lost), (0, record.frames.sent));
    }

    #[test]
    fn late_and_repeated_frames_cost_time_only() {
        let mut scenario = built_in("factory");
        let usual = flown(&scenario, 0, 0.0);
        (scenario.radio.delay, scenario.radio.duplicate) = (4, 0.5);
        let record = flown(&scenario, 0, 0.0);
        assert!(record.outcome.is_success() && record.collisions.total() == 0, "{:?}", record.outcome);
        assert!(record.ticks > usual.ticks);
        assert!(record.robots.iter().all(|robot| robot.rejected > 0), "a frame heard twice is rejected once");
        assert!(usual.robots.iter().all(|robot| robot.rejected == 0));
    }
}

mod json {
    use super::*;

    fn json(name: &str, seed: u64, loss: f64) -> String {
        flown(&built_in(name), seed, loss).to_json().unwrap()
    }

    #[test]
    fn the_same_seed_gives_the_same_bytes() {
        for name in ["factory", "detour"] {
            assert_eq!(json(name, 7, 0.3), json(name, 7, 0.3), "{name}");
            assert_ne!(json(name, 7, 0.3), json(name, 8, 0.3), "{name}");
        }
    }

    #[test]
    fn it_tells_the_whole_flight() {
        let record = flown(&built_in("two-goals"), 3, 0.0);
        let value: serde_json::Value = serde_json::from_str(&record.to_json().unwrap()).unwrap();
        assert_eq!(value["scenario"], "two-goals");
        assert_eq!(
            (&value["seed"], &value["loss"], &value["outcome"]),
            (&3.into(), &0.0.into(), &"together".into())
        );
        assert_eq!(value["history"][0], serde_json::json!([28, 2]));
        assert_eq!(value["robots"][0]["path"], serde_json::json!([28, 35, 36, 37, 38, 31, 24]));
        assert_eq!(value["history"].as_array().unwrap().len(), record.history.len());
    }
}

mod readme {
    use super::*;
    use host_sim::FlightEvent;
    use serde_json::Value;

    const README: &str = include_str!("../host-sim/scenarios/README.md");

    /// The keys of a value, those inside it included.
    fn keys(value: &Value) -> BTreeSet<String> {
        match value {
            Value::Object(members) => {
                members.iter().flat_map(|(key, value)| keys(value).into_iter().chain([key.clone()])).collect()
            }
            Value::Array(values) => values.iter().flat_map(keys).collect(),
            _ => BTreeSet::new(),
        }
    }

    #[test]
    fn every_member_of_the_record_is_explained() {
        let record = flown(&built_in("factory"), 0, 0.0);
        let mut names = keys(&serde_json::to_value(&record).unwrap());
        names.extend(keys(&serde_json::to_value(FlightEvent::Collided { times: 1 }).unwrap()));
        names.extend(["appeared", "found", "chose", "agreed", "arrived", "collided"].map(String::from));
        names.extend(
            ["asked", "refused", "visited", "drained", "left", "returned", "stopped", "resumed"]
                .map(String::from),
        );
        names.extend(
            ["obstacle", "way_point", "battery", "free", "position", "teammate", "shortfall"]
                .map(String::from),
        );
        names.extend(["deciding", "announced", "away", "together", "apart", "unfinished"].map(String::from));
        names.extend(["nothing_to_do", "cleared", "waits", "for", "reason"].map(String::from));
        let missing: Vec<_> = names.iter().filter(|name| !README.contains(&format!("`{name}`"))).collect();
        assert!(names.len() > 40 && missing.is_empty(), "of {}, missing {missing:?}", names.len());
    }
}

/// The README describes every key that a scenario can have, and no other.
mod keys {
    use super::*;

    const README: &str = include_str!("../host-sim/scenarios/README.md");

    /// The keys of a table, as the refusal of an unknown one lists them.
    fn known(table: &str) -> BTreeSet<String> {
        let text = format!("title = 't'\nmap = '1.G'\n{table}\nxyzzy = 1");
        let refusal = Scenario::parse("t", &text).expect_err("there is no such key").reason;
        let list = refusal.split_once("expected").expect("a list").1;
        list.split('`').skip(1).step_by(2).map(str::to_owned).collect()
    }

    /// The keys of the table of the README.
    fn described() -> BTreeSet<String> {
        let rows = README.lines().skip_while(|line| !line.starts_with("| key ")).skip(2);
        let cells = rows.take_while(|line| line.starts_with('|')).filter_map(|row| row.split('|').nth(1));
        let names = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2));
        names.map(|name| name.trim_matches(['[', ']']).to_owned()).collect()
    }

    #[test]
    fn every_key_is_described_and_no_other() {
        let known: BTreeSet<String> = [
            "",
            "[radio]",
            "[inference]",
            "[[robot]]",
            "[[event]]",
            "[[goal]]\ncell = 2\nserves = 1",
            "[[wear]]\nrobot = 'R1'\nmove = 'up'\nfails = 1",
        ]
        .into_iter()
        .flat_map(known)
        .collect();
        assert!(known.len() > 40, "{known:?}");
        assert_eq!(known, described());
    }

    #[test]
    fn keys_that_are_gone_are_refused() {
        for key in ["peer_sensor", "haste", "collision"] {
            let text = format!("title = 't'\nmap = '1.G'\n[inference]\n{key} = 1");
            let refusal = Scenario::parse("t.toml", &text).expect_err("it is gone").to_string();
            assert!(refusal.starts_with(&format!("t.toml:4: unknown field `{key}`")), "{refusal}");
        }
    }
}

mod refused {
    use super::*;

    /// A sound scenario; the cases below each spoil one line of it.
    const SOUND: &str = "\
title = 'two robots'
limit = 100
map = '''
....
.#..
....
'''
goals = [3, 11]
[[robot]]
start = 0
paths = [[0, 1, 2, 3]]
[[robot]]
name = 'Bo'
start = 8
paths = [[8, 9, 10, 11]]
[radio]
loss = 0.1
delay = 1
[[event]]
tick = 4
block = 7
[inference]
precision = 16.0
";

    fn refusal(name: &str, text: &str) -> String {
        Scenario::parse(name, text).map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
    }

    #[test]
    fn the_sound_one_is_not() {
        assert_eq!(refusal("sound.toml", SOUND), "accepted");
    }

    #[test]
    fn with_file_line_and_reason() {
        #[rustfmt::skip]
        let cases = [
            ("limit = 100", "limit = ", "2", "string values must be quoted"),
            ("limit = 100", "limits = 100", "2", "unknown field `limits`, expected one of `title`"),
            ("limit = 100", "limit = 0", "2", "limit = 0 is not between 1 and 100000"),
            ("limit = 100", "limit = 2.5", "2", "expected a whole number"),
            ("limit = 100", "view = 9", "2", "view = 9 is not between 1 and 8"),
            ("'two robots'", "''", "1", "title is not one line of 1 to 120 characters"),
            (".#..", ".#.", "5", "row 1 of the map has 3 cells, but row 0 has 4"),
            (".#..", ".#x.", "5", "row 1, column 2 of the map: 'x' is not a map character"),
            (".#..", ".#1.", "10", "the map draws R1 as '1' already"),
            (".#..", ".#1.\n1...", "6", "row 2, column 0 of the map: robot 1 is drawn at 6 already"),
            (".#..", ".#G.", "8", "the map draws goals as 'G' already"),
            ("limit = 100", "need = 0", "2", "need = 0 is not between 1 and 2"),
            ("limit = 100", "need = 3", "2", "need = 3 is not between 1 and 2"),
            ("limit = 100", "need = 'all'", "2", "expected a whole number"),
            ("limit = 100", "forget = -1", "2", "forget = -1 is not between 0 and 65535"),
            ("limit = 100", "forget = 70000", "2", "forget = 70000 is not between 0 and 65535"),
            ("limit = 100", "wait_for_charging = 1", "2", "expected a boolean"),
            ("start = 0", "start = 0\ngoal = 5", "11", "goal 5 is blocked on the map"),
            ("start = 0", "start = 0\ngoal = 12", "11", "goal 12 is outside the map, whose cells are 0 to 11"),
            ("precision = 16.0", "policies = 0", "23", "policies = 0 is not between 1 and 16"),
            ("precision = 16.0", "policies = 17", "23", "policies = 17 is not between 1 and 16"),
            ("precision = 16.0", "budget = 0", "23", "budget = 0 is not between 1 and 1000000000"),
            ("precision = 16.0", "haste = 2.0", "23", "unknown field `haste`"),
            ("block = 7", "clear = 5", "21", "clear 5 is blocked on the map"),
            ("block = 7", "clear = 12", "21", "clear 12 is outside the map"),
            ("block = 7", "clear = 7\nwho = 'Bo'", "22", "an obstacle is nobody's: leave `who` out"),
            ("block = 7", "block = 7\nclear = 7", "19", "say what happens: exactly one of block, block_path_of, clear"),
            ("block = 7", "block_path_of = 'Al'", "21", "no robot is called \"Al\": there are R1, Bo"),
            ("block = 7", "block_path_of = 7", "21", "expected a string"),
            ("block = 7", "block_path_of = 'Bo'\nfor = 3", "22", "only stop takes a time: leave `for` out"),
            ("[3, 11]", "[3, 3]", "8", "goal 3 is listed twice"),
            ("[3, 11]", "[3,\n12]", "9", "goal 12 is outside the map, whose cells are 0 to 11"),
            ("[3, 11]", "[3, 11, 5]", "8", "goal 5 is blocked on the map"),
            ("[3, 11]", "[-1, 11]", "8", "goal -1 is outside the map"),
            ("start = 0", "start = 5", "10", "start 5 is blocked on the map"),
            ("start = 0", "start = 70000", "10", "start 70000 is outside the map"),
            ("start = 0", "battery = 50", "9", "R1 has no start: write start = CELL, or draw '1' on the map"),
            ("start = 8\npaths = [[8", "start = 0\npaths = [[0, 1, 2, 3], [0, 4, 8", "12", "Bo starts at 0, where R1 stands already"),
            ("'Bo'", "'R1'", "12", "two robots are called R1"),
            ("'Bo'", r#""B\no""#, "13", "name is not one line of 1 to 12 characters"),
            ("[[0, 1, 2, 3]]", "[[0, 1, 2]]", "11", "the path ends at 2, which is no goal"),
            ("[[0, 1, 2, 3]]", "[[0, 2, 3]]", "11", "0 and 2 on the path are no neighbours"),
            ("[[0, 1, 2, 3]]", "[[1, 2, 3]]", "11", "no path begins at 0, where the robot starts"),
            ("[[0, 1, 2, 3]]", "[[0, 1, 5]]", "11", "path cell 5 is blocked on the map"),
            ("[[0, 1, 2, 3]]", "[[0, 1, 99]]", "11", "path cell 99 is outside the map"),
            ("[[0, 1, 2, 3]]", "[[]]", "11", "the path has no cells"),
            ("[[0, 1, 2, 3]]", "[]", "11", "0 paths listed: give 1 to 16"),
            ("paths = [[0, 1, 2, 3]]", "", "15", "R1 has no paths: list them for every robot or for none"),
            ("loss = 0.1", "loss = 1.5", "17", "loss = 1.5 is not between 0 and 1"),
            ("loss = 0.1", "loss = nan", "17", "loss = NaN is not between 0 and 1"),
            ("delay = 1", "delay = 0", "18", "delay = 0 is not between 1 and 1000"),
            ("delay = 1", "jitter = 1", "18", "unknown field `jitter`"),
            ("block = 7", "block = 8", "21", "8 is where Bo starts"),
            ("block = 7", "block = 12", "21", "block 12 is outside the map"),
            ("tick = 4", "at = 4", "19", "say when it happens"),
            ("tick = 4", "robot = 'Al'\nat = 4", "20", "no robot is called \"Al\": there are R1, Bo"),
            ("tick = 4\nblock = 7", "tick = 4", "19", "say what happens: exactly one of block, block_path_of, clear, charge, visit and stop"),
            ("tick = 4", "tick = 4\nplan = 2", "19", "say when it happens"),
            ("tick = 4", "plan = 0", "20", "plan = 0 is not between 1 and 1000"),
            ("tick = 4", "plan = 1\nmoves = 65", "21", "moves = 65 is not between 0 and 64"),
            ("tick = 4", "tick = 4\nmoves = 1", "21", "moves are those of a plan: write plan = N with it"),
            ("block = 7", "block = 7\nstop = true", "19", "say what happens: exactly one"),
            ("block = 7", "block = 7\nwho = 'Bo'", "22", "an obstacle is nobody's: leave `who` out"),
            ("block = 7", "block = 7\nfor = 3", "22", "only stop takes a time: leave `for` out"),
            ("block = 7", "charge = 20", "19", "say whom it concerns: who = \"NAME\""),
            ("block = 7", "charge = 101\nwho = 'Bo'", "21", "charge = 101 is not between 0 and 100"),
            ("block = 7", "visit = 5\nwho = 'Bo'", "21", "way-point 5 is blocked on the map"),
            ("block = 7", "visit = 12\nwho = 'Bo'", "21", "way-point 12 is outside the map"),
            ("block = 7", "visit = 7\nwho = 'Al'", "22", "no robot is called \"Al\": there are R1, Bo"),
            ("block = 7", "stop = false\nwho = 'Bo'", "21", "stop = false says nothing"),
            ("block = 7", "stop = true\nfor = 0\nwho = 'Bo'", "22", "for = 0 is not between 1 and 100000"),
            ("block = 7", "stop = 1\nwho = 'Bo'", "21", "expected a boolean"),
            ("start = 0", "start = 0\ncharger = 5", "11", "charger 5 is blocked on the map"),
            ("start = 0", "start = 0\ncharger = 12", "11", "charger 12 is outside the map"),
            ("start = 0", "start = 0\ndrain = -1", "11", "drain = -1 is not between 0 and 100"),
            ("start = 0", "start = 0\ncharging = 200", "11", "charging = 200 is not between 0 and 100"),
            ("start = 0", "start = 0\nslip = 2", "11", "slip = 2 is not between 0 and 1"),
            ("limit = 100", "slip = 1.5", "2", "slip = 1.5 is not between 0 and 1"),
            ("start = 0", "start = 0\npace = 0", "11", "pace = 0 is not between 1 and 8"),
            ("start = 0", "start = 0\nsensor = 2", "11", "sensor = 2 is not between 0 and 1"),
            ("start = 0", "start = 0\nview = 9", "11", "view = 9 is not between 1 and 8"),
            ("limit = 100", "missions = 0", "2", "missions = 0 is not between 1 and 1000"),
            ("[radio]", "[[goal]]\ncell = 4\nserves = 0.5\n[radio]", "17", "4 is no goal"),
            ("[radio]", "[[goal]]\ncell = 3\nserves = 2\n[radio]", "18", "serves = 2 is not between 0 and 1"),
            ("[radio]", "[[goal]]\ncell = 3\nserves = 1\n[[goal]]\ncell = 3\nserves = 1\n[radio]", "20", "goal 3 has a [[goal]] already"),
            ("precision = 16.0", "alike = 1", "23", "expected a boolean"),
            ("precision = 16.0", "precision = -1", "23", "precision = -1 is not between 0 and 1000"),
        ];
        for (right, wrong, line, reason) in cases {
            assert!(SOUND.contains(right), "{right}");
            let refusal = refusal("my.toml", &SOUND.replacen(right, wrong, 1));
            assert!(refusal.starts_with(&format!("my.toml:{line}: ")), "{wrong}: {refusal}");
            assert!(refusal.contains(reason), "{wrong}: {refusal}");
        }
    }

    #[test]
    fn when_a_robot_cannot_get_to_a_goal_of_its_own() {
        let apart = SOUND.replacen("....\n.#..\n....", "..#.\n.##.\n..#.", 1).replace("paths", "# paths");
        let refused = refusal("my.toml", &apart);
        assert!(
            refused.starts_with("my.toml:10: R1 on 0 can reach no goal: no way of at most 64"),
            "{refused}"
        );
        let shared = "title = 't'\nmap = '''\n1.#G\n2.#.\nG.#.\n'''";
        let refused = refusal("my.toml", shared);
        assert!(refused.starts_with("my.toml:2: R2 on 4 can reach no goal of its own"), "{refused}");
    }

    #[test]
    fn when_a_charger_or_a_way_point_is_out_of_reach_or_taken() {
        let text = |more: &str| format!("title = 't'\nmap = '''\n1.G\n###\n2.G\n'''\n{more}");
        let refused = |more: &str| refusal("my.toml", &text(more));
        assert_eq!(refused("[[robot]]\ncharger = 7"), "my.toml:8: R1 on 0 cannot reach the charger 7");
        let visit = "[[event]]\ntick = 3\nvisit = 1\nwho = 'R2'";
        assert_eq!(refused(visit), "my.toml:9: R2 on 6 cannot reach the way-point 1");
        let free = text("[[robot]]\ncharger = 1\n[[robot]]\ncharger = 1").replace("###", "...");
        assert_eq!(refusal("my.toml", &free), "my.toml:10: 1 is the charger of R1 already");
    }

    #[test]
    fn when_a_goal_is_owned_twice_or_out_of_reach() {
        let text = |more: &str| format!("title = 't'\nmap = '''\n1.G\n###\n2.G\n'''\n{more}");
        let refused = |more: &str| refusal("my.toml", &text(more));
        assert_eq!(refused("[[robot]]\ngoal = 8"), "my.toml:8: R1 on 0 cannot reach the goal 8");
        let twice = text("[[robot]]\ngoal = 2\n[[robot]]\ngoal = 2").replace("###", "...");
        assert_eq!(refusal("my.toml", &twice), "my.toml:10: 2 is the goal of R1 already");
    }

    #[test]
    fn when_a_number_is_left_out() {
        let refused = refusal("my.toml", "title = 't'\nmap = '''\n1.G\n3.G\n'''");
        assert_eq!(refused, "my.toml:2: robot 2 is missing, but the map draws robot 3: leave no number out");
    }

    #[test]
    fn when_the_team_or_the_map_is_too_large() {
        let nine = "[[robot]]\nstart = 0\n".repeat(9);
        let team = refusal("a.toml", &format!("title = 't'\nmap = '...'\ngoals = [1]\n{nine}"));
        assert_eq!(team, "a.toml:20: 9 robots, but a team has at most 8");
        let map = refusal("a.toml", &format!("title = 't'\nmap = '''\n{}'''", "1.......G\n".repeat(114)));
        assert!(map.starts_with("a.toml:2: the map has 9 x 114 cells: draw 2 to 1024"), "{map}");
        let goals = refusal("a.toml", "title = 't'\nmap = '1GGGGGGGGG'");
        assert_eq!(goals, "a.toml:2: 9 goals, but a mission has at most 8");
        let no_goal = refusal("a.toml", "title = 't'\nmap = '1...'");
        assert_eq!(no_goal, "a.toml:2: no goal for 1 robot: draw 'G' on the map or list them");
        let nobody = refusal("a.toml", "title = 't'\nmap = '...G'");
        assert!(nobody.starts_with("a.toml:2: no robots"), "{nobody}");
        let path = format!("0{}", ", 1, 0".repeat(40));
        let long = format!("title = 't'\nmap = '...'\ngoals = [0]\n[[robot]]\nstart = 0\npaths = [[{path}]]");
        assert_eq!(refusal("a.toml", &long), "a.toml:6: the path has 80 moves, but at most 64 fit");
    }

    #[test]
    fn when_it_is_no_text() {
        let error = Scenario::read("noise.bin", b"title = 't'\n\xff\xfe").unwrap_err();
        assert_eq!(error.to_string(), "noise.bin:2: this is no UTF-8 text");
    }

    #[test]
    fn when_there_is_no_such_name() {
        assert!(library::find("factori").is_none());
        assert_eq!(library::nearest("factori"), Some("factory"));
    }

    proptest! {
        #[test]
        fn any_bytes_without_a_panic(bytes: Vec<u8>) {
            prop_assert!(Scenario::read("noise", &bytes).is_err());
        }

        #[test]
        fn any_damage_without_a_panic(at in 0..SOUND.len(), length in 0usize..40, insert in "[ -~\n]{0,6}") {
            let end = (at + length).min(SOUND.len());
            let text = [&SOUND[..at], &insert, &SOUND[end..]].concat();
            if let Err(error) = Scenario::parse("damaged", &text) {
                let lines = 1..=text.lines().count() + 1;
                prop_assert!(error.line.is_some_and(|line| lines.contains(&line)), "{error}");
                prop_assert!(!error.reason.is_empty());
            }
        }
    }
}

mod accepted {
    use super::*;

    /// A drawing of up to 8 x 8 cells with two robots and two goals somewhere.
    fn drawing() -> impl Strategy<Value = String> {
        let cells = (2usize..8, 2usize..8);
        cells.prop_flat_map(|(width, height)| {
            let floor =
                proptest::collection::vec(prop_oneof![4 => Just('.'), 1 => Just('#')], width * height - 4);
            let marks = floor.prop_map(|floor| floor.into_iter().chain("12GG".chars()).collect::<Vec<_>>());
            marks.prop_shuffle().prop_map(move |marks| {
                marks.chunks(width).map(|row| row.iter().collect::<String>()).collect::<Vec<_>>().join("\n")
            })
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn can_be_flown_without_a_collision(map in drawing(), seed: u64) {
            let text = format!("title = 't'\nlimit = 60\nmap = '''\n{map}\n'''\n[radio]\nloss = 0.2");
            let scenario = match Scenario::parse("drawn", &text) {
                Err(error) if error.reason.contains("can reach no goal") => {
                    return Err(TestCaseError::reject("walled off"));
                }
                scenario => scenario.unwrap(),
            };
            let record = fly(&scenario, Conditions { seed, ..Conditions::default() }, &mut ()).unwrap();
            prop_assert_eq!(record.collisions.total(), 0);
            prop_assert!(record.history.len() <= 61);
        }
    }
}
