//! Scenarios: a mission and its world, read from TOML with a drawn map and checked as a whole.
//!
//! `scenarios/README.md` describes the format for users. A [`Scenario`] is checked when it is
//! built: every cell it names is on the map, every start is free and distinct, every number is in
//! its range, and every robot has a way to a goal of its own by the drawn map.

mod check;
mod drawing;
mod event;
mod file;
mod reach;
mod team;
mod unknown;
pub(crate) use reach::{parts, served};

use crate::input::{FileError, toml, utf8};
use iibt_core::grid::{Cell, Map, Move, Path};
use iibt_core::navigation::{Effect, Place, Sight, Unknown};
use serde::Serialize;

/// The most cells a map has.
pub const MAX_CELLS: usize = 1024;

/// The most candidate paths a robot is given.
pub const MAX_PATHS: usize = 16;

/// The longest mission, in ticks.
pub const MAX_TICKS: u32 = 100_000;

/// A map of up to [`MAX_CELLS`] cells.
pub type Floor = Map<{ iibt_core::grid::words(MAX_CELLS, 1) }>;

/// A mission and the world it is flown in.
///
/// ```
/// use host_sim::{Conditions, Scenario, fly};
///
/// let scenario = Scenario::parse(
///     "corner.toml",
///     r#"
/// title = "Two robots around a corner"
/// map = """
/// 1..
/// .#.
/// 2GG
/// """
/// "#,
/// )?;
/// assert_eq!((scenario.robots.len(), scenario.goals.len()), (2, 2));
/// let record = fly(&scenario, Conditions::default(), &mut ())?;
/// assert!(record.outcome.is_success());
///
/// let refused = Scenario::parse("typo.toml", "title = 'x'\nmap = '1.G'\nview = 0").unwrap_err();
/// assert!(refused.to_string().starts_with("typo.toml:3: "), "{refused}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The name on the command line: that of a built-in scenario, else the file.
    pub name: String,
    /// The title, in one line.
    pub title: String,
    /// The limit in ticks, after which the mission counts as not accomplished.
    pub limit: u32,
    /// The map that the robots know when they start.
    pub map: Floor,
    /// The goals, with those that robots own.
    pub goals: Vec<Cell>,
    /// The number of goals on which robots must stand at the end.
    pub need: usize,
    /// Whether the others stand while a robot charges.
    pub waits_for_charging: bool,
    /// The ticks after which evidence about obstacles fades by a sixteenth of a nat; zero for
    /// never.
    pub forgets: u16,
    /// The probability with which each goal serves a robot that stands there at the end of a
    /// mission.
    pub serves: Vec<f64>,
    /// What the robots do not know.
    pub unknowns: Vec<UnknownSpec>,
    /// The number of missions flown in a row.
    pub missions: u32,
    /// The team, in the order of the robots' numbers.
    pub robots: Vec<RobotSpec>,
    /// The events of the mission.
    pub events: Vec<Event>,
    /// The drive faults.
    pub drive_faults: Vec<DriveFault>,
    /// The radio between the robots.
    pub radio: Radio,
    /// The parameters of the robots' inference.
    pub inference: InferenceSpec,
}

/// What the robots of a mission do not know, and how it is.
#[derive(Clone, Debug, PartialEq)]
pub struct UnknownSpec {
    /// What its value means for its cells.
    pub effect: Effect,
    /// Its cells, and the value to which each belongs.
    pub cells: Vec<Place>,
    /// The probability of each value.
    pub prior: Vec<f32>,
    /// From where it is seen, and how well.
    pub sights: Vec<Sight>,
    /// Its value; `None` for one that is drawn from the prior by the seed of the flight.
    pub real: Option<u8>,
    /// The stranger whose goal it is: of an unknown that [takes](Effect::Takes) a goal.
    pub stranger: Option<StrangerSpec>,
}

/// A robot that is no member of the team: it says nothing, and goes to the goal that is the value
/// of its unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StrangerSpec {
    /// The start cell.
    pub start: Cell,
    /// The range in which the robots see it, in cells, diagonals included; `None` for everywhere.
    pub range: Option<u16>,
}

impl UnknownSpec {
    /// The unknown as the robots know it.
    #[must_use]
    pub fn as_known(&self) -> Unknown<'_> {
        let Self { effect, cells, prior, sights, .. } = self;
        Unknown { effect: *effect, cells, prior, sights }
    }
}

