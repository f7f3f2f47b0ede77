//! E, learned: which policies are usually chosen.

use super::tally::Tally;
use super::{Dirichlet, Rates};
use crate::inference::likelihood::FLOOR;
use crate::math;

/// Dirichlet counts of E, the habits over `P` policies. Memory: about 8 `P` bytes.
///
/// ```
/// use iibt_core::inference::Habits;
/// use iibt_core::inference::learning::{HabitCounts, Rates};
///
/// let mut counts = HabitCounts::new([1.0; 2], Rates::DEFAULT);
/// assert!(counts.learn_choice(1));
/// let ln_prior = counts.ln_prior();
/// assert!(ln_prior[1] > ln_prior[0]);
/// let habits = Habits::Joint(&ln_prior);
/// # let _ = habits;
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HabitCounts<const P: usize>(Tally<P>);

impl<const P: usize> HabitCounts<P> {
    /// From prior counts; such that are negative or not finite are repaired as in [`Dirichlet::new`].
    #[must_use]
    pub fn new(prior: [f32; P], rates: Rates) -> Self {
        Self(Tally::new(prior, rates))
    }

    /// Learns from the posterior over policies of a decision, e := e + η π (Friston et al. 2016, "Active inference and
    /// learning"). Returns `false`, and learns nothing, when it is no distribution over the policies.
    pub fn learn(&mut self, posterior: &[f32; P]) -> bool {
        let sound = math::is_distribution(posterior);
        if sound {
            self.0.learn(1.0, posterior);
        }
        sound
    }

    /// Learns from the policy that was carried out, in place of the posterior. Returns `false` when there is no such policy.
    pub fn learn_choice(&mut self, policy: usize) -> bool {
        let sound = policy < P;
        if sound {
            self.0.learn(1.0, &core::array::from_fn(|at| if at == policy { 1.0 } else { 0.0 }));
        }
        sound
    }

    /// ln E, for [`Habits::Joint`](crate::inference::Habits::Joint): finite, no lower than ln [`FLOOR`].
    #[must_use]
    pub fn ln_prior(&self) -> [f32; P] {
        self.0.now().ln_expected(math::ln(FLOOR))
    }

    /// The counts.
    #[must_use]
    pub const fn counts(&self) -> &Dirichlet<P> {
        self.0.now()
    }

    /// Forgets everything learned.
    pub const fn reset(&mut self) {
        self.0.reset();
    }
}

#[cfg(test)]
mod tests {
    use super::super::sampling::Dice;
    use super::*;

    #[test]
    fn habits_come_to_how_often_each_policy_is_chosen() {
        let truth = [0.6, 0.3, 0.1, 0.0];
        let mut dice = Dice::new(6);
        let mut counts = HabitCounts::new([0.25; 4], Rates::DEFAULT);
        for _ in 0..4000 {
            assert!(counts.learn_choice(dice.draw(&truth)));
        }
        let error =
            counts.ln_prior().iter().zip(truth).map(|(&e, q)| (math::exp(e) - q).abs()).fold(0.0, f32::max);
        // Three standard errors of a fair coin.
        assert!(error < 0.024, "{error}");
    }

    #[test]
    fn a_policy_never_chosen_has_a_finite_prior() {
        let mut counts = HabitCounts::new([1.0, 0.0], Rates::new(1.0, 1.0));
        assert!(counts.learn(&[0.5, 0.5]));
        assert!(!counts.learn(&[0.5, f32::NAN]) && !counts.learn_choice(2));
        counts.reset();
        assert_eq!(counts.ln_prior(), [0.0, math::ln(FLOOR)]);
    }
}
