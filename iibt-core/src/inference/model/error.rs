//! The error of a model whose parts do not fit together.

use super::{MAX_FACTORS, MAX_MODALITIES};
use thiserror::Error;

/// The error of a model whose parts do not fit together.
///
/// ```
/// use iibt_core::inference::{Factor, IdentityNoise, Modality, Model, ModelError, NextState};
///
/// let (moves, sensor) = (NextState::new(&[0, 1], 2), IdentityNoise::new(0.9, 2));
/// let factors = [Factor::new(&moves, moves.shape(), &[0.5, 0.5])];
/// let of_another = [Modality::new(&sensor, sensor.shape(), &[1], &[0.0, 0.0])];
/// let error = Model::try_new(&factors, &of_another).unwrap_err();
/// assert_eq!(error, ModelError::Dependency(0));
/// let message = "modality 0 depends on a factor that does not exist, or on one twice";
/// assert_eq!(error.to_string(), message);
/// assert_eq!(Model::try_new(&[], &of_another).unwrap_err(), ModelError::Factors(0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ModelError {
    /// This many factors: none, or more than [`MAX_FACTORS`], or more than 65,535 states in all.
    #[error("{0} factors: a model has 1 to {MAX_FACTORS}, of 65,535 states in all")]
    Factors(usize),
    /// This many modalities: none, or more than [`MAX_MODALITIES`].
    #[error("{0} modalities: a model has 1 to {MAX_MODALITIES}")]
    Modalities(usize),
    /// This modality names a factor that does not exist, or one twice.
    #[error("modality {0} depends on a factor that does not exist, or on one twice")]
    Dependency(usize),
    /// This modality's likelihood has another number of states than a factor that it depends on.
    #[error("A[{0}], the likelihood, does not have the states of its factors")]
    Likelihood(usize),
    /// This factor's transition is coupled to a factor that does not exist, or does not have the
    /// states of those it is coupled to.
    #[error("B[{0}], the transition, does not have the states of its factors")]
    Transition(usize),
}
