//! Campaigns: conventional trees that fly every mission, and what holds for every flight of the
//! inference node.

use host_sim::campaign::{Campaign, Disturbance, Score, Trace, Violations};
use host_sim::{Conditions, Outcome, Pilot, Record, Scenario, fly, library};
use std::num::NonZeroUsize;
use std::slice::from_ref;
use std::sync::atomic::{AtomicUsize, Ordering};

fn scenario(name: &str) -> Scenario {
    library::find(name).expect("it is built in").expect("what is built in is sound")
}

fn flown(scenario: &Scenario, tree: Pilot, seed: u64) -> Record {
    fly(scenario, Conditions { seed, loss: None, tree }, &mut ()).expect("the mission fits")
}

const BOTH: [Pilot; 2] = [Pilot::Inference, Pilot::Conventional];

/// The missions that are compared.
const MISSIONS: [&str; 3] = ["two-goals", "factory", "warehouse"];

/// The disturbances after which a mission can go on.
fn passing() -> Vec<Disturbance> {
    Disturbance::USUAL.into_iter().filter(|&disturbance| disturbance != Disturbance::Stop).collect()
}

mod conventional {
    use super::*;

    #[test]
    fn the_tree_of_figure_8_accomplishes_every_mission_that_is_built_in() {
        for name in library::names() {
            let (scenario, record) = (scenario(name), flown(&scenario(name), Pilot::Conventional, 0));
            let score = Score::of(&scenario, &record);
            assert!(score.accomplished, "{name}: {:?}, {:?}", record.outcome, score.faults);
            assert_eq!(record.pilot, Pilot::Conventional);
        }
    }

    #[test]
    fn it_brings_robots_together_where_nothing_goes_wrong() {
        for name in ["two-goals", "detour", "factory", "warehouse", "courtyard"] {
            let record = flown(&scenario(name), Pilot::Conventional, 0);
            assert_eq!(record.outcome, Outcome::Together, "{name}: {} ticks apart", record.spread());
            assert!(record.spread() <= 1, "{name}: {} ticks apart", record.spread());
        }
    }

    #[test]
    fn the_tree_of_figure_5_accomplishes_missions_with_two_goals_and_flies_no_others() {
        for name in ["two-goals", "detour"] {
            let (scenario, record) = (scenario(name), flown(&scenario(name), Pilot::Figure5, 0));
            assert!(Score::of(&scenario, &record).accomplished, "{name}: {:?}", record.outcome);
        }
        let conditions = Conditions { tree: Pilot::Figure5, ..Conditions::default() };
        assert!(fly(&scenario("factory"), conditions, &mut ()).is_err());
    }

    #[test]
    fn a_robot_that_is_not_heard_is_kept_clear_of() {
        for disturbance in [Disturbance::Loss, Disturbance::Pause, Disturbance::Stop] {
            for name in MISSIONS {
                for seed in 0..20 {
                    let disturbed = disturbance.applied(&scenario(name), seed);
                    let score = Score::of(&disturbed, &flown(&disturbed, Pilot::Conventional, seed));
                    assert!(!score.has_collided(), "{name}, {}, seed {seed}: {score:?}", disturbance.name());
                }
            }
        }
    }

    #[test]
    fn it_visits_way_points_and_comes_back_charged() {
        let text = "title = 't'\nmap = '''\n1.....G\n.......\n2.....G\n'''\n[[robot]]\ncharger = 7\n\
                    [[event]]\ntick = 1\nwho = 'R1'\ncharge = 10\n[[event]]\ntick = 1\nwho = 'R2'\nvisit = 10";
        let scenario = Scenario::parse("chores", text).expect("it is sound");
        let record = flown(&scenario, Pilot::Conventional, 0);
        assert!(Score::of(&scenario, &record).accomplished, "{:?}", record.outcome);
        assert_eq!((record.robots[0].charged, record.robots[1].visited.len()), (1, 1));
    }

    #[test]
    fn a_slow_radio_slows_it_down_and_harms_nobody() {
        for delay in [2, 3, 5] {
            let mut slow = scenario("factory");
            slow.radio.delay = delay;
            for seed in 0..5 {
                let disturbed = Disturbance::Loss.applied(&slow, seed);
                let score = Score::of(&disturbed, &flown(&disturbed, Pilot::Conventional, seed));
                assert!(score.accomplished, "delay {delay}, seed {seed}: {score:?}");
            }
        }
    }
}

mod inference {
    use super::*;

