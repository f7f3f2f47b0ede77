//! Whatever the radio, the drive and the world do: no two robots ever share or swap a cell.

use host_sim::reproduce;
use iibt_core::actions::HORIZON;
use iibt_core::grid::{Cell, Map, Move, Path, Planner};
use iibt_core::navigation::{Intention, Mission, Round, Said, Stage};
use iibt_core::team::{RobotId, Stamp};
use tests::team::{Hardship, Outcome, Random, Team};

const RUNS: u64 = 200;

/// How many missions with errands, which take longer.
const LONG_RUNS: u64 = 150;

/// A random map with walls in a tenth of its cells, and a team of two to five robots with as many goals, and chargers for
/// all but the last robot, all within reach of each other.
fn fly(seed: u64, hardship: Hardship) -> Outcome {
    fly_at(seed, hardship, [1; 5], &[])
}

/// The same with robots whose moves take so many ticks, and what they take for the steps of a plan that those are.
fn fly_at(seed: u64, hardship: Hardship, ticks: [u32; 5], paces: &[u8]) -> Outcome {
    let mut random = Random::new(seed);
    let mut map = Map::new(7, 7).expect("49 cells fit two words");
    for cell in 0..49 {
        if random.chance(0.1) {
            map.block(Cell(cell));
        }
    }
    let mut free: Vec<Cell> = (0..49).map(Cell).filter(|&cell| map.is_free(cell)).collect();
    let mut planner = Planner::<49>::new();
    let anchor = free[0];
    free.retain(|&cell| planner.shortest(&map, anchor, cell).is_ok());
    let mut draw = || free.swap_remove(random.below(free.len() as u32) as usize);
    let size = 2 + (seed % 4) as usize;
    let starts: Vec<Cell> = (0..size).map(|_| draw()).collect();
    let goals: Vec<Cell> = (0..size).map(|_| draw()).collect();
    let chargers: Vec<Option<Cell>> = (1..size).map(|_| Some(draw())).collect();
    let mission = Mission { chargers: &chargers, paces, ..Mission::new(map, &starts, &goals) };
    Team::new(&mission, hardship, seed).at_paces(ticks).fly(800)
}

/// Flies many missions; returns in how many all robots arrived.
fn campaign(name: &str, hardship: Hardship) -> usize {
    campaign_of(RUNS, name, hardship)
}

fn campaign_of(runs: u64, name: &str, hardship: Hardship) -> usize {
    let mut arrived = 0;
    for seed in 0..runs {
        let outcome = fly(seed, hardship);
        assert_eq!(outcome.collisions, 0, "{name}: seed {seed}: {outcome:?}");
        arrived += usize::from(outcome.arrived.is_some());
    }
    println!("{name}: all arrived in {arrived} of {runs}");
    arrived
}

#[test]
fn with_a_perfect_radio() {
    assert!(campaign("perfect", Hardship::default()) >= 195);
}

#[test]
fn with_a_third_of_the_frames_lost_late_or_twice() {
    let hardship = Hardship { loss: 0.3, delay: 3, duplicates: 0.2, ..Hardship::default() };
    assert!(campaign("lossy", hardship) >= 195);
}

#[test]
fn with_most_of_the_frames_lost() {
    let hardship = Hardship { loss: 0.7, delay: 5, duplicates: 0.5, ..Hardship::default() };
    assert!(campaign("deaf", hardship) >= 170);
}

#[test]
fn with_moves_that_fail_and_obstacles_that_appear() {
    let hardship = Hardship { loss: 0.2, slip: 0.1, obstacle: 0.05, ..Hardship::default() };
    assert!(campaign("rough ground", hardship) >= 185);
}

#[test]
fn with_localisers_that_err_as_often_as_the_model_says() {
    let hardship = Hardship { loss: 0.2, misreading: 0.0048, ..Hardship::default() };
    assert!(campaign("misread", hardship) >= 190);
}

#[test]
fn with_low_batteries_and_way_points() {
    let hardship = Hardship { low_battery: 0.02, errand: 0.02, ..Hardship::default() };
    assert!(campaign_of(LONG_RUNS, "errands", hardship) >= 145);
}

#[test]
fn with_low_batteries_and_way_points_and_everything_else_that_goes_wrong() {
    let hardship = Hardship {
        loss: 0.3,
        delay: 3,
        duplicates: 0.2,
        slip: 0.05,
        misreading: 0.0048,
        obstacle: 0.01,
        low_battery: 0.02,
        errand: 0.02,
        ..Hardship::default()
    };
    assert!(campaign_of(LONG_RUNS, "hard day", hardship) >= 132);
}

#[test]
fn with_low_batteries_and_robots_that_restart() {
    let hardship = Hardship {
        loss: 0.2,
        delay: 3,
        slip: 0.05,
        restart: 0.01,
        low_battery: 0.02,
        errand: 0.02,
        ..Hardship::default()
    };
    assert!(campaign_of(LONG_RUNS, "restarts away", hardship) >= 138);
}

#[test]
fn with_robots_that_restart_at_any_moment() {
    let hardship = Hardship { loss: 0.2, delay: 2, slip: 0.05, restart: 0.02, ..Hardship::default() };
    // A restart in every tenth tick leaves some teams no time.
    assert!(campaign("restarts", hardship) >= 100);
}

#[test]
fn with_no_radio_at_all_nobody_moves() {
    for seed in 0..20 {
        let outcome = fly(seed, Hardship { loss: 1.1, ..Hardship::default() });
        assert_eq!((outcome.arrived, outcome.collisions), (None, 0));
    }
}

