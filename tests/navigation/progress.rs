//! Localisers and drives that freeze: the robot notices, stands and says so, and goes on when its
//! readings follow its moves again.

use super::*;
use host_sim::{Device, Random};
use tests::ground::ground;

/// The missions of each kind, unless `IIBT_PROGRESS` says otherwise.
const MISSIONS: u64 = 150;

/// The ticks of a flight: long after the last robot that can arrive has done so.
const TICKS: u32 = 300;

/// How a mission went in which a device of one robot froze.
#[derive(Clone, Copy, Debug, Default)]
struct Struck {
    collisions: u32,
    /// The moves into walls that the robot made after that.
    into_walls: u32,
    /// The most moves in a row that did not change where the robot stands.
    without_progress: u32,
    /// Whether it stands and says that it is stuck.
    is_stuck: bool,
    /// Whether it has neither arrived by its readings nor says why.
    is_silent: bool,
    /// Whether all others have arrived.
    others_arrived: bool,
}

/// Flies a random mission of two to five robots; a device of one of them freezes in one of the
/// first ticks, after its localiser has been right.
fn fly(seed: u64, device: Device, faults: Faults) -> Struck {
    let mut random = Random::new(seed);
    let size = 2 + (seed % 4) as usize;
    let (map, mut free) = ground(&mut random, 2 * size);
    let mut draw = || free.swap_remove(random.below(free.len()));
    let starts: Vec<Cell> = (0..size).map(|_| draw()).collect();
    let goals: Vec<Cell> = (0..size).map(|_| draw()).collect();
    let mission = Mission::new(map, &starts, &goals);
    let (struck, tick) = (random.below(size), random.below(16) as u32);
    let mut team = Team::over(&mission, faults, seed).expect("a sound mission");
    let mut outcome = Struck::default();
    let mut row = 0;
    while team.ticks() < TICKS {
        if team.ticks() == tick {
            team.cause(EventEffect::Freeze(struck, device, None));
        }
        let before = team.cells()[struck];
        team.tick();
        let step = team.commands()[struck].filter(|_| team.ticks() > tick);
        let Some(step) = step else { continue };
        let to = team.floor().neighbour(before, step);
        outcome.into_walls += u32::from(to == before || !team.floor().is_free(to));
        row = if team.cells()[struck] == before { row + 1 } else { 0 };
        outcome.without_progress = outcome.without_progress.max(row);
    }
    outcome.collisions = team.collisions().shared + team.collisions().swapped;
    let Report { stage, waiting, .. } = report(&team, struck);
    outcome.is_stuck = stage == Stage::Stuck;
    outcome.is_silent = !matches!(stage, Stage::Stuck | Stage::Arrived) && waiting.is_none();
    let others = (0..size).filter(|&robot| robot != struck);
    outcome.others_arrived =
        others.map(|robot| team.statuses()[robot]).all(|status| status == Status::Success);
    outcome
}

fn missions() -> u64 {
    match std::env::var("IIBT_PROGRESS") {
        Ok(count) => count.parse().expect("IIBT_PROGRESS is a number of missions"),
        Err(_) => MISSIONS,
    }
}

/// Flies the missions of one kind; prints and returns what came out.
fn campaign(name: &str, device: Device, faults: Faults) -> Vec<Struck> {
    let flown: Vec<Struck> = (0..missions()).map(|seed| fly(seed, device, faults)).collect();
    let count = |is: fn(&Struck) -> bool| flown.iter().filter(|struck| is(struck)).count();
    println!(
        "{name}: of {} missions {} with collisions, {} stuck at the end, {} neither stuck nor arrived nor waiting, {} in which all others arrived; \
         at most {} moves into walls, {} in a row without progress",
        flown.len(),
        count(|struck| struck.collisions > 0),
        count(|struck| struck.is_stuck),
        count(|struck| struck.is_silent),
        count(|struck| struck.others_arrived),
        flown.iter().map(|struck| struck.into_walls).max().expect("flights"),
        flown.iter().map(|struck| struck.without_progress).max().expect("flights"),
    );
    for (seed, struck) in
        flown.iter().enumerate().filter(|(_, s)| s.collisions > 0 || s.into_walls > 3 || s.is_silent)
    {
        println!("{name}: seed {seed}: {struck:?}");
    }
    flown
}

