//! A run: the loop in which the world, the robots and the radio take turns.

use super::conventional::Conventional;
use super::record::{Actions, Decided, RobotTick, Run, Thought, Tick, deed_name, place_name, state_name};
use super::robot::{Inferring, Skills};
use super::sense::Sense;
use super::skill::Skill;
use super::terms::{Terms, Trees, Trust};
use super::world::{Spot, World};
use crate::body::{Antenna, Clock};
use crate::radio::{KEY, Radio};
use crate::scenario;
use crate::tree::{BoundTree, Diagnostic};
use firmware::{Controller, Robot, Settings, hardware};
use iibt_core::iibt::Manipulation;
use iibt_core::iibt::manipulation::{Announcement, Command, Deed, Mission, MissionError, Percept, TEAM};
use iibt_core::team::{Member, Peers, RobotId};
use iibt_core::time::Instant;
use iibt_core::tree::{Full, NodeMemory, Status};
use std::fmt;
use std::num::NonZero;

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
    let robots = [
        controller(Arm::new(terms, mission, 0, left)?, 0),
        controller(Arm::new(terms, mission, 1, right)?, 1),
    ];
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
        believed = show.robots[0].robot().status == Status::Success;
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

/// One robot: its tree, and what runs the leaves.
struct Arm {
    tree: BoundTree<Skill>,
    memory: Vec<NodeMemory<Full>>,
    skills: Box<dyn Skills>,
    status: Status,
    percept: Percept,
}

/// The robot's hardware, filled and read by the world.
#[derive(Default)]
struct Body {
    link: Antenna,
    clock: Clock,
    percept: Percept,
    command: Option<Command>,
}

impl hardware::Link for Body {
    fn receive(&mut self) -> Option<u8> {
        self.link.receive()
    }
    fn send(&mut self, frame: &[u8]) -> bool {
        self.link.send(frame)
    }
}

impl hardware::Clock for Body {
    fn now(&mut self) -> Instant {
        self.clock.now()
    }
}

impl Arm {
    fn new(terms: &Terms, mission: Mission, index: u8, tree: BoundTree<Skill>) -> Result<Self, RunError> {
        let task = Manipulation::new(mission, RobotId(index)).map_err(RunError::Mission)?;
        let skills: Box<dyn Skills> = match (terms.trees, terms.trust) {
            (Trees::Inference, _) => Box::new(Inferring::new(task)),
            (_, Trust::Equal(enough)) => Box::new(Conventional::new(Sense::debounced(enough))),
            (_, Trust::Belief) => Box::new(Conventional::new(Sense::believed(task))),
        };
        let memory = vec![NodeMemory::NEW; tree.len()];
        Ok(Self { tree, memory, skills, status: Status::Running, percept: Percept::default() })
    }
}

impl Robot<Body> for Arm {
    type Message = Announcement;

    fn sense(&mut self, hardware: &mut Body, _: Instant) {
        self.percept = hardware.percept;
    }

    fn tick(&mut self, peers: Peers<'_, Announcement>, now: Instant) -> Status {
        self.skills.perceive(self.percept, peers);
        self.status = self.skills.tick(&self.tree, &mut self.memory, peers, now);
        self.status
    }

    fn act(&mut self, hardware: &mut Body) {
        hardware.command = self.skills.command();
    }

    fn message(&self) -> Announcement {
        self.skills.announcement()
    }
}

fn controller(arm: Arm, index: u8) -> Controller<Arm, Body> {
    let member = Member::new(RobotId(index), TEAM).unwrap_or_else(|_| unreachable!("a team of two"));
    Controller::new(arm, Settings::new(member, KEY, 1, NonZero::<u16>::MIN), Body::default())
}

struct Show<'t> {
    terms: &'t Terms,
    detail: Detail,
    world: World,
    radio: Radio,
    robots: [Controller<Arm, Body>; TEAM],
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
        for (receiver, bytes) in self.radio.arrivals(self.tick) {
            self.robots[receiver].hardware_mut().link.received.extend(bytes);
        }
        let commands = [0, 1].map(|index| {
            let busy = self.world.bodies[index].doing.is_some();
            let (place, state) = Some(self.world.read(index)).filter(|_| !busy).unzip();
            let body = self.robots[index].hardware_mut();
            (body.percept, body.clock.now) = (Percept { place, state, busy }, self.tick);
            self.robots[index].tick();
            self.robots[index].hardware_mut().command.take()
        });
        for (index, command) in commands.into_iter().enumerate() {
            if let Some(command) = command {
                self.begin(index, command);
            }
            for frame in self.robots[index].hardware_mut().link.sent.drain(..) {
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
        if let Some(decision) = self.robots[index].robot().skills.task().and_then(Manipulation::decision) {
            let probability = decision.posterior.get(decision.choice.number()).copied().unwrap_or(0.0);
            self.decisions.push(Decided::of(self.tick, index, decision.choice, probability));
        }
    }

    fn note(&mut self, commands: [Option<Command>; TEAM]) {
        let robots = [0, 1].map(|index| {
            let (robot, body) = (self.robots[index].robot(), self.world.bodies[index]);
            let reading = robot.percept.place.zip(robot.percept.state);
            RobotTick {
                place: place_name(body.place),
                state: state_name(self.world.state(index)),
                reading: reading.map(|(place, state)| [place_name(place), state_name(state)]),
                begins: commands[index].map(|command| [deed_name(command.deed), place_name(command.place)]),
                status: match robot.status {
                    Status::Success => "success",
                    Status::Failure => "failure",
                    Status::Running | Status::Skipped => "running",
                },
                leaf: robot.tree.running(&robot.memory).map(|skill| skill.name()),
                thought: robot
                    .skills
                    .task()
                    .zip(robot.skills.preferences())
                    .map(|(task, c)| Thought::of(task, c)),
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
