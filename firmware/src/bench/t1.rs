//! T1: two robots among four places, sixteen joint policies of one step.

use super::Benchmark;
use iibt_core::inference::{
    Candidates, Evidence, Factor, IdentityNoise, Modality, Model, NextState, OutcomeTable, Policy,
};

/// Places.
pub const S: usize = 4;

#[rustfmt::skip]
static NEXT: [u16; 4 * S] = [
    0, 0, 0, 0,
    1, 1, 1, 1,
    2, 2, 2, 2,
    3, 3, 3, 3,
];
static MOTION: NextState = NextState::with_slip(&NEXT, S, 0.1);
static SENSOR: IdentityNoise = IdentityNoise::new(0.9, S);
static RESULT: OutcomeTable = OutcomeTable::new(&LABELS, &KINDS, &COLUMNS, 3);
static LABELS: [&[u8]; 2] = [&[0, 1, 2, 3]; 2];
#[rustfmt::skip]
static KINDS: [u8; S * S] = [
    0, 0, 0, 0,
    0, 2, 1, 0,
    0, 1, 2, 0,
    0, 0, 0, 2,
];
/// Nothing, success, failure: mostly nothing, mostly success, mostly failure.
#[rustfmt::skip]
static COLUMNS: [f32; 9] = [
    0.96, 0.02, 0.02,
    0.03, 0.95, 0.02,
    0.08, 0.02, 0.90,
];

static FACTORS: [Factor; 2] = [
    Factor::new(&MOTION, MOTION.shape(), &[0.7, 0.1, 0.1, 0.1]),
    Factor::new(&MOTION, MOTION.shape(), &[0.4, 0.2, 0.2, 0.2]),
];
static MODALITIES: [Modality; 3] = [
    Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 0.5, 0.25, 0.0]),
    Modality::new(&SENSOR, SENSOR.shape(), &[1], &[0.0, 0.25, 0.5, 0.0]),
    Modality::new(&RESULT, RESULT.shape(), &[0, 1], &[0.0, 2.0, -2.0]),
];

/// The model.
pub static MODEL: Model = Model::new(&FACTORS, &MODALITIES);

static MOVES: [Policy; 4] = [Policy::of(&[0]), Policy::of(&[1]), Policy::of(&[2]), Policy::of(&[3])];

/// All pairs of moves, the second robot's running fastest.
pub static CANDIDATES: Candidates = Candidates::all(&[&MOVES, &MOVES]);

/// Both robots' readings, and no result.
pub const OBSERVED: [Evidence; 3] = [Evidence::Outcome(1), Evidence::Outcome(0), Evidence::Outcome(0)];

/// One update and decision.
pub static BENCHMARK: Benchmark<S> =
    Benchmark { name: "T1", model: &MODEL, candidates: &CANDIDATES, observed: OBSERVED };
