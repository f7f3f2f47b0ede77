//! Robots of teams of two, four and eight on the chip, in step with their teammates on the host:
//! the same frames bit for bit, and what their ticks take.

use firmware::bench::joint_plans::Planner;
use firmware::bench::lockstep::{self, CELLS, KEY, WORDS, problem, robot};
use firmware::bench::sign;
use firmware::missions::{LAYERS, NODES, POLICIES};
use host_sim::{Faults, NavigatorFlight, Reading};
use iibt_core::grid::Cell;
use std::path::Path;
use tests::budgets::{assert_stack_within, assert_within};
use tests::qemu::{Robot, image, image_for, number};

/// Robots with the sizes of the images, on any map.
type OnMap<'m, const S: usize, const W: usize> = NavigatorFlight<'m, S, W, LAYERS, NODES, POLICIES>;

type Flight<'m> = OnMap<'m, CELLS, WORDS>;

/// A team that looks for the bay that serves.
type Looking<'m> = OnMap<'m, { sign::CELLS }, { sign::WORDS }>;

/// The problems that a team flies, of those in which all can come to goals.
const FLIGHTS: usize = 8;

/// The instructions of ticks, by what the robot does in them.
#[derive(Debug, Default)]
struct Measured {
    /// Neither of the two below: it stands in a round or drives.
    ordinary: Vec<u64>,
    /// It makes the list of joint policies and scores it.
    listing: Vec<u64>,
    /// It knows all scores, weighs the list, and moves.
    deciding: Vec<u64>,
}

impl Measured {
    /// Flies a problem until all have arrived, one of the robots on the chip.
    fn fly(&mut self, image: &Path, robots: usize, draw: usize) {
        let problem = problem(robots, draw).expect("it has a plan");
        let (mission, number) = (problem.mission(), draw % robots);
        let mut flight = Flight::with_key(&mission, KEY, Faults::default(), 0).expect("it is sound");
        let mut chip = Robot::boot_counting(image);
        chip.wait_for("boot");
        chip.send(&[robots as u8, draw as u8, number as u8, 0]);
        self.follow(&mut flight, &mut chip, number);
    }

    /// Prints the ticks of a team by their kinds.
    fn tell(&self, team: &str) {
        let Self { ordinary, listing, deciding } = self;
        for (kind, ticks) in [("ordinary", ordinary), ("listing", listing), ("deciding", deciding)] {
            println!("{team}: {} {kind} ticks, mean {}, worst {}", ticks.len(), mean(ticks), worst(ticks));
        }
    }

    /// Flies the mission with the sign until all have arrived, one of the robots on the chip.
    fn look(&mut self, image: &Path, robots: usize, number: usize, (serving, seed): (u8, u64)) {
        let mission = sign::mission(robots).expect("a team");
        let mut flight = Looking::with_key(&mission, KEY, Faults::default(), seed).expect("it is sound");
        let mut chip = Robot::boot_counting(image);
        chip.wait_for("boot");
        chip.send(&[robots as u8, serving, number as u8, 2]);
        self.follow(&mut flight, &mut chip, number);
    }

    /// Flies until all have arrived, and keeps what the ticks of the robot on the chip take.
    fn follow<const S: usize, const W: usize>(
        &mut self,
        flight: &mut OnMap<'_, S, W>,
        chip: &mut Robot,
        number: usize,
    ) {
        let stage = |flight: &OnMap<'_, S, W>| {
            let protocol = flight.robot(number).robot().navigation().rounds().map(|rounds| rounds.protocol());
            protocol.map(|protocol| (protocol.proposal().round, protocol.digest(), protocol.has_decided()))
        };
        let mut heard = Vec::new();
        while !flight.has_arrived() {
            assert!(flight.ticks() < 60, "no arrival");
            let before = stage(flight);
            let took = in_step(flight, chip, number, &mut heard);
            let after = stage(flight);
            let has = |decided: bool, stage: Option<(u32, Option<_>, bool)>| {
                stage.is_some_and(|(_, digest, has_decided)| digest.is_some() && (has_decided || !decided))
            };
            let kind =
                match (has(false, after) && !has(false, before), has(true, after) && !has(true, before)) {
                    (true, _) => &mut self.listing,
                    (_, true) => &mut self.deciding,
                    _ => &mut self.ordinary,
                };
            kind.push(took);
        }
    }
}

/// Ticks the flight and the robot on the chip; returns the instructions that the latter took.
fn in_step<const S: usize, const W: usize>(
    flight: &mut OnMap<'_, S, W>,
    chip: &mut Robot,
    number: usize,
    heard: &mut Vec<u8>,
) -> u64 {
    let (robots, here) = (flight.cells().len(), flight.cells()[number]);
    flight.set_reading(number, Reading::Cell(here));
    flight.tick();
    let (took, frame) = tick(chip, here.0, heard);
    assert_eq!(frame, flight.sent(number).concat(), "tick {}: not the frame of the host", flight.ticks());
    let others = (0..robots).filter(|&other| other != number);
    *heard = others.flat_map(|other| flight.sent(other).concat()).collect();
    took
}

/// The instructions of a tick on the chip, and the frame that it sends.
fn tick(chip: &mut Robot, cell: u16, heard: &[u8]) -> (u64, Vec<u8>) {
    let length = u16::try_from(heard.len()).expect("eight frames");
    chip.send(&[&cell.to_le_bytes(), &length.to_le_bytes(), heard].concat());
    let [a, b, c, d, length] = chip.read();
    let mut frame = vec![0; length.into()];
    chip.fill(&mut frame);
    // An instruction takes a nanosecond, and the timer runs at 168 MHz.
    (u64::from(u32::from_le_bytes([a, b, c, d])) * 1000 / 168, frame)
}

