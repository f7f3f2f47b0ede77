//! T2: two robots on the paper's 7 by 7 grid, four paths of six steps each.

use super::Benchmark;
use iibt_core::inference::{
    Candidates, Evidence, Factor, IdentityNoise, Modality, Model, NextState, OutcomeTable, Policy,
};

/// Cells.
pub const S: usize = 49;

const SIDE: usize = 7;

/// The cells that the robots are to stand on, a different one each.
const GOALS: [usize; 2] = [24, 26];

/// Up, down, left and right; a robot at the edge stays.
const fn next() -> [u16; 4 * S] {
    let mut next = [0; 4 * S];
    let mut cell = 0;
    while cell < S {
        let (row, column) = (cell / SIDE, cell % SIDE);
        next[cell] = if row > 0 { cell - SIDE } else { cell } as u16;
        next[S + cell] = if row + 1 < SIDE { cell + SIDE } else { cell } as u16;
        next[2 * S + cell] = if column > 0 { cell - 1 } else { cell } as u16;
        next[3 * S + cell] = if column + 1 < SIDE { cell + 1 } else { cell } as u16;
        cell += 1;
    }
    next
}

const fn preference() -> [f32; S] {
    let mut preference = [0.0; S];
    preference[GOALS[0]] = 1.0;
    preference[GOALS[1]] = 1.0;
    preference
}

const fn labels() -> [u8; S] {
    let mut labels = [0; S];
    labels[GOALS[0]] = 1;
    labels[GOALS[1]] = 2;
    labels
}

static NEXT: [u16; 4 * S] = next();
static MOTION: NextState = NextState::new(&NEXT, S);
static SENSORS: [IdentityNoise; 2] = [IdentityNoise::new(0.9952, S), IdentityNoise::new(0.904, S)];
static RESULT: OutcomeTable = OutcomeTable::new(&[&LABELS, &LABELS], &KINDS, &COLUMNS, 3);
static LABELS: [u8; S] = labels();
/// No robot on a goal; one, or both on the same: failure; on different ones: success.
static KINDS: [u8; 9] = [0, 2, 2, 2, 2, 1, 2, 1, 2];
/// Nothing, success and failure, each for certain.
static COLUMNS: [f32; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

static PRIOR: [f32; S] = [1.0 / S as f32; S];
static PREFERENCE: [f32; S] = preference();
static FACTORS: [Factor; 2] =
    [Factor::new(&MOTION, MOTION.shape(), &PRIOR), Factor::new(&MOTION, MOTION.shape(), &PRIOR)];
static MODALITIES: [Modality; 3] = [
    Modality::new(&SENSORS[0], SENSORS[0].shape(), &[0], &PREFERENCE),
    Modality::new(&SENSORS[1], SENSORS[1].shape(), &[1], &PREFERENCE),
    Modality::new(&RESULT, RESULT.shape(), &[0, 1], &[0.0, 1.0, 0.0]),
];

/// The model.
pub static MODEL: Model = Model::new(&FACTORS, &MODALITIES);

static FIRST: [Policy; 4] = [
    Policy::of(&[1, 1, 3, 3, 2, 3]),
    Policy::of(&[3, 3, 1, 1, 0, 1]),
    Policy::of(&[1, 1, 3, 3, 3, 3]),
    Policy::of(&[3, 3, 3, 3, 1, 1]),
];
static SECOND: [Policy; 4] = [
    Policy::of(&[0, 0, 3, 3, 2, 3]),
    Policy::of(&[3, 3, 0, 0, 1, 0]),
    Policy::of(&[0, 0, 3, 3, 3, 3]),
    Policy::of(&[3, 3, 3, 3, 0, 0]),
];

/// All pairs of paths, the second robot's running fastest.
pub static CANDIDATES: Candidates = Candidates::all(&[&FIRST, &SECOND]);

/// Both robots where they start, and no result.
pub const OBSERVED: [Evidence; 3] = [Evidence::Outcome(8), Evidence::Outcome(36), Evidence::Outcome(0)];

/// One update and decision.
pub static BENCHMARK: Benchmark<S> =
    Benchmark { name: "T2", model: &MODEL, candidates: &CANDIDATES, observed: OBSERVED };
