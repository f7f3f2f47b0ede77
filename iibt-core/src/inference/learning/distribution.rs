//! D and E, learned: the initial states of a hidden factor, and the usual policies.

use super::{Dirichlet, Rates};
use crate::inference::likelihood::FLOOR;
use crate::math;

/// Dirichlet counts of one distribution over `K` values: D, the prior over the states of a factor,
/// or E, the habits over joint policies. Memory: about 8 `K` bytes.
///
/// ```
/// use iibt_core::inference::Habits;
/// use iibt_core::inference::learning::{DistributionCounts, Rates};
///
/// // Two episodes began in the second of two states.
/// let mut states = DistributionCounts::new([1.0; 2], Rates::DEFAULT);
/// assert!(states.learn(&[0.0, 1.0]) && states.learn(&[0.0, 1.0]));
/// assert_eq!(states.expected(), [0.25, 0.75]);
///
/// // The second of two policies was carried out.
/// let mut policies = DistributionCounts::new([1.0; 2], Rates::DEFAULT);
/// assert!(policies.learn_value(1) && !policies.learn_value(2));
/// let ln_prior = policies.ln_expected();
/// assert!(ln_prior[1] > ln_prior[0]);
/// let habits = Habits::Joint(&ln_prior);
/// # let _ = habits;
/// ```
#[doc(alias = "d")]
#[doc(alias = "e")]
#[doc(alias = "habits")]
#[derive(Clone, Debug, PartialEq)]
pub struct DistributionCounts<const K: usize> {
    prior: Dirichlet<K>,
    now: Dirichlet<K>,
    rates: Rates,
}

impl<const K: usize> DistributionCounts<K> {
    /// From prior counts; such that are negative or not finite are repaired as in
    /// [`Dirichlet::new`].
    #[must_use]
    pub fn new(prior: [f32; K], rates: Rates) -> Self {
        let prior = Dirichlet::new(prior);
        Self { prior, now: prior, rates }
    }

    /// Learns from a distribution over the values. Of D that is the belief about the state that an
    /// episode began in, d := d + η q(s_1), which what was observed since may have made surer; of E
    /// the posterior over policies of a decision, e := e + η π (Friston et al. 2016, "Active
    /// inference and learning").
    ///
    /// Returns `false`, and learns nothing, when it is no distribution over the values.
    pub fn learn(&mut self, distribution: &[f32]) -> bool {
        let sound = distribution.len() == K && math::is_distribution(distribution);
        if sound {
            let mut experience = [0.0; K];
            math::assign(&mut experience, distribution);
            self.add(1.0, &experience);
        }
        sound
    }

    /// Learns from one value: the policy that was carried out, in place of the posterior. Returns
    /// `false` when there is no such value.
    pub fn learn_value(&mut self, value: usize) -> bool {
        self.learn(&core::array::from_fn::<_, K, _>(|at| if at == value { 1.0 } else { 0.0 }))
    }

    /// Applies forgetting, and adds `weight` times the experience.
    pub(super) fn add(&mut self, weight: f32, experience: &[f32; K]) {
        self.now.forget(self.rates.forgetting(), &self.prior);
        self.now.add(weight * self.rates.learning(), experience);
    }

    /// The expected distribution: D, for a [`Factor`](crate::inference::Factor).
    #[must_use]
    pub fn expected(&self) -> [f32; K] {
        self.now.expected()
    }

    /// Its logarithm, finite and no lower than ln [`FLOOR`]: ln E, for
    /// [`Habits::Joint`](crate::inference::Habits::Joint).
    #[must_use]
    pub fn ln_expected(&self) -> [f32; K] {
        self.now.ln_expected(math::ln(FLOOR))
    }

    /// The counts.
    #[must_use]
    pub const fn counts(&self) -> &Dirichlet<K> {
        &self.now
    }

    /// Forgets everything learned.
    pub const fn reset(&mut self) {
        self.now = self.prior;
    }
}

#[cfg(test)]
mod tests {
    use super::super::sampling::{Dice, one};
    use super::*;

    #[test]
    fn the_prior_comes_to_where_episodes_begin_and_follows_when_that_changes() {
        let mut dice = Dice::new(5);
        let mut counts = DistributionCounts::new([1.0; 3], Rates::new(1.0, 0.01));
        for truth in [[0.7, 0.2, 0.1], [0.1, 0.1, 0.8]] {
            for _ in 0..1500 {
                assert!(counts.learn(&dice.one_of(&truth)));
            }
            // A hundred episodes are remembered: three standard errors of a fair coin, and the
            // prior's own pull.
            let error = counts.expected().iter().zip(truth).map(|(p, q)| (p - q).abs()).fold(0.0, f32::max);
            assert!(error < 0.12, "{error}");
        }
        counts.reset();
        assert_eq!(counts.expected(), DistributionCounts::new([1.0; 3], Rates::DEFAULT).expected());
    }

    #[test]
    fn habits_come_to_how_often_each_policy_is_chosen() {
        let truth = [0.6, 0.3, 0.1, 0.0];
        let mut dice = Dice::new(6);
        let mut counts = DistributionCounts::new([0.25; 4], Rates::DEFAULT);
        for _ in 0..4000 {
            assert!(counts.learn_value(dice.draw(&truth)));
        }
        let error = counts
            .ln_expected()
            .iter()
            .zip(truth)
            .map(|(&e, q)| (math::exp(e) - q).abs())
            .fold(0.0, f32::max);
        // Three standard errors of a fair coin.
        assert!(error < 0.024, "{error}");
    }

    #[test]
    fn what_is_no_distribution_teaches_nothing() {
        let mut counts = DistributionCounts::new([1.0, f32::NAN], Rates::DEFAULT);
        let before = counts.clone();
        for wrong in [&[1.0][..], &[0.5, 0.4], &[f32::NAN, 1.0], &[-1.0, 2.0], &[0.5, 0.25, 0.25]] {
            assert!(!counts.learn(wrong));
        }
        assert!(!counts.learn_value(2));
        assert_eq!(counts, before);
        assert!(counts.learn(&one::<2>(1)) && counts.expected() == [0.5, 0.5]);
        counts.reset();
        assert_eq!(counts.ln_expected(), [0.0, math::ln(FLOOR)], "a value never met has a finite logarithm");
    }
}