impl From<&Unknown<'_>> for UnknownSpec {
    /// One whose value is drawn, and without a stranger: a mission says nothing of where one
    /// starts.
    fn from(unknown: &Unknown<'_>) -> Self {
        let Unknown { effect, cells, prior, sights } = *unknown;
        Self {
            effect,
            cells: cells.to_vec(),
            prior: prior.to_vec(),
            sights: sights.to_vec(),
            real: None,
            stranger: None,
        }
    }
}

/// One robot of the team, as the scenario specifies it.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSpec {
    /// The robot's name.
    pub name: String,
    /// The start cell.
    pub start: Cell,
    /// The charge of its battery in percent.
    pub battery: u8,
    /// The charging cell, if the robot has one.
    pub charger: Option<Cell>,
    /// The goal that the robot owns; `None` for a robot that takes any.
    pub goal: Option<Cell>,
    /// The charge that a move takes, in percent.
    pub drain: f64,
    /// The charge gained per tick on the charger, in percent.
    pub charging: f64,
    /// The probability that a move fails and the robot stays.
    pub slip: f64,
    /// The probability that the localiser is right; else it names any other cell.
    pub localiser: f64,
    /// The probability that the team's models give to the localiser being right, where it differs
    /// from the one for all robots.
    pub sensor: Option<f32>,
    /// The range in which obstacles are seen, in cells, diagonals included.
    pub view: u16,
    /// The ticks that one move takes.
    pub pace: u32,
    /// The candidate paths; empty for a robot that plans its own.
    pub paths: Vec<Path>,
}

/// An event that happens once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// The trigger.
    pub when: Trigger,
    /// The effect.
    pub effect: EventEffect,
}

/// The effect of an event. Robots are named by their index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventEffect {
    /// An obstacle appears in this cell, as soon as no robot stands there.
    Block(Cell),
    /// An obstacle appears on a robot's path, two moves ahead of it or, before its last cell, one;
    /// as soon as it has two moves to make.
    BlockPath(usize),
    /// The obstacle in this cell is taken away.
    Clear(Cell),
    /// A robot's battery falls to a charge in percent, if it has more.
    Charge(usize, u8),
    /// A robot is told to visit a cell before its goal.
    Visit(usize, Cell),
    /// A robot stops, with its controller dead, for a number of ticks or for good.
    Stop(usize, Option<u32>),
    /// A device of a robot freezes, for a number of ticks or for good.
    Freeze(usize, Device, Option<u32>),
}

/// A device of a robot that can freeze.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Device {
    /// The localiser: it reads the same again and again, whatever the robot does.
    Localiser,
    /// The drive: no move that is commanded is begun.
    Drive,
}

impl Device {
    /// Both of them.
    pub const ALL: [Self; 2] = [Self::Localiser, Self::Drive];

    /// Returns the name in scenario files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Localiser => "localiser",
            Self::Drive => "drive",
        }
    }
}

/// The trigger of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trigger {
    /// At the beginning of a tick.
    Tick(u32),
    /// Once this robot, by its index, stands in this cell.
    Reached(usize, Cell),
    /// Once this number of joint plans was chosen, and all robots have made this number of moves of
    /// the last one, waits included; at the latest when all have arrived.
    Planned(u32, u32),
}

/// A drive fault: a robot's drive fails to make one kind of move.
#[doc(alias = "fault injection")]
#[doc(alias = "wear")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveFault {
    /// The robot, by its index.
    pub robot: usize,
    /// The move.
    pub step: Move,
    /// The first tick in which it may fail.
    pub from: u32,
    /// The probability that it fails, and the robot stays.
    pub fails: f64,
}

/// The properties of the radio between the robots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radio {
    /// The probability that a frame does not reach a teammate, independently for each of them.
    pub loss: f64,
    /// The mean number of frames in a row that a link from a robot to a teammate loses: the burst
    /// length of the model of Gilbert and Elliott. Zero for losses that do not depend on each
    /// other.
    ///
    /// A link loses all frames in its bad state and none in its good one; `loss` is the share of
    /// the bad state. A length below `loss / (1 - loss)` is not possible and counts as that.
    #[doc(alias = "Gilbert-Elliott")]
    pub burst: u32,
    /// The delay of a frame in ticks, at least one.
    pub delay: u32,
    /// The most ticks that a copy travels beyond them, drawn for each copy.
    pub jitter: u32,
    /// The probability that a frame reaches a teammate twice.
    pub duplicate: f64,
    /// The bytes of noise before each copy, none of them a delimiter.
    pub stray: usize,
    /// The bytes of noise that each robot receives in each tick, of any value.
    pub garbage: usize,
}