    #[test]
    fn no_flight_has_a_collision_whatever_goes_wrong() {
        for name in MISSIONS {
            let mission = scenario(name);
            let campaign = Campaign {
                scenarios: from_ref(&mission),
                disturbances: &Disturbance::USUAL,
                pilots: &[Pilot::Inference],
                seeds: 24,
            };
            let report = campaign.fly(None, &|_, _| ()).expect("the mission fits");
            for row in &report.rows {
                let summary = &row.summaries[0];
                assert_eq!(summary.faults, Violations::default(), "{name}\n{}", report.table());
                assert_eq!(summary.collided.count, 0, "{name}\n{}", report.table());
            }
        }
    }

    #[test]
    fn every_mission_is_accomplished_that_no_robot_leaves_for_good() {
        let mission = scenario("factory");
        let campaign = Campaign {
            scenarios: from_ref(&mission),
            disturbances: &passing(),
            pilots: &[Pilot::Inference],
            seeds: 24,
        };
        let report = campaign.fly(None, &|_, _| ()).expect("the mission fits");
        for row in &report.rows {
            assert_eq!(row.summaries[0].accomplished.count, 24, "{}", report.table());
        }
    }
}

mod report {
    use super::*;

    #[test]
    fn it_does_not_depend_on_the_number_of_threads() {
        let mission = scenario("factory");
        let disturbances = [Disturbance::All, Disturbance::Loss];
        let campaign =
            Campaign { scenarios: from_ref(&mission), disturbances: &disturbances, pilots: &BOTH, seeds: 7 };
        let told = AtomicUsize::new(0);
        let progress = |_, flights| {
            assert_eq!(flights, 28);
            told.fetch_add(1, Ordering::Relaxed);
        };
        let reports = [1, 2, 5].map(|threads| {
            let report = campaign.fly(NonZeroUsize::new(threads), &progress).expect("the mission fits");
            serde_json::to_string(&report).expect("it is text")
        });
        assert_eq!(told.load(Ordering::Relaxed), 3 * 28);
        assert!(reports[0] == reports[1] && reports[1] == reports[2]);
    }

    #[test]
    fn a_row_compares_the_same_seeds() {
        let mission = scenario("two-goals");
        let campaign = Campaign {
            scenarios: from_ref(&mission),
            disturbances: &[Disturbance::None],
            pilots: &BOTH,
            seeds: 3,
        };
        let report = campaign.fly(None, &|_, _| ()).expect("the mission fits");
        let [inference, conventional] = &report.rows[0].summaries[..] else { panic!("two pilots") };
        let comparison = &report.rows[0].comparisons[0];
        assert_eq!((inference.accomplished.of, comparison.ticks.pairs), (3, 3));
        assert_eq!(comparison.ticks.mean, inference.ticks.mean - conventional.ticks.mean);
        let table = report.table();
        assert!(table.contains("inference minus conventional"), "{table}");
    }
}

/// The statements of docs/paper.md about the two trees.
mod comparison {
    use super::*;
    use host_sim::campaign::CampaignRow;

    fn rows(name: &str, disturbances: &[Disturbance], seeds: u32) -> Vec<CampaignRow> {
        let mission = scenario(name);
        let campaign = Campaign { scenarios: from_ref(&mission), disturbances, pilots: &BOTH, seeds };
        campaign.fly(None, &|_, _| ()).expect("the mission fits").rows
    }

    /// In a team of three, robots in a burst of losses hear by way of each other what was said.
    #[test]
    fn the_conventional_tree_is_faster_and_sends_less_but_for_three_robots_in_bursts() {
        for name in ["two-goals", "factory"] {
            for row in rows(name, &passing(), 100) {
                let comparison = &row.comparisons[0];
                let sign =
                    if name == "factory" && row.disturbance == Disturbance::Bursts { -1.0 } else { 1.0 };
                for difference in [&comparison.ticks, &comparison.messages] {
                    assert!(difference.interval.iter().all(|bound| sign * bound > 0.0), "{name}, {row:?}");
                }
            }
        }
    }

    /// Last moves wait for a message of every teammate, and what a lost one costs depends on the
    /// mission.
    #[test]
    fn who_arrives_together_more_often_depends_on_the_mission_where_frames_are_lost() {
        let ahead = |name| {
            let row = &rows(name, &[Disturbance::Loss], 500)[0];
            println!(
                "{name}: {:?}",
                row.summaries.iter().map(|summary| summary.together.ratio).collect::<Vec<_>>()
            );
            let together = row.comparisons[0].together;
            together.is_significant().then_some(together.mean > 0.0)
        };
        assert_eq!(["two-goals", "factory", "warehouse"].map(ahead), [Some(false), None, Some(false)]);
    }

