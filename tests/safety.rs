//! Whatever the radio, the drive and the world do: no two robots ever share or swap a cell.
//!
//! How many teams must arrive is what was measured less some three standard deviations of such a
//! count, and five where nearly all arrive: another stream of random numbers passes. Of teams for
//! which all is within reach at most one may be held up; four where way-points can ask for plans
//! that a search of the image's size does not find; two where a move that has failed leaves a robot
//! in doubt among teammates at other paces, so that no move of it is safe (116 of 56,000 teams).

use firmware::missions::{LAYERS, NODES, POLICIES};
use host_sim::{EventEffect, Faults, NavigatorFlight, Radio, Random, reproduce};
use iibt_core::grid::{Cell, CellSet};
use iibt_core::navigation::{
    CellEvidence, Cells, Fact, Intention, MAX_EVIDENCE, Mission, Purpose, Report, Stage,
};
use iibt_core::team::rounds::{Answer, Choice, Claim, Digest, Proposal, RoundMessage, Score, Scores, View};
use iibt_core::team::{Envelope, RobotId, Stamp};
use iibt_core::time::Instant;
use iibt_core::tree::Status;
use tests::ground::ground;
use tests::judge::{self, Outcome};
use tests::rig::{context, overhear};

/// The missions of a campaign: the nineteen campaigns together fly 11,400. `tests/nightly` sets
/// another number in `IIBT_SAFETY`.
const RUNS: u64 = 600;

/// The ticks after which a team is held up.
const LIMIT: u32 = 800;

/// Robots with the sizes of the images.
type Team<'m> = NavigatorFlight<'m, 49, 2, LAYERS, NODES, POLICIES>;

/// A team whose clocks wrap after some ticks.
fn team<'m>(mission: &'m Mission<'m, 2>, faults: Faults, seed: u64) -> Team<'m> {
    Team::over(mission, faults, seed).expect("a sound mission").beginning_at(Instant(u32::MAX - 50))
}

/// A radio that loses and doubles copies with these probabilities, and delays them by up to so many
/// ticks more.
fn radio(loss: f64, jitter: u32, duplicate: f64) -> Radio {
    Radio { loss, jitter, duplicate, ..Radio::default() }
}

/// How a mission ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    /// All that are alive have arrived.
    Arrived,
    /// What has appeared, or the cells that a dead robot may be on, cut off a goal, way-point or
    /// charger.
    CutOff,
    /// They have not arrived, though all is within reach.
    HeldUp,
    /// Two robots have shared or swapped a cell.
    Collided,
}

/// How many missions ended in which way.
#[derive(Clone, Copy, Debug, Default)]
struct Fates {
    arrived: usize,
    cut_off: usize,
    held_up: usize,
    collided: usize,
}

impl Fates {
    /// Counts the fates of the missions of a campaign, by their seeds.
    fn of(name: &str, fly: impl Fn(u64) -> Fate) -> Self {
        let (mut fates, runs) = (Self::default(), runs());
        for seed in 0..runs {
            let fate = fly(seed);
            match fate {
                Fate::Arrived => fates.arrived += 1,
                Fate::CutOff => fates.cut_off += 1,
                Fate::HeldUp => fates.held_up += 1,
                Fate::Collided => fates.collided += 1,
            }
            if matches!(fate, Fate::HeldUp | Fate::Collided) {
                println!("{name}: seed {seed}: {fate:?}");
            }
        }
        let Self { arrived, cut_off, held_up, collided } = fates;
        let last = runs - 1;
        println!(
            "{name}: seeds 0 to {last}: {arrived} arrived, {cut_off} cut off, {held_up} held up, {collided} collided"
        );
        fates
    }

    /// Fails unless so many of 500 teams have arrived, no more than so many of 600 were held up,
    /// and none collided.
    fn are_good(self, arrived: u64, held_up: u64) {
        assert_eq!(self.collided, 0, "{self:?}");
        let (arrived, held_up) = (arrived * runs() / 500, held_up * runs().div_ceil(RUNS));
        assert!(self.arrived as u64 >= arrived && self.held_up as u64 <= held_up, "{self:?}");
    }
}

/// The missions of a campaign.
fn runs() -> u64 {
    match std::env::var("IIBT_SAFETY") {
        Ok(runs) => runs.parse().ok().filter(|&runs| runs > 0).expect("IIBT_SAFETY is a number of missions"),
        Err(_) => RUNS,
    }
}

