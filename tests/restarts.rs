//! Robots that start again at any moment: in a move, in a frame, in a write of the flash, when
//! their numbers run out. Nobody collides, and the team agrees again.

use firmware::BootCounter;
use firmware::adapters::{Counted, DeadReckoning};
use firmware::hardware::{Drive, Localiser};
use firmware::missions::{LAYERS, NODES, POLICIES};
use firmware::page::Page;
use host_sim::{EventEffect, Faults, NavigatorFlight, Random, Reading};
use iibt_core::grid::{Cell, Map, Move};
use iibt_core::navigation::{Mission, Report};
use iibt_core::team::RobotId;
use iibt_core::team::rounds::{Timing, View};
use iibt_core::time::Instant;
use std::rc::Rc;
use tests::ground::ground;
use tests::judge;
use tests::nor_flash::PoweredFlash;

/// The missions of each kind of restart; `tests/nightly` sets another number in `IIBT_RESTARTS`.
const MISSIONS: u64 = 200;

/// The ticks after which a team is held up.
const LIMIT: u32 = 800;

/// Robots with the sizes of the images.
pub(super) type Team<'m> = NavigatorFlight<'m, 49, 2, LAYERS, NODES, POLICIES>;

fn missions() -> u64 {
    match std::env::var("IIBT_RESTARTS") {
        Ok(count) => count.parse().ok().filter(|&count| count > 0).expect("IIBT_RESTARTS is a number"),
        Err(_) => MISSIONS,
    }
}

/// A random mission of two to five robots, and the ticks that a move of each takes.
struct Drawn {
    map: Map<2>,
    starts: Vec<Cell>,
    goals: Vec<Cell>,
    paces: Vec<u32>,
}

impl Drawn {
    fn new(random: &mut Random, size: usize) -> Self {
        let (map, mut free) = ground(random, 2 * size);
        let mut cells = || (0..size).map(|_| free.swap_remove(random.below(free.len()))).collect();
        let (starts, goals) = (cells(), cells());
        Self { map, starts, goals, paces: (0..size).map(|_| 1 + random.below(3) as u32).collect() }
    }

    fn mission(&self) -> Mission<'_, 2> {
        Mission::new(self.map, &self.starts, &self.goals)
    }
}

fn team<'m>(mission: &'m Mission<'m, 2>, drawn: &Drawn, faults: Faults, seed: u64) -> Team<'m> {
    let mut team = Team::over(mission, faults, seed).expect("a sound mission");
    drawn.paces.iter().enumerate().for_each(|(robot, &ticks)| team.set_pace(robot, ticks));
    team
}

/// The ticks after which a team arrives that nothing happens to.
fn undisturbed(mission: &Mission<'_, 2>, drawn: &Drawn, seed: u64) -> u32 {
    let outcome = judge::fly(&mut team(mission, drawn, Faults::default(), seed), LIMIT);
    outcome.arrived.expect("nothing is in its way")
}

/// Whether all robots know the plan of one round, of which all are members.
fn agree(reports: &[Report]) -> bool {
    let is_same = |report: &Report| report.policy.is_some() && report.round == reports[0].round;
    reports.iter().all(is_same) && reports[0].members == View::full(reports.len())
}

/// The wheels of a robot in the simulated world, for the firmware's dead reckoning: they move as
/// the world says.
struct Wheels(Rc<std::cell::Cell<bool>>);

impl Drive for Wheels {
    fn go(&mut self, _: Move) {
        self.0.set(true);
    }
    fn is_moving(&mut self) -> bool {
        self.0.get()
    }
    fn stop(&mut self) {}
}

/// The localiser of the image: the firmware's own, started as the image starts it.
struct Reckoning {
    position: &'static DeadReckoning<2>,
    wheels: Counted<'static, Wheels, 2>,
    is_moving: Rc<std::cell::Cell<bool>>,
}

impl Reckoning {
    /// The localiser of a robot that starts for the `epoch`-th time, with a page that does not name
    /// an epoch.
    fn boot(map: Map<2>, start: Cell, epoch: u32) -> Self {
        let is_first = Page::<49, 2, 1>::EMPTY.is_first_start(epoch);
        let position: &'static _ = Box::leak(Box::new(DeadReckoning::at_boot(map, start, is_first)));
        let is_moving = Rc::new(std::cell::Cell::new(false));
        Self { position, wheels: position.count(Wheels(is_moving.clone())), is_moving }
    }

    /// What it reads after a tick in which the robot was told to make this move.
    fn read(&mut self, command: Option<Move>, is_moving: bool) -> Reading {
        command.into_iter().for_each(|step| self.wheels.go(step));
        self.is_moving.set(is_moving);
        self.wheels.is_moving();
        let mut position = self.position;
        position.locate().map_or(Reading::Nothing, Reading::Cell)
    }
}

