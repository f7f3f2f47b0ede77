//! Variational and expected free energy, in named terms.

use super::Likelihood;
use crate::actions::Action;
use crate::math;

/// F = KL[q(s) || P(s)] - E_q ln P(o | s), complexity less accuracy (the paper's equation 5), in nats.
///
/// At the exact posterior this is the surprise -ln P(o); for any other belief it is more.
#[must_use]
pub fn variational<const S: usize, const O: usize>(
    belief: &[f32; S],
    prior: &[f32; S],
    likelihood: &impl Likelihood<S, O>,
    outcome: usize,
) -> f32 {
    let surprise = |(state, &q): (usize, &f32)| -> f32 {
        if q > 0.0 { -q * math::ln(likelihood.probability(outcome, state)) } else { 0.0 }
    };
    math::kl(belief, prior) + belief.iter().enumerate().map(surprise).sum::<f32>()
}

/// What a policy is expected to bring, in nats, summed over modalities and steps.
///
/// G = risk + ambiguity = -(utility + information gain), because the entropy of the predicted outcomes is
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
}

impl Terms {
    /// KL[q(o) || P(o)]: how far the predicted outcomes are from the preferred ones.
    #[must_use]
    pub fn risk(&self) -> f32 {
        -self.utility - self.information_gain - self.ambiguity
    }

    /// G, the expected free energy, under a convention; lower is better.
    #[must_use]
    pub fn expected_free_energy(&self, convention: Convention) -> f32 {
        match convention {
            Convention::Standard => -self.utility - self.information_gain,
            Convention::AsPrinted => self.risk() - self.ambiguity,
        }
    }

    /// The terms of one modality at one step, from the predicted belief and ln P(o).
    #[must_use]
    pub fn of_modality<const S: usize, const O: usize>(
        belief: &[f32; S],
        likelihood: &impl Likelihood<S, O>,
        ln_preference: &[f32; O],
    ) -> Self {
        let outcomes = likelihood.predict(belief);
        let ambiguity = likelihood.ambiguity(belief);
        Self {
            utility: math::expectation(&outcomes, ln_preference),
            information_gain: math::entropy(&outcomes) - ambiguity,
            ambiguity,
        }
    }
}

impl core::ops::AddAssign for Terms {
    fn add_assign(&mut self, other: Self) {
        self.utility += other.utility;
        self.information_gain += other.information_gain;
        self.ambiguity += other.ambiguity;
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
}

impl Scoring {
    /// What is right: arrived robots stay, goals count on arrival, standard G with per-modality gain.
    pub const DEFAULT: Self = Self {
        precision: 16.0,
        convention: Convention::Standard,
        gain: Gain::PerModality,
        credit: Credit::OnArrival,
        padding: Padding::Stay,
    };

    /// The paper's own arithmetic with its artefact: policies shorter than the horizon go on with action
    /// zero, which is "up", so that a robot that has arrived walks off again.
    pub const AS_PUBLISHED: Self = Self {
        precision: 16.0,
        convention: Convention::Standard,
        gain: Gain::Joint,
        credit: Credit::EveryStep,
        padding: Padding::Repeat(0),
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

#[cfg(test)]
mod tests {
    use super::super::{Belief, IdentityNoise, Preference};
    use super::*;

    const SENSOR: IdentityNoise<4> = IdentityNoise::new(0.8);

    #[test]
    fn free_energy_is_least_at_the_exact_posterior() {
        let prior = [0.4, 0.3, 0.2, 0.1];
        let mut posterior = Belief::from_weights(prior).unwrap();
        let surprise = posterior.update(&SENSOR, 1).unwrap();
        let at = |belief: &[f32; 4]| variational(belief, &prior, &SENSOR, 1);
        assert!((at(posterior.probabilities()) - surprise).abs() < 1e-6);
        for other in [prior, [0.25; 4], [0.0, 1.0, 0.0, 0.0]] {
            assert!(at(&other) > surprise + 1e-3);
        }
    }

    #[test]
    fn the_two_readings_of_g_agree() {
        let belief = [0.1, 0.6, 0.3, 0.0];
        let preference = Preference::new([0.0, 2.0, -1.0, 0.5]).ln_probabilities();
        let terms = Terms::of_modality(&belief, &SENSOR, &preference);
        let outcomes = SENSOR.predict(&belief);
        let risk = math::kl(&outcomes, &preference.map(math::exp));
        assert!((terms.risk() - risk).abs() < 1e-5);
        let standard = terms.expected_free_energy(Convention::Standard);
        assert!((standard - (risk + terms.ambiguity)).abs() < 1e-5);
        let printed = terms.expected_free_energy(Convention::AsPrinted);
        assert!((printed - (risk - terms.ambiguity)).abs() < 1e-5);
        assert!(terms.information_gain > 0.0);
    }
}