/// A random map with walls in a tenth of its cells, and a team of two to five robots with as many
/// goals, and chargers for all but the last robot, all within reach of each other.
fn fly(seed: u64, faults: Faults) -> Fate {
    fly_at(seed, faults, [1; 5], &[])
}

/// The same with robots whose moves take so many ticks, and what they take for the steps of a plan
/// that those are.
fn fly_at(seed: u64, faults: Faults, ticks: [u32; 5], paces: &[u8]) -> Fate {
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
    let outcome = judge::fly(&mut team, LIMIT);
    if outcome.collisions > 0 {
        return Fate::Collided;
    }
    let misses = outcome.arrived.is_some() && team.cells().iter().any(|cell| !goals.contains(cell));
    assert!(!misses || faults.misreading > 0.0, "seed {seed}: not on goals, but on {:?}", team.cells());
    fate(&team, &mission, &(0..size).collect::<Vec<_>>(), outcome)
}

/// How a mission ended for these robots of its team.
fn fate(team: &Team<'_>, mission: &Mission<'_, 2>, robots: &[usize], outcome: Outcome) -> Fate {
    if outcome.arrived.is_some() {
        Fate::Arrived
    } else if is_cut_off(team, mission, robots) {
        Fate::CutOff
    } else {
        println!("held up: {}", state(team));
        Fate::HeldUp
    }
}

/// Whether a way-point or a charger is out of reach, or some of the robots can come to fewer goals
/// than they are. A robot can leave the walls of the round, but not enter them.
fn is_cut_off(team: &Team<'_>, mission: &Mission<'_, 2>, robots: &[usize]) -> bool {
    let walls = walls(team, robots[0]);
    let near = |&robot: &usize| {
        let from = team.cells()[robot];
        let is_closed = |cell: &Cell| !team.floor().is_free(*cell) || walls.contains(*cell);
        let closed = (0..49).map(Cell).filter(|&cell| cell != from).filter(is_closed);
        mission.map.avoiding(closed).connected(from)
    };
    let near: Vec<CellSet<2>> = robots.iter().map(near).collect();
    let is_errand_out_of_reach = |(&robot, near): (&usize, &CellSet<2>)| {
        let report = &team.reports()[robot];
        let charger = mission.charger(RobotId(robot as u8)).filter(|_| report.stage == Stage::Away);
        report.waypoint.into_iter().chain(charger).any(|errand| !near.contains(errand))
    };
    let goals: CellSet<2> = mission.goals.iter().copied().collect();
    let is_short = |group: u32| {
        let members = near.iter().enumerate().filter(|(robot, _)| group >> robot & 1 == 1);
        let within = members.fold(CellSet::EMPTY, |all, (_, near)| all.union(near));
        within.intersection(&goals).len() < group.count_ones() as usize
    };
    robots.iter().zip(&near).any(is_errand_out_of_reach) || (1..1 << robots.len()).any(is_short)
}

/// Where the robots that one of the team leaves out may be.
fn walls(team: &Team<'_>, robot: usize) -> CellSet<2> {
    let rounds = team.robot(robot).robot().navigation().rounds();
    let walls = rounds.into_iter().flat_map(|rounds| rounds.proposal().left_out(team.cells().len()));
    walls.fold(CellSet::EMPTY, |all, (_, wall)| all.union(&wall.0))
}

/// What keeps the robots of a team from arriving, for the one who looks into a failure.
fn state(team: &Team<'_>) -> String {
    let robot = |(report, cell): (&Report, &Cell)| {
        let waiting = report.waiting.map_or_else(String::new, |waiting| format!(", {waiting}"));
        let (round, members) = (report.round, report.members);
        let failure = report.failure.map_or_else(String::new, |failure| format!(", {failure:?}"));
        let errand = report.waypoint.map_or_else(String::new, |cell| format!(", to visit {}", cell.0));
        let short = if report.short_by > 0 { format!(", {} short", report.short_by) } else { String::new() };
        format!(
            "on {} {:?} in round {round} of {}{waiting}{failure}{short}{errand}",
            cell.0,
            report.stage,
            members.len()
        )
    };
    let robots: Vec<String> = team.reports().iter().zip(team.cells()).map(robot).collect();
    robots.join("; ")
}

