//! A modality, through which hidden factors are observed.

use super::error::ModelError;
use super::factor::Factor;
use super::groups::contains;
use crate::inference::evidence::Evidence;
use crate::inference::likelihood::Likelihood;
use crate::inference::shape::{MAX_CONDITIONS, Shape};

/// A modality: its likelihood A, the factors that it depends on, and the preference C over its
/// outcomes.
///
/// ```
/// use iibt_core::inference::{IdentityNoise, Modality};
///
/// static THERMOMETER: IdentityNoise = IdentityNoise::new(0.8, 3);
/// // It reads factor 0, and the middle reading is preferred: P(o) = softmax(C).
/// static READING: Modality =
///     Modality::new(&THERMOMETER, THERMOMETER.shape(), &[0], &[0.0, 2.0, 0.0]);
/// assert_eq!(READING.shape().values(), 3);
/// assert_eq!(READING.factors(), [0]);
/// assert_eq!(READING.preference(), [0.0, 2.0, 0.0]);
///
/// // A preference too few, of a table that is only known at run time.
/// assert!(Modality::try_new(&THERMOMETER, THERMOMETER.shape(), &[0], &[0.0, 2.0]).is_none());
/// ```
#[doc(alias = "observation")]
#[doc(alias = "sensor")]
#[derive(Clone, Copy)]
pub struct Modality<'a> {
    likelihood: &'a dyn Likelihood,
    shape: Shape,
    pub(super) factors: &'a [usize],
    preference: &'a [f32],
}

impl<'a> Modality<'a> {
    /// A modality that depends on `factors`, one for each condition of `shape`, which is the
    /// likelihood's. `preference` is C on a log scale: P(o) = softmax(C).
    ///
    /// # Panics
    /// When the numbers of factors or preferences do not fit the shape, or a preference is not
    /// finite; in a `const` or `static` this fails the build.
    #[must_use]
    pub const fn new(
        likelihood: &'a dyn Likelihood,
        shape: Shape,
        factors: &'a [usize],
        preference: &'a [f32],
    ) -> Self {
        assert!(factors.len() == shape.conditions(), "A, the likelihood, needs a factor for each condition");
        assert!(preference.len() == shape.values(), "C, the preference, does not have an entry per outcome");
        assert!(all_finite(preference), "C, the preference, has a value that is not finite");
        Self { likelihood, shape, factors, preference }
    }

    /// Builds a modality from numbers that are only known at run time; `None` when they do not fit.
    #[must_use]
    pub const fn try_new(
        likelihood: &'a dyn Likelihood,
        shape: Shape,
        factors: &'a [usize],
        preference: &'a [f32],
    ) -> Option<Self> {
        let fits = factors.len() == shape.conditions() && preference.len() == shape.values();
        if fits && all_finite(preference) {
            Some(Self { likelihood, shape, factors, preference })
        } else {
            None
        }
    }

    /// A: the likelihood of the outcomes given the states.
    #[must_use]
    pub const fn likelihood(&self) -> &'a dyn Likelihood {
        self.likelihood
    }

    /// Outcomes and states.
    #[must_use]
    pub const fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The factors that it depends on.
    #[must_use]
    pub const fn factors(&self) -> &'a [usize] {
        self.factors
    }

    /// P(e | s) for the states that all factors of the model have now.
    pub(in crate::inference) fn probability(&self, evidence: Evidence, now: &[usize]) -> f32 {
        let mut states = [0; MAX_CONDITIONS];
        for (state, &factor) in states.iter_mut().zip(self.factors) {
            *state = now.get(factor).copied().unwrap_or(0);
        }
        let states = states.get(..self.factors.len()).unwrap_or(&[]);
        evidence.probability(self.shape.values(), |outcome| self.likelihood.probability(outcome, states))
    }

    /// The initial C.
    #[must_use]
    pub const fn preference(&self) -> &'a [f32] {
        self.preference
    }
}

impl Modality<'_> {
    pub(super) const fn check(&self, number: usize, factors: &[Factor]) -> Result<(), ModelError> {
        let mut condition = 0;
        while condition < self.factors.len() {
            let factor = self.factors[condition];
            let (before, _) = self.factors.split_at(condition);
            if factor >= factors.len() || contains(before, factor) {
                return Err(ModelError::Dependency(number));
            }
            if factors[factor].states() != self.shape.states(condition) {
                return Err(ModelError::Likelihood(number));
            }
            condition += 1;
        }
        Ok(())
    }
}

const fn all_finite(values: &[f32]) -> bool {
    let mut at = 0;
    while at < values.len() {
        if !values[at].is_finite() {
            return false;
        }
        at += 1;
    }
    true
}
