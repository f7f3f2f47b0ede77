//! Frames that were recorded and are played back to robots that have started again, by whoever has
//! no key: of lives before and of this one, whole and in any order. None is relied upon.
//!
//! A robot that has started again holds a recording only until its sender speaks. It relies on one
//! if it decides by its scores, moves by its report, scores a list with walls that nobody else has
//! known since, or visits a way-point that it names.

use super::restarts::Team;
use firmware::missions::{LAYERS, NODES, POLICIES};
use host_sim::{EventEffect, Faults, KEY, Radio, Random};
use iibt_core::grid::{Cell, Map};
use iibt_core::navigation::{Cells, Intention, Mission, Navigation};
use iibt_core::team::rounds::{Digest, Proposal, View};
use iibt_core::team::{Context, RobotId, SipHash64, Stamp, decode};
use iibt_core::time::Instant;
use std::collections::HashMap;
use tests::ground::ground;
use tests::judge;
use tests::rig::context;

/// The recorded frames that are played back; `tests/nightly` sets another number in
/// `IIBT_RECORDINGS`.
const TRIES: u64 = 20_000;

/// The ticks after which a team is held up.
const LIMIT: u32 = 1200;

/// How long recordings are played back after a restart.
const PLAYED: u32 = 40;

/// The frames that each robot hears of a recording in a tick.
const FRAMES: usize = 3;

/// The flights of which each is flown with recordings and without.
const FLIGHTS: u64 = 60;

/// The ticks of a decision, from a fact to the first move.
const DECISION: u32 = 3;

type Task<'m> = Navigation<'m, 49, 2, LAYERS, NODES, POLICIES>;

fn tries() -> u64 {
    match std::env::var("IIBT_RECORDINGS") {
        Ok(tries) => tries.parse().ok().filter(|&tries| tries > 0).expect("IIBT_RECORDINGS is a number"),
        Err(_) => TRIES,
    }
}

/// The frames that robots have sent, with their senders.
type Recording = Vec<(usize, Vec<u8>)>;

/// Which robots start again.
#[derive(Clone, Copy, Debug)]
enum Restarts {
    /// All, as on another day.
    Whole,
    /// One, in the middle of the mission.
    One,
    /// Two at once.
    Two,
    /// One, and again before it is answered.
    Again,
    /// One, while a teammate is silent.
    WhileSilent,
    /// One, while a teammate is left out.
    WhileLeftOut,
}

const KINDS: [Restarts; 6] = [
    Restarts::Whole,
    Restarts::One,
    Restarts::Two,
    Restarts::Again,
    Restarts::WhileSilent,
    Restarts::WhileLeftOut,
];

/// A team, and what its robots have truly said and decided.
struct Watched<'m> {
    team: Team<'m>,
    context: Context,
    /// The newest stamp of each sender.
    said: Vec<Stamp>,
    /// The newest stamp of each sender when a robot started, by robot and sender.
    before: Vec<Vec<Stamp>>,
    /// The tick in which each robot started.
    started: Vec<u32>,
    /// The tick in which a robot has given scores for a digest.
    given: HashMap<(usize, Digest), u32>,
    /// The last tick in which a robot was in a round with these members and walls.
    rounds: HashMap<(usize, Proposal<Cells<2>>), u32>,
    sent: Recording,
    collisions: u32,
    held: u64,
}

impl<'m> Watched<'m> {
    fn new(mission: &'m Mission<'m, 2>, faults: Faults, seed: u64) -> Self {
        let team = Team::over(mission, faults, seed).expect("a sound mission");
        let robots = team.cells().len();
        let none = Stamp { epoch: 0, sequence: 0 };
        Self {
            context: context(team.robot(0).robot().navigation()),
            said: vec![none; robots],
            before: vec![vec![none; robots]; robots],
            started: vec![0; robots],
            given: HashMap::new(),
            rounds: HashMap::new(),
            sent: Recording::new(),
            collisions: 0,
            held: 0,
            team,
        }
    }

    fn robots(&self) -> usize {
        self.said.len()
    }

