//! Expected free energy, in named terms, and the conventions by which it is scored.

use crate::actions::Action;
use crate::math::Outlook;

/// What a policy is expected to bring, in nats, summed over modalities and steps.
///
/// Without novelty, G = risk + ambiguity = -(utility + information gain), because the entropy of the predicted outcomes is
/// information gain plus ambiguity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Terms {
    /// E_q(o) ln P(o): how much the predicted outcomes are liked.
    pub utility: f32,
    /// I(o; s) = H[q(o)] - ambiguity: how much the outcomes will tell about the states.
    pub information_gain: f32,
    /// Σ_s q(s) H[P(o | s)]: how noisy the outcomes will be even when the state is known.
    pub ambiguity: f32,
    /// How much the outcomes and moves will tell about the model's own tables, while those are being learned.
    pub novelty: f32,
}

impl Terms {
    /// Nothing yet.
    pub const ZERO: Self = Self { utility: 0.0, information_gain: 0.0, ambiguity: 0.0, novelty: 0.0 };

    /// The terms of one modality at one step, from its predicted outcomes and its ambiguity.
    #[inline]
    #[must_use]
    pub const fn of(outlook: &Outlook, ambiguity: f32) -> Self {
        Self {
            utility: outlook.utility(),
            information_gain: outlook.entropy() - ambiguity,
            ambiguity,
            novelty: 0.0,
        }
    }

    /// H[q(o)], the entropy of the predicted outcomes.
    #[must_use]
    pub const fn entropy(&self) -> f32 {
        self.information_gain + self.ambiguity
    }

    /// KL[q(o) || P(o)]: how far the predicted outcomes are from the preferred ones.
    #[must_use]
    pub fn risk(&self) -> f32 {
        -self.utility - self.information_gain - self.ambiguity
    }

    /// G, the expected free energy, under a convention; lower is better.
    #[must_use]
    pub fn expected_free_energy(&self, convention: Convention) -> f32 {
        match convention {
            Convention::Standard => -self.utility - self.information_gain - self.novelty,
            Convention::AsPrinted => self.risk() - self.ambiguity - self.novelty,
        }
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

/// The sign of the ambiguity in G.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Convention {
    /// G = risk + ambiguity, as everywhere in the field.
    #[default]
    Standard,
    /// G = risk - ambiguity, as the paper prints it (equation 6, algorithm 2).
    AsPrinted,
}

/// How the information gain of several modalities is put together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Gain {
    /// The sum of each modality's own gain.
    #[default]
    PerModality,
    /// The mutual information of all states with all outcomes at once.
    Joint,
}

/// When a preference counts along a policy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Credit {
    /// What a robot likes counts at the last step of its policy, what it dislikes at every step. What two
    /// robots bring about together is judged, and observed, once: when the first of them arrives.
    #[default]
    OnArrival,
    /// Every preference counts at every step, as published.
    EveryStep,
}

/// What a robot does after the last action of its policy, while others are still under way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Padding {
    /// It stays.
    #[default]
    Stay,
    /// It goes on with this action.
    Repeat(Action),
}

/// How policies are scored.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Scoring {
    /// γ, the precision of the policy posterior: it scales all of G.
    pub precision: f32,
    /// The sign of the ambiguity.
    pub convention: Convention,
    /// Joint or per-modality information gain.
    pub gain: Gain,
    /// When preferences count.
    pub credit: Credit,
    /// What comes after the last action.
    pub padding: Padding,
    /// Occam's window, in nats: policies whose log posterior is more than this below the best are pruned. Infinity keeps
    /// them all.
    pub window: f32,
}

impl Scoring {
    /// What is right: arrived robots stay, goals count on arrival, standard G with per-modality gain.
    pub const DEFAULT: Self = Self {
        precision: 16.0,
        convention: Convention::Standard,
        gain: Gain::PerModality,
        credit: Credit::OnArrival,
        padding: Padding::Stay,
        window: f32::INFINITY,
    };

    /// The field's: every preference counts at every step, and the gain is the sum of each modality's own, as in JAX
    /// pymdp, cpp-AIF and tira.
    pub const JAX_PYMDP: Self = Self { credit: Credit::EveryStep, ..Self::DEFAULT };

    /// The same with the joint gain, as in numpy pymdp, SPM and ActiveInference.jl.
    pub const NUMPY_PYMDP: Self = Self { gain: Gain::Joint, ..Self::JAX_PYMDP };

    /// The same as [`JAX_PYMDP`](Self::JAX_PYMDP) with the sign of the ambiguity that the paper prints.
    pub const AS_PRINTED: Self = Self { convention: Convention::AsPrinted, ..Self::JAX_PYMDP };

    /// The paper's own arithmetic with its artefact: policies shorter than the horizon go on with action
    /// zero, which is "up", so that a robot that has arrived walks off again.
    pub const AS_PUBLISHED: Self = Self {
        precision: 16.0,
        convention: Convention::Standard,
        gain: Gain::Joint,
        credit: Credit::EveryStep,
        padding: Padding::Repeat(0),
        window: f32::INFINITY,
    };

    /// ln E - F - γ G, the log of the policy posterior up to a constant (equation 7), from -G.
    #[must_use]
    pub fn score(&self, ln_prior: f32, free_energy: f32, value: f32) -> f32 {
        ln_prior - free_energy + self.precision * value
    }
}

impl Default for Scoring {
    fn default() -> Self {
        Self::DEFAULT
    }
}
