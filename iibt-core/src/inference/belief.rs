//! q(s), what a robot believes about a hidden state, and how an action and an observation change it.

use super::{Likelihood, OutcomeTable, Transition};
use crate::actions::Action;
use crate::math;

/// A distribution over `S` states: finite, not negative, summing to one. Every method keeps it so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belief<const S: usize>([f32; S]);

/// The observation has probability zero under the belief and the model. The belief was left as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Impossible;

impl core::fmt::Display for Impossible {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the observation has probability zero under the belief and the model")
    }
}

impl core::error::Error for Impossible {}

impl<const S: usize> Belief<S> {
    /// The same probability for every state.
    #[must_use]
    pub const fn uniform() -> Self {
        Self([1.0 / S as f32; S])
    }

    /// All mass on one state; uniform when there is no such state.
    #[must_use]
    pub fn certain(state: usize) -> Self {
        let mut masses = [0.0; S];
        match masses.get_mut(state) {
            Some(mass) => *mass = 1.0,
            None => return Self::uniform(),
        }
        Self(masses)
    }

    /// The belief in proportion to non-negative weights; `None` when they sum to nothing or to no number.
    #[must_use]
    pub fn from_weights(mut weights: [f32; S]) -> Option<Self> {
        if weights.iter().any(|weight| *weight < 0.0) {
            return None;
        }
        math::normalise(&mut weights).map(|_| Self(weights))
    }

    /// For models, which have checked that it is one.
    pub(super) const fn from_distribution(distribution: [f32; S]) -> Self {
        Self(distribution)
    }

    /// The probability of each state.
    #[must_use]
    pub const fn probabilities(&self) -> &[f32; S] {
        &self.0
    }

    /// The most probable state and its probability; the first of equals.
    #[must_use]
    pub fn most_likely(&self) -> (usize, f32) {
        let state = math::argmax(&self.0);
        (state, self.0.get(state).copied().unwrap_or(0.0))
    }

    /// The belief after `action`: q(s') = Σ_s B_u(s', s) q(s).
    pub fn predict(&mut self, transition: &impl Transition<S>, action: Action) {
        let mut next = [0.0; S];
        transition.predict(action, &self.0, &mut next);
        self.replace(next);
    }

    /// Mixes in a share of another belief: q := (1 - share) q + share other. `share` is held to 0..=1.
    pub fn mix(&mut self, other: &Self, share: f32) {
        let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
        let mut mixed = self.0;
        for (q, p) in mixed.iter_mut().zip(&other.0) {
            *q += share * (p - *q);
        }
        self.replace(mixed);
    }

    /// The belief after an observation, by Bayes' rule; returns the variational free energy, which for this
    /// exact posterior is the surprise F = -ln P(o).
    ///
    /// # Errors
    /// [`Impossible`] when the observation has probability zero; the belief is left as it was.
    pub fn update<const O: usize>(
        &mut self,
        likelihood: &impl Likelihood<S, O>,
        outcome: usize,
    ) -> Result<f32, Impossible> {
        let mut posterior = self.0;
        likelihood.weigh(outcome, &mut posterior);
        let evidence = math::normalise(&mut posterior).ok_or(Impossible)?;
        self.0 = posterior;
        Ok(-math::ln(evidence))
    }

    fn replace(&mut self, mut next: [f32; S]) {
        if math::normalise(&mut next).is_some() {
            self.0 = next;
        }
    }
}

