//! The state of a navigating robot, for displays and logs.

use super::{Cause, Navigation, Purpose};
use crate::grid::joint::Failure;
use crate::grid::{Cell, Move, Path};
use crate::team::rounds::{View, Waiting};

/// How far a robot is with its part of the mission.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Stage {
    /// The list or scores of its round are missing.
    #[default]
    Deciding,
    /// It has announced its scores.
    Announced,
    /// It knows the joint plan and follows it.
    Agreed,
    /// It stands where it is to end.
    Arrived,
    /// It charges its battery, or is on its way there.
    Away,
    /// Its readings do not follow its moves: its localiser or its drive stands still. It stands,
    /// and tries a move from time to time until a reading follows.
    Stuck,
}

/// A navigating robot's state after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Report {
    /// How far it is.
    pub stage: Stage,
    /// The number of the joint decision.
    pub round: u32,
    /// The robots that decide together.
    pub members: View,
    /// The goal that its path leads to.
    pub goal: Option<Cell>,
    /// The path, from where the robot stood when the round began; its
    /// [`cells`](crate::grid::Path::cells) need the map.
    pub path: Path,
    /// The number of steps of the path that are done.
    pub step: usize,
    /// The number of the chosen policy in the list, once it is known.
    pub policy: Option<usize>,
    /// The posterior probability of the joint policy.
    pub probability: f32,
    /// The most likely cell.
    pub cell: Cell,
    /// The probability of that cell.
    pub confidence: f32,
    /// The surprise of the last reading, -ln P(o); `None` when the reading was impossible.
    pub surprise: Option<f32>,
    /// The next way-point to visit.
    pub waypoint: Option<Cell>,
    /// The first way-point that the robot does not visit because an obstacle is on it, by what it
    /// has seen itself; it is visited once the robot knows that the obstacle is gone.
    pub obstructed: Option<Cell>,
    /// The first way-point that is put off, because no plan was found that leads there; it is tried
    /// again later.
    pub put_off: Option<Cell>,
    /// The first way-point of a lost teammate that no member has taken over. If that lasts, no
    /// member can get there, or none has room for it.
    pub left_behind: Option<Cell>,
    /// The look-out that its path leads by, to see a cell of which no member knows whether it is
    /// blocked.
    pub look_out: Option<Cell>,
    /// The reason for which the robot opened the round, if it did.
    pub cause: Option<Cause>,
    /// What it waits for.
    pub waiting: Option<Waiting>,
    /// Why the plan does not lead all robots to their targets, if it does not.
    pub failure: Option<Failure>,
    /// The goals that the plan misses: they are blocked, or a robot that was left out may be on
    /// them. As long as nothing new is known, the team stands at the end of it.
    pub short_by: usize,
}

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    Navigation<'_, S, W, L, M, K>
{
    /// Returns the robot's state after the last tick.
    #[must_use]
    pub fn report(&self) -> Report {
        let (cell, confidence) = self.localisation().position();
        let rounds = self.rounds();
        let (path, moves) = self.course().map_or((Path::at(cell), 0), |(path, moves)| (*path, moves));
        let end = path.end(&self.mission().map);
        let members = rounds.map_or(View::EMPTY, |rounds| rounds.proposal().view);
        let policy = rounds.and_then(|rounds| rounds.protocol().policy());
        Report {
            stage: self.stage(),
            round: rounds.map_or(0, |rounds| rounds.proposal().round),
            members,
            goal: policy.and(Some(end)).filter(|&end| self.mission().is_goal_of(members, self.robot(), end)),
            path,
            step: steps_after(&path, moves),
            policy,
            probability: policy.map_or(0.0, |policy| self.weighed().probability(policy)),
            cell,
            confidence,
            surprise: self.localisation().surprise().ok(),
            waypoint: self.waypoints().first().copied(),
            obstructed: self.first_obstructed(),
            put_off: self.first_put_off(),
            left_behind: self.left_behind().next(),
            look_out: self.look_out(),
            cause: self.cause(),
            waiting: self.waiting(),
            failure: self.failure(),
            short_by: self.short_by(),
        }
    }

    fn stage(&self) -> Stage {
        let protocol = self.rounds().map(|rounds| rounds.protocol());
        if self.is_stuck() {
            Stage::Stuck
        } else if matches!(self.purpose(), Purpose::Charge(_) | Purpose::Stand) {
            Stage::Away
        } else if self.has_arrived() {
            Stage::Arrived
        } else if protocol.is_some_and(|protocol| protocol.has_decided()) {
            Stage::Agreed
        } else if protocol.is_some_and(|protocol| protocol.digest().is_some()) {
            Stage::Announced
        } else {
            Stage::Deciding
        }
    }
}

/// The number of steps, waits included, after which this many moves of a path are made.
pub(super) fn steps_after(path: &Path, moves: u16) -> usize {
    let mut left = moves;
    let step = |step: Move| {
        let is_move = step != Move::Wait;
        let is_done = left > 0 || !is_move;
        left = left.saturating_sub(u16::from(is_move && left > 0));
        is_done
    };
    path.moves().map(step).take_while(|&is_done| is_done).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Map;

    #[test]
    fn waits_before_the_next_move_are_done_with_the_last_one() {
        let map = Map::<2>::new(7, 7).unwrap();
        let path = Path::through(&map, &[0, 0, 1, 1, 1, 2, 2].map(Cell)).unwrap();
        assert_eq!([0, 1, 2, 3].map(|moves| steps_after(&path, moves)), [1, 4, 6, 6]);
    }
}
