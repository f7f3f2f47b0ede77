//! The model "switch", written by `host-sim export`.
//!
//! - factor 0: 3 states, 3 actions, dense
//! - factor 1: 2 states, 1 actions, dense
//! - modality 0: 3 outcomes of factor 0, identity with noise
//! - modality 1: 2 outcomes of factor 0 and 1, outcome table
//!
//! The numbers of A, B, C and D take 261 bytes, as full tables 316; 9 policies take 297.
//! `Agent` takes about 789 bytes of RAM.

use iibt_core::inference::{
    Candidates, Control, DenseTransition, Factor, Habits, IdentityNoise, Modality, Model,
    OutcomeTable, Policy, Scoring,
};

#[rustfmt::skip]
static B_0_TABLE: [f32; 27] = [
    1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.2,
    0.0, 0.0, 0.8, 0.2, 0.0, 0.0, 0.8, 1.0,
];
static B_0: DenseTransition = DenseTransition::new(&B_0_TABLE, 3, &[3]);

static B_1_TABLE: [f32; 12] = [0.9, 0.9, 0.5, 0.1, 0.1, 0.5, 0.1, 0.1, 0.5, 0.9, 0.9, 0.5];
static B_1: DenseTransition = DenseTransition::new(&B_1_TABLE, 1, &[2, 3]);

static A_0: IdentityNoise = IdentityNoise::new(0.9, 3);

static A_1_LABELS_0: [u8; 3] = [0, 0, 1];
static A_1_LABELS_1: [u8; 2] = [0, 1];
static A_1_KINDS: [u8; 4] = [0, 1, 2, 3];
static A_1_COLUMNS: [f32; 8] = [1.0, 0.0, 0.0, 1.0, 0.8, 0.2, 0.3, 0.7];
static A_1: OutcomeTable = OutcomeTable::new(
    &[&A_1_LABELS_0, &A_1_LABELS_1],
    &A_1_KINDS,
    &A_1_COLUMNS,
    2,
);

static D_0: [f32; 3] = [1.0, 0.0, 0.0];
static D_1: [f32; 2] = [0.5, 0.5];

/// The hidden factors: B and D.
pub static FACTORS: [Factor; 2] = [
    Factor::new(&B_0, B_0.shape(), &D_0),
    Factor::new(&B_1, B_1.shape(), &D_1).coupled_to(&[0]).controlled_by(Control::None),
];

static C_0: [f32; 3] = [0.0, 0.0, 0.0];
static C_1: [f32; 2] = [0.0, 2.0];

/// The modalities: A and C.
pub static MODALITIES: [Modality; 2] = [
    Modality::new(&A_0, A_0.shape(), &[0], &C_0),
    Modality::new(&A_1, A_1.shape(), &[0, 1], &C_1),
];

/// The generative model.
pub static MODEL: Model = Model::new(&FACTORS, &MODALITIES);

static SEQUENCES_0: [Policy; 9] = [
    Policy::of(&[0, 0]),
    Policy::of(&[0, 1]),
    Policy::of(&[0, 2]),
    Policy::of(&[1, 0]),
    Policy::of(&[1, 1]),
    Policy::of(&[1, 2]),
    Policy::of(&[2, 0]),
    Policy::of(&[2, 1]),
    Policy::of(&[2, 2]),
];
#[rustfmt::skip]
static LN_E: [f32; 9] = [
    -1.3862944, -1.3862944, -1.3862944, -2.0794415, -2.0794415, f32::NEG_INFINITY,
    f32::NEG_INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY,
];

/// The policies to choose from, in the order of the notebook.
pub static CANDIDATES: Candidates = Candidates::all(&[&SEQUENCES_0]).with_habits(Habits::Joint(&LN_E));

/// How policies are scored: every preference at every step, per-modality information gain.
pub const SCORING: Scoring = Scoring { precision: 4.0, ..Scoring::JAX_PYMDP };

/// An agent with room for all policies.
pub type Agent = iibt_core::Agent![MODEL, for CANDIDATES];

/// An agent that has observed nothing yet.
pub const AGENT: Agent = Agent::new(&MODEL).with_scoring(SCORING);
