//! C, learned online from outcomes that led to success.

use super::{Dirichlet, DistributionCounts, Rates, held, observed};
use crate::inference::{Evidence, Preference};

/// Dirichlet counts of C, the preference over `O` outcomes of one modality, learned from outcomes
/// that turned out well.
///
/// c := c + η r o, where `o` is the outcome and `r` how well it turned out, and C(o) = ln(c_o / Σ
/// c), no lower than -`bound`. That is the outcome distribution of the successes, P(o | success),
/// as preferences are read in active inference (after Sajid, Tigas and Friston 2021, "Exploration
/// and preference satisfaction trade-off in reward-free learning", who count every outcome). An
/// outcome that no longer goes with success loses its preference at the rate of forgetting. Memory:
/// about 8 `O` bytes.
///
/// ```
/// use iibt_core::inference::Evidence;
/// use iibt_core::inference::learning::{PreferenceCounts, Rates};
///
/// let mut counts = PreferenceCounts::new([1.0; 3], Rates::new(1.0, 0.05), 4.0);
/// for _ in 0..20 {
///     counts.learn(Evidence::Outcome(2), 1.0);
///     counts.learn(Evidence::Outcome(0), 0.0);
/// }
/// let [null, failure, success] = counts.values();
/// assert!(success > null && success > failure && null >= -4.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PreferenceCounts<const O: usize> {
    counts: DistributionCounts<O>,
    bound: f32,
}

impl<const O: usize> PreferenceCounts<O> {
    /// From prior counts, repaired as in [`Dirichlet::new`], and the most that one outcome can be
    /// disliked more than certainty, in nats: `bound` is held to 0..=80, and NaN counts as zero, so
    /// that no outcome is preferred.
    #[must_use]
    pub fn new(prior: [f32; O], rates: Rates, bound: f32) -> Self {
        Self { counts: DistributionCounts::new(prior, rates), bound: held(bound, 80.0) }
    }

    /// Learns from an outcome and how well it turned out, from 0, not at all, to 1; held to that
    /// range. Of a soft observation each outcome gets its share. Returns `false`, and learns
    /// nothing, for an observation that is missing or makes no sense, or a success that is NaN.
    pub fn learn(&mut self, evidence: Evidence, success: f32) -> bool {
        let Some(outcome) = observed(evidence).filter(|_| !success.is_nan()) else { return false };
        self.counts.add(held(success, 1.0), &outcome);
        true
    }

    /// C, on a log scale from -`bound` to 0, for a [`Modality`](crate::inference::Modality) or
    /// [`Problem::preferences`](crate::inference::Problem::preferences).
    #[must_use]
    pub fn values(&self) -> [f32; O] {
        self.counts.counts().ln_expected(-self.bound)
    }

    /// Returns C as a preference that can be raised temporarily.
    #[must_use]
    pub fn preference(&self) -> Preference<O> {
        let values = self.values();
        Preference::from_fn(|outcome| values.get(outcome).copied().unwrap_or(0.0))
    }

    /// The counts.
    #[must_use]
    pub const fn counts(&self) -> &Dirichlet<O> {
        self.counts.counts()
    }

    /// Forgets everything learned.
    pub const fn reset(&mut self) {
        self.counts.reset();
    }
}

#[cfg(test)]
mod tests {
    use super::super::sampling::Dice;
    use super::*;
    use crate::math;

    #[test]
    fn preferences_come_to_the_outcomes_of_the_successes() {
        // All outcomes are as frequent; they turn out well with these chances.
        let chances = [0.9, 0.3, 0.05];
        let total: f32 = chances.iter().sum();
        let mut dice = Dice::new(7);
        let mut counts = PreferenceCounts::new([0.1; 3], Rates::DEFAULT, 10.0);
        for _ in 0..12_000 {
            let outcome = dice.below(3);
            let success = if dice.even() < chances[outcome] { 1.0 } else { 0.0 };
            assert!(counts.learn(Evidence::Outcome(outcome), success));
        }
        for (c, chance) in counts.values().into_iter().zip(chances) {
            // 5,000 successes: three standard errors of a fair coin.
            assert!((math::exp(c) - chance / total).abs() < 0.022, "{c}");
        }
        assert_eq!(counts.preference().values(), counts.values());
    }

    #[test]
    fn a_preference_that_no_longer_pays_is_forgotten() {
        let mut counts = PreferenceCounts::new([1.0; 2], Rates::new(1.0, 0.02), 8.0);
        for (good, bad) in [(0, 1), (1, 0)] {
            for _ in 0..300 {
                counts.learn(Evidence::Outcome(good), 1.0);
                counts.learn(Evidence::Outcome(bad), 0.0);
            }
            assert!(counts.values()[good] > counts.values()[bad] + 2.0, "{:?}", counts.values());
        }
    }

    #[test]
    fn values_stay_within_the_bound_whatever_is_learned() {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3.0, 0.0, 1.0, f32::MAX];
        let mut dice = Dice::new(8);
        for bound in [f32::NAN, -1.0, 0.0, 3.0, f32::INFINITY] {
            let mut counts =
                PreferenceCounts::new([f32::INFINITY, 0.0, f32::NAN], Rates::new(f32::MAX, 0.3), bound);
            for _ in 0..2000 {
                let mut pick = || odd[dice.below(odd.len())];
                let soft = [pick(), pick(), pick()];
                let success = pick();
                let evidence =
                    if dice.even() < 0.5 { Evidence::Soft(&soft) } else { Evidence::Outcome(dice.below(4)) };
                counts.learn(evidence, success);
                let lowest = -held(bound, 80.0);
                assert!(counts.values().iter().all(|c| c.is_finite() && (lowest..=0.0).contains(c)));
            }
        }
    }
}