fn is_safe(flown: &[Struck]) -> bool {
    flown.iter().all(|struck| struck.collisions == 0 && struck.into_walls <= 3)
}

#[test]
fn a_robot_whose_localiser_freezes_hits_nobody_and_stops() {
    let flown = campaign("frozen localiser", Device::Localiser, Faults::default());
    assert!(is_safe(&flown) && flown.iter().any(|struck| struck.is_stuck));
}

#[test]
fn a_robot_whose_localiser_freezes_hits_nobody_where_a_third_of_the_frames_is_lost() {
    let radio = Radio { loss: 0.3, jitter: 3, duplicate: 0.2, ..Radio::default() };
    let flown = campaign("frozen localiser, lossy", Device::Localiser, Faults { radio, ..Faults::default() });
    assert!(is_safe(&flown));
}

#[test]
fn a_robot_whose_drive_stalls_stops() {
    let flown = campaign("stalled drive", Device::Drive, Faults::default());
    assert!(is_safe(&flown) && flown.iter().any(|struck| struck.is_stuck));
}

/// Ticks a team until something holds; returns whether it does before a tick.
fn ticks_until(team: &mut Team<'_>, limit: u32, holds: impl Fn(&Team<'_>) -> bool) -> bool {
    while !holds(team) && team.ticks() < limit {
        team.tick();
    }
    holds(team)
}

/// The robot notices within the time of three moves, its leaf fails at its timeout, and when the
/// localiser works again, all arrive.
#[test]
fn a_localiser_that_works_again_is_believed_once_a_reading_follows_a_move() {
    let mission = factory();
    for device in Device::ALL {
        let mut team = agreed(&mission);
        team.cause(EventEffect::Freeze(0, device, Some(150)));
        let is_stuck = |team: &Team<'_>| report(team, 0).stage == Stage::Stuck;
        assert!(ticks_until(&mut team, 40, is_stuck), "{device:?}: it is not stuck");
        let tells = |team: &Team<'_>| report(team, 0).cause == Some(Cause::NoProgress);
        assert!(ticks_until(&mut team, 40, tells), "{device:?}: it does not tell why");
        let fails = |team: &Team<'_>| team.statuses()[0] == Status::Failure;
        assert!(ticks_until(&mut team, 160, fails), "{device:?}: its leaf does not fail");
        assert!(ticks_until(&mut team, 600, stopped), "{device:?}: they do not arrive");
        assert_eq!((team.collisions().shared, team.collisions().swapped), (0, 0));
        assert!(on_goals(&team, &mission), "{device:?}: on {:?}", cells(&team));
    }
}

/// Moves that fail are repeated: they are no reason to stand.
#[test]
fn a_drive_that_fails_once_in_ten_moves_is_seldom_stuck_and_never_for_good() {
    let mission = factory();
    let (mut stuck, mut ticks) = (0, 0);
    for seed in 0..200 {
        let mut team = Team::over(&mission, Faults { slip: 0.1, ..Faults::default() }, seed).expect("sound");
        let mut is_stuck = false;
        while !stopped(&team) {
            team.tick();
            is_stuck |= team.reports().iter().any(|report| report.stage == Stage::Stuck);
            assert!(team.ticks() < 400, "seed {seed}");
        }
        (stuck, ticks) = (stuck + u32::from(is_stuck), ticks + team.ticks());
    }
    println!("slips: {stuck} of 200 teams had a robot that was stuck; {} ticks in the mean", ticks / 200);
    assert!(stuck <= 50 && ticks / 200 <= 20, "{stuck}");
}
