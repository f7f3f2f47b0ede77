//! The score of one flight, and the summary of all flights of a kind.

use super::validator::{Trace, Violations};
use crate::record::Record;
use crate::scenario::Scenario;
use crate::statistics::{Difference, Distribution, Share};
use crate::team::Pilot;
use crate::verdict::Outcome;
use serde::Serialize;

/// One flight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Its seed.
    pub seed: u64,
    /// The outcome.
    pub outcome: Outcome,
    /// Whether the mission was accomplished by moves, without a collision.
    pub accomplished: bool,
    /// Whether the robots also came together, as [`Outcome::Together`] says.
    pub together: bool,
    /// The ticks until the last robot reached its final cell.
    pub ticks: u32,
    /// The ticks until all robots had reported that they have arrived: one or two more.
    pub reported: u32,
    /// The ticks between the first and the last arrival.
    pub spread: u32,
    /// The violations that the validator found.
    pub faults: Violations,
    /// Moves into an obstacle or the border, which the referee counts because positions do not show
    /// them.
    pub bumps: u32,
    /// The frames sent by all robots.
    pub messages: u32,
    /// The moves made by all robots, waits not counted.
    pub moves: u32,
    /// The robots that stood alone at a goal at the end.
    pub in_place: u32,
}

impl Score {
    /// Returns the score of a flight of a scenario.
    #[must_use]
    pub fn of(scenario: &Scenario, record: &Record) -> Self {
        let faults = Trace::of(scenario, record).validate();
        let bumps = record.collisions.bumps;
        let is_safe = faults.total() + bumps == 0;
        let accomplished = is_safe && matches!(record.outcome, Outcome::Together | Outcome::Apart);
        let spread = record.spread();
        Self {
            seed: record.seed,
            outcome: record.outcome,
            accomplished,
            together: accomplished && record.outcome == Outcome::Together,
            ticks: record.last_arrival(),
            reported: record.ticks,
            spread,
            faults,
            bumps,
            messages: record.frames.sent,
            moves: record.robots.iter().map(|robot| robot.moves).sum(),
            in_place: in_place(record),
        }
    }

    /// Whether there was a violation or collision of any kind.
    #[must_use]
    pub const fn has_collided(&self) -> bool {
        self.faults.total() + self.bumps > 0
    }
}

fn in_place(record: &Record) -> u32 {
    let cells = || record.robots.iter().map(|robot| robot.cell);
    let alone = |cell| cells().filter(|&other| other == cell).count() == 1;
    cells().filter(|&cell| record.goals.contains(&cell) && alone(cell)).count() as u32
}

/// All flights of one pilot under one disturbance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The pilot.
    pub pilot: Pilot,
    /// The share of flights that accomplished the mission.
    pub accomplished: Share,
    /// The seeds of the flights that did not.
    pub missed: Vec<u64>,
    /// The share of these that brought the robots there together.
    pub together: Share,
    /// The share of flights with a collision of any kind.
    pub collided: Share,
    /// The violations that the validator found, in all flights together.
    pub faults: Violations,
    /// The moves into an obstacle or the border, in all flights together.
    pub bumps: u32,
    /// The ticks that it took, in flights that accomplished the mission.
    pub ticks: Distribution,
    /// The ticks until all robots had reported that they have arrived, in the same flights.
    pub reported: Distribution,
    /// The ticks between the first and the last arrival, in the same flights.
    pub spread: Distribution,
    /// The frames sent, in the same flights.
    pub messages: Distribution,
    /// The moves made, in the same flights.
    pub moves: Distribution,
    /// The robots that stood alone at a goal at the end, in all flights.
    pub in_place: Distribution,
}

impl Summary {
    /// Returns the summary of flights.
    #[must_use]
    pub fn of(pilot: Pilot, scores: &[Score]) -> Self {
        let done = || scores.iter().filter(|score| score.accomplished);
        let over = |value: fn(&Score) -> u32| Distribution::of(done().map(|score| f64::from(value(score))));
        let faults = scores.iter().fold(Violations::default(), |sum, score| Violations {
            shared: sum.shared + score.faults.shared,
            swapped: sum.swapped + score.faults.swapped,
            blocked: sum.blocked + score.faults.blocked,
            jumps: sum.jumps + score.faults.jumps,
        });
        Self {
            pilot,
            accomplished: Share::of(scores, |score| score.accomplished),
            missed: scores.iter().filter(|score| !score.accomplished).map(|score| score.seed).collect(),
            together: Share::of(done(), |score| score.together),
            collided: Share::of(scores, Score::has_collided),
            faults,
            bumps: scores.iter().map(|score| score.bumps).sum(),
            ticks: over(|score| score.ticks),
            reported: over(|score| score.reported),
            spread: over(|score| score.spread),
            messages: over(|score| score.messages),
            moves: over(|score| score.moves),
            in_place: Distribution::of(scores.iter().map(|score| f64::from(score.in_place))),
        }
    }
}

/// The differences between two pilots on the same seeds, the first minus the second.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The first and the second.
    pub pilots: [Pilot; 2],
    /// Missions accomplished, per flight.
    pub accomplished: Difference,
    /// Flights that brought the robots there together, in pairs of which both accomplished the
    /// mission.
    pub together: Difference,
    /// Ticks, in the same pairs.
    pub ticks: Difference,
    /// Frames sent, in the same pairs.
    pub messages: Difference,
    /// Moves made, in the same pairs.
    pub moves: Difference,
}

impl Comparison {
    /// Compares flights with the same seeds in the same order.
    #[must_use]
    pub fn of(pilots: [Pilot; 2], first: &[Score], second: &[Score]) -> Self {
        let pairs = || first.iter().zip(second);
        let done = || pairs().filter(|(one, other)| one.accomplished && other.accomplished);
        let over = |value: fn(&Score) -> u32| {
            Difference::of(done().map(|(one, other)| f64::from(value(one)) - f64::from(value(other))))
        };
        let more = |one: bool, other: bool| f64::from(u8::from(one)) - f64::from(u8::from(other));
        Self {
            pilots,
            accomplished: Difference::of(
                pairs().map(|(one, other)| more(one.accomplished, other.accomplished)),
            ),
            together: Difference::of(done().map(|(one, other)| more(one.together, other.together))),
            ticks: over(|score| score.ticks),
            messages: over(|score| score.messages),
            moves: over(|score| score.moves),
        }
    }
}
