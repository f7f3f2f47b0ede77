//! Discrete active inference: beliefs, free energies and the choice of a policy.
//!
//! | symbol | here | shape |
//! |---|---|---|
//! | A = P(o \| s) | [`Likelihood`]: [`Dense`](likelihood::Dense), [`IdentityNoise`], [`OutcomeTable`] | outcomes x states |
//! | B = P(s' \| s, u) | [`Transition`]: [`Dense`](transition::Dense), [`NextState`] | states x states per action |
//! | C, ln P(o) up to a constant | [`Preference`] | outcomes |
//! | D = P(s) at the start | [`Model::prior`] | states |
//! | E = P(π) | the `ln_prior` of each candidate | policies |
//! | q(s) | [`Belief`] | states |
//! | G | [`Terms`] | by policy |
//! | γ | [`Scoring::precision`] | |
//!
//! A [`Model`] never changes after it is built; beliefs and preferences are state. Data flows
//! model → belief → free energy → posterior → choice, and the room knows neither trees nor robots.

pub mod belief;
pub mod free_energy;
pub mod joint;
pub mod likelihood;
pub mod model;
pub mod policy;
pub mod preference;
pub mod published;
pub mod transition;

pub use belief::{Belief, Impossible};
pub use free_energy::{Convention, Credit, Gain, Padding, Scoring, Terms};
pub use joint::{Interaction, Side, Workspace};
pub use likelihood::{IdentityNoise, Likelihood, OutcomeTable};
pub use model::Model;
pub use policy::{Choice, Policy, Star};
pub use preference::Preference;
pub use transition::{NextState, Transition};
