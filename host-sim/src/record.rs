//! The record of a flight: all that is printed at its end, and the content of `--json`.

use crate::flight_event::FlightEvent;
use crate::phases::Phase;
use crate::radio::Traffic;
use crate::referee::Collisions;
use crate::scenario::Scenario;
use crate::team::Pilot;
use iibt_core::grid::Cell;
use iibt_core::navigation::{Report, Stage};
use serde::Serialize;

/// The record of a flight, from its first to its last tick. Cells are numbered row by row from the
/// top left, from zero.
///
/// ```
/// use host_sim::{Conditions, FlightEvent, Outcome, fly, library};
///
/// let scenario = library::find("two-goals").expect("it is built in")?;
/// let record = fly(&scenario, Conditions { seed: 7, ..Conditions::default() }, &mut ())?;
/// assert_eq!((record.outcome, record.collisions.total()), (Outcome::Together, 0));
/// assert_eq!(record.history.len() as u32, record.ticks + 2);
/// let choices =
///     record.events.iter().filter(|timed| matches!(timed.event, FlightEvent::Chose { .. }));
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
    /// The probability that each robot gave to the cell it stood in, in every tick before its move.
    pub certainty: Vec<Vec<f32>>,
}

/// The outcome of a flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// All robots stand at different goals, reached with the same step of one joint plan; robots
    /// with a conventional tree, which have none, at most [`TOGETHER`] ticks apart.
    Together,
    /// All robots stand at different goals, but did not come there together.
    Apart,
    /// The limit was reached first, without a collision.
    Unfinished,
    /// Robots shared or swapped cells, or ran into something.
    Collided,
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
    /// The leaves of its tree that were running, one after the other.
    pub tree: Vec<Activity>,
    /// The number of frames it accepted.
    pub accepted: u32,
    /// The number of frames it rejected.
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
    /// The event.
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

    /// Returns the ticks between the first and the last arrival.
    #[must_use]
    pub fn spread(&self) -> u32 {
        self.last_arrival() - self.robots.iter().map(|robot| robot.arrived).min().unwrap_or(0)
    }

    /// Returns the first tick in which all robots stood in their last cells.
    #[must_use]
    pub fn last_arrival(&self) -> u32 {
        self.robots.iter().map(|robot| robot.arrived).max().unwrap_or(0)
    }
}

impl TimedEvent {
    /// Returns the event with its tick in one line of text.
    #[must_use]
    pub fn line(&self, scenario: &Scenario) -> String {
        format!("tick {:>3}  {}", self.tick, self.event.line(scenario))
    }
}

impl Outcome {
    /// Returns whether the mission was accomplished.
    #[must_use]
    pub const fn is_success(self) -> bool {
        matches!(self, Self::Together)
    }
}

/// Returns the outcome for robots at `cells`, given the collisions and whether they arrived
/// together.
pub(crate) fn outcome(collisions: &Collisions, goals: &[Cell], cells: &[Cell], is_joint: bool) -> Outcome {
    // First, because a mission with a collision is not accomplished wherever the robots end.
    if collisions.total() > 0 {
        Outcome::Collided
    } else if !at_different_goals(goals, cells) {
        Outcome::Unfinished
    } else if is_joint {
        Outcome::Together
    } else {
        Outcome::Apart
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

/// Whether every robot stands at a goal, and no two at the same.
pub(crate) fn at_different_goals(goals: &[Cell], cells: &[Cell]) -> bool {
    let alone = |cell| cells.iter().filter(|&other| other == cell).count() == 1;
    cells.iter().all(|cell| goals.contains(cell) && alone(cell))
}

/// Whether the paths reach their ends with the same step; one that stays at its end from the first
/// agrees with any.
pub(crate) fn is_joint<'p>(paths: impl Iterator<Item = &'p [Cell]>) -> bool {
    let last_step = |path: &[Cell]| path.iter().rposition(|cell| Some(cell) != path.last());
    let mut steps = paths.filter_map(last_step);
    let first = steps.next();
    steps.all(|step| Some(step) == first)
}

/// The most ticks between the arrivals of robots without a joint plan that count as together.
pub const TOGETHER: u32 = 2;

/// Whether these arrivals, in ticks, are at most [`TOGETHER`] apart.
pub(crate) fn is_close(arrivals: impl Iterator<Item = u32> + Clone) -> bool {
    let last = arrivals.clone().max().unwrap_or(0);
    arrivals.min().is_none_or(|first| last - first <= TOGETHER)
}

/// Returns a stage in one word.
pub(crate) const fn status(report: &Report) -> &'static str {
    match report.stage {
        Stage::Deciding => "deciding",
        Stage::Announced => "announced",
        Stage::Agreed => "agreed",
        Stage::Arrived => "arrived",
        Stage::Away => "away",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(cells: [u16; 2], paths: [&[u16]; 2]) -> Outcome {
        let paths = paths.map(|path| path.iter().copied().map(Cell).collect::<Vec<_>>());
        let joint = is_joint(paths.iter().map(Vec::as_slice));
        outcome(&Collisions::default(), &[Cell(3), Cell(8)], &cells.map(Cell), joint)
    }

    #[test]
    fn together_means_different_goals_with_the_same_step() {
        assert_eq!(ends([3, 8], [&[1, 2, 3], &[6, 7, 8]]), Outcome::Together);
        assert_eq!(ends([8, 3], [&[6, 6, 8], &[1, 2, 3]]), Outcome::Together);
        assert_eq!(ends([3, 8], [&[2, 3, 3], &[6, 7, 8]]), Outcome::Apart);
        assert_eq!(ends([3, 8], [&[3, 3, 3], &[6, 7, 8]]), Outcome::Together, "it was there all along");
        assert_eq!(ends([3, 3], [&[2, 3], &[2, 3]]), Outcome::Unfinished);
        assert_eq!(ends([3, 7], [&[2, 3], &[6, 7]]), Outcome::Unfinished);
    }

    #[test]
    fn a_collision_spoils_everything() {
        let collisions = Collisions { swapped: 1, ..Collisions::default() };
        assert_eq!(outcome(&collisions, &[Cell(0)], &[Cell(0)], true), Outcome::Collided);
    }
}