fn mean(ticks: &[u64]) -> u64 {
    ticks.iter().sum::<u64>() / ticks.len().max(1) as u64
}

fn worst(ticks: &[u64]) -> u64 {
    ticks.iter().copied().max().unwrap_or(0)
}

#[test]
fn a_robot_of_any_team_ticks_on_the_chip_as_on_the_host_and_within_budget() {
    let image = image("lockstep");
    for robots in [2, 4, 8] {
        let (mut ticks, mut planner) = (Measured::default(), Planner::new());
        let mut has_plan =
            |&draw: &usize| problem(robots, draw).is_some_and(|problem| problem.plan(&mut planner).is_some());
        (0..).filter(|draw| has_plan(draw)).take(FLIGHTS).for_each(|draw| ticks.fly(&image, robots, draw));
        ticks.tell(&format!("{robots} robots"));
        let Measured { ordinary, listing, deciding } = &ticks;
        assert!(ordinary.len() > 5 * FLIGHTS && listing.len() > FLIGHTS / 2 && deciding.len() > FLIGHTS / 4);
        if robots == 8 {
            assert_within("team_of_eight", "ordinary_tick", mean(ordinary));
            assert_within("team_of_eight", "worst_ordinary_tick", worst(ordinary));
            assert_within("team_of_eight", "deciding_tick", mean(deciding));
        }
    }
}

/// A seed for each bay with which that is the one, by where a team ends.
fn worlds() -> Vec<(u8, u64)> {
    let mission = sign::mission(3).expect("a team");
    let mut found: [Option<u64>; 4] = [None; 4];
    for seed in 0..100 {
        let mut flight = Looking::with_key(&mission, KEY, Faults::default(), seed).expect("it is sound");
        while !flight.has_arrived() {
            assert!(flight.ticks() < 60, "no arrival with seed {seed}");
            flight.tick();
        }
        let is_held = |goal: &Cell| flight.cells().contains(goal);
        let bay = mission.goals.chunks(2).position(|bay| bay.iter().all(is_held)).expect("they are in a bay");
        found[bay].get_or_insert(seed);
    }
    (0..).zip(found).map(|(bay, seed)| (bay, seed.expect("each bay is drawn"))).collect()
}

/// The mission of `host-sim/scenarios/sign.toml` in each of its worlds, by three robots, and in the
/// likeliest and the least likely one by eight.
#[test]
fn a_robot_that_looks_for_the_bay_that_serves_ticks_on_the_chip_as_on_the_host() {
    let image = image_for("lockstep", "firmware", "thumbv7em-none-eabihf", "stm32f405,unknowns");
    let worlds = worlds();
    let few = [worlds[0], worlds[3]];
    let teams = [("sign_of_three", 3, &worlds[..]), ("sign_of_eight", 8, &few[..])];
    let measured = teams.map(|(name, robots, worlds)| {
        let mut ticks = Measured::default();
        for (place, &world) in worlds.iter().enumerate() {
            ticks.look(&image, robots, place % robots, world);
        }
        ticks.tell(&format!("sign, {robots} robots"));
        let Measured { ordinary, listing, .. } = &ticks;
        assert!(listing.len() >= worlds.len() && ordinary.len() > 8 * worlds.len());
        (name, worst(listing), worst(ordinary))
    });
    for (name, listing, ordinary) in measured {
        assert_within(name, "list_with_unknowns", listing);
        assert_within(name, "ordinary_tick_with_unknowns", ordinary);
    }
}

/// Eight robots that own their goals: in the tick in which the list is made, searches over all of
/// them follow each other. Beside the stack, what the robot takes of the statics.
#[test]
fn the_memory_of_a_team_that_searches_is_within_budget() {
    let problem = problem(8, 0).expect("the map has room");
    let mission = problem.mission_with_owners();
    let mut flight = Flight::with_key(&mission, KEY, Faults::default(), 0).expect("it is sound");
    let mut chip = Robot::boot_counting(&image("lockstep"));
    chip.wait_for("boot");
    chip.send(&[8, 0, 0, 1]);
    let navigation = chip.wait_for("navigation takes").message;
    assert_within("team_of_eight", "ram_of_navigation", number(&navigation, "takes ").into());
    let mut heard = Vec::new();
    in_step(&mut flight, &mut chip, 0, &mut heard); // the robot has been built
    let top = chip.pause().paint();
    let mut searched = 0;
    while !flight.has_arrived() && flight.ticks() < 30 {
        searched = searched.max(in_step(&mut flight, &mut chip, 0, &mut heard));
    }
    assert!(searched > 200_000, "{searched} instructions in no tick for a list");
    let used = top - chip.pause().lowest_used();
    assert_stack_within("team_of_eight", "stack_of_a_searching_tick", used.into());
}

#[test]
fn a_clock_that_jumps_back_silences_no_robot() {
    let problem = problem(2, 0).expect("the map has room");
    let (mission, here) = (problem.mission(), problem.mission().starts[0]);
    let mut robot = robot(&mission, 0).expect("the team has it");
    for instant in [5000, 5001, 10, 11, u32::MAX, 0] {
        robot.hardware_mut().clock = lockstep::Ticks(instant);
        assert!(!lockstep::tick(&mut robot, here).is_empty(), "silent at {instant}");
    }
}