mod with_robots_of_different_paces {
    use super::*;

    /// Robots whose moves take up to six ticks, on all kinds of ground; returns in how many missions all arrived.
    fn campaign(hardship: Hardship, paces: fn([u32; 5]) -> [u8; 5]) -> usize {
        let outcomes = (0..RUNS).map(|seed| {
            let ticks = [0, 1, 2, 3, 4].map(|robot| 1 + ((seed / 4 + robot * 5) % 6) as u32);
            let outcome = fly_at(seed, hardship, ticks, &paces(ticks));
            assert_eq!(outcome.collisions, 0, "seed {seed}, {ticks:?}: {outcome:?}");
            outcome
        });
        outcomes.filter(|outcome| outcome.arrived.is_some()).count()
    }

    fn known(ticks: [u32; 5]) -> [u8; 5] {
        ticks.map(|ticks| ticks as u8)
    }

    #[test]
    fn who_know_each_other() {
        let arrived = campaign(Hardship::default(), known);
        assert!(arrived >= 195, "{arrived}");
    }

    #[test]
    fn who_take_each_other_for_equal() {
        let arrived = campaign(Hardship::default(), |_| [1; 5]);
        assert!(arrived >= 195, "{arrived}");
    }

    #[test]
    fn who_are_wrong_about_each_other() {
        let arrived = campaign(Hardship { loss: 0.2, ..Hardship::default() }, |ticks| {
            let [a, b, c, d, e] = known(ticks);
            [b, c, d, e, a]
        });
        assert!(arrived >= 190, "{arrived}");
    }

    #[test]
    fn with_half_of_the_frames_lost_late_or_twice() {
        let hardship = Hardship { loss: 0.5, delay: 3, duplicates: 0.2, ..Hardship::default() };
        let arrived = campaign(hardship, known);
        assert!(arrived >= 180, "{arrived}");
    }

    #[test]
    fn with_moves_that_fail_and_obstacles_that_appear() {
        let hardship = Hardship { loss: 0.2, slip: 0.1, obstacle: 0.05, ..Hardship::default() };
        let arrived = campaign(hardship, known);
        assert!(arrived >= 170, "{arrived}");
    }

    #[test]
    fn with_robots_that_restart_at_any_moment() {
        let hardship = Hardship { loss: 0.2, delay: 2, slip: 0.05, restart: 0.005, ..Hardship::default() };
        let arrived = campaign(hardship, known);
        assert!(arrived >= 120, "{arrived}");
    }
}

/// A teammate that says anything a frame can carry, mostly of a round that the team may be in.
fn nonsense(random: &mut Random, sequence: u32) -> Said {
    let cell = |random: &mut Random| {
        let cells = if random.chance(0.1) { 65536 } else { 49 };
        Cell(random.below(cells) as u16)
    };
    let mut path = Path::at(cell(random));
    for _ in 0..random.below(HORIZON as u32 + 1) {
        path.push(Move::ALL[random.below(5) as usize]).expect("within the horizon");
    }
    let all = [Stage::Deciding, Stage::Announced, Stage::Agreed, Stage::Arrived, Stage::Away];
    let message = Intention {
        round: Round(sequence as u16 / 20 + random.below(2) as u16),
        stage: all[random.below(5) as usize],
        plan: random.bits(),
        goal: random.chance(0.5).then(|| cell(random)),
        step: random.below(path.len() as u32 + 1) as u8,
        path,
        probability: random.bits() as f32 / u32::MAX as f32,
        hazards: (0..random.below(5)).map(|_| cell(random)).collect(),
    };
    Said { sender: RobotId(2), stamp: Stamp { epoch: 9, sequence }, message }
}

/// The ticks after which the team of the factory has arrived.
fn arrival(hardship: Hardship) -> u32 {
    let (starts, goals) = ([Cell(28), Cell(2), Cell(45)], [Cell(24), Cell(26), Cell(32)]);
    let mission = Mission::new(reproduce::map(), &starts, &goals);
    let outcome = Team::new(&mission, hardship, 3).fly(200);
    assert_eq!(outcome.collisions, 0);
    outcome.arrived.expect("it arrives")
}

#[test]
fn noise_on_the_line_makes_no_team_deaf() {
    let usual = arrival(Hardship::default());
    for stray in [1, 3, 200] {
        let noisy = arrival(Hardship { stray, ..Hardship::default() });
        assert!(noisy <= 2 * usual, "{stray} bytes before every frame: {noisy} ticks in place of {usual}");
    }
    // A line of 115,200 baud carries 1,152 bytes in a tick of 100 ms.
    let flooded = arrival(Hardship { garbage: 1152, ..Hardship::default() });
    assert!(flooded <= 2 * usual, "garbage at line rate: {flooded} ticks in place of {usual}");
}

#[test]
fn with_a_teammate_that_talks_nonsense_nobody_breaks() {
    let (starts, goals) = ([Cell(28), Cell(2), Cell(45)], [Cell(24), Cell(26), Cell(32)]);
    let mission = Mission::new(reproduce::map(), &starts, &goals);
    for seed in 0..20 {
        let mut random = Random::new(seed);
        let mut team = Team::new(&mission, Hardship::default(), seed);
        team.silence(2, true);
        for sequence in 0..400 {
            team.overhear(&nonsense(&mut random, sequence));
            team.tick();
            for robot in &team.robots {
                let report = robot.robot().navigation().report();
                assert!(report.path.is_open(&mission.map) && (0.0..=1.0).contains(&report.probability));
            }
        }
    }
}
