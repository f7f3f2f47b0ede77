//! Discrete active inference: beliefs, free energies and the choice of a policy.
//!
//! | symbol | here | shape |
//! |---|---|---|
//! | A = P(o \| s) | a [`Likelihood`], such as [`DenseLikelihood`] | outcomes x states |
//! | B = P(s' \| s, u) | a [`Transition`], such as [`NextState`] | states x states per action |
//! | C, ln P(o) up to a constant | a slice in each [`Modality`], or a [`Preference`] | outcomes |
//! | D = P(s) at the start | a slice in each [`Factor`] | states |
//! | E = P(π) | [`Habits`] | policies |
//! | q(s) | [`Beliefs`] | states |
//! | G | [`Terms`] | by policy |
//! | G in ticks, of a team's list | [`PolicyCost`], weighed by [`WeighedPolicies`] | by policy |
//! | P(h) of what stays unknown | [`Worlds`] | worlds |
//! | G in ticks where something may be seen | [`Outlook`], as an [`ExpectedTime`] | by policy |
//! | γ | [`Scoring::precision`], updated by a [`Precision`] | |
//! | a, counts of A | [`LikelihoodCounts`], itself a [`Likelihood`] | outcomes x states |
//! | b, counts of B | [`TransitionCounts`], itself a [`Transition`] | states x states per action |
//! | c, counts of C | [`PreferenceCounts`] | outcomes |
//! | d, e, counts of D, E | [`DistributionCounts`] | states; policies |
//!
//! [`LikelihoodCounts`]: learning::LikelihoodCounts
//! [`TransitionCounts`]: learning::TransitionCounts
//! [`PreferenceCounts`]: learning::PreferenceCounts
//! [`DistributionCounts`]: learning::DistributionCounts
//!
//! A [`Model`] never changes after it is built; beliefs, preferences and counts are state. Data
//! flows model → beliefs → problem → evaluation → choice, and the room knows neither trees nor
//! robots.

mod agent;
mod belief;
mod candidates;
mod costs;
mod error;
mod estimation;
mod evaluation;
mod evidence;
pub mod explanation;
mod free_energy;
mod gain;
pub mod learning;
pub mod likelihood;
mod model;
mod outlook;
pub mod policy;
mod precision;
mod preference;
mod problem;
mod shape;
mod table;
pub mod transition;
mod worlds;

pub use agent::{Agent, Decision, Room};
pub use belief::Beliefs;
pub use candidates::{Candidates, Combinations, Habits};
pub use costs::{
    CostExplanation, CostTerm, Eighths, PolicyCost, PrivateCost, RankedPolicy, WeighedPolicies, cheapest,
    expected_time, worth_of_nats,
};
pub use error::{Argument, DecisionError, Impossible, ObservationError, OutOfRange};
pub use estimation::{EXACT_LIMIT, MAX_SWEEPS, Update};
pub use evaluation::Evaluation;
pub use evidence::Evidence;
pub use free_energy::{Gain, PreferenceTiming, Scoring, Terms};
pub use likelihood::{DenseLikelihood, IdentityNoise, Likelihood, OutcomeTable, TableError};
pub use model::{Control, Factor, MAX_FACTORS, MAX_MODALITIES, Modality, Model, ModelError};
pub use outlook::{ExpectedTime, Outlook};
pub use policy::{Choice, Policy};
pub use precision::Precision;
pub use preference::Preference;
pub use problem::{PairPreference, Problem};
pub use shape::{MAX_CONDITIONS, Shape};
pub use transition::{Blocks, DenseTransition, NextState, Transition};
pub use worlds::Worlds;
