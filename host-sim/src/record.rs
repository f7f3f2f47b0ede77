//! The record of a flight: all that is printed at its end, and the content of `--json`.

use crate::awaited::Awaited;
use crate::flight_event::FlightEvent;
use crate::phases::Phase;
use crate::radio::Traffic;
use crate::referee::Collisions;
use crate::scenario::Scenario;
use crate::team::Pilot;
use crate::verdict::Outcome;
use iibt_core::grid::Cell;
use iibt_core::navigation::{Report, Stage};
use serde::Serialize;

/// A flight from its first to its last tick. Cells are numbered row by row from the top left, from
/// zero.
///
/// ```
/// use host_sim::{Conditions, FlightEvent, Outcome, fly, library};
///
/// let scenario = library::find("two-goals").expect("it is built in")?;
/// let record = fly(&scenario, Conditions { seed: 7, ..Conditions::default() }, &mut ())?;
/// assert_eq!((record.outcome, record.collisions.total()), (Outcome::Together, 0));
/// assert_eq!(record.history.len() as u32, record.ticks + 2);
/// let choices = record.events.iter().filter(|timed| matches!(timed.event, FlightEvent::Chose { .. }));
/// assert!(choices.count() >= record.robots.len());
/// assert!(record.to_json()?.starts_with(r#"{"scenario":"two-goals""#));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "trajectory log")]
#[doc(alias = "result")]
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Record {
    /// The scenario's name.
    pub scenario: String,
    /// The scenario's title.
    pub title: String,
    /// The seed of all chance.
    pub seed: u64,
    /// The pilot of the robots.
    pub pilot: Pilot,
    /// The probability that a frame does not reach a teammate.
    pub loss: f64,
    /// The outcome.
    pub outcome: Outcome,
    /// The number of the last tick, from zero: the one in which the last robot announced that it
    /// had arrived, or the last before the limit.
    pub ticks: u32,
    /// The collisions that the referee counted.
    pub collisions: Collisions,
    /// The radio's traffic of all robots together.
    pub frames: Traffic,
    /// The number of columns of the map.
    pub width: u16,
    /// The number of rows of the map.
    pub height: u16,
    /// The goals.
    pub goals: Vec<Cell>,
    /// The robots, in the order of their numbers.
    pub robots: Vec<RobotRecord>,
    /// The events in order.
    #[serde(rename = "news")]
    pub events: Vec<TimedEvent>,
    /// The rounds in which the team decided or a robot charged, in the order they were opened.
    pub phases: Vec<Phase>,
    /// The robots' cells at first and after every tick, so two entries more than the last tick's
    /// number.
    pub history: Vec<Vec<Cell>>,
    /// The cells of the strangers at the same times; empty for a mission without any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub strangers: Vec<Vec<Cell>>,
    /// The probability that each robot gave to the cell it stood in, in every tick before its move.
    pub certainty: Vec<Vec<f32>>,
}

/// One robot's part of a record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotRecord {
    /// The robot's name.
    pub name: String,
    /// The start cell.
    pub start: Cell,
    /// The true cell at the end.
    pub cell: Cell,
    /// The goal of its last choice.
    pub goal: Option<Cell>,
    /// The cells of the path it chose last.
    pub path: Vec<Cell>,
    /// The posterior probability of that choice.
    pub probability: f32,
    /// The announced stage in one word.
    pub status: &'static str,
    /// What it waits for.
    pub waiting: Option<Awaited>,
    /// Why its last joint plan does not lead all robots to their targets, if it does not.
    pub failure: Option<String>,
    /// The moves it made, waits not counted.
    pub moves: u32,
    /// The first tick in which it stood where it stands at the end.
    pub arrived: u32,
    /// The traffic of the frames it sent.
    pub frames: Traffic,
    /// The charge of its battery at the end, in percent.
    pub battery: u8,
    /// The way-points it visited.
    pub visited: Vec<Cell>,
    /// The number of times it came back charged.
    pub charged: u32,
    /// Whether it has stopped.
    pub stopped: bool,
    /// Whether it is of the team at the end: a robot that was left out for good does not count.
    pub member: bool,
    /// The leaves of its tree that were running, one after the other.
    pub tree: Vec<Activity>,
    /// The number of frames it accepted.
    pub accepted: u32,
    /// The number of frames it rejected, those that it had received before included.
    pub rejected: u32,
}

/// The leaf of a robot's tree that is running from a tick on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Activity {
    /// The tick, from zero.
    pub tick: u32,
    /// The leaf; `None` while none is running.
    pub running: Option<&'static str>,
}

/// An event and its tick.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimedEvent {
    /// The tick in which it happened, from zero.
    pub tick: u32,
    /// What happened.
    #[serde(flatten)]
    pub event: FlightEvent,
}

impl Record {
    /// Returns one line of JSON; the same flight gives the same bytes.
    ///
    /// # Errors
    /// None that can occur: no key of a record is anything but text.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string(self)
    }

    /// Returns the ticks between the first and the last arrival of the members that moved.
    #[must_use]
    pub fn spread(&self) -> u32 {
        let moved = self.members().map(|robot| robot.arrived).filter(|&arrived| arrived > 0);
        self.last_arrival() - moved.min().unwrap_or(0)
    }

    /// Returns the first tick in which all members stood in their last cells.
    #[must_use]
    pub fn last_arrival(&self) -> u32 {
        self.members().map(|robot| robot.arrived).max().unwrap_or(0)
    }

    /// The robots that are of the team at the end.
    pub(crate) fn members(&self) -> impl Iterator<Item = &RobotRecord> {
        self.robots.iter().filter(|robot| robot.member)
    }

    /// The obstacles that appeared, with their ticks.
    pub(crate) fn obstacles(&self) -> impl Iterator<Item = (u32, Cell)> + '_ {
        self.events.iter().filter_map(|timed| match timed.event {
            FlightEvent::Appeared { cell } => Some((timed.tick, cell)),
            _ => None,
        })
    }
}

impl TimedEvent {
    /// Returns the event with its tick in one line of text.
    #[must_use]
    pub fn line(&self, scenario: &Scenario) -> String {
        format!("tick {:>3}  {}", self.tick, self.event.line(scenario))
    }
}

/// Returns the number of times a robot came back with more charge than it left with.
pub(crate) fn times_charged(events: &[TimedEvent], index: usize) -> u32 {
    let (mut left_with, mut times) = (100, 0);
    for timed in events {
        match timed.event {
            FlightEvent::Left { robot, charge } if robot == index => left_with = charge,
            FlightEvent::Returned { robot, charge } if robot == index => {
                times += u32::from(charge > left_with)
            }
            _ => {}
        }
    }
    times
}

/// Returns a stage in one word.
pub(crate) const fn status(report: &Report) -> &'static str {
    match report.stage {
        Stage::Deciding => "deciding",
        Stage::Announced => "announced",
        Stage::Agreed => "agreed",
        Stage::Arrived => "arrived",
        Stage::Away => "away",
        Stage::Stuck => "stuck",
    }
}
