//! Expected free energy, in named terms, and the conventions by which it is scored.

use crate::math::Prediction;

/// The terms of a policy's expected free energy, in nats, summed over modalities and steps.
///
/// Without novelty, G = risk + ambiguity = -(utility + information gain), because the entropy of
/// the predicted outcomes is information gain plus ambiguity.
///
/// ```
/// use iibt_core::inference::Terms;
///
/// let terms = Terms { utility: -0.5, information_gain: 0.3, ambiguity: 0.2, novelty: 0.0 };
/// assert!((terms.entropy() - 0.5).abs() < 1e-6);
/// assert!(terms.risk().abs() < 1e-6); // the predicted outcomes are the preferred ones
/// assert!((terms.expected_free_energy() - (terms.risk() + terms.ambiguity)).abs() < 1e-6);
/// assert_eq!((terms + terms).utility, -1.0);
/// ```
#[doc(alias = "expected free energy")]
#[doc(alias = "epistemic value")]
#[doc(alias = "pragmatic value")]
#[doc(alias = "ambiguity")]
#[doc(alias = "risk")]
#[doc(alias = "information gain")]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Terms {
    /// E_q(o) ln P(o): the expected preference for the predicted outcomes.
    pub utility: f32,
    /// I(o; s) = H[q(o)] - ambiguity: the information that the outcomes give about the states.
    pub information_gain: f32,
    /// Σ_s q(s) H[P(o | s)]: the expected noise of the outcomes given the states.
    pub ambiguity: f32,
    /// The information that outcomes and moves give about the model's own tables, while those are
    /// learned.
    pub novelty: f32,
}

impl Terms {
    /// All terms zero.
    pub const ZERO: Self = Self { utility: 0.0, information_gain: 0.0, ambiguity: 0.0, novelty: 0.0 };

    /// The terms of one modality at one step, from its predicted outcomes and its ambiguity.
    #[inline]
    #[must_use]
    pub const fn of(prediction: &Prediction, ambiguity: f32) -> Self {
        Self {
            utility: prediction.utility(),
            information_gain: prediction.entropy() - ambiguity,
            ambiguity,
            novelty: 0.0,
        }
    }

    /// H[q(o)], the entropy of the predicted outcomes.
    #[must_use]
    pub const fn entropy(&self) -> f32 {
        self.information_gain + self.ambiguity
    }

    /// KL[q(o) || P(o)]: the divergence of the predicted outcomes from the preferred ones.
    #[must_use]
    pub fn risk(&self) -> f32 {
        -self.utility - self.information_gain - self.ambiguity
    }

    /// G = risk + ambiguity - novelty, the expected free energy; lower is better.
    #[must_use]
    pub const fn expected_free_energy(&self) -> f32 {
        -self.utility - self.information_gain - self.novelty
    }
}

impl core::ops::Add for Terms {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl core::ops::AddAssign for Terms {
    fn add_assign(&mut self, other: Self) {
        self.utility += other.utility;
        self.information_gain += other.information_gain;
        self.ambiguity += other.ambiguity;
        self.novelty += other.novelty;
    }
}

/// The combination of the information gains of several modalities.
///
/// ```
/// use iibt_core::inference::{Gain, Scoring};
///
/// assert_eq!(Scoring::DEFAULT.gain, Gain::PerModality);
/// assert_eq!(Scoring::NUMPY_PYMDP.gain, Gain::Joint);
/// ```
#[doc(alias = "mutual information")]
#[doc(alias = "epistemic value")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Gain {
    /// The sum of each modality's own gain.
    #[default]
    PerModality,
    /// The mutual information of all states with all outcomes at once.
    Joint,
}

/// The steps of a policy at which preferences count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PreferenceTiming {
    /// A positive preference counts at the last step of a policy, a negative one at every step.
    /// The joint outcome of two robots is judged, and observed, once: when the first of them
    /// arrives.
    #[default]
    OnArrival,
    /// Every preference counts at every step, as published.
    EveryStep,
}

/// The scoring of policies.
///
/// ```
/// use iibt_core::inference::{PreferenceTiming, Scoring};
///
/// // As in JAX pymdp, with a precision of 4, and no policy whose posterior is a thousandth of the
/// // best one's.
/// let scoring = Scoring { precision: 4.0, window: 6.9, ..Scoring::JAX_PYMDP };
/// assert_eq!(scoring.timing, PreferenceTiming::EveryStep);
/// // ln E - F - γ G
/// assert_eq!(scoring.score(-1.0, 0.5, 2.0), -1.0 - 0.5 + 4.0 * 2.0);
/// assert_eq!(scoring.score(f32::NAN, 0.0, 0.0), f32::NEG_INFINITY);
/// ```
#[doc(alias = "gamma")]
#[doc(alias = "Occam window")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Scoring {
    /// γ, the precision of the policy posterior: it scales all of G.
    pub precision: f32,
    /// Joint or per-modality information gain.
    pub gain: Gain,
    /// The steps at which preferences count.
    pub timing: PreferenceTiming,
    /// Occam's window, in nats: policies whose log posterior is more than this below the best are
    /// pruned. Infinity keeps them all.
    pub window: f32,
}

impl Scoring {
    /// The default: arrived robots stay, goals count on arrival, and standard G with per-modality
    /// gain.
    pub const DEFAULT: Self = Self {
        precision: 16.0,
        gain: Gain::PerModality,
        timing: PreferenceTiming::OnArrival,
        window: f32::INFINITY,
    };

    /// The field's usual scoring: every preference counts at every step, and the gain is the sum of
    /// each modality's own, as in JAX pymdp, cpp-AIF and tira.
    pub const JAX_PYMDP: Self = Self { timing: PreferenceTiming::EveryStep, ..Self::DEFAULT };

    /// As [`JAX_PYMDP`](Self::JAX_PYMDP) with the joint gain, as in numpy pymdp, SPM and
    /// ActiveInference.jl.
    pub const NUMPY_PYMDP: Self = Self { gain: Gain::Joint, ..Self::JAX_PYMDP };

    /// ln E - F - γ G, the log of the policy posterior up to a constant (equation 7), from -G;
    /// minus infinity, so that the policy is never chosen, where it is no number.
    #[must_use]
    pub fn score(&self, ln_prior: f32, free_energy: f32, value: f32) -> f32 {
        (ln_prior - free_energy + self.precision * value).max(f32::NEG_INFINITY)
    }
}

impl Default for Scoring {
    fn default() -> Self {
        Self::DEFAULT
    }
}
