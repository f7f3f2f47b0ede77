//! The record of a flight: everything that is printed at its end, and the whole of `--json`.

use crate::news::News;
use crate::phases::Phase;
use crate::radio::Traffic;
use crate::referee::Collisions;
use crate::scenario::Scenario;
use crate::team::Pilot;
use iibt_core::grid::Cell;
use iibt_core::navigation::{Report, Stage};
use serde::Serialize;

/// A flight from its first to its last tick. Cells are numbered row by row from the top left, from zero.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Record {
    /// The scenario's name.
    pub scenario: String,
    /// The scenario's title.
    pub title: String,
    /// The seed of all chance.
    pub seed: u64,
    /// What flew the robots.
    pub pilot: Pilot,
    /// The probability that a frame does not reach a teammate.
    pub loss: f64,
    /// How it ended.
    pub outcome: Outcome,
    /// The number of the last tick, from zero: the one in which the last robot said that it had arrived, or the
    /// last before the limit.
    pub ticks: u32,
    /// What the referee saw.
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
    /// What happened, in order.
    pub news: Vec<Dated>,
    /// The rounds in which the team decided or a robot charged, in the order they were opened.
    pub phases: Vec<Phase>,
    /// Where the robots stood: at first, then after every tick, so two entries more than the last tick's number.
    pub history: Vec<Vec<Cell>>,
    /// How likely each robot took itself to be in the cell it stood in, in every tick before its move.
    pub certainty: Vec<Vec<f32>>,
}

/// How a flight ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// All robots stand at different goals, reached with the same step of one joint plan; robots with a conventional tree,
    /// which have none, at most [`TOGETHER`] ticks apart.
    Together,
    /// All robots stand at different goals, but did not come there together.
    Apart,
    /// The limit was reached first, without a collision.
    Unfinished,
    /// Robots shared or swapped cells, or ran into something.
    Collided,
}

/// One robot's part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotRecord {
    /// What it is called.
    pub name: String,
    /// Where it started.
    pub start: Cell,
    /// Where it stands at the end, in truth.
    pub cell: Cell,
    /// The goal of its last choice.
    pub goal: Option<Cell>,
    /// The cells of the path it chose last.
    pub path: Vec<Cell>,
    /// The posterior probability of that choice.
    pub probability: f32,
    /// What it says it is doing.
    pub status: &'static str,
    /// The moves it made, waits not counted.
    pub moves: u32,
    /// The first tick in which it stood where it stands at the end.
    pub arrived: u32,
    /// What became of the frames it sent.
    pub frames: Traffic,
    /// The charge of its battery at the end, in percent.
    pub battery: u8,
    /// The way-points it visited.
    pub visited: Vec<Cell>,
    /// How often it came back charged.
    pub charged: u32,
    /// Whether it has stopped.
    pub stopped: bool,
    /// The leaves of its tree that were running, one after the other.
    pub tree: Vec<Activity>,
    /// The frames it received and took in.
    pub accepted: u32,
    /// The frames it received and rejected.
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

/// News and its tick.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dated {
    /// The tick in which it happened, from zero.
    pub tick: u32,
    /// What happened.
    #[serde(flatten)]
    pub news: News,
}

impl Record {
    /// The record as one line of JSON; the same flight gives the same bytes.
    ///
    /// # Errors
    /// None that can occur: no key of a record is anything but text.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string(self)
    }

    /// The ticks between the first and the last arrival.
    #[must_use]
    pub fn spread(&self) -> u32 {
        self.last_arrival() - self.robots.iter().map(|robot| robot.arrived).min().unwrap_or(0)
    }

    /// The first tick in which all robots stood where they stand at the end.
    #[must_use]
    pub fn last_arrival(&self) -> u32 {
        self.robots.iter().map(|robot| robot.arrived).max().unwrap_or(0)
    }
}

impl Dated {
    /// This in one line.
    #[must_use]
    pub fn line(&self, scenario: &Scenario) -> String {
        format!("tick {:>3}  {}", self.tick, self.news.line(scenario))
    }
}

impl Outcome {
    /// Whether the mission was accomplished.
    #[must_use]
    pub const fn is_success(self) -> bool {
        matches!(self, Self::Together)
    }
}

/// How robots at `cells` stand, given what the referee saw and whether they arrived together.
pub(crate) fn outcome(collisions: &Collisions, goals: &[Cell], cells: &[Cell], is_joint: bool) -> Outcome {
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

/// How often a robot came back with more charge than it left with.
pub(crate) fn times_charged(news: &[Dated], index: usize) -> u32 {
    let (mut left_with, mut times) = (100, 0);
    for dated in news {
        match dated.news {
            News::Left { robot, charge } if robot == index => left_with = charge,
            News::Returned { robot, charge } if robot == index => times += u32::from(charge > left_with),
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

/// Whether the paths reach their ends with the same step; one that stays at its end from the first agrees
/// with any.
pub(crate) fn is_joint<'p>(paths: impl Iterator<Item = &'p [Cell]>) -> bool {
    let last_step = |path: &[Cell]| path.iter().rposition(|cell| Some(cell) != path.last());
    let mut steps = paths.filter_map(last_step);
    let first = steps.next();
    steps.all(|step| Some(step) == first)
}

/// How many ticks apart robots without a joint plan may arrive to have arrived together.
pub const TOGETHER: u32 = 2;

/// Whether these arrivals, in ticks, are at most [`TOGETHER`] apart.
pub(crate) fn is_close(arrivals: impl Iterator<Item = u32> + Clone) -> bool {
    let last = arrivals.clone().max().unwrap_or(0);
    arrivals.min().is_none_or(|first| last - first <= TOGETHER)
}

/// A status in one word.
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
