//! A run: the loop in which the world, the robots and the radio take turns.

use super::conventional::Conventional;
use super::record::{Actions, Decided, RobotTick, Run, Thought, Tick, deed_name, place_name, state_name};
use super::robot::{Inferring, Skills};
use super::sense::Sense;
use super::skill::Skill;
use super::terms::{Terms, Trees, Trust};
use super::world::{Spot, World};
use crate::radio::{KEY, Radio};
use crate::scenario;
use crate::tree::{BoundTree, Diagnostic};
use iibt_core::iibt::Manipulation;
use iibt_core::iibt::manipulation::{Command, Deed, Mission, MissionError, Percept, Place, State, TEAM};
use iibt_core::team::{Deframer, Limits, MAX_FRAME, Numbering, RobotId, Roster, SipHash64, encode};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::{Full, NodeMemory, Status};
use std::fmt;

/// How much of a run is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// The outcome and the decisions.
    Outcome,
    /// Every tick.
    History,
}

/// Why there is no such run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RunError {
    /// A tree cannot be run by these robots.
    Tree(Diagnostic),
    /// The numbers are no mission.
    Mission(MissionError),
    /// A disturbance is no probability.
    Disturbance(&'static str),
}

/// Runs a mission to its end: robot 1's tree has succeeded, or there are no more ticks.
///
/// # Errors
/// [`RunError`] when the terms are none.
pub fn run(terms: &Terms, detail: Detail) -> Result<Run, RunError> {
    check(terms)?;
    let mut mission = Mission::BOTTLE_AND_PLATE;
    let [Some(first), Some(second)] = [mission.role(0), mission.role(1)] else {
        return Err(RunError::Mission(MissionError::NoSuchRobot));
    };
    mission = Mission::new([first, second], mission.meeting(), terms.preset, terms.order)
        .map_err(RunError::Mission)?;
    let [left, right] = terms.trees.bind().map_err(RunError::Tree)?;
    let robots = [Robot::new(terms, mission, 0, left)?, Robot::new(terms, mission, 1, right)?];
    let radio = scenario::Radio { loss: terms.disturbances.loss, delay: 1, duplicate: 0.0 };
    let mut show = Show {
        terms,
        detail,
        world: World::new(terms.seed, terms.disturbances),
        radio: Radio::new(radio, TEAM, terms.seed),
        robots,
        tick: 0,
        begun: Vec::new(),
        actions: Actions::default(),
        retries: 0,
        decisions: Vec::new(),
        history: Vec::new(),
    };
    let mut believed = false;
    while !believed && show.tick < terms.max_ticks {
        show.tick();
        believed = show.robots[0].status == Status::Success;
    }
    Ok(show.record(believed))
}

fn check(terms: &Terms) -> Result<(), RunError> {
    let of = terms.disturbances;
    let named = [
        ("wrong readings", of.wrong_readings),
        ("failed grasps", of.failed_grasps),
        ("failed moves", of.failed_moves),
        ("failed placings", of.failed_placings),
        ("loss", of.loss),
    ];
    let wrong = named.into_iter().find(|(_, p)| !(0.0..=1.0).contains(p));
    wrong.map_or(Ok(()), |(name, _)| Err(RunError::Disturbance(name)))
}

/// One robot: its tree, what runs the leaves, and its end of the radio.
struct Robot {
    tree: BoundTree<Skill>,
    memory: Vec<NodeMemory<Full>>,
    skills: Box<dyn Skills>,
    deframer: Deframer,
    auth: SipHash64,
    numbering: Numbering,
    status: Status,
    reading: Option<(Place, State)>,
}

impl Robot {
    fn new(terms: &Terms, mission: Mission, index: u8, tree: BoundTree<Skill>) -> Result<Self, RunError> {
        let id = RobotId(index);
        let limits = Limits::for_beacons(Duration(1)).unwrap_or_else(|_| unreachable!("a tick is short"));
        let roster = Roster::new(id, TEAM, limits).unwrap_or_else(|_| unreachable!("a team of two"));
        let task = Manipulation::new(mission, id, roster.clone()).map_err(RunError::Mission)?;
        let skills: Box<dyn Skills> = match (terms.trees, terms.trust) {
            (Trees::Inference, _) => Box::new(Inferring::new(task)),
            (_, Trust::Equal(enough)) => Box::new(Conventional::new(id, roster, Sense::debounced(enough))),
            (_, Trust::Belief) => Box::new(Conventional::new(id, roster, Sense::believed(task))),
        };
        Ok(Self {
            memory: vec![NodeMemory::NEW; tree.len()],
            tree,
            skills,
            deframer: Deframer::new(),
            auth: SipHash64::new(KEY),
            numbering: Numbering::new(1),
            status: Status::Running,
            reading: None,
        })
    }