/// Flies many missions.
fn campaign(name: &str, faults: Faults) -> Fates {
    Fates::of(name, |seed| fly(seed, faults))
}

#[test]
fn with_a_perfect_radio() {
    campaign("perfect", Faults::default()).are_good(495, 1);
}

#[test]
fn with_a_third_of_the_frames_lost_late_or_twice() {
    let faults = Faults { radio: radio(0.3, 3, 0.2), ..Faults::default() };
    campaign("lossy", faults).are_good(495, 1);
}

#[test]
fn with_most_of_the_frames_lost() {
    let faults = Faults { radio: radio(0.7, 5, 0.5), ..Faults::default() };
    campaign("deaf", faults).are_good(495, 1);
}

#[test]
fn with_frames_lost_in_bursts_of_twenty() {
    let faults = Faults { radio: Radio { burst: 20, ..radio(0.3, 0, 0.0) }, ..Faults::default() };
    campaign("bursts", faults).are_good(495, 1);
}

#[test]
fn with_moves_that_fail_and_obstacles_that_appear() {
    let faults = Faults { radio: radio(0.2, 0, 0.0), slip: 0.1, obstacle: 0.05, ..Faults::default() };
    campaign("rough ground", faults).are_good(494, 1);
}

#[test]
fn with_localisers_that_err_as_often_as_the_model_says() {
    let faults = Faults { radio: radio(0.2, 0, 0.0), misreading: 0.0048, ..Faults::default() };
    campaign("misread", faults).are_good(495, 1);
}

#[test]
fn with_low_batteries_and_way_points() {
    let faults = Faults { low_battery: 0.02, errand: 0.02, ..Faults::default() };
    campaign("errands", faults).are_good(491, 4);
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
    campaign("hard day", faults).are_good(415, 4);
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
    campaign("restarts away", faults).are_good(495, 4);
}

#[test]
fn with_robots_that_restart_at_any_moment() {
    let faults = Faults { radio: radio(0.2, 2, 0.0), slip: 0.05, restart: 0.02, ..Faults::default() };
    campaign("restarts", faults).are_good(495, 1);
}

#[test]
fn with_no_radio_at_all_nobody_moves() {
    for seed in 0..20 {
        assert_eq!(fly(seed, Faults { radio: radio(1.0, 0, 0.0), ..Faults::default() }), Fate::HeldUp);
    }
}

mod with_robots_of_different_paces {
    use super::*;

    /// Robots whose moves take up to six ticks, on all kinds of ground.
    fn campaign(name: &str, faults: Faults, paces: fn([u32; 5]) -> [u8; 5]) -> Fates {
        Fates::of(name, |seed| {
            let ticks = [0, 1, 2, 3, 4].map(|robot| 1 + ((seed / 4 + robot * 5) % 6) as u32);
            fly_at(seed, faults, ticks, &paces(ticks))
        })
    }

    fn known(ticks: [u32; 5]) -> [u8; 5] {
        ticks.map(|ticks| ticks as u8)
    }

    #[test]
    fn who_know_each_other() {
        let fates = campaign("paces known", Faults::default(), known);
        fates.are_good(495, 1);
    }

    #[test]
    fn who_take_each_other_for_equal() {
        let fates = campaign("paces taken for equal", Faults::default(), |_| [1; 5]);
        fates.are_good(495, 1);
    }

    #[test]
    fn who_are_wrong_about_each_other() {
        let fates =
            campaign("paces wrong", Faults { radio: radio(0.2, 0, 0.0), ..Faults::default() }, |ticks| {
                let [a, b, c, d, e] = known(ticks);
                [b, c, d, e, a]
            });
        fates.are_good(495, 1);
    }

    #[test]
    fn with_half_of_the_frames_lost_late_or_twice() {
        let faults = Faults { radio: radio(0.5, 3, 0.2), ..Faults::default() };
        let fates = campaign("paces, lossy", faults, known);
        fates.are_good(495, 1);
    }

    #[test]
    fn with_moves_that_fail_and_obstacles_that_appear() {
        let faults = Faults { radio: radio(0.2, 0, 0.0), slip: 0.1, obstacle: 0.05, ..Faults::default() };
        let fates = campaign("paces, rough ground", faults, known);
        fates.are_good(494, 2);
    }