/// The parameters of the robots' inference; `None` keeps the core's default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InferenceSpec {
    /// The precision β of the posterior over policies, in nats per tick.
    pub precision: Option<f32>,
    /// The habit of going on with the plan that runs, ln E in nats.
    pub habit: Option<f32>,
    /// The modelled probability that a robot's own localiser is right.
    pub sensor: Option<f32>,
    /// The number of joint policies that are weighed.
    pub policies: Option<u8>,
    /// The work units that planning may take in a tick; `None` for as many as it takes.
    pub budget: Option<u32>,
    /// The learning rate for failures of the drive; zero turns learning off.
    pub learning: Option<f32>,
    /// Whether the robots' models ignore that paces and sensors differ.
    pub alike: bool,
}

impl Event {
    /// The robots that it waits for and that it happens to.
    fn robots(&self) -> impl Iterator<Item = usize> {
        let waits_for = match self.when {
            Trigger::Reached(robot, _) => Some(robot),
            Trigger::Tick(_) | Trigger::Planned(..) => None,
        };
        let happens_to = match self.effect {
            EventEffect::BlockPath(robot)
            | EventEffect::Charge(robot, _)
            | EventEffect::Visit(robot, _)
            | EventEffect::Stop(robot, _)
            | EventEffect::Freeze(robot, ..) => Some(robot),
            EventEffect::Block(_) | EventEffect::Clear(_) => None,
        };
        waits_for.into_iter().chain(happens_to)
    }
}

impl RobotSpec {
    /// Returns the number of steps of a plan that one move takes; a step takes at least a tick.
    #[must_use]
    pub const fn steps(&self) -> u8 {
        self.pace as u8
    }
}

impl Default for Radio {
    fn default() -> Self {
        Self { loss: 0.0, burst: 0, delay: 1, jitter: 0, duplicate: 0.0, stray: 0, garbage: 0 }
    }
}

impl Scenario {
    /// Returns whether a cell is a goal, a charger, or a way-point of an event.
    pub(crate) fn has_place_at(&self, cell: Cell) -> bool {
        let is_waypoint = |event: &Event| matches!(event.effect, EventEffect::Visit(_, at) if at == cell);
        let is_charger = |robot: &RobotSpec| robot.charger == Some(cell);
        self.goals.contains(&cell)
            || self.robots.iter().any(is_charger)
            || self.events.iter().any(is_waypoint)
    }

    /// Whether there are robots that are no members of the team.
    pub(crate) fn has_strangers(&self) -> bool {
        self.unknowns.iter().any(|unknown| unknown.stranger.is_some())
    }

    /// The goals on which no robot of the team counts in a world: those that do not serve, and
    /// those that strangers take. Each unknown has one of `values`.
    pub(crate) fn useless_goals(&self, values: &[u8]) -> impl Iterator<Item = Cell> {
        let idle = self.cells_of_unknowns(Effect::Serves, values, false);
        idle.chain(self.cells_of_unknowns(Effect::Takes, values, true))
    }

    /// The cells of all unknowns with an effect that belong to the values they have, or, where
    /// `is_real` is false, to other values. Each unknown has one of `values`.
    pub(crate) fn cells_of_unknowns(
        &self,
        effect: Effect,
        values: &[u8],
        is_real: bool,
    ) -> impl Iterator<Item = Cell> {
        let of = self.unknowns.iter().zip(values).filter(move |(unknown, _)| unknown.effect == effect);
        of.flat_map(move |(unknown, &value)| {
            let places = unknown.cells.iter().filter(move |place| (place.value == value) == is_real);
            places.map(|place| place.cell)
        })
    }

    /// The scenario with its first robots only, and without what happens to the others; `None` when
    /// it has none, or fewer than this number.
    #[must_use]
    pub fn with_robots(mut self, robots: usize) -> Option<Self> {
        if !(1..=self.robots.len()).contains(&robots) {
            return None;
        }
        self.robots.truncate(robots);
        self.need = self.need.min(robots);
        self.drive_faults.retain(|fault| fault.robot < robots);
        self.events.retain(|event| event.robots().all(|robot| robot < robots));
        Some(self)
    }

    /// Reads a scenario from the bytes of a file; see [`Scenario::parse`].
    ///
    /// # Errors
    /// As [`Scenario::parse`], and when the bytes are no UTF-8.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, FileError> {
        Self::parse(name, utf8(name, bytes)?)
    }

    /// Reads a scenario from text; `name` is its name, also in errors.
    ///
    /// # Errors
    /// [`FileError`] with the line and the reason for the first thing that is wrong.
    pub fn parse(name: &str, text: &str) -> Result<Self, FileError> {
        let read = toml(text).and_then(|file| check::check(name, text, &file));
        read.map_err(|fault| fault.on_line(name, text))
    }
}
