//! The generative model of a robot and a teammate on a map, and the preferences for their pair.

use super::mission::{LABELS, Mission, OUTCOMES, outcome_of};
use crate::actions::Action;
use crate::grid::{Cell, Move};
use crate::inference::{
    Beliefs, Factor, IdentityNoise, Modality, Model, NextState, OutcomeTable, PairPreference, Preference,
    Shape,
};
use crate::math;
use crate::team::RobotId;

/// The factor and the modality of a robot's own place.
pub(super) const OWN: usize = 0;

/// The factor and the modality of the teammate's place.
pub(super) const PEER: usize = 1;

/// The modality of what the two places mean for the team.
pub(super) const TEAM: usize = 2;

/// C: the default preference for a goal.
pub(super) const GOAL: f32 = 1.0;

/// The tables of the model, for maps of at most `S` cells. A robot uses them for its teammates too.
#[derive(Clone, Debug)]
pub(super) struct World<const S: usize> {
    /// B: the next cell per move and cell, a row of `cells` per move.
    next: [[u16; S]; Move::ALL.len()],
    /// D: every free cell is equally likely.
    prior: [f32; S],
    /// C: one for each goal, or the learned preference.
    preference: [f32; S],
    /// The number of the goal that a cell is, counted from one.
    labels: [u8; S],
    /// The outcome of each pair of labels.
    outcomes: [u8; LABELS * LABELS],
    sensor: IdentityNoise,
    peer_sensor: IdentityNoise,
    goals: usize,
    cells: usize,
}

/// Every outcome is certain given the labels.
const COLUMNS: [f32; OUTCOMES * OUTCOMES] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

impl<const S: usize> World<S> {
    pub(super) fn new<const W: usize>(mission: &Mission<'_, W>, robot: RobotId) -> Self {
        let cells = mission.map.len().clamp(1, S);
        let free = |state: usize| mission.map.is_free(Cell(state as u16));
        let free_cells = (0..S).filter(|&state| free(state)).count() as f32;
        let goal = |state: usize| mission.goals.iter().position(|&goal| goal == Cell(state as u16));
        let next = |state: usize, step: Move| {
            let next = mission.map.neighbour(Cell(state as u16), step);
            if mission.map.is_free(next) && next.index() < S { next.0 } else { state as u16 }
        };
        let labels = mission.goals.len() + 1;
        let mut moves = [[0; S]; Move::ALL.len()];
        for (row, step) in moves.as_flattened_mut().chunks_exact_mut(cells).zip(Move::ALL) {
            row.iter_mut().enumerate().for_each(|(state, to)| *to = next(state, step));
        }
        Self {
            next: moves,
            prior: core::array::from_fn(|state| if free(state) { 1.0 / free_cells } else { 0.0 }),
            preference: core::array::from_fn(|state| if goal(state).is_some() { GOAL } else { 0.0 }),
            labels: core::array::from_fn(|state| goal(state).map_or(0, |goal| goal as u8 + 1)),
            outcomes: core::array::from_fn(|pair| outcome_of(pair / labels, pair % labels)),
            sensor: IdentityNoise::among(mission.sensor_of(robot), cells),
            peer_sensor: IdentityNoise::among(mission.peer_sensor, cells),
            goals: mission.goals.len(),
            cells,
        }
    }

    /// Sets the probability that a teammate's announced position is correct.
    pub(super) fn set_peer_reliability(&mut self, word: f32) {
        self.peer_sensor = IdentityNoise::among(word, self.cells);
    }

    /// Sets the preference for each goal, at most [`GOAL`].
    pub(super) fn set_goal_preferences(&mut self, goals: &[Cell], values: &[f32]) {
        for (goal, &value) in goals.iter().zip(values) {
            if let Some(preference) = self.preference.get_mut(goal.index()) {
                *preference = if value > 0.0 && value <= GOAL { value } else { GOAL };
            }
        }
    }

    /// Returns the base preference for a cell.
    pub(super) fn preference_for(&self, cell: Cell) -> f32 {
        self.preference.get(cell.index()).copied().unwrap_or(0.0)
    }