    #[test]
    fn with_robots_that_restart_at_any_moment() {
        let faults = Faults { radio: radio(0.2, 2, 0.0), slip: 0.05, restart: 0.005, ..Faults::default() };
        let fates = campaign("paces, restarts", faults, known);
        fates.are_good(495, 1);
    }
}

/// A teammate that says anything a frame can carry, mostly of a round that the team may be in.
fn nonsense(random: &mut Random, sequence: u32, digest: Option<Digest>) -> Said {
    let view = View::full(3);
    let view = if random.bernoulli(0.8) {
        view
    } else {
        (0..3).map(RobotId).filter(|_| random.bernoulli(0.5)).collect()
    };
    let wall = |random: &mut Random| -> CellSet<2> { (0..random.below(20)).map(|_| cell(random)).collect() };
    let left_out = 3 - view.len();
    let proposal = Proposal {
        round: sequence / 20 + random.below(3) as u32,
        view,
        walls: (0..left_out).map(|_| Cells(wall(random)).to_wire(left_out)).collect(),
    };
    let (anchor, purpose, evidence) = (cell(random), purpose(random), evidence(random));
    let fact = Fact { anchor, purpose, evidence, ..Fact::default() };
    let room = MAX_EVIDENCE - fact.evidence.len();
    let waypoints = (0..random.below(room + 1)).map(|_| cell(random)).collect();
    let answer = answer(random, digest);
    Envelope {
        sender: RobotId(2),
        stamp: Stamp { epoch: 9, sequence },
        message: Intention { rounds: RoundMessage { proposal, fact, answer }, waypoints },
    }
}

type Said = Envelope<Intention<2, POLICIES>>;

/// Now and then one that the map does not have.
fn cell(random: &mut Random) -> Cell {
    let cells = if random.bernoulli(0.05) { 65536 } else { 49 };
    Cell(random.below(cells) as u16)
}

fn purpose(random: &mut Random) -> Purpose {
    let cell = cell(random);
    [Purpose::Goal, Purpose::Visit(cell), Purpose::Charge(cell), Purpose::Stand][random.below(4)]
}

fn evidence(random: &mut Random) -> iibt_core::navigation::Announced {
    let one = |random: &mut Random| CellEvidence { cell: cell(random), weight: random.bits() as i8 };
    (0..random.below(MAX_EVIDENCE + 1)).map(|_| one(random)).collect()
}

/// An answer, mostly to the digest that the others have.
fn answer(random: &mut Random, digest: Option<Digest>) -> Answer<POLICIES> {
    let own = Digest(random.bits().to_le_bytes());
    let digest = digest.filter(|_| random.bernoulli(0.7)).unwrap_or(own);
    let score = |random: &mut Random| Score { delay: random.bits() as u8, price: random.bits() as u8 };
    let scores: Scores<POLICIES> = (0..random.below(POLICIES + 1)).map(|_| score(random)).collect();
    match random.below(3) {
        0 => Answer::Listing(random.below(POLICIES + 1) as u8),
        1 => Answer::Scored { digest, scores },
        _ => {
            let policy = random.below(POLICIES) as u8;
            let choice = Choice { policy, probability: random.bits() as u8 };
            let is_listed = usize::from(policy) < scores.len();
            let choice = Some(choice).filter(|_| is_listed && random.bernoulli(0.9));
            Answer::Decided { digest, scores: Some(scores), choice, step: random.bits() as u16 % 12 }
        }
    }
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
    let (mut decided, mut refused) = (0, 0);
    for seed in 0..20 {
        let mut random = Random::new(seed);
        let mut team = team(&mission, Faults::default(), seed);
        team.silence(2, true);
        let context = context(team.robot(0).robot().navigation());
        for sequence in 0..400 {
            let digest =
                team.robot(0).robot().navigation().rounds().and_then(|rounds| rounds.protocol().digest());
            overhear(&mut team, context, &nonsense(&mut random, sequence, digest));
            team.tick();
            for report in team.reports() {
                assert!(report.path.is_open(&mission.map) && (0.0..=1.0).contains(&report.probability));
            }
            decided += u32::from(team.reports()[0].policy.is_some());
        }
        refused += team.robot(0).link_report().received.foreign;
    }
    println!("nonsense: decided in {decided} ticks, refused {refused} messages");
    assert!(decided > 0 && refused > 0);
}

