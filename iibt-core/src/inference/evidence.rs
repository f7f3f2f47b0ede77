//! What was observed through one modality.

/// One modality's observation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Evidence<'a> {
    /// Nothing was observed: the modality says nothing about the states.
    #[default]
    Missing,
    /// This outcome was observed.
    Outcome(usize),
    /// The reading itself is uncertain: a weight for each outcome. One that is negative or not finite counts as zero.
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

    /// How well the states explain the observation, from the probability of each outcome: P(e | s).
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

    /// Whether the weights of a soft observation are weights: finite, not negative, not all zero, and no more
    /// than there are outcomes.
    #[must_use]
    pub fn is_sound(&self, outcomes: usize) -> bool {
        match self {
            Self::Missing => true,
            Self::Outcome(outcome) => *outcome < outcomes,
            Self::Soft(weights) => {
                let sound = |weight: &&f32| weight.is_finite() && **weight >= 0.0;
                weights.len() <= outcomes
                    && weights.iter().filter(sound).count() == weights.len()
                    && weights.iter().sum::<f32>() > 0.0
            }
        }
    }
}
