//! The failures of actions: two counts per action.

use super::{Dirichlet, Rates};
use crate::actions::Action;

/// The successes and failures of `U` actions, in which an action that fails leaves the state as it
/// is: the counts of a [`NextState`](crate::inference::NextState).
///
/// Every action begins with the same number of successes and no failure, so that before the first
/// failure every slip is exactly zero and motion certain. Twelve bytes per action.
///
/// ```
/// use iibt_core::inference::NextState;
/// use iibt_core::inference::learning::{Rates, SlipCounts};
///
/// let mut counts = SlipCounts::<2>::new(3.0, Rates::DEFAULT);
/// assert!(counts.learn(1, false)); // the second action failed once
/// let slips = counts.slips();
/// assert_eq!(slips, [0.0, 0.25]);
/// let motion = NextState::new(&[0, 0, 1, 1], 2).try_slipping(&slips)?;
/// assert_eq!(motion.slip(1), 0.25);
/// # Ok::<(), iibt_core::inference::TableError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SlipCounts<const U: usize> {
    actions: [Dirichlet<2>; U],
    trust: f32,
    rates: Rates,
}

impl<const U: usize> SlipCounts<U> {
    /// Counts without any success, as working memory.
    pub(crate) const EMPTY: Self =
        Self { actions: [Dirichlet::EMPTY; U], trust: 0.0, rates: Rates::new(0.0, 0.0) };

    /// Counts that begin with `trust` successes of each action. The more, the less a single failure
    /// says: after it the slip is η / (`trust` + η).
    #[must_use]
    pub fn new(trust: f32, rates: Rates) -> Self {
        Self { actions: [Self::prior(trust); U], trust, rates }
    }

    /// Counts one attempt; `false`, and nothing changes, for an action that is not counted.
    pub fn learn(&mut self, action: Action, succeeded: bool) -> bool {
        let (prior, rates) = (Self::prior(self.trust), self.rates);
        let Some(counts) = self.actions.get_mut(usize::from(action)) else { return false };
        counts.forget(rates.forgetting(), &prior);
        counts.add(rates.learning(), if succeeded { &[1.0, 0.0] } else { &[0.0, 1.0] });
        true
    }

    /// The expected slip of every action: failures / (successes + failures).
    #[must_use]
    pub fn slips(&self) -> [f32; U] {
        self.actions.each_ref().map(|counts| counts.probability(1))
    }

    /// The successes and failures of an action, its prior's included; none of one that is not
    /// counted.
    #[must_use]
    pub fn counts(&self, action: Action) -> Option<&[f32; 2]> {
        self.actions.get(usize::from(action)).map(Dirichlet::counts)
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        self.actions = [Self::prior(self.trust); U];
    }

    fn prior(trust: f32) -> Dirichlet<2> {
        // No trust at all is a prior too: the least of it.
        Dirichlet::new([trust.max(super::LEAST), 0.0])
    }
}

#[cfg(test)]
mod tests {
    use super::super::sampling::Dice;
    use super::*;

    #[test]
    fn without_a_failure_motion_is_certain_to_the_last_bit() {
        let mut counts = SlipCounts::<2>::new(8.0, Rates::new(1.0, 0.02));
        for _ in 0..1000 {
            assert!(counts.learn(0, true));
        }
        assert_eq!(counts.slips(), [0.0; 2]);
    }

    #[test]
    fn a_failure_is_weighed_against_the_trust() {
        let mut counts = SlipCounts::<2>::new(3.0, Rates::DEFAULT);
        assert!(counts.learn(1, false) && !counts.learn(2, false));
        assert_eq!(counts.slips(), [0.0, 0.25]);
        assert_eq!(counts.counts(1), Some(&[3.0, 1.0]));
        assert_eq!(counts.counts(2), None);
        counts.reset();
        assert_eq!(counts.slips(), [0.0; 2]);
    }

    #[test]
    fn learned_slips_reach_the_true_ones_within_three_standard_errors() {
        let (truth, tries) = ([0.0, 0.1, 0.5, 0.9], 20_000);
        let mut counts = SlipCounts::<4>::new(8.0, Rates::DEFAULT);
        let mut dice = Dice::new(7);
        for _ in 0..tries {
            for (action, slip) in (0..).zip(truth) {
                counts.learn(action, dice.even() >= slip);
            }
        }
        for (learned, slip) in counts.slips().into_iter().zip(truth) {
            let error = (slip * (1.0 - slip) / tries as f32).sqrt();
            assert!((learned - slip).abs() <= 3.0 * error + 8.0 / tries as f32, "{learned} for {slip}");
        }
    }

    #[test]
    fn what_is_forgotten_is_believed_as_at_first() {
        let mut counts = SlipCounts::<1>::new(8.0, Rates::new(1.0, 0.02));
        for _ in 0..500 {
            counts.learn(0, false);
        }
        // 8 successes against the last 1 / 0.02 failures.
        assert!((counts.slips()[0] - 50.0 / 58.0).abs() < 0.01, "{:?}", counts.slips());
        for _ in 0..500 {
            counts.learn(0, true);
        }
        assert!(counts.slips()[0] < 0.001);
    }

    #[test]
    fn nothing_odd_breaks_it() {
        for trust in [f32::NAN, f32::INFINITY, -1.0, 0.0] {
            let mut counts = SlipCounts::<1>::new(trust, Rates::new(f32::INFINITY, f32::NAN));
            assert_eq!(counts.slips(), [0.0], "{trust}");
            counts.learn(0, false);
            assert!((0.0..=1.0).contains(&counts.slips()[0]));
        }
    }
}