    fn task(&self, robot: usize) -> &Task<'m> {
        self.team.robot(robot).robot().navigation()
    }

    fn restart(&mut self, robot: usize) {
        self.team.restart(robot).expect("it has been built before");
        self.started[robot] = self.team.ticks();
        self.before[robot] = self.said.clone();
    }

    /// Ticks, after each robot has heard these frames; a robot that relies on one is named.
    fn tick(&mut self, heard: &[(usize, &[u8])]) {
        heard.iter().for_each(|&(robot, frame)| self.team.deliver(robot, frame));
        let limit = self.team.ticks() + 1;
        self.collisions += judge::fly_until(&mut self.team, limit, |_| false).collisions;
        self.note();
        for robot in 0..self.robots() {
            if let Some(reason) = self.relies_on_a_recording(robot) {
                panic!("robot {robot} in tick {limit}: {reason}: {:?}", self.team.reports()[robot]);
            }
        }
    }

    /// Notes what the robots have said, given and joined in a tick.
    fn note(&mut self) {
        let (tick, auth) = (self.team.ticks(), SipHash64::new(KEY));
        for robot in 0..self.robots() {
            for frame in self.team.sent(robot).to_vec() {
                let inner = &frame[1..frame.len() - 1];
                let said = decode::<Intention<2, POLICIES>>(inner, &auth, self.context).expect("it is ours");
                if said.sender.index() == robot {
                    self.said[robot] = said.stamp;
                    self.sent.push((robot, frame));
                }
            }
            let Some(rounds) = self.task(robot).rounds() else { continue };
            let (digest, proposal) = (rounds.protocol().digest(), rounds.proposal().clone());
            self.rounds.insert((robot, proposal), tick);
            if let Some(digest) = digest {
                self.given.entry((robot, digest)).or_insert(tick);
            }
        }
        for robot in 0..self.robots() {
            let held = (0..self.robots()).filter(|&other| self.holds_a_recording(robot, other)).count();
            self.held += held as u64;
        }
    }

    /// Whether the newest that a robot has heard of another was said before the robot started.
    fn holds_a_recording(&self, robot: usize, other: usize) -> bool {
        let peers = self.team.robot(robot).peers(Instant(self.team.ticks()));
        let peer = peers.get(RobotId(other as u8));
        self.started[robot] > 0 && peer.is_some_and(|peer| peer.envelope().stamp <= self.before[robot][other])
    }

    /// Whether a robot has given scores for a digest after another has started.
    fn has_given_since(&self, giver: usize, digest: Digest, started: usize) -> bool {
        self.given.get(&(giver, digest)).is_some_and(|&tick| tick >= self.started[started])
    }

    /// What a robot relies on that nobody has said since it started.
    fn relies_on_a_recording(&self, robot: usize) -> Option<&'static str> {
        let task = self.task(robot);
        let (protocol, proposal) = task.rounds().map(|rounds| (rounds.protocol(), rounds.proposal()))?;
        let others = || proposal.view.iter().map(|other| other.index()).filter(|&other| other != robot);
        if protocol.has_decided()
            && let Some(digest) = protocol.digest()
            && !others().all(|other| self.has_given_since(other, digest, robot))
        {
            return Some("a vector");
        }
        if self.team.commands()[robot].is_some() && others().any(|other| self.holds_a_recording(robot, other))
        {
            return Some("a move");
        }
        let takes_part = protocol.digest().is_some() && proposal.view != View::full(self.robots());
        if takes_part && !self.is_live(robot, proposal) {
            return Some("a wall");
        }
        if !task.waypoints().is_empty() || task.left_behind().next().is_some() {
            return Some("a way-point");
        }
        None
    }

    /// Whether another robot has been in a round since this one started; or, if it has opened that
    /// itself, whether those left out have answered it.
    fn is_live(&self, robot: usize, proposal: &Proposal<Cells<2>>) -> bool {
        let since = self.started[robot];
        let is_in =
            |other: usize| self.rounds.get(&(other, proposal.clone())).is_some_and(|&tick| tick >= since);
        let has_answered =
            |other: usize| self.given.iter().any(|(&(giver, _), &tick)| giver == other && tick >= since);
        let is_own = proposal.round as usize % self.robots() == robot;
        let mut others = (0..self.robots()).filter(|&other| other != robot);
        let mut left_out = others.clone().filter(|&other| !proposal.view.contains(RobotId(other as u8)));
        others.any(is_in) || (is_own && left_out.all(has_answered))
    }
}

/// The frames of a day on which robots were told to visit cells, saw an obstacle, lost a third of
/// the frames, and left a teammate out for a while.
fn yesterday(mission: &Mission<'_, 2>, seed: u64) -> Recording {
    let faults = Faults {
        radio: Radio { loss: 0.2, ..Radio::default() },
        errand: 0.02,
        obstacle: 0.02,
        ..Faults::default()
    };
    let mut day = Team::over(mission, faults, seed).expect("a sound mission");
    let robots = day.cells().len();
    let mut recording = Recording::new();
    for tick in 0..120 {
        if tick == 12 {
            day.cause(EventEffect::Stop(seed as usize % robots, Some(60)));
        }
        day.tick();
        for robot in 0..robots {
            recording.extend(day.sent(robot).iter().map(|frame| (robot, frame.clone())));
        }
    }
    recording
}

/// What came of a flight with recordings.
struct Played {
    tries: u64,
    held: u64,
    /// The ticks from the restart until all had arrived.
    arrived: u32,
}