    fn hear(&mut self, bytes: &[u8], now: Instant) {
        for &byte in bytes {
            if let Some(frame) = self.deframer.feed(byte) {
                // The roster counts what it refuses.
                let _ = self.skills.roster_mut().receive(frame, &self.auth, now);
            }
        }
    }

    fn tick(&mut self, busy: bool, read: (Place, State), now: Instant) -> Option<Command> {
        self.reading = (!busy).then_some(read);
        let (place, state) = self.reading.unzip();
        self.skills.roster_mut().expire(now);
        self.skills.perceive(Percept { now, place, state, busy });
        self.status = self.tree.tick(&mut self.memory, &mut *self.skills, now).status;
        self.skills.command()
    }

    fn frame(&mut self, now: Instant) -> Option<Vec<u8>> {
        let stamp = self.numbering.next_stamp()?;
        let mut intention = self.skills.intention();
        (intention.epoch, intention.sequence, intention.tick) = (stamp.epoch, stamp.sequence, now);
        let mut buffer = [0; MAX_FRAME];
        encode(&intention, &self.auth, &mut buffer).ok().map(<[u8]>::to_vec)
    }
}

struct Show<'t> {
    terms: &'t Terms,
    detail: Detail,
    world: World,
    radio: Radio,
    robots: [Robot; TEAM],
    tick: u32,
    /// The actions that robots have begun.
    begun: Vec<(usize, Command)>,
    actions: Actions,
    retries: u32,
    decisions: Vec<Decided>,
    history: Vec<Tick>,
}

impl Show<'_> {
    fn tick(&mut self) {
        let now = Instant(self.tick);
        for (receiver, bytes) in self.radio.arrivals(self.tick) {
            self.robots[receiver].hear(&bytes, now);
        }
        let commands = [0, 1].map(|index| {
            let busy = self.world.bodies[index].doing.is_some();
            let read = self.world.read(index);
            self.robots[index].tick(busy, read, now)
        });
        for (index, command) in commands.into_iter().enumerate() {
            if let Some(command) = command {
                self.begin(index, command);
            }
            if let Some(frame) = self.robots[index].frame(now) {
                self.radio.send(self.tick, index, &frame);
            }
        }
        if self.detail == Detail::History {
            self.note(commands);
        }
        self.world.pass();
        self.tick += 1;
    }

    fn begin(&mut self, index: usize, command: Command) {
        self.world.begin(index, command);
        match command.deed {
            Deed::MoveTo => self.actions.moves += 1,
            Deed::Pick => self.actions.picks += 1,
            Deed::Place => self.actions.placings += 1,
            Deed::Idle => {}
        }
        self.retries += u32::from(self.begun.contains(&(index, command)));
        self.begun.push((index, command));
        if let Some(decision) = self.robots[index].skills.task().and_then(Manipulation::decision) {
            let probability = decision.posterior.get(decision.choice.number()).copied().unwrap_or(0.0);
            self.decisions.push(Decided::of(self.tick, index, decision.choice, probability));
        }
    }

    fn note(&mut self, commands: [Option<Command>; TEAM]) {
        let robots = [0, 1].map(|index| {
            let (robot, body) = (&self.robots[index], self.world.bodies[index]);
            RobotTick {
                place: place_name(body.place),
                state: state_name(self.world.state(index)),
                reading: robot.reading.map(|(place, state)| [place_name(place), state_name(state)]),
                begins: commands[index].map(|command| [deed_name(command.deed), place_name(command.place)]),
                status: match robot.status {
                    Status::Success => "success",
                    Status::Failure => "failure",
                    Status::Running | Status::Skipped => "running",
                },
                leaf: robot.tree.running(&robot.memory).map(|skill| skill.name()),
                thought: robot.skills.task().map(Thought::of),
            }
        });
        let [bottle, plate] = self.world.things.map(spot_name);
        self.history.push(Tick { tick: self.tick, robots, bottle, plate });
    }

    fn record(self, believed: bool) -> Run {
        Run {
            seed: self.terms.seed,
            trees: self.terms.trees,
            disturbances: self.terms.disturbances,
            success: believed && self.world.is_accomplished(),
            believed,
            ticks: self.tick,
            actions: self.actions,
            retries: self.retries,
            frames: self.radio.traffic().iter().sum(),
            decisions: self.decisions,
            history: self.history,
        }
    }
}

fn spot_name(spot: Spot) -> String {
    match spot {
        Spot::At(place) => format!("at {}", place_name(place)),
        Spot::HeldBy(robot) => format!("held by robot {}", robot + 1),
        Spot::OnPlate => "on the plate".to_owned(),
    }
}

impl fmt::Display for RunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tree(diagnostic) => diagnostic.fmt(f),
            Self::Mission(error) => error.fmt(f),
            Self::Disturbance(name) => write!(f, "{name}: a probability is a number from 0 to 1"),
        }
    }
}

impl std::error::Error for RunError {}