/// The exact beliefs of two robots after an outcome that couples them, without storing their product; returns
/// F = -ln P(o). Costs `2 S + L * L`.
///
/// q(s1) ∝ p(s1) Σ_s2 p(s2) P(o | s1, s2), and likewise for s2: the marginals of the joint posterior.
///
/// # Errors
/// [`Impossible`] when the outcome has probability zero; both beliefs are left as they were.
pub fn update_pair<const S: usize, const L: usize, const K: usize>(
    first: &mut Belief<S>,
    second: &mut Belief<S>,
    table: &OutcomeTable<S, L, K>,
    outcome: usize,
) -> Result<f32, Impossible> {
    let masses = (table.label_masses(&first.0), table.label_masses(&second.0));
    let to_first = table.message(outcome, &masses.1);
    let to_second = table.transposed().message(outcome, &masses.0);
    let (mut p, mut q) = (first.0, second.0);
    weigh_labels(&mut p, &to_first, table);
    weigh_labels(&mut q, &to_second, table);
    let evidence = math::normalise(&mut p).ok_or(Impossible)?;
    math::normalise(&mut q).ok_or(Impossible)?;
    (first.0, second.0) = (p, q);
    Ok(-math::ln(evidence))
}

fn weigh_labels<const S: usize, const L: usize, const K: usize>(
    belief: &mut [f32; S],
    message: &[f32; L],
    table: &OutcomeTable<S, L, K>,
) {
    for (state, q) in belief.iter_mut().enumerate() {
        *q *= message.get(table.label(state)).copied().unwrap_or(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{IdentityNoise, NextState};
    use super::*;

    const SENSOR: IdentityNoise<4> = IdentityNoise::new(0.91);

    #[test]
    fn bayes_rule_and_the_surprise() {
        let mut belief = Belief::from_weights([1.0, 1.0, 2.0, 0.0]).unwrap();
        let surprise = belief.update(&SENSOR, 2).unwrap();
        assert!((surprise + math::ln(0.5 * 0.91 + 0.5 * 0.03)).abs() < 1e-6);
        assert_eq!(belief.most_likely().0, 2);
    }

    #[test]
    fn an_impossible_observation_changes_nothing() {
        let perfect = IdentityNoise::<4>::new(1.0);
        let before = Belief::certain(1);
        let mut belief = before;
        assert_eq!(belief.update(&perfect, 3), Err(Impossible));
        assert_eq!(belief.update(&SENSOR, 99), Err(Impossible));
        assert_eq!(belief, before);
    }

    #[test]
    fn motion_carries_the_belief_along() {
        let ring = NextState::<4, 1>::new([[1, 2, 3, 0]]);
        let mut belief = Belief::from_weights([0.7, 0.3, 0.0, 0.0]).unwrap();
        belief.predict(&ring, 0);
        assert_eq!(belief.probabilities(), &[0.0, 0.7, 0.3, 0.0]);
    }

    #[test]
    fn nothing_makes_it_anything_but_a_distribution() {
        assert_eq!(Belief::from_weights([0.0; 3]), None);
        assert_eq!(Belief::from_weights([1.0, f32::NAN, 0.0]), None);
        assert_eq!(Belief::from_weights([2.0, -1.0, 0.0]), None);
        let mut belief = Belief::<4>::certain(9);
        assert_eq!(belief, Belief::uniform());
        belief.mix(&Belief::certain(0), f32::NAN);
        assert_eq!(belief, Belief::uniform());
        belief.mix(&Belief::certain(0), 7.0);
        assert_eq!(belief, Belief::certain(0));
    }

    #[test]
    fn two_robots_are_inferred_together() {
        // Success only where the two stand on different goals (states 0 and 3).
        let table = OutcomeTable::<4, 3, 3>::new([1, 0, 0, 2], [[0, 2, 2], [2, 2, 1], [2, 1, 2]]);
        let mut first = Belief::from_weights([0.4, 0.1, 0.1, 0.4]).unwrap();
        let mut second = Belief::from_weights([0.1, 0.1, 0.1, 0.7]).unwrap();
        let free_energy = update_pair(&mut first, &mut second, &table, 1).unwrap();
        assert!((free_energy + math::ln(0.4 * 0.7 + 0.4 * 0.1)).abs() < 1e-6);
        assert!((first.probabilities()[0] - 0.28 / 0.32).abs() < 1e-6);
        assert!((second.probabilities()[0] - 0.04 / 0.32).abs() < 1e-6);
    }
}