/// Restarts robots of a random mission, and plays frames back to them, so many to each in a tick:
/// those of another day, and those of this one.
fn play_back(seed: u64, frames: usize, loss: f64) -> Played {
    let (mut random, mut playing) = (Random::new(seed), Random::new(!seed));
    let kind = KINDS[seed as usize % KINDS.len()];
    let size = 2 + (seed / KINDS.len() as u64 % 4) as usize;
    let (map, mut free): (Map<2>, Vec<Cell>) = ground(&mut random, 2 * size);
    let mut cells = || (0..size).map(|_| free.swap_remove(random.below(free.len()))).collect::<Vec<_>>();
    let (starts, goals) = (cells(), cells());
    let mission = Mission::new(map, &starts, &goals);
    let old = yesterday(&mission, seed);
    let radio = Radio { loss, ..Radio::default() };
    let mut day = Watched::new(&mission, Faults { radio, ..Faults::default() }, seed);
    // Yesterday they were in their first epoch.
    (0..size).for_each(|robot| day.restart(robot));
    let (one, other) = (random.below(size), random.below(size - 1));
    let other = (one + 1 + other) % size;
    for _ in 0..if matches!(kind, Restarts::Whole) { 0 } else { random.below(25) } {
        day.tick(&[]);
    }
    match kind {
        Restarts::Whole => {}
        Restarts::One | Restarts::Again => day.restart(one),
        Restarts::Two => [one, other].into_iter().for_each(|robot| day.restart(robot)),
        Restarts::WhileSilent => {
            day.team.silence(other, true);
            day.restart(one);
        }
        Restarts::WhileLeftOut => {
            day.team.silence(other, true);
            (0..30).for_each(|_| day.tick(&[]));
            day.restart(one);
        }
    }
    let (mut tries, mut arrived, since) = (0, None, day.team.ticks());
    for tick in 0..PLAYED {
        if matches!(kind, Restarts::Again) && tick % 3 == 2 && tick < 12 {
            day.restart(one);
        }
        let recorded = day.sent.clone();
        let mut heard = Vec::new();
        for robot in 0..size {
            for _ in 0..frames {
                let from = if playing.bernoulli(0.5) && !recorded.is_empty() { &recorded } else { &old };
                let (sender, frame) = &from[playing.below(from.len())];
                if *sender != robot {
                    heard.push((robot, frame.as_slice()));
                }
            }
        }
        tries += heard.len() as u64;
        day.tick(&heard);
        arrived = arrived.or(day.team.has_arrived().then(|| day.team.ticks()));
    }
    day.team.silence(other, false);
    while !day.team.has_arrived() && day.team.ticks() < LIMIT {
        day.tick(&[]);
    }
    assert!(day.team.has_arrived(), "{kind:?}, seed {seed}: {:?}", day.team.reports());
    assert_eq!(day.collisions, 0, "{kind:?}, seed {seed}");
    Played { tries, held: day.held, arrived: arrived.unwrap_or(day.team.ticks()) - since }
}

#[test]
fn no_recording_is_relied_upon_whoever_has_started_again() {
    let (mut tries, mut held, mut flights) = (0, 0, 0);
    while tries < self::tries() {
        let played = play_back(flights, FRAMES, 0.0);
        (tries, held, flights) = (tries + played.tries, held + played.held, flights + 1);
    }
    println!(
        "recordings: {tries} played back in {flights} flights; relied upon: 0; held until the sender spoke: {held} \
         (robot, teammate, tick)"
    );
    assert!(held > tries / 200, "{held}: recordings must get into rosters to be tried");
}

/// In the mean of the flights, a recorded round costs a team at most another decision.
#[test]
fn recordings_delay_a_team_by_a_decision_at_the_most() {
    for loss in [0.0, 0.3] {
        let mut sums = [[0; 2]; KINDS.len()];
        let (mut later, mut worst) = (0, 0);
        for seed in 0..FLIGHTS {
            let [with, without] = [FRAMES, 0].map(|frames| play_back(seed, frames, loss).arrived);
            let sum = &mut sums[seed as usize % KINDS.len()];
            *sum = [sum[0] + with, sum[1] + without];
            later += u64::from(with > without);
            worst = worst.max(with.saturating_sub(without));
        }
        for (kind, [with, without]) in KINDS.iter().zip(sums) {
            println!("{kind:?}: {with} ticks until they arrive with recordings, {without} without");
        }
        println!("loss {loss}: later {later} times of {FLIGHTS}, by {worst} ticks at the most");
        let flights = FLIGHTS as u32 / KINDS.len() as u32;
        let is_late = |[with, without]: &[u32; 2]| *with > without + flights * DECISION;
        assert!(!sums.iter().any(is_late), "loss {loss}: {sums:?}");
    }
}
