//! Scenarios: what a mission is flown in. Read from TOML with a drawn map, checked as a whole.
//!
//! The format is described for users in `scenarios/README.md`. A [`Scenario`] that exists is sound: every cell
//! it names is on the map, every start is free and nobody else's, every number is in its range,
//! and by the map there is a way for every robot to a goal of its own.

mod check;
mod drawing;
mod error;
mod event;
mod file;
mod reach;
mod team;
mod values;

pub use error::ScenarioError;

use iibt_core::grid::{Cell, Map, Move, Path};

/// The most cells a map has.
pub const MAX_CELLS: usize = 1024;

/// The most candidate paths a robot is given.
pub const MAX_PATHS: usize = 16;

/// The longest mission, in ticks.
pub const MAX_TICKS: u32 = 100_000;

/// A map of up to [`MAX_CELLS`] cells.
pub type Floor = Map<{ iibt_core::grid::words(MAX_CELLS, 1) }>;

/// A mission and the world it is flown in.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// What it is called on the command line: the name of a built-in one, else the file.
    pub name: String,
    /// What it shows, in one line.
    pub title: String,
    /// The ticks after which the mission counts as not accomplished.
    pub limit: u32,
    /// What the robots know of the world when they start.
    pub map: Floor,
    /// Where robots are wanted, one each.
    pub goals: Vec<Cell>,
    /// The probability with which each goal serves a robot that stands there at the end of a mission.
    pub serves: Vec<f64>,
    /// How often the mission is flown in a row.
    pub missions: u32,
    /// The team, in the order of the robots' numbers.
    pub robots: Vec<Robot>,
    /// What happens while the mission is flown.
    pub events: Vec<Event>,
    /// The drives that make some moves only now and then.
    pub wear: Vec<Wear>,
    /// The radio between the robots.
    pub radio: Radio,
    /// What the robots' inference works with.
    pub inference: Inference,
}

/// One robot of the team.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// What it is called.
    pub name: String,
    /// Where it stands at first.
    pub start: Cell,
    /// The charge of its battery in percent.
    pub battery: u8,
    /// Where it charges, if there is such a place.
    pub charger: Option<Cell>,
    /// What a move takes from its battery, in percent.
    pub drain: f64,
    /// What a tick on its charger gives its battery, in percent.
    pub charging: f64,
    /// The probability that a move fails, and it stays.
    pub slip: f64,
    /// The probability that its localiser is right; else it names any other cell.
    pub localiser: f64,
    /// The probability with which the team takes that localiser to be right, where it is not the one for all robots.
    pub sensor: Option<f32>,
    /// How many cells far it sees obstacles, diagonals included.
    pub view: u16,
    /// The ticks that one of its moves takes.
    pub pace: u32,
    /// The paths it may choose from; none when it plans its own.
    pub paths: Vec<Path>,
}

/// Something that happens once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// When.
    pub when: When,
    /// What.
    pub effect: Effect,
}

/// What an event does. Robots are named by their index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// An obstacle appears in this cell, as soon as no robot stands there.
    Block(Cell),
    /// A robot's battery falls to a charge in percent, if it has more.
    Charge(usize, u8),
    /// A robot is told to visit a cell before its goal.
    Visit(usize, Cell),
    /// A robot stops: its controller is dead and it stands, for so many ticks or for good.
    Stop(usize, Option<u32>),
}

/// When an event happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// At the beginning of a tick.
    Tick(u32),
    /// Once this robot, by its index, stands in this cell.
    Reached(usize, Cell),
    /// Once all robots have agreed to a joint plan so many times, and made so many moves of the last, waits included.
    Planned(u32, u32),
}

/// A robot's drive that fails to make one kind of move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wear {
    /// The robot, by its index.
    pub robot: usize,
    /// The move.
    pub step: Move,
    /// The first tick in which it may fail.
    pub from: u32,
    /// The probability that it fails, and the robot stays.
    pub fails: f64,
}

/// What happens to frames between the robots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radio {
    /// The probability that a frame does not reach a teammate, for each of them alone.
    pub loss: f64,
    /// The ticks a frame travels, at least one.
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

/// The parameters of the robots' inference; `None` leaves the core's own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inference {
    /// The policy precision γ.
    pub precision: Option<f32>,
    /// The probability with which a robot takes its own localiser to be right.
    pub sensor: Option<f32>,
    /// The probability with which it takes a teammate's word on its cell to be right.
    pub peer_sensor: Option<f32>,
    /// What it costs in a policy's prior to arrive later than the team could, per move.
    pub haste: Option<f32>,
    /// The preference for a collision, at most zero.
    pub collision: Option<f32>,
    /// How much a robot learns of its drive from one move; zero turns learning off.
    pub learning: Option<f32>,
    /// Whether the robots take each other for equal, whatever their paces and their sensors are.
    pub alike: bool,
}

impl Robot {
    /// The steps of a plan that one of its moves takes: a step takes a tick at the least.
    #[must_use]
    pub const fn steps(&self) -> u8 {
        self.pace as u8
    }
}

impl Default for Radio {
    fn default() -> Self {
        Self { loss: 0.0, delay: 1, jitter: 0, duplicate: 0.0, stray: 0, garbage: 0 }
    }
}

impl Scenario {
    /// Reads a scenario from the bytes of a file, which need not be text; see [`Scenario::parse`].
    ///
    /// # Errors
    /// As [`Scenario::parse`], and when the bytes are no UTF-8.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, ScenarioError> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let before = bytes.iter().take(error.valid_up_to());
            let line = 1 + before.filter(|&&byte| byte == b'\n').count();
            ScenarioError { file: name.to_owned(), line, reason: "this is no UTF-8 text".to_owned() }
        })?;
        Self::parse(name, text)
    }

    /// Reads a scenario; `name` is what it will be called, in errors too.
    ///
    /// # Errors
    /// [`ScenarioError`] with the line and the reason for the first thing that is wrong.
    pub fn parse(name: &str, text: &str) -> Result<Self, ScenarioError> {
        let parsed = toml::from_str(text).map_err(error::Fault::from);
        parsed.and_then(|file| check::check(name, text, &file)).map_err(|fault| fault.in_file(name, text))
    }
}
