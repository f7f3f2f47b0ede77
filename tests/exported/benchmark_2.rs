//! The model "benchmark-2", written by `host-sim export`.
//!
//! - factor 0: 49 states, 4 actions, next state
//! - factor 1: 49 states, 4 actions, next state
//! - modality 0: 49 outcomes of factor 0, identity with noise
//! - modality 1: 49 outcomes of factor 1, identity with noise
//! - modality 2: 3 outcomes of factor 0 and 1, outcome table
//!
//! The numbers of A, B, C and D take 1779 bytes, as full tables 1047632; 16 policies take 264. `Beliefs` takes 392 bytes of
//! RAM and `Evaluation` about 2696.

use iibt_core::inference::{
    Candidates, Combinations, Factor, Habits, IdentityNoise, Modality, Model, NextState,
    OutcomeTable, Policy, Problem, Scoring,
};

#[rustfmt::skip]
static B_0_NEXT: [u16; 196] = [
    0, 1, 2, 3, 4, 5, 6, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20,
    21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 7, 8, 9, 10,
    11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34,
    35, 36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47, 48, 42, 43, 44, 45, 46, 47, 48, 0, 0, 1, 2,
    3, 4, 5, 7, 7, 8, 9, 10, 11, 12, 14, 14, 15, 16, 17, 18, 19, 21, 21, 22, 23, 24, 25, 26, 28, 28,
    29, 30, 31, 32, 33, 35, 35, 36, 37, 38, 39, 40, 42, 42, 43, 44, 45, 46, 47, 1, 2, 3, 4, 5, 6, 6,
    8, 9, 10, 11, 12, 13, 13, 15, 16, 17, 18, 19, 20, 20, 22, 23, 24, 25, 26, 27, 27, 29, 30, 31,
    32, 33, 34, 34, 36, 37, 38, 39, 40, 41, 41, 43, 44, 45, 46, 47, 48, 48,
];
static B_0: NextState = NextState::new(&B_0_NEXT, 49);

#[rustfmt::skip]
static B_1_NEXT: [u16; 196] = [
    0, 1, 2, 3, 4, 5, 6, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20,
    21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 7, 8, 9, 10,
    11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34,
    35, 36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47, 48, 42, 43, 44, 45, 46, 47, 48, 0, 0, 1, 2,
    3, 4, 5, 7, 7, 8, 9, 10, 11, 12, 14, 14, 15, 16, 17, 18, 19, 21, 21, 22, 23, 24, 25, 26, 28, 28,
    29, 30, 31, 32, 33, 35, 35, 36, 37, 38, 39, 40, 42, 42, 43, 44, 45, 46, 47, 1, 2, 3, 4, 5, 6, 6,
    8, 9, 10, 11, 12, 13, 13, 15, 16, 17, 18, 19, 20, 20, 22, 23, 24, 25, 26, 27, 27, 29, 30, 31,
    32, 33, 34, 34, 36, 37, 38, 39, 40, 41, 41, 43, 44, 45, 46, 47, 48, 48,
];
static B_1: NextState = NextState::new(&B_1_NEXT, 49);

static A_0: IdentityNoise = IdentityNoise::new(0.9952, 49);

static A_1: IdentityNoise = IdentityNoise::new(0.904, 49);

#[rustfmt::skip]
static A_2_LABELS_0: [u8; 49] = [
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 2, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
];
#[rustfmt::skip]
static A_2_LABELS_1: [u8; 49] = [
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 2, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
];
static A_2_KINDS: [u8; 9] = [0, 1, 1, 1, 1, 2, 1, 2, 1];
static A_2_COLUMNS: [f32; 9] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0];
static A_2: OutcomeTable = OutcomeTable::new(
    &[&A_2_LABELS_0, &A_2_LABELS_1],
    &A_2_KINDS,
    &A_2_COLUMNS,
    3,
);

#[rustfmt::skip]
static D_0: [f32; 49] = [
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
];
#[rustfmt::skip]
static D_1: [f32; 49] = [
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
    0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163, 0.020408163,
];

/// The hidden factors: B and D.
pub static FACTORS: [Factor; 2] = [
    Factor::new(&B_0, B_0.shape(), &D_0),
    Factor::new(&B_1, B_1.shape(), &D_1),
];

#[rustfmt::skip]
static C_0: [f32; 49] = [
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
];
#[rustfmt::skip]
static C_1: [f32; 49] = [
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
];
static C_2: [f32; 3] = [0.0, 1.0, 0.0];

/// The modalities: A and C.
pub static MODALITIES: [Modality; 3] = [
    Modality::new(&A_0, A_0.shape(), &[0], &C_0),
    Modality::new(&A_1, A_1.shape(), &[1], &C_1),
    Modality::new(&A_2, A_2.shape(), &[0, 1], &C_2),
];

/// The generative model.
pub static MODEL: Model = Model::new(&FACTORS, &MODALITIES);

/// An action sequence.
const fn sequence(actions: &[u8]) -> Policy {
    let mut sequence = Policy::EMPTY;
    let mut step = 0;
    while step < actions.len() {
        assert!(sequence.push(actions[step]).is_ok(), "a sequence is too long");
        step += 1;
    }
    sequence
}

static SEQUENCES_0: [Policy; 4] = [
    sequence(&[1, 1, 3, 3, 2, 3]),
    sequence(&[3, 3, 1, 1, 0, 1]),
    sequence(&[1, 1, 3, 3, 3, 3]),
    sequence(&[3, 3, 3, 3, 1, 1]),
];
static SEQUENCES_1: [Policy; 4] = [
    sequence(&[0, 0, 3, 3, 2, 3]),
    sequence(&[3, 3, 0, 0, 1, 0]),
    sequence(&[0, 0, 3, 3, 3, 3]),
    sequence(&[3, 3, 3, 3, 0, 0]),
];

/// The policies to choose from, in the order of the notebook.
pub static CANDIDATES: Candidates = Candidates {
    sequences: &[&SEQUENCES_0, &SEQUENCES_1],
    combinations: Combinations::All,
    habits: Habits::Flat,
};

/// How policies are scored: every preference at every step, per-modality information gain.
pub const SCORING: Scoring = Scoring { precision: 16.0, ..Scoring::JAX_PYMDP };

/// How many steps are looked at.
pub const HORIZON: usize = 6;

/// Beliefs of the model's size.
pub type Beliefs = iibt_core::inference::Beliefs<49, 2>;

/// An evaluation that holds all policies.
pub type Evaluation = iibt_core::inference::Evaluation<49, 2, 4, 4>;

/// The decision to be made under these beliefs.
#[must_use]
pub fn problem(beliefs: &Beliefs) -> Problem<'_, 49, 2> {
    let problem = Problem::new(&MODEL, beliefs, CANDIDATES, SCORING);
    Problem { horizon: HORIZON, ..problem }
}
