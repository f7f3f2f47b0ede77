//! The model "benchmark-1", written by `host-sim export`.
//!
//! - factor 0: 4 states, 4 actions, next state with slip
//! - factor 1: 4 states, 4 actions, next state with slip
//! - modality 0: 4 outcomes of factor 0, identity with noise
//! - modality 1: 4 outcomes of factor 1, identity with noise
//! - modality 2: 3 outcomes of factor 0 and 1, outcome table
//!
//! The numbers of A, B, C and D take 256 bytes, as full tables 1292; 16 policies take 264.
//! `Agent` takes about 1008 bytes of RAM.

use iibt_core::inference::{
    Candidates, Factor, IdentityNoise, Modality, Model, NextState, OutcomeTable, Policy, Scoring,
};

static B_0_NEXT: [u16; 16] = [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3];
static B_0: NextState = NextState::with_slip(&B_0_NEXT, 4, 0.1);

static B_1_NEXT: [u16; 16] = [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3];
static B_1: NextState = NextState::with_slip(&B_1_NEXT, 4, 0.1);

static A_0: IdentityNoise = IdentityNoise::new(0.9, 4);

static A_1: IdentityNoise = IdentityNoise::new(0.9, 4);

static A_2_LABELS_0: [u8; 4] = [0, 1, 2, 3];
static A_2_LABELS_1: [u8; 4] = [0, 1, 2, 3];
static A_2_KINDS: [u8; 16] = [0, 0, 0, 0, 0, 1, 2, 0, 0, 2, 1, 0, 0, 0, 0, 1];
static A_2_COLUMNS: [f32; 9] = [0.96, 0.02, 0.02, 0.08, 0.02, 0.9, 0.03, 0.95, 0.02];
static A_2: OutcomeTable = OutcomeTable::new(
    &[&A_2_LABELS_0, &A_2_LABELS_1],
    &A_2_KINDS,
    &A_2_COLUMNS,
    3,
);

static D_0: [f32; 4] = [0.7, 0.1, 0.1, 0.1];
static D_1: [f32; 4] = [0.4, 0.2, 0.2, 0.2];

/// The hidden factors: B and D.
pub static FACTORS: [Factor; 2] = [
    Factor::new(&B_0, B_0.shape(), &D_0),
    Factor::new(&B_1, B_1.shape(), &D_1),
];

static C_0: [f32; 4] = [0.0, 0.5, 0.25, 0.0];
static C_1: [f32; 4] = [0.0, 0.25, 0.5, 0.0];
static C_2: [f32; 3] = [0.0, 2.0, -2.0];

/// The modalities: A and C.
pub static MODALITIES: [Modality; 3] = [
    Modality::new(&A_0, A_0.shape(), &[0], &C_0),
    Modality::new(&A_1, A_1.shape(), &[1], &C_1),
    Modality::new(&A_2, A_2.shape(), &[0, 1], &C_2),
];

/// The generative model.
pub static MODEL: Model = Model::new(&FACTORS, &MODALITIES);

static SEQUENCES_0: [Policy; 4] = [
    Policy::of(&[0]),
    Policy::of(&[1]),
    Policy::of(&[2]),
    Policy::of(&[3]),
];
static SEQUENCES_1: [Policy; 4] = [
    Policy::of(&[0]),
    Policy::of(&[1]),
    Policy::of(&[2]),
    Policy::of(&[3]),
];

/// The policies to choose from, in the order of the notebook.
pub static CANDIDATES: Candidates = Candidates::all(&[&SEQUENCES_0, &SEQUENCES_1]);

/// How policies are scored: every preference at every step, per-modality information gain.
pub const SCORING: Scoring = Scoring { precision: 16.0, ..Scoring::JAX_PYMDP };

/// An agent with room for all policies.
pub type Agent = iibt_core::Agent![MODEL, for CANDIDATES];

/// An agent that has observed nothing yet.
pub const AGENT: Agent = Agent::new(&MODEL).with_scoring(SCORING);
