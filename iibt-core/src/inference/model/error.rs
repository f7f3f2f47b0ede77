//! What does not fit together in a model.

use super::{MAX_FACTORS, MAX_MODALITIES};

/// What does not fit together in a model.
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
