//! The decision of two robots on the paper's grid, in the paper's arithmetic and in ours.

use crate::notebook::Sweeps;
use iibt_core::actions::Action;
use iibt_core::grid::{Cell, Map, Move, Path, first_conflict};
use iibt_core::inference::{
    Beliefs, Candidates, Evaluation, Evidence, Factor, IdentityNoise, Modality, Model, NextState,
    OutcomeTable, PairPreference, Policy, Problem, Scoring, Shape,
};
use iibt_core::math;

/// Cells of the paper's grid.
pub const CELLS: usize = 49;

/// Cells in a row of it.
pub(super) const WIDTH: u16 = 7;

/// The most candidates a robot has.
const CANDIDATES: usize = 10;

/// The default preference for a collision, on the log scale of C.
const COLLISION: f32 = -4.0;

/// The arithmetic of a decision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DecisionMode {
    /// The paper's own, artefacts included.
    AsPublished,
    /// The product's.
    Default,
}

/// The joint decision of two robots: their candidates and preferences.
#[derive(Clone, Debug)]
pub struct PaperDecision {
    /// The candidate paths of both robots, at least one each, by the names that the paper gives
    /// them.
    pub candidates: [Vec<(&'static str, Path)>; 2],
    /// The goals, in the order of their labels.
    pub goals: Vec<Cell>,
    /// C of both robots' positions.
    pub preferences: [[f32; CELLS]; 2],
    /// The probability that each robot's localiser is right.
    pub sensors: [f32; 2],
    /// The horizon in steps.
    pub horizon: usize,
}

/// An evaluated decision.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The beliefs over both robots' positions after the first observation.
    pub beliefs: [Vec<f32>; 2],
    /// The posterior over the joint policies, a row for each path of the first robot.
    pub posterior: Vec<f32>,
    /// The log of the same up to a constant.
    pub scores: Vec<f32>,
}

impl PaperDecision {
    /// Creates the decision of two robots that prefer any goal, with the sensors of section 5.1.
    #[must_use]
    pub fn new(candidates: [&[(&'static str, &[u16])]; 2], goals: &[u16], horizon: usize) -> Self {
        let drawn =
            |list: &[(&'static str, &[u16])]| list.iter().map(|&(name, cells)| (name, path(cells))).collect();
        let mut preference = [0.0; CELLS];
        goals.iter().for_each(|&goal| preference[usize::from(goal)] = 1.0);
        Self {
            candidates: candidates.map(drawn),
            goals: goals.iter().copied().map(Cell).collect(),
            preferences: [preference; 2],
            sensors: [0.9952, 0.904],
            horizon,
        }
    }

    /// Adds an obstacle with a negative preference for both robots.
    #[must_use]
    pub fn around(mut self, obstacle: Cell) -> Self {
        self.preferences.iter_mut().for_each(|preference| preference[obstacle.index()] = -1.0);
        self
    }

    /// Returns the joint policies, row by row, in which both robots arrive in the same step at
    /// different goals without entering a cell of negative preference.
    #[must_use]
    pub fn simultaneous(&self) -> Vec<usize> {
        let map = map();
        let together = |a: &Path, b: &Path| a.len() == b.len() && a.end(&map) != b.end(&map);
        let avoids = |robot: usize, path: &Path| {
            path.cells(&map).all(|cell| self.preferences[robot][cell.index()] >= 0.0)
        };
        let fits = |pair: &usize| {
            let [(_, a), (_, b)] = self.pair(*pair);
            together(&a, &b) && avoids(0, &a) && avoids(1, &b)
        };
        (0..self.pairs()).filter(fits).collect()
    }

    /// Returns the number of joint policies.
    #[must_use]
    pub fn pairs(&self) -> usize {
        self.candidates[0].len() * self.candidates[1].len()
    }

    /// Returns the paths of both robots in a joint policy.
    ///
    /// # Panics
    /// When there is no such joint policy.
    #[must_use]
    pub fn pair(&self, index: usize) -> [(&'static str, Path); 2] {
        let columns = self.candidates[1].len().max(1);
        [self.candidates[0][index / columns], self.candidates[1][index % columns]]
    }

    /// Returns whether the robots meet in a cell or swap cells in a joint policy.
    ///
    /// # Panics
    /// When there is no such joint policy.
    #[must_use]
    pub fn conflicts(&self, index: usize) -> bool {
        let [(_, first), (_, second)] = self.pair(index);
        first_conflict(&map(), &first, &second).is_some()
    }

    /// Returns the joint policy that a team which lists its paths follows: of those without a
    /// conflict that end at different goals and avoid cells of negative preference, the first that
    /// takes the fewest steps, and of equal ones the one with the shortest wait at a goal.
    ///
    /// # Panics
    /// When there is none.
    #[must_use]
    pub fn soonest(&self) -> usize {
        let map = map();
        let fits = |&pair: &usize| {
            let paths = self.pair(pair).map(|(_, path)| path);
            let avoids = |robot: usize| {
                let mut cells = paths[robot].cells(&map).skip(1);
                cells.all(|cell| self.preferences[robot][cell.index()] >= 0.0)
            };
            paths[0].end(&map) != paths[1].end(&map) && avoids(0) && avoids(1) && !self.conflicts(pair)
        };
        let cost = |pair: &usize| {
            let steps = self.pair(*pair).map(|(_, path)| path.len());
            (steps.into_iter().max(), steps[0].abs_diff(steps[1]))
        };
        // The first of equal ones.
        (0..self.pairs()).filter(fits).min_by_key(cost).expect("the paper lists such a pair")
    }

    /// Returns the name of a joint policy.
    ///
    /// # Panics
    /// When there is no such joint policy.
    #[must_use]
    pub fn name(&self, index: usize) -> String {
        self.pair(index).map(|(name, _)| name).join(" with ")
    }

    /// Evaluates the joint policies.
    #[must_use]
    pub fn judge(&self, mode: DecisionMode) -> Judged {
        let kinds = self.goals.len() + 1;
        let label = |cell: usize| self.goals.iter().position(|goal| goal.index() == cell);
        let labels: [u8; CELLS] = core::array::from_fn(|cell| label(cell).map_or(0, |goal| goal as u8 + 1));
        let labels = [&labels[..]; 2];
        let table: Vec<u8> = (0..kinds * kinds).map(|pair| outcome(pair / kinds, pair % kinds)).collect();
        let outcomes = OutcomeTable::new(&labels, &table, &CERTAIN, OUTCOMES);
        let sensors = self.sensors.map(|right| IdentityNoise::new(right, CELLS));
        let (next, place, flat) =
            (next(), Shape::new(CELLS, &[CELLS]).expect("49"), [1.0 / CELLS as f32; CELLS]);
        let motion = NextState::new(&next, CELLS);
        let factors = [Factor::new(&motion, place, &flat); 2];
        let modalities = [
            Modality::new(&sensors[0], place, &[0], &self.preferences[0]),
            Modality::new(&sensors[1], place, &[1], &self.preferences[1]),
            Modality::new(&outcomes, outcomes.shape(), &[0, 1], &[0.0, 1.0, 0.0]),
        ];
        let model = Model::new(&factors, &modalities);
        let beliefs = self.beliefs(mode, &model);
        let policies = self
            .candidates
            .each_ref()
            .map(|list| list.iter().map(|(_, path)| self.policy(mode, path)).collect::<Vec<Policy>>());
        let sequences = policies.each_ref().map(|policies| policies.as_slice());
        let negative_preferences = self.preferences.map(|preference| preference.map(|value| value.min(0.0)));
        let problem = Problem {
            horizon: self.horizon,
            negative_preferences: &[&negative_preferences[0], &negative_preferences[1]],
            pair_preferences: if mode == DecisionMode::Default { &[&Collision] } else { &[] },
            ..Problem::new(&model, &beliefs, Candidates::all(&sequences), mode.scoring())
        };
        let mut evaluation = Evaluation::<CELLS, 2, CANDIDATES, CANDIDATES>::new();
        evaluation.evaluate(&problem).expect("there is room for 100 policies");
        let posterior = evaluation.posterior().as_flattened()[..evaluation.done()].to_vec();
        Judged {
            beliefs: [0, 1].map(|robot| beliefs.of(&model, robot).expect("the model has it").to_vec()),
            posterior,
            scores: evaluation.scores().to_vec(),
        }
    }

    /// Returns the actions of a path. As published, a robot that arrives before the horizon
    /// continues with action zero, "up", and so leaves its goal again.
    fn policy(&self, mode: DecisionMode, path: &Path) -> Policy {
        let mut policy = path.actions;
        while mode == DecisionMode::AsPublished && policy.len() < self.horizon {
            policy.push(Move::Up.code()).expect("a horizon is a policy's length");
        }
        policy
    }

    fn beliefs(&self, mode: DecisionMode, model: &Model) -> Beliefs<CELLS, 2> {
        let [first, second] =
            self.candidates.each_ref().map(|list| Evidence::Outcome(list[0].1.start.index()));
        let seen = [first, second, Evidence::Outcome(0)];
        let mut beliefs = Beliefs::prior(model);
        if mode == DecisionMode::AsPublished {
            Sweeps::PAPER.update(&mut beliefs, model, &seen);
        } else {
            beliefs.update(model, &seen).expect("every cell can be read, and nobody is on a goal");
        }
        beliefs
    }
}

impl DecisionMode {
    const fn scoring(self) -> Scoring {
        match self {
            Self::Default => Scoring::DEFAULT,
            Self::AsPublished => Scoring::NUMPY_PYMDP,
        }
    }
}

impl std::fmt::Display for DecisionMode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::AsPublished => "as published",
            Self::Default => "default",
        })
    }
}

/// The outcomes of the team: null, success, failure.
const OUTCOMES: usize = 3;

/// Every outcome is certain given the labels.
const CERTAIN: [f32; OUTCOMES * OUTCOMES] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// The outcome of two labels, where zero is no goal.
const fn outcome(first: usize, second: usize) -> u8 {
    match (first, second) {
        (0, 0) => 0,
        (0, _) | (_, 0) => 2,
        _ if first == second => 2,
        _ => 1,
    }
}

/// The preference for a collision in the default mode.
struct Collision;

impl PairPreference for Collision {
    fn factors(&self) -> [usize; 2] {
        [0, 1]
    }

    fn departing(&self, [first, second]: [&[f32]; 2], [action, reply]: [Option<Action>; 2]) -> f32 {
        let (Some(action), Some(reply)) = (action.and_then(Move::from_code), reply.and_then(Move::from_code))
        else {
            return 0.0;
        };
        let (map, cells) = (map(), (0..CELLS as u16).map(Cell));
        let to = |step, cell: Cell| map.neighbour(cell, step);
        let swaps = |cell: &Cell| to(action, *cell) != *cell && to(reply, to(action, *cell)) == *cell;
        let both = |cell: Cell| first[cell.index()] * second[to(action, cell).index()];
        COLLISION * cells.filter(swaps).map(both).sum::<f32>()
    }

    fn arrived(&self, [first, second]: [&[f32]; 2]) -> f32 {
        COLLISION * math::expectation(first, second)
    }
}

/// The paper's grid.
#[must_use]
pub fn map() -> Map<2> {
    Map::new(WIDTH, WIDTH).expect("49 cells fit 64 bits")
}

/// A path on the paper's grid, by its cells.
///
/// # Panics
/// When two cells that follow each other are no neighbours.
#[must_use]
pub(super) fn path(cells: &[u16]) -> Path {
    let cells: Vec<Cell> = cells.iter().copied().map(Cell).collect();
    Path::through(&map(), &cells).expect("a legal path")
}

/// The next cell per move and cell.
fn next() -> Vec<u16> {
    let (map, cells) = (map(), || (0..CELLS as u16).map(Cell));
    Move::ALL.iter().flat_map(|&step| cells().map(move |cell| map.neighbour(cell, step).0)).collect()
}
