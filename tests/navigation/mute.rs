//! A stranger that says nothing: the team infers from its moves which goal it takes, and keeps out
//! of its way.

use super::*;
use host_sim::campaign::Ablation;
use host_sim::{Conditions, Pilot, Record, Scenario, fly};
use iibt_core::grid::words;
use iibt_core::navigation::{AnnouncedReadings, Effect, Place, Policies, Unknown};
use iibt_core::team::rounds::Proposal;

/// What the team would take if rounds took no time: at most this much in the mean.
const BAR: f64 = 8.2;

/// The ticks of the first round of two robots.
const FIRST_ROUND: f64 = 2.0;

fn mute() -> Scenario {
    Scenario::parse("mute", include_str!("../../host-sim/scenarios/mute.toml")).expect("it is sound")
}

/// Flights to each goal that the stranger may take, with so many seeds each.
fn flights(scenario: &Scenario, pilot: Pilot, loss: Option<f64>, seeds: u64) -> Vec<Vec<Record>> {
    let flown = |real: u8, seed: u64| {
        let mut scenario = scenario.clone();
        scenario.unknowns[0].real = Some(real);
        fly(&scenario, Conditions { seed, loss, tree: pilot }, &mut ()).expect("it fits")
    };
    (0..3).map(|real| (1..=seeds).map(|seed| flown(real, seed)).collect()).collect()
}

/// The mean of the ticks over all worlds; fails where the mission is not accomplished.
fn mean(what: &str, flights: &[Vec<Record>]) -> f64 {
    let of = |flights: &[Record]| {
        assert!(flights.iter().all(|record| record.outcome.is_success()), "{what}");
        flights.iter().map(|record| f64::from(record.ticks)).sum::<f64>() / flights.len() as f64
    };
    let worlds: Vec<f64> = flights.iter().map(|flights| of(flights)).collect();
    let mean = worlds.iter().sum::<f64>() / worlds.len() as f64;
    println!("{what}: {mean:.2}, by the goal of the stranger {worlds:.2?}");
    mean
}

/// A further round takes three ticks; without a stranger in view the team learns too late where it
/// goes.
#[test]
fn a_team_that_watches_a_stranger_comes_to_the_goals_that_it_leaves() {
    let scenario = mute();
    let watching = flights(&scenario, Pilot::Inference, None, 40);
    let rounds = watching.iter().flatten().map(|record| record.phases.len() as f64 - 1.0);
    println!("{:.2} further rounds", rounds.sum::<f64>() / 120.0);
    let watching = mean("watching", &watching);
    assert!(watching <= BAR + FIRST_ROUND, "{watching}");
    let mut near = scenario.clone();
    near.unknowns[0].stranger.as_mut().expect("it has one").range = Some(2);
    let near = mean("seen from two cells away", &flights(&near, Pilot::Inference, None, 40));
    assert!(watching <= near - 1.0, "{watching} {near}");
    for name in ["free-space", "likeliest"] {
        let rule = Ablation::find(name).expect("a rule");
        let rule = mean(name, &flights(&scenario, Pilot::Ablated(rule), None, 40));
        assert!(watching <= rule - 1.5, "{name}: {watching} {rule}");
    }
}

#[test]
fn nobody_runs_into_a_stranger_whatever_is_lost() {
    let flights: Vec<_> = flights(&mute(), Pilot::Inference, Some(0.3), 67).into_iter().flatten().collect();
    for record in &flights {
        assert_eq!(record.collisions.total(), 0, "seed {}", record.seed);
    }
    let done = flights.iter().filter(|record| record.outcome.is_success()).count();
    let ticks = flights.iter().map(|record| record.ticks);
    println!("{done} of {}, at most {:?} ticks", flights.len(), ticks.max());
    assert_eq!(done, flights.len());
}

/// What two robots expect of each policy of a round, by what each tells of an unknown: by evidence
/// against its values in half nats, two a byte.
fn expected(effect: Effect, told: [&[u8]; 2]) -> Vec<u16> {
    const W: usize = words(9, 9);
    let map = Map::<W>::drawn(
        "....#....\n....#....\n....#....\n.........\n.........\n.........\n...#.#...\n...#.#...\n...#.#...",
    );
    let goals = [Cell(0), Cell(8), Cell(76)];
    let cells = [0, 1, 2].map(|value| Place::new(goals[usize::from(value)], value));
    let unknowns = [Unknown { effect, cells: &cells, prior: &[0.4, 0.3, 0.3], sights: &[] }];
    let starts = [Cell(38), Cell(42)];
    let mission = Mission::new(map.expect("a sound map"), &starts, &goals);
    let mission = Mission { unknowns: &unknowns, ..mission };
    let facts: Vec<_> = (starts.iter().zip(told))
        .map(|(&anchor, told)| {
            let readings: AnnouncedReadings = told.iter().copied().collect();
            iibt_core::navigation::Fact { anchor, readings, ..Default::default() }
        })
        .collect();
    let proposal = Proposal { round: 0, view: View::full(2), walls: Default::default() };
    let policies =
        Policies::<81, W, LAYERS, NODES, 16>::of_round(&mission, &proposal, |robot| facts.get(robot.index()));
    policies.expect("all facts are there").expected().iter().map(|expected| expected.total()).collect()
}

#[test]
fn two_that_see_the_same_moves_believe_what_one_of_them_does() {
    let (seen, nothing): (&[u8], &[u8]) = (&[0x30, 0x02], &[]);
    let one = expected(Effect::Takes, [seen, nothing]);
    assert!(one.len() > 2 && one != expected(Effect::Takes, [nothing; 2]));
    assert_eq!(expected(Effect::Takes, [seen; 2]), one);
    assert_ne!(expected(Effect::Serves, [seen; 2]), expected(Effect::Serves, [seen, nothing]));
}