/// A team whose robots reckon their places from their own moves, as the image does.
struct Reckoned<'m> {
    team: Team<'m>,
    reckonings: Vec<Reckoning>,
    collisions: u32,
}

impl<'m> Reckoned<'m> {
    fn new(mission: &'m Mission<'m, 2>, drawn: &Drawn, seed: u64) -> Self {
        let boot = |&start: &Cell| Reckoning::boot(mission.map, start, 1);
        let reckonings = mission.starts.iter().map(boot).collect();
        let mut new = Self { team: team(mission, drawn, Faults::default(), seed), reckonings, collisions: 0 };
        new.read();
        new
    }

    fn read(&mut self) {
        let commands = self.team.commands().to_vec();
        let entering: Vec<_> = self.team.entering().collect();
        for (robot, reckoning) in self.reckonings.iter_mut().enumerate() {
            let reading = reckoning.read(commands[robot], entering[robot].is_some());
            self.team.set_reading(robot, reading);
        }
    }

    fn tick(&mut self) {
        let limit = self.team.ticks() + 1;
        self.collisions += judge::fly_until(&mut self.team, limit, |_| false).collisions;
        self.read();
    }

    /// Ticks until something holds; `None` if it does not within `limit`.
    fn fly_until(&mut self, limit: u32, is_done: impl Fn(&Team<'_>) -> bool) -> Option<u32> {
        (0..limit).find(|_| {
            self.tick();
            is_done(&self.team)
        })
    }

    /// Power fails in the robot: what it counted is lost.
    fn brown_out(&mut self, robot: usize, start: Cell, map: Map<2>, goes_back: bool) {
        self.team.brown_out(robot, goes_back).expect("it has been built before");
        self.reckonings[robot] = Reckoning::boot(map, start, self.team.epoch(robot));
        self.team.set_reading(robot, Reading::Nothing);
    }

    /// Somebody who sees the robot places it.
    fn place(&mut self, robot: usize) {
        let seen = self.team.cells()[robot];
        self.reckonings[robot].position.place(seen).expect("it is on the map");
        self.team.set_reading(robot, Reading::Cell(seen));
    }
}

/// What the flights of one kind came to.
#[derive(Debug, Default)]
struct Sums {
    flights: u64,
    collisions: u32,
    held_up: Vec<u64>,
    /// The ticks until all agreed again.
    agreed: Vec<u32>,
}

impl Sums {
    /// Prints the sums; fails if there was a collision, or a team that did not arrive, or agreed
    /// later than `within` ticks.
    fn judge(mut self, name: &str, within: u32) {
        self.agreed.sort_unstable();
        let (count, latest) = (self.agreed.len(), self.agreed.last().copied().unwrap_or(0));
        let median = self.agreed.get(count / 2).copied().unwrap_or(0);
        let late = self.agreed.iter().filter(|&&ticks| ticks > within).count();
        println!(
            "{name}: {} restarts: {} collisions, {} held up {:?}; agreed again after {median} ticks, {latest} at the \
             most, {late} later than {within}",
            self.flights,
            self.collisions,
            self.held_up.len(),
            self.held_up,
        );
        assert_eq!((self.collisions, self.held_up.len()), (0, 0));
        assert_eq!((late, count as u64), (0, self.flights));
    }
}

/// `lost_after` and a round: three ticks, the turn of the last of five robots to open one, and a
/// move of three ticks that ends first.
const AGREED_WITHIN: u32 = Timing::DEFAULT.lost_after() as u32 + 3 + 2 * 4 + 3;

/// Restarts a robot of a random mission at a random tick, in whatever it is doing.
fn restart_at_any_tick(seed: u64, sums: &mut Sums, restart: impl Fn(&mut Team<'_>, usize, &mut Random)) {
    let mut random = Random::new(seed);
    let drawn = Drawn::new(&mut random, 2 + (seed % 4) as usize);
    let mission = drawn.mission();
    let last = undisturbed(&mission, &drawn, seed);
    let (tick, robot) = (random.below(last as usize + 1) as u32, random.below(drawn.starts.len()));
    let mut team = team(&mission, &drawn, Faults::default(), seed);
    let before = judge::fly_until(&mut team, tick, |_| false);
    restart(&mut team, robot, &mut random);
    let since = team.ticks();
    let again = judge::fly_until(&mut team, LIMIT, |team| agree(team.reports()));
    let outcome = judge::fly(&mut team, LIMIT);
    sums.flights += 1;
    sums.collisions += before.collisions + again.collisions + outcome.collisions;
    sums.agreed.extend(again.arrived.map(|agreed| agreed - since));
    if outcome.arrived.is_none() {
        sums.held_up.push(seed);
    }
}

#[test]
fn a_robot_that_is_reset_at_any_tick_is_soon_in_the_plan_again() {
    let mut sums = Sums::default();
    for seed in 0..missions() {
        restart_at_any_tick(seed, &mut sums, |team, robot, _| {
            team.restart(robot).expect("it has been built before");
        });
    }
    sums.judge("reset", AGREED_WITHIN);
}

#[test]
fn a_robot_whose_power_fails_between_two_cells_claims_both_until_it_is_centred() {
    let (mut sums, mut between) = (Sums::default(), std::cell::Cell::new(0));
    for seed in 0..missions() {
        restart_at_any_tick(seed, &mut sums, |team, robot, random| {
            while team.entering().nth(robot).flatten().is_none() && !team.has_arrived() {
                team.tick();
            }
            between.set(between.get() + u64::from(team.entering().nth(robot).flatten().is_some()));
            team.brown_out(robot, random.bernoulli(0.5)).expect("it has been built before");
        });
    }
    println!("power failed between two cells: {} times", between.get_mut());
    assert!(*between.get_mut() > missions() / 4);
    sums.judge("brown-out", AGREED_WITHIN);
}

/// The ticks in which the drive of a slow robot centres it: longer than its team takes to decide.
const SLOW: u32 = 8;

#[test]
fn a_slow_robot_whose_power_fails_between_two_cells_is_run_into_on_neither() {
    let mut sums = Sums::default();
    for seed in 0..missions() {
        restart_at_any_tick(seed, &mut sums, |team, robot, random| {
            while team.entering().nth(robot).flatten().is_none() && !team.has_arrived() {
                team.tick();
            }
            team.set_pace(robot, SLOW);
            team.brown_out(robot, random.bernoulli(0.5)).expect("it has been built before");
        });
    }
    sums.judge("brown-out of a slow robot", AGREED_WITHIN + SLOW);
}

/// Its localiser still reads the start, as it did when the robot was switched off.
#[test]
fn a_robot_that_was_carried_while_it_was_off_does_not_believe_the_start_of_the_mission() {
    let mut collisions = 0;
    for seed in 0..missions() {
        let mut random = Random::new(seed);
        let drawn = Drawn::new(&mut random, 2 + (seed % 4) as usize);
        let mission = drawn.mission();
        let (robot, other) = (0, 1);
        let near = Move::ALL.map(|step| drawn.map.neighbour(drawn.starts[other], step));
        let is_free = |cell: &Cell| drawn.map.is_free(*cell) && !drawn.starts.contains(cell);
        let Some(carried) = near.into_iter().filter(is_free).nth(random.below(2)) else { continue };
        let mut team = team(&mission, &drawn, Faults::default(), seed);
        team.place(robot, carried);
        team.set_reading(robot, Reading::Cell(drawn.starts[robot]));
        team.restart(robot).expect("it has been built before");
        let first = judge::fly_until(&mut team, 1, |_| false);
        let is_silent = team.sent(robot).is_empty();
        team.set_reading(robot, Reading::Drawn);
        let outcome = judge::fly(&mut team, LIMIT);
        collisions += first.collisions + outcome.collisions;
        assert!(outcome.arrived.is_some(), "seed {seed}");
        assert!(is_silent, "seed {seed}: it has nothing true to say; {collisions} collisions so far");
    }
    assert_eq!(collisions, 0);
}

/// The robots of a team without those that are lost.
fn rest(size: usize, lost: &[usize]) -> View {
    (0..size).filter(|robot| !lost.contains(robot)).map(|robot| RobotId(robot as u8)).collect()
}

/// Whether the members of a view know the plan of one round, in which they alone decide.
fn agree_alone(reports: &[Report], view: View) -> bool {
    let members: Vec<&Report> = view.iter().map(|robot| &reports[robot.index()]).collect();
    let is_one = |report: &&Report| report.policy.is_some() && report.round == members[0].round;
    members.iter().all(is_one) && members.iter().all(|report| report.members == view)
}

/// It cannot know where the dead one may be, and takes the word of the others, who are a quorum.
#[test]
fn a_robot_that_has_not_heard_a_dead_teammate_since_it_started_decides_with_the_others() {
    let (mut sums, mut before) = (Sums::default(), 0);
    for seed in 0..missions() {
        let mut random = Random::new(seed);
        let size = 4 + (seed % 3) as usize;
        let drawn = Drawn::new(&mut random, size);
        let (dead, one) = loop {
            let (dead, one) = (random.below(size), random.below(size));
            if dead != one && rest(size, &[dead, one]).is_quorum(size) {
                break (dead, one);
            }
        };
        let mission = drawn.mission();
        let mut team = team(&mission, &drawn, Faults::default(), seed);
        let agreed = judge::fly_until(&mut team, LIMIT, |team| agree(team.reports()));
        let death = team.ticks() + random.below(8) as u32;
        let mut collisions = agreed.collisions + judge::fly_until(&mut team, death, |_| false).collisions;
        team.cause(EventEffect::Stop(dead, None));
        let living = rest(size, &[dead]);
        let restart = death + random.below(60) as u32;
        let went_on = judge::fly_until(&mut team, restart, |_| false);
        before += u64::from(!agree_alone(team.reports(), living));
        team.restart(one).expect("it has been built before");
        let again = judge::fly_until(&mut team, LIMIT, |team| agree_alone(team.reports(), living));
        let end = team.ticks() + 60;
        collisions += went_on.collisions + again.collisions;
        collisions += judge::fly_until(&mut team, end, |_| false).collisions;
        (sums.flights, sums.collisions) = (sums.flights + 1, sums.collisions + collisions);
        match again.arrived {
            Some(agreed) => sums.agreed.push(agreed - restart),
            None => sums.held_up.push(seed),
        }
    }
    println!("started again before the others had left the dead one out: {before} times");
    sums.judge("restart beside a dead one", 2 * AGREED_WITHIN);
}

/// The image's own localiser: the firmware's, through the simulated drive.
#[test]
fn a_robot_that_reckons_from_its_moves_stands_after_a_restart_until_it_is_placed() {
    let (mut sums, mut left_out) = (Sums::default(), 0);
    for seed in 0..missions() {
        let mut random = Random::new(seed);
        let drawn = Drawn::new(&mut random, 2 + (seed % 4) as usize);
        let mission = drawn.mission();
        let last = undisturbed(&mission, &drawn, seed);
        let (tick, robot) = (random.below(last as usize + 1) as u32, random.below(drawn.starts.len()));
        let mut flight = Reckoned::new(&mission, &drawn, seed);
        flight.fly_until(tick, |_| false);
        flight.brown_out(robot, drawn.starts[robot], drawn.map, random.bernoulli(0.5));
        for _ in 0..4 + random.below(80) {
            flight.tick();
            assert_eq!(flight.team.commands()[robot], None, "seed {seed}: it does not know where it is");
            assert!(flight.team.sent(robot).is_empty(), "seed {seed}: it has nothing true to say");
        }
        let leaves_it_out =
            |report: &Report| report.policy.is_some() && !report.members.contains(RobotId(robot as u8));
        left_out += u64::from(flight.team.reports().iter().any(leaves_it_out));
        flight.place(robot);
        sums.agreed.extend(flight.fly_until(LIMIT, |team| agree(team.reports())));
        let arrived = flight.fly_until(LIMIT, |team| team.has_arrived());
        sums.flights += 1;
        sums.collisions += flight.collisions;
        if arrived.is_none() {
            sums.held_up.push(seed);
        }
    }
    println!("the others went on without it: {left_out} times");
    assert!(left_out > missions() / 8);
    sums.judge("own reckoning", AGREED_WITHIN);
}

/// The epochs are counted in a flash whose power fails as often as it does not.
#[test]
fn epochs_that_are_counted_while_the_power_fails_keep_every_life_apart() {
    const COUNTER: BootCounter = BootCounter { first: 0, second: 128, length: 128 };
    let (mut collisions, mut cut) = (0, 0);
    for seed in 0..missions() / 4 {
        let mut random = Random::new(seed);
        let drawn = Drawn::new(&mut random, 2 + (seed % 4) as usize);
        let mission = drawn.mission();
        let mut team = team(&mission, &drawn, Faults::default(), seed);
        let mut flashes: Vec<_> =
            (0..drawn.starts.len() as u64).map(|robot| PoweredFlash::<4, 128>::erased(2, robot)).collect();
        for flash in &mut flashes {
            assert_eq!(COUNTER.count(flash, 0), Ok(1), "the first start");
        }
        for _ in 0..6 {
            let limit = team.ticks() + random.below(12) as u32;
            collisions += judge::fly_until(&mut team, limit, |_| false).collisions;
            let robot = random.below(flashes.len());
            let flash = &mut flashes[robot];
            flash.power = random.bernoulli(0.5).then(|| random.below(4) as u32);
            let first = COUNTER.count(flash, 0);
            flash.power = None;
            cut += u64::from(first.is_err());
            let epoch = first.or_else(|_| COUNTER.count(flash, 0)).expect("the power is back");
            assert!(epoch > team.epoch(robot));
            team.restart_in(robot, epoch).expect("it has been built before");
        }
        let limit = team.ticks() + LIMIT;
        let outcome = judge::fly(&mut team, limit);
        collisions += outcome.collisions;
        assert!(outcome.arrived.is_some(), "seed {seed}");
    }
    assert!(collisions == 0 && cut > missions() / 4, "{collisions} collisions, {cut} cuts");
}

#[test]
fn robots_whose_numbers_run_out_take_the_next_epoch_and_the_team_goes_on() {
    for seed in 0..missions() / 4 {
        let mut random = Random::new(seed);
        let drawn = Drawn::new(&mut random, 2 + (seed % 4) as usize);
        let mission = drawn.mission();
        let mut team = team(&mission, &drawn, Faults::default(), seed);
        let one = random.below(drawn.starts.len());
        let concerned: Vec<usize> = if seed % 2 == 0 { vec![one] } else { (0..drawn.starts.len()).collect() };
        for &robot in &concerned {
            team.robot_mut(robot).use_up_numbers(random.below(3) as u32);
        }
        let outcome = judge::fly(&mut team, LIMIT);
        assert!(outcome.collisions == 0 && outcome.arrived.is_some(), "seed {seed}: {outcome:?}");
        assert!(concerned.iter().all(|&robot| team.epoch(robot) == 2), "seed {seed}");
    }
}

#[test]
fn a_clock_that_jumps_back_or_forward_costs_a_team_a_tick_at_the_most() {
    let (mut usual, mut with, mut jumps) = (0, 0, 0);
    for seed in 0..missions() / 4 {
        let mut random = Random::new(seed);
        let drawn = Drawn::new(&mut random, 2 + (seed % 4) as usize);
        let mission = drawn.mission();
        let last = undisturbed(&mission, &drawn, seed);
        let mut team = team(&mission, &drawn, Faults::default(), seed);
        let mut collisions = 0;
        for _ in 0..4 {
            let limit = team.ticks() + random.below(6) as u32;
            collisions += judge::fly_until(&mut team, limit, |_| false).collisions;
            let ticks =
                [u32::MAX - random.bits() % 5000, random.bits() % 5000, random.bits()][random.below(3)];
            team.turn_clock(random.below(drawn.starts.len()), ticks);
            jumps += 1;
        }
        let outcome = judge::fly(&mut team, LIMIT);
        let arrived = outcome.arrived.expect("it arrives");
        assert_eq!(collisions + outcome.collisions, 0, "seed {seed}");
        (usual, with) = (usual + last, with + arrived);
    }
    println!("clocks that jump {jumps} times: {with} ticks, {usual} with true clocks");
    assert!(with <= usual + jumps, "{with} ticks for {usual}");
}

/// The power fails while a frame is sent: what is out is cut off anywhere, and the next frame of
/// the next life is heard as if nothing had been sent.
#[test]
fn a_frame_that_is_cut_off_anywhere_costs_the_next_one_nothing() {
    let drawn = Drawn::new(&mut Random::new(1), 3);
    let mission = drawn.mission();
    let mut lengths = std::collections::BTreeSet::new();
    for tick in 1..12 {
        let heard_after = |length: usize| {
            let mut team = team(&mission, &drawn, Faults::default(), 0);
            let before = judge::fly_until(&mut team, tick, |_| false);
            let frame = team.sent(1).concat();
            team.restart(1).expect("it has been built before");
            [0, 2].iter().for_each(|&other| team.deliver(other, &frame[..length.min(frame.len())]));
            let epoch = |team: &Team<'_>, by: usize| {
                let peers = team.robot(by).peers(Instant(team.ticks()));
                peers.get(RobotId(1)).map(|peer| peer.envelope().stamp.epoch)
            };
            let has_heard = |team: &Team<'_>| [0, 2].iter().all(|&by| epoch(team, by) == Some(2));
            let heard = judge::fly_until(&mut team, LIMIT, has_heard).arrived.expect("it is heard");
            let outcome = judge::fly(&mut team, LIMIT);
            assert!(outcome.arrived.is_some() && before.collisions + outcome.collisions == 0);
            (frame.len(), heard)
        };
        let (whole, usual) = heard_after(0);
        lengths.insert(whole);
        for length in 1..=whole {
            assert_eq!(heard_after(length), (whole, usual), "{length} bytes in tick {tick}");
        }
    }
    assert!(lengths.len() > 2, "{lengths:?}: frames that list, score and drive");
}
