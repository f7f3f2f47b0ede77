//! The evidence of one modality.

use super::error::{Argument, OutOfRange, below, exactly};

/// One modality's observation.
///
/// ```
/// use iibt_core::inference::Evidence;
///
/// // A modality with three outcomes.
/// assert!(Evidence::Outcome(2).check(0, 3).is_ok());
/// let error = Evidence::Outcome(3).check(0, 3).unwrap_err();
/// assert_eq!(error.to_string(), "modality 0 has no outcome 3: there are 3, from 0");
/// let error = Evidence::Soft(&[0.2, 0.8]).check(4, 3).unwrap_err();
/// assert_eq!(error.to_string(), "modality 4 has 3 outcomes, but 2 weights are given");
/// assert!(Evidence::default().is_missing());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Evidence<'a> {
    /// No observation of this modality.
    #[default]
    Missing,
    /// This outcome was observed.
    Outcome(usize),
    /// The reading itself is uncertain: a weight for each outcome, finite and not negative.
    ///
    /// The states are weighed with Σ_o w(o) A(o, ·), Pearl's virtual evidence.
    Soft(&'a [f32]),
}

/// A weight as it counts.
#[inline]
pub(super) fn sound(weight: f32) -> f32 {
    if weight.is_finite() { weight.max(0.0) } else { 0.0 }
}

impl Evidence<'_> {
    /// Whether anything was observed.
    #[must_use]
    pub const fn is_missing(&self) -> bool {
        matches!(self, Self::Missing)
    }

    /// The likelihood of the observation, from the probability of each outcome: P(e | s).
    #[inline]
    pub(super) fn probability(&self, outcomes: usize, probability: impl Fn(usize) -> f32) -> f32 {
        match self {
            Self::Missing => 1.0,
            Self::Outcome(outcome) if *outcome < outcomes => probability(*outcome),
            Self::Outcome(_) => 0.0,
            Self::Soft(weights) => {
                let weighed = |(outcome, weight): (usize, &f32)| sound(*weight) * probability(outcome);
                weights.iter().take(outcomes).enumerate().map(weighed).sum()
            }
        }
    }

    /// Whether it is an observation through modality `number`, which has `outcomes` outcomes.
    ///
    /// # Errors
    /// [`OutOfRange`] for an outcome that does not exist, and for weights that are not one for each
    /// outcome, negative or not finite.
    pub fn check(&self, number: usize, outcomes: usize) -> Result<(), OutOfRange> {
        match self {
            Self::Missing => Ok(()),
            Self::Outcome(outcome) => below(Argument::Outcome, number, *outcome, outcomes),
            Self::Soft(weights) => {
                exactly(Argument::Weights, number, weights.len(), outcomes)?;
                let wrong = weights.iter().position(|weight| !(weight.is_finite() && *weight >= 0.0));
                wrong.map_or(Ok(()), |at| Err(OutOfRange::new(Argument::Weight, number, at, outcomes)))
            }
        }
    }
}
