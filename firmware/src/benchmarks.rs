//! Two models of the field's benchmarks, in their best form: what the image `benchmark` and the host's bench run.
//!
//! T1 has two factors of 4 states, modalities of 4, 4 and 3 outcomes and 16 one-step policies; T2 has two factors of 49,
//! modalities of 49, 49 and 3 and 16 policies of 6 steps. Other tools take 154 thousand and 195 million instructions for
//! one belief update and policy posterior of them (cpp-AIF, x86-64).

use iibt_core::actions::Action;
use iibt_core::inference::{
    Beliefs, Candidates, Evaluation, Evidence, Factor, IdentityNoise, Impossible, Modality, Model, NextState,
    OutcomeTable, Policy, Problem, Scoring,
};

/// The joint policies of both models.
pub const POLICIES: usize = 16;

/// One robot's candidates in both models.
const CANDIDATES: usize = 4;

/// A model with what is to be decided: `S` states a robot.
#[derive(Clone, Copy)]
pub struct Benchmark<const S: usize> {
    /// What it is called.
    pub name: &'static str,
    /// The generative model.
    pub model: &'static Model<'static>,
    /// Each robot's candidates.
    pub candidates: [[Policy; CANDIDATES]; 2],
    /// What was observed.
    pub evidence: [Evidence<'static>; 3],
}

/// The memory that a benchmark works in.
#[derive(Clone, Debug)]
pub struct Workspace<const S: usize> {
    /// q(s) after the update.
    pub beliefs: Beliefs<S, 2>,
    /// The policies' scores.
    pub evaluation: Evaluation<S, 2, CANDIDATES, CANDIDATES>,
}

impl<const S: usize> Workspace<S> {
    /// Empty.
    #[must_use]
    pub fn new(benchmark: &Benchmark<S>) -> Self {
        Self { beliefs: Beliefs::prior(benchmark.model), evaluation: Evaluation::new() }
    }
}

impl<const S: usize> Benchmark<S> {
    /// One belief update and the posterior over the policies.
    ///
    /// # Errors
    /// [`Impossible`] when the observation has probability zero, which those of the benchmarks have not.
    pub fn run(&self, workspace: &mut Workspace<S>, scoring: Scoring) -> Result<[f32; POLICIES], Impossible> {
        workspace.beliefs = Beliefs::prior(self.model);
        workspace.beliefs.update(self.model, &self.evidence)?;
        let sequences = self.candidates.each_ref().map(|list| list.as_slice());
        let problem = Problem::new(self.model, &workspace.beliefs, Candidates::all(&sequences), scoring);
        workspace.evaluation.evaluate(&problem);
        let mut flat = [0.0; POLICIES];
        flat.copy_from_slice(workspace.evaluation.posterior().as_flattened());
        Ok(flat)
    }
}

/// T1: four places to go to, reached nine times in ten.
#[must_use]
pub fn t1() -> Benchmark<4> {
    static MOTION: NextState =
        NextState::with_slip(&[0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3], 4, 0.1);
    static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 4);
    static RESULT: OutcomeTable = OutcomeTable::new(
        &[&[0, 1, 2, 3], &[0, 1, 2, 3]],
        &[0, 0, 0, 0, 0, 2, 1, 0, 0, 1, 2, 0, 0, 0, 0, 2],
        &[0.96, 0.02, 0.02, 0.03, 0.95, 0.02, 0.08, 0.02, 0.9],
        3,
    );
    static FACTORS: [Factor; 2] = [
        Factor::new(&MOTION, MOTION.shape(), &[0.7, 0.1, 0.1, 0.1]),
        Factor::new(&MOTION, MOTION.shape(), &[0.4, 0.2, 0.2, 0.2]),
    ];
    static MODALITIES: [Modality; 3] = [
        Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 0.5, 0.25, 0.0]),
        Modality::new(&SENSOR, SENSOR.shape(), &[1], &[0.0, 0.25, 0.5, 0.0]),
        Modality::new(&RESULT, RESULT.shape(), &[0, 1], &[0.0, 2.0, -2.0]),
    ];
    static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
    let places = [0, 1, 2, 3].map(|place: Action| policy(&[place]));
    Benchmark {
        name: "T1",
        model: &MODEL,
        candidates: [places, places],
        evidence: [Evidence::Outcome(1), Evidence::Outcome(0), Evidence::Outcome(0)],
    }
}

/// The cells of T2's grid of 7 x 7.
pub const CELLS: usize = 49;

/// T2: two robots on a grid, who are to stand on its two goals, one each.
#[must_use]
pub fn t2() -> Benchmark<CELLS> {
    static MOVES: [u16; 4 * CELLS] = moves();
    static MOTION: NextState = NextState::new(&MOVES, CELLS);
    static SENSORS: [IdentityNoise; 2] =
        [IdentityNoise::new(0.9952, CELLS), IdentityNoise::new(0.904, CELLS)];
    static LABELS: [u8; CELLS] = {
        let mut labels = [0; CELLS];
        (labels[24], labels[26]) = (1, 2);
        labels
    };
    static RESULT: OutcomeTable = OutcomeTable::new(
        &[&LABELS, &LABELS],
        &[0, 2, 2, 2, 2, 1, 2, 1, 2],
        &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        3,
    );
    static GOALS: [f32; CELLS] = {
        let mut goals = [0.0; CELLS];
        (goals[24], goals[26]) = (1.0, 1.0);
        goals
    };
    static EVEN: [f32; CELLS] = [1.0 / CELLS as f32; CELLS];
    static FACTORS: [Factor; 2] = [Factor::new(&MOTION, MOTION.shape(), &EVEN); 2];
    static MODALITIES: [Modality; 3] = [
        Modality::new(&SENSORS[0], SENSORS[0].shape(), &[0], &GOALS),
        Modality::new(&SENSORS[1], SENSORS[1].shape(), &[1], &GOALS),
        Modality::new(&RESULT, RESULT.shape(), &[0, 1], &[0.0, 1.0, 0.0]),
    ];
    static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
    let first = [[1, 1, 3, 3, 2, 3], [3, 3, 1, 1, 0, 1], [1, 1, 3, 3, 3, 3], [3, 3, 3, 3, 1, 1]];
    let second = [[0, 0, 3, 3, 2, 3], [3, 3, 0, 0, 1, 0], [0, 0, 3, 3, 3, 3], [3, 3, 3, 3, 0, 0]];
    Benchmark {
        name: "T2",
        model: &MODEL,
        candidates: [first.map(|path| policy(&path)), second.map(|path| policy(&path))],
        evidence: [Evidence::Outcome(8), Evidence::Outcome(36), Evidence::Outcome(0)],
    }
}

fn policy(actions: &[Action]) -> Policy {
    Policy::new(actions).unwrap_or(Policy::EMPTY)
}

/// The next cell per move, up, down, left or right, and cell; the border stops a robot.
const fn moves() -> [u16; 4 * CELLS] {
    let mut table = [0; 4 * CELLS];
    let mut cell = 0;
    while cell < CELLS {
        let (row, column) = (cell / 7, cell % 7);
        let there = [
            if row > 0 { cell - 7 } else { cell },
            if row < 6 { cell + 7 } else { cell },
            if column > 0 { cell - 1 } else { cell },
            if column < 6 { cell + 1 } else { cell },
        ];
        let mut step = 0;
        while step < 4 {
            table[step * CELLS + cell] = there[step] as u16;
            step += 1;
        }
        cell += 1;
    }
    table
}
