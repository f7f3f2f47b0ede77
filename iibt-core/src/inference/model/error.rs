//! What does not fit together in a model.

use super::{MAX_FACTORS, MAX_MODALITIES};

/// What does not fit together in a model.
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ModelError {
    /// This many factors: none, or more than [`MAX_FACTORS`], or more than 65,535 states in all.
    Factors(usize),
    /// This many modalities: none, or more than [`MAX_MODALITIES`].
    Modalities(usize),
    /// This modality names a factor that does not exist, or one twice.
    Dependency(usize),
    /// This modality's likelihood has another number of states than a factor that it depends on.
    Likelihood(usize),
    /// This factor's transition is coupled to a factor that does not exist, or does not have the states of those it
    /// is coupled to.
    Transition(usize),
}

impl core::fmt::Display for ModelError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Factors(count) => {
                write!(f, "{count} factors: a model has 1 to {MAX_FACTORS}, of 65,535 states in all")
            }
            Self::Modalities(count) => write!(f, "{count} modalities: a model has 1 to {MAX_MODALITIES}"),
            Self::Dependency(modality) => {
                write!(f, "modality {modality} depends on a factor that does not exist, or on one twice")
            }
            Self::Likelihood(modality) => {
                write!(f, "A[{modality}], the likelihood, does not have the states of its factors")
            }
            Self::Transition(factor) => {
                write!(f, "B[{factor}], the transition, does not have the states of its factors")
            }
        }
    }
}

impl core::error::Error for ModelError {}