mod with_a_robot_that_dies {
    use super::*;

    /// When a robot stops for good.
    #[derive(Clone, Copy)]
    enum Dies {
        /// Up to nine ticks after all others have heard it with a vector.
        HeardByAll,
        /// As soon as one has.
        HeardByOne,
    }

    /// A random mission of three to six robots of which one dies. Returns also whether a robot has
    /// arrived on a goal on which the dead one may be.
    fn fly(seed: u64, dies: Dies, faults: Faults) -> (Fate, bool) {
        let mut random = Random::new(seed);
        let size = 3 + (seed % 4) as usize;
        let (map, mut free) = ground(&mut random, 2 * size);
        let mut draw = || free.swap_remove(random.below(free.len()));
        let starts: Vec<Cell> = (0..size).map(|_| draw()).collect();
        let goals: Vec<Cell> = (0..size).map(|_| draw()).collect();
        let mission = Mission::new(map, &starts, &goals);
        let (dying, later) = (random.below(size), random.below(10) as u32);
        let others: Vec<usize> = (0..size).filter(|&robot| robot != dying).collect();
        let mut team = team(&mission, faults, seed);
        let (enough, after) = match dies {
            Dies::HeardByAll => (others.len(), later),
            Dies::HeardByOne => (1, 0),
        };
        let knowing = |team: &Team<'_>| others.iter().filter(|&&robot| knows(team, robot, dying)).count();
        let before = judge::fly_until(&mut team, LIMIT, |team| knowing(team) >= enough);
        let tick = before.arrived.expect("it is heard") + after;
        let meanwhile = judge::fly_until(&mut team, tick, |_| false);
        team.cause(EventEffect::Stop(dying, None));
        let have_arrived =
            |team: &Team<'_>| others.iter().all(|&robot| team.statuses()[robot] == Status::Success);
        let outcome = judge::fly_until(&mut team, LIMIT, |team| have_arrived(team));
        let collisions = before.collisions + meanwhile.collisions + outcome.collisions;
        if collisions > 0 {
            return (Fate::Collided, false);
        }
        let is_on_goal = |&robot: &usize| goals.contains(&team.cells()[robot]);
        assert!(outcome.arrived.is_none() || others.iter().all(is_on_goal), "seed {seed}: {}", state(&team));
        let walls = walls(&team, others[0]);
        let holds_closed = others.iter().any(|&robot| walls.contains(team.cells()[robot]));
        (fate(&team, &mission, &others, outcome), outcome.arrived.is_some() && holds_closed)
    }

    /// A third of the frames is lost, and others come late or twice.
    fn lossy() -> Faults {
        Faults { radio: radio(0.3, 3, 0.2), ..Faults::default() }
    }

    /// Whether a robot knows where a teammate can be, which it does once it has heard it with a
    /// vector.
    fn knows(team: &Team<'_>, robot: usize, teammate: usize) -> bool {
        let rounds = team.robot(robot).robot().navigation().rounds();
        rounds.is_some_and(|rounds| rounds.protocol().reach(RobotId(teammate as u8)).is_some())
    }

    #[test]
    fn the_others_arrive() {
        Fates::of("one dies", |seed| fly(seed, Dies::HeardByAll, Faults::default()).0).are_good(463, 1);
    }

    #[test]
    fn the_others_arrive_though_a_third_of_the_frames_is_lost_late_or_twice() {
        Fates::of("one dies, lossy", |seed| fly(seed, Dies::HeardByAll, lossy()).0).are_good(451, 1);
    }

    /// Who has heard it passes on its last frame. Else those that it has not reached could never
    /// know where it may be.
    #[test]
    fn the_others_arrive_though_it_has_reached_only_one_of_them() {
        Fates::of("one dies, heard by one", |seed| fly(seed, Dies::HeardByOne, lossy()).0).are_good(435, 1);
    }

    /// In one of some 300 flights a robot stands where the dead one may be by what the others know.
    #[test]
    fn a_robot_keeps_a_goal_where_the_dead_one_may_be() {
        assert!(
            (600..2600).any(|seed| fly(seed, Dies::HeardByAll, lossy()) == (Fate::Arrived, true)),
            "nobody keeps such a goal"
        );
    }
}
