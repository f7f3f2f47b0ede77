//! No two robots ever share or swap a cell, whatever the radio, the drive and the world do.
//!
//! How many teams must arrive is what was measured less some three standard deviations of such a
//! count, and five where nearly all arrive: another stream of random numbers passes, a team that is
//! held up does not.

use host_sim::{Faults, NavigatorFlight, Radio, Random, reproduce};
use iibt_core::actions::HORIZON;
use iibt_core::grid::{Cell, Map, Move, Path, Planner};
use iibt_core::navigation::{Intention, Mission, Round, Said, Stage};
use iibt_core::team::{RobotId, Stamp};
use iibt_core::time::Instant;
use tests::judge::{self, Outcome};
use tests::rig::overhear;

const RUNS: u64 = 200;

/// The number of missions with errands, which take longer.
const LONG_RUNS: u64 = 150;

type Team<'m> = NavigatorFlight<'m, 49, 2, 16>;

/// A team whose clocks wrap after some ticks.
fn team<'m>(mission: &'m Mission<'m, 2>, faults: Faults, seed: u64) -> Team<'m> {
    Team::over(mission, faults, seed).expect("a sound mission").beginning_at(Instant(u32::MAX - 50))
}

/// A radio that loses and doubles copies with these probabilities, and delays them by up to so many
/// ticks more.
fn radio(loss: f64, jitter: u32, duplicate: f64) -> Radio {
    Radio { loss, jitter, duplicate, ..Radio::default() }
}

/// A random map with walls in a tenth of its cells, and a team of two to five robots with as many
/// goals, and chargers for all but the last robot, all within reach of each other.
fn fly(seed: u64, faults: Faults) -> Outcome {
    fly_at(seed, faults, [1; 5], &[])
}

/// The same with robots whose moves take so many ticks, and what they take for the steps of a plan
/// that those are.
fn fly_at(seed: u64, faults: Faults, ticks: [u32; 5], paces: &[u8]) -> Outcome {
    let mut random = Random::new(seed);
    let size = 2 + (seed % 4) as usize;
    let (map, mut free) = ground(&mut random, 3 * size);
    let mut draw = || free.swap_remove(random.below(free.len()));
    let starts: Vec<Cell> = (0..size).map(|_| draw()).collect();
    let goals: Vec<Cell> = (0..size).map(|_| draw()).collect();
    let chargers: Vec<Option<Cell>> = (1..size).map(|_| Some(draw())).collect();
    let mission = Mission { chargers: &chargers, paces, ..Mission::new(map, &starts, &goals) };
    let mut team = team(&mission, faults, seed);
    (0..size).zip(ticks).for_each(|(robot, ticks)| team.set_pace(robot, ticks));
    judge::fly(&mut team, 800)
}

/// A map with walls in about a tenth of its cells, and at least so many free cells within reach of
/// each other.
fn ground(random: &mut Random, least: usize) -> (Map<2>, Vec<Cell>) {
    let mut planner = Planner::<49>::new();
    loop {
        let mut map = Map::new(7, 7).expect("49 cells fit two words");
        for cell in 0..49 {
            if random.bernoulli(0.1) {
                map.block(Cell(cell));
            }
        }
        let mut free: Vec<Cell> = (0..49).map(Cell).filter(|&cell| map.is_free(cell)).collect();
        let anchor = free[0];
        free.retain(|&cell| planner.shortest(&map, anchor, cell).is_ok());
        if free.len() >= least {
            return (map, free);
        }
    }
}

/// Flies many missions; returns in how many all robots arrived.
fn campaign(name: &str, faults: Faults) -> usize {
    campaign_of(RUNS, name, faults)
}

fn campaign_of(runs: u64, name: &str, faults: Faults) -> usize {
    let mut arrived = 0;
    for seed in 0..runs {
        let outcome = fly(seed, faults);
        assert_eq!(outcome.collisions, 0, "{name}: seed {seed}: {outcome:?}");
        arrived += usize::from(outcome.arrived.is_some());
    }
    println!("{name}: all arrived in {arrived} of {runs}");
    arrived
}

#[test]
fn with_a_perfect_radio() {
    assert!(campaign("perfect", Faults::default()) >= 195);
}