    #[test]
    fn neither_arrives_together_less_often_where_nothing_goes_wrong_and_inference_not_where_drives_slip() {
        for name in MISSIONS {
            let undisturbed = &rows(name, &[Disturbance::None], 20)[0];
            assert!(undisturbed.summaries.iter().all(|summary| summary.together.count == 20), "{name}");
            let slips = &rows(name, &[Disturbance::Slips], 500)[0];
            let together = slips.comparisons[0].together;
            assert!(together.interval[1] > 0.0 && together.interval[0] > -0.06, "{name}: {slips:?}");
        }
    }

    #[test]
    fn a_robot_that_stops_for_good_stops_the_conventional_tree_and_not_the_team_that_decides() {
        for name in ["two-goals", "factory"] {
            let row = &rows(name, &[Disturbance::Stop], 48)[0];
            assert!(row.comparisons[0].accomplished.interval[0] > 0.0, "{name}: {row:?}");
            assert_eq!(row.summaries[1].accomplished.count, 0, "{name}: {row:?}");
            assert!(row.summaries.iter().all(|summary| summary.collided.count == 0), "{name}: {row:?}");
        }
    }
}

mod validator {
    use super::*;

    /// A sound flight with 30 % loss, as its validator sees it.
    fn sound() -> Trace {
        let scenario = Disturbance::Loss.applied(&scenario("factory"), 1);
        let trace = Trace::of(&scenario, &flown(&scenario, Pilot::Inference, 1));
        assert_eq!(trace.validate(), Violations::default());
        trace
    }

    fn moves(trace: &Trace) -> Vec<(usize, usize)> {
        let robots = 0..trace.history[0].len();
        let ticks = 1..trace.history.len();
        let all = ticks.flat_map(|tick| robots.clone().map(move |robot| (tick, robot)));
        all.filter(|&(tick, robot)| trace.history[tick][robot] != trace.history[tick - 1][robot]).collect()
    }

    #[test]
    fn it_finds_every_fault_that_is_planted() {
        let trace = sound();
        assert!(moves(&trace).len() > 8);
        for (tick, robot) in moves(&trace) {
            let other = (robot + 1) % trace.history[0].len();
            let entered = trace.history[tick][robot];
            let judged = |change: &dyn Fn(&mut Trace)| {
                let mut changed = trace.clone();
                change(&mut changed);
                changed.validate()
            };
            let shared = judged(&|trace| trace.history[tick][other] = entered);
            assert!(shared.shared > 0, "tick {tick}, robot {robot}: {shared:?}");
            let left = trace.history[tick - 1][robot];
            let swapped = judged(&|trace| {
                trace.history[tick - 1][other] = entered;
                trace.history[tick][other] = left;
            });
            assert!(swapped.swapped > 0, "tick {tick}, robot {robot}: {swapped:?}");
            let walled = judged(&|trace| trace.blocked[entered] = true);
            assert!(walled.blocked > 0, "tick {tick}, robot {robot}: {walled:?}");
            let late = judged(&|trace| trace.appeared.push((tick - 1, entered)));
            assert!(late.blocked > 0, "tick {tick}, robot {robot}: {late:?}");
            let jumped = judged(&|trace| trace.history[tick - 1][robot] = (entered + 16) % 49);
            assert!(jumped.jumps > 0, "tick {tick}, robot {robot}: {jumped:?}");
        }
    }

    #[test]
    fn it_agrees_with_the_referee() {
        let mut collided = 0;
        for seed in 0..40 {
            let mut scenario = Disturbance::All.applied(&scenario("factory"), seed);
            // Localisers this bad make conventional robots collide: something for both to see.
            scenario.robots.iter_mut().for_each(|robot| robot.localiser = 0.2);
            let record = flown(&scenario, Pilot::Conventional, seed);
            let faults = Trace::of(&scenario, &record).validate();
            let counted = (record.collisions.shared, record.collisions.swapped);
            assert_eq!((faults.shared, faults.swapped), counted, "seed {seed}");
            assert_eq!((faults.blocked, faults.jumps), (0, 0), "the world lets nobody do that: seed {seed}");
            collided += u32::from(record.collisions.total() > 0);
        }
        assert!(collided > 0, "there was nothing to see");
    }
}