    /// Returns the base preference C.
    pub(super) fn preference(&self) -> Preference<S> {
        Preference::from_fn(|state| self.preference.get(state).copied().unwrap_or(0.0))
    }

    /// Returns the initial belief D.
    pub(super) fn initial(&self) -> Beliefs<S, 1> {
        self.with_own_model(|model| Beliefs::try_prior(model).ok()).flatten().unwrap_or(Beliefs::EMPTY)
    }

    /// Returns the team's outcome of two cells.
    pub(super) fn outcome(&self, own: Cell, peer: Cell) -> usize {
        let label = |cell: Cell| self.labels.get(cell.index()).copied().map_or(0, usize::from);
        let pair = label(own) * (self.goals + 1) + label(peer);
        self.outcomes.get(pair).copied().map_or(0, usize::from)
    }

    /// Returns B: each move leads to the neighbour, or stays at a wall or border.
    pub(super) fn motion(&self) -> NextState<'_> {
        let rows = self.next.as_flattened().get(..Move::ALL.len() * self.cells);
        NextState::trusted(rows.unwrap_or(&[]), self.cells)
    }

    /// Returns the entries of a list of `S` that belong to cells of the map.
    pub(super) fn cells<'a, T>(&self, list: &'a [T]) -> &'a [T] {
        list.get(..self.cells).unwrap_or(list)
    }

    /// Calls `then` with the model of this robot alone; returns `None` for tables that are no
    /// model, which a checked mission does not produce.
    pub(super) fn with_own_model<T>(&self, then: impl FnOnce(&Model) -> T) -> Option<T> {
        let (motion, place) = (self.motion(), Shape::new(self.cells, &[self.cells])?);
        let factors = [Factor::trusted(&motion, place, self.cells(&self.prior))];
        let modalities = [Modality::trusted(&self.sensor, place, &[OWN], self.cells(&self.preference))];
        let Ok(model) = Model::try_new(&factors, &modalities) else { return None };
        Some(then(&model))
    }

    /// Calls `then` with the model of this robot and a teammate: each reads its own cell, and both
    /// cells determine the team's outcome.
    pub(super) fn with_pair_model<T>(&self, then: impl FnOnce(&Model) -> T) -> Option<T> {
        let labels = [self.cells(&self.labels); 2];
        let count = self.goals + 1;
        let kinds = self.outcomes.get(..count * count)?;
        let outcomes = OutcomeTable::trusted(&labels, count, kinds, &COLUMNS, OUTCOMES)?;
        let (motion, place) = (self.motion(), Shape::new(self.cells, &[self.cells])?);
        let (prior, preference) = (self.cells(&self.prior), self.cells(&self.preference));
        let factors = [Factor::trusted(&motion, place, prior); 2];
        let modalities = [
            Modality::trusted(&self.sensor, place, &[OWN], preference),
            Modality::trusted(&self.peer_sensor, place, &[PEER], preference),
            Modality::trusted(&outcomes, outcomes.shape(), &[OWN, PEER], &Mission::<0>::OUTCOME_PREFERENCE),
        ];
        let Ok(model) = Model::try_new(&factors, &modalities) else { return None };
        Some(then(&model))
    }
}

/// The preference for a collision of two robots, in one cell or swapping cells: at most zero, on
/// the log scale of C.
pub(super) struct Collision<'a> {
    pub(super) motion: NextState<'a>,
    pub(super) preference: f32,
}

impl PairPreference for Collision<'_> {
    fn factors(&self) -> [usize; 2] {
        [OWN, PEER]
    }

    fn departing(&self, [own, peer]: [&[f32]; 2], [action, reply]: [Option<Action>; 2]) -> f32 {
        let (Some(action), Some(reply)) = (action, reply) else { return 0.0 };
        let mut exchange = 0.0;
        for (state, p) in own.iter().enumerate() {
            let next = self.motion.successor(action, state);
            if next != state && self.motion.successor(reply, next) == state {
                exchange += p * peer.get(next).copied().unwrap_or(0.0);
            }
        }
        self.preference * exchange
    }

    fn arrived(&self, [own, peer]: [&[f32]; 2]) -> f32 {
        self.preference * math::expectation(own, peer)
    }
}
