//! D, learned: where a hidden factor begins.

use super::tally::Tally;
use super::{Dirichlet, Rates};
use crate::math;

/// Dirichlet counts of D, the prior over the `S` states of one factor. Memory: about 8 `S` bytes.
///
/// ```
/// use iibt_core::inference::learning::{PriorCounts, Rates};
///
/// let mut counts = PriorCounts::new([1.0; 2], Rates::DEFAULT);
/// assert!(counts.learn(&[0.0, 1.0]) && counts.learn(&[0.0, 1.0]));
/// assert_eq!(counts.expected(), [0.25, 0.75]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PriorCounts<const S: usize>(Tally<S>);

impl<const S: usize> PriorCounts<S> {
    /// From prior counts; such that are negative or not finite are repaired as in [`Dirichlet::new`].
    #[must_use]
    pub fn new(prior: [f32; S], rates: Rates) -> Self {
        Self(Tally::new(prior, rates))
    }

    /// Learns from the belief about the state that an episode began in, d := d + η q(s_1), which what was observed since may
    /// have made surer. Returns `false`, and learns nothing, when it is no distribution over the states.
    pub fn learn(&mut self, first: &[f32]) -> bool {
        let sound = first.len() == S && math::is_distribution(first);
        if sound {
            let mut experience = [0.0; S];
            math::assign(&mut experience, first);
            self.0.learn(1.0, &experience);
        }
        sound
    }

    /// D, the expected prior, for a [`Factor`](crate::inference::Factor).
    #[must_use]
    pub fn expected(&self) -> [f32; S] {
        self.0.now().expected()
    }

    /// The counts.
    #[must_use]
    pub const fn counts(&self) -> &Dirichlet<S> {
        self.0.now()
    }

    /// Forgets everything learned.
    pub const fn reset(&mut self) {
        self.0.reset();
    }
}

#[cfg(test)]
mod tests {
    use super::super::sampling::{Dice, one};
    use super::*;

    #[test]
    fn the_prior_comes_to_where_episodes_begin_and_follows_when_that_changes() {
        let mut dice = Dice::new(5);
        let mut counts = PriorCounts::new([1.0; 3], Rates::new(1.0, 0.01));
        for truth in [[0.7, 0.2, 0.1], [0.1, 0.1, 0.8]] {
            for _ in 0..1500 {
                assert!(counts.learn(&dice.one_of(&truth)));
            }
            // A hundred episodes are remembered: three standard errors of a fair coin, and the prior's own pull.
            let error = counts.expected().iter().zip(truth).map(|(p, q)| (p - q).abs()).fold(0.0, f32::max);
            assert!(error < 0.12, "{error}");
        }
        counts.reset();
        assert_eq!(counts.expected(), PriorCounts::new([1.0; 3], Rates::DEFAULT).expected());
    }

    #[test]
    fn what_is_no_belief_teaches_nothing() {
        let mut counts = PriorCounts::new([1.0, f32::NAN], Rates::DEFAULT);
        let before = counts.clone();
        for wrong in [&[1.0][..], &[0.5, 0.4], &[f32::NAN, 1.0], &[-1.0, 2.0], &[0.5, 0.25, 0.25]] {
            assert!(!counts.learn(wrong));
        }
        assert_eq!(counts, before);
        assert!(counts.learn(&one::<2>(1)) && counts.expected() == [0.5, 0.5]);
    }
}