#[test]
fn with_a_third_of_the_frames_lost_late_or_twice() {
    let faults = Faults { radio: radio(0.3, 3, 0.2), ..Faults::default() };
    assert!(campaign("lossy", faults) >= 195);
}

#[test]
fn with_most_of_the_frames_lost() {
    let faults = Faults { radio: radio(0.7, 5, 0.5), ..Faults::default() };
    assert!(campaign("deaf", faults) >= 195);
}

#[test]
fn with_moves_that_fail_and_obstacles_that_appear() {
    let faults = Faults { radio: radio(0.2, 0, 0.0), slip: 0.1, obstacle: 0.05, ..Faults::default() };
    assert!(campaign("rough ground", faults) >= 192);
}

#[test]
fn with_localisers_that_err_as_often_as_the_model_says() {
    let faults = Faults { radio: radio(0.2, 0, 0.0), misreading: 0.0048, ..Faults::default() };
    assert!(campaign("misread", faults) >= 195);
}

#[test]
fn with_low_batteries_and_way_points() {
    let faults = Faults { low_battery: 0.02, errand: 0.02, ..Faults::default() };
    assert!(campaign_of(LONG_RUNS, "errands", faults) >= 142);
}

#[test]
fn with_low_batteries_and_way_points_and_everything_else_that_goes_wrong() {
    let faults = Faults {
        radio: radio(0.3, 3, 0.2),
        slip: 0.05,
        misreading: 0.0048,
        obstacle: 0.01,
        low_battery: 0.02,
        errand: 0.02,
        ..Faults::default()
    };
    assert!(campaign_of(LONG_RUNS, "hard day", faults) >= 122);
}

#[test]
fn with_low_batteries_and_robots_that_restart() {
    let faults = Faults {
        radio: radio(0.2, 3, 0.0),
        slip: 0.05,
        restart: 0.01,
        low_battery: 0.02,
        errand: 0.02,
        ..Faults::default()
    };
    assert!(campaign_of(LONG_RUNS, "restarts away", faults) >= 144);
}

#[test]
fn with_robots_that_restart_at_any_moment() {
    let faults = Faults { radio: radio(0.2, 2, 0.0), slip: 0.05, restart: 0.02, ..Faults::default() };
    assert!(campaign("restarts", faults) >= 193);
}

#[test]
fn with_no_radio_at_all_nobody_moves() {
    for seed in 0..20 {
        let outcome = fly(seed, Faults { radio: radio(1.0, 0, 0.0), ..Faults::default() });
        assert_eq!((outcome.arrived, outcome.collisions), (None, 0));
    }
}

mod with_robots_of_different_paces {
    use super::*;

    /// Robots whose moves take up to six ticks, on all kinds of ground; returns in how many
    /// missions all arrived.
    fn campaign(faults: Faults, paces: fn([u32; 5]) -> [u8; 5]) -> usize {
        let outcomes = (0..RUNS).map(|seed| {
            let ticks = [0, 1, 2, 3, 4].map(|robot| 1 + ((seed / 4 + robot * 5) % 6) as u32);
            let outcome = fly_at(seed, faults, ticks, &paces(ticks));
            assert_eq!(outcome.collisions, 0, "seed {seed}, {ticks:?}: {outcome:?}");
            outcome
        });
        let arrived = outcomes.filter(|outcome| outcome.arrived.is_some()).count();
        println!("paces: all arrived in {arrived} of {RUNS}");
        arrived
    }

    fn known(ticks: [u32; 5]) -> [u8; 5] {
        ticks.map(|ticks| ticks as u8)
    }

    #[test]
    fn who_know_each_other() {
        let arrived = campaign(Faults::default(), known);
        assert!(arrived >= 195, "{arrived}");
    }

    #[test]
    fn who_take_each_other_for_equal() {
        let arrived = campaign(Faults::default(), |_| [1; 5]);
        assert!(arrived >= 195, "{arrived}");
    }

    #[test]
    fn who_are_wrong_about_each_other() {
        let arrived = campaign(Faults { radio: radio(0.2, 0, 0.0), ..Faults::default() }, |ticks| {
            let [a, b, c, d, e] = known(ticks);
            [b, c, d, e, a]
        });
        assert!(arrived >= 195, "{arrived}");
    }

    #[test]
    fn with_half_of_the_frames_lost_late_or_twice() {
        let faults = Faults { radio: radio(0.5, 3, 0.2), ..Faults::default() };
        let arrived = campaign(faults, known);
        assert!(arrived >= 195, "{arrived}");
    }

    #[test]
    fn with_moves_that_fail_and_obstacles_that_appear() {
        let faults = Faults { radio: radio(0.2, 0, 0.0), slip: 0.1, obstacle: 0.05, ..Faults::default() };
        let arrived = campaign(faults, known);
        assert!(arrived >= 190, "{arrived}");
    }

    #[test]
    fn with_robots_that_restart_at_any_moment() {
        let faults = Faults { radio: radio(0.2, 2, 0.0), slip: 0.05, restart: 0.005, ..Faults::default() };
        let arrived = campaign(faults, known);
        assert!(arrived >= 190, "{arrived}");
    }
}

/// A teammate that says anything a frame can carry, mostly of a round that the team may be in.
fn nonsense(random: &mut Random, sequence: u32) -> Said {
    let cell = |random: &mut Random| {
        let cells = if random.bernoulli(0.1) { 65536 } else { 49 };
        Cell(random.below(cells) as u16)
    };
    let mut path = Path::at(cell(random));
    for _ in 0..random.below(HORIZON + 1) {
        path.push(Move::ALL[random.below(5)]).expect("within the horizon");
    }
    let all = [Stage::Deciding, Stage::Announced, Stage::Agreed, Stage::Arrived, Stage::Away];
    let message = Intention {
        round: Round(sequence as u16 / 20 + random.below(2) as u16),
        stage: all[random.below(5)],
        plan: random.bits(),
        goal: random.bernoulli(0.5).then(|| cell(random)),
        step: random.below(path.len() + 1) as u8,
        path,
        probability: random.bits() as f32 / u32::MAX as f32,
        hazards: (0..random.below(5)).map(|_| cell(random)).collect(),
    };
    Said { sender: RobotId(2), stamp: Stamp { epoch: 9, sequence }, message }
}

/// The ticks after which the team of the factory has arrived.
fn arrival(faults: Faults) -> u32 {
    let (starts, goals) = ([Cell(28), Cell(2), Cell(45)], [Cell(24), Cell(26), Cell(32)]);
    let mission = Mission::new(reproduce::map(), &starts, &goals);
    let outcome = judge::fly(&mut team(&mission, faults, 3), 200);
    assert_eq!(outcome.collisions, 0);
    outcome.arrived.expect("it arrives")
}

#[test]
fn noise_on_the_line_makes_no_team_deaf() {
    let usual = arrival(Faults::default());
    for stray in [1, 3, 200] {
        let noisy = arrival(Faults { radio: Radio { stray, ..Radio::default() }, ..Faults::default() });
        assert!(noisy <= 2 * usual, "{stray} bytes before every frame: {noisy} ticks in place of {usual}");
    }
    // A line of 115,200 baud carries 1,152 bytes in a tick of 100 ms.
    let flooded = arrival(Faults { radio: Radio { garbage: 1152, ..Radio::default() }, ..Faults::default() });
    assert!(flooded <= 2 * usual, "garbage at line rate: {flooded} ticks in place of {usual}");
}

#[test]
fn with_a_teammate_that_talks_nonsense_nobody_breaks() {
    let (starts, goals) = ([Cell(28), Cell(2), Cell(45)], [Cell(24), Cell(26), Cell(32)]);
    let mission = Mission::new(reproduce::map(), &starts, &goals);
    for seed in 0..20 {
        let mut random = Random::new(seed);
        let mut team = team(&mission, Faults::default(), seed);
        team.silence(2, true);
        for sequence in 0..400 {
            overhear(&mut team, &mission, &nonsense(&mut random, sequence));
            team.tick();
            for report in team.reports() {
                assert!(report.path.is_open(&mission.map) && (0.0..=1.0).contains(&report.probability));
            }
        }
    }
}
