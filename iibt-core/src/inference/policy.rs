//! The posterior over policies and the choice of one.

use crate::actions::{Action, Actions, HORIZON};
use crate::math;

/// A policy: a sequence of actions, one per step.
pub type Policy = Actions;

/// Every policy of `steps` steps of the actions 0 to `actions` - 1, the last step's action running
/// fastest. There are `actions` to the power of `steps`; none where a policy cannot have such an
/// action or this many steps.
///
/// ```
/// use iibt_core::inference::{Policy, policy};
///
/// let all: Vec<Policy> = policy::generated(2, 2).collect();
/// assert_eq!(all, [[0, 0], [0, 1], [1, 0], [1, 1]].map(|actions| Policy::of(&actions)));
/// ```
pub fn generated(actions: u8, steps: usize) -> impl Iterator<Item = Policy> {
    let fits = actions <= Actions::CODES && steps <= HORIZON;
    let count = u32::try_from(steps).ok().and_then(|steps| usize::from(actions).checked_pow(steps));
    let policy = move |number: usize| {
        let mut policy = Policy::EMPTY;
        for step in 0..steps {
            let slower = (steps - step - 1) as u32;
            let place = usize::from(actions).checked_pow(slower).unwrap_or(usize::MAX).max(1);
            // There is room, and the action exists: that was asked first.
            let _ = policy.push((number / place % usize::from(actions.max(1))) as Action);
        }
        policy
    };
    (0..count.filter(|_| fits).unwrap_or(0)).map(policy)
}

/// Turns scores into the posterior over policies, their softmax; policies whose score is more than
/// `window` below the best are pruned (Occam's window, in nats, zero at the least) and get nothing,
/// as do those whose score is NaN. Without any score all get nothing.
///
/// ```
/// use iibt_core::inference::policy;
///
/// let mut scores = [0.0, 0.0, -10.0, f32::NAN];
/// policy::posterior(&mut scores, 3.0);
/// assert_eq!(scores, [0.5, 0.5, 0.0, 0.0]);
/// ```
#[doc(alias = "Occam window")]
#[doc(alias = "pruning")]
pub fn posterior(scores: &mut [f32], window: f32) {
    let best = scores.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    if best == f32::NEG_INFINITY {
        return scores.fill(0.0);
    }
    let least = best.min(f32::MAX) - window.max(0.0);
    for score in scores.iter_mut() {
        *score = if *score >= least { score.min(f32::MAX) } else { f32::NEG_INFINITY };
    }
    math::softmax(scores);
}

/// The policy that a number `u` from 0 to 1, drawn evenly by the caller's generator, picks from a
/// posterior: the first up to which there is more mass than `u`.
///
/// ```
/// use iibt_core::inference::policy;
///
/// let posterior = [0.25, 0.0, 0.75];
/// assert_eq!([0.0, 0.2, 0.3, 0.99].map(|u| policy::sample(&posterior, u)), [0, 0, 2, 2]);
/// ```
#[must_use]
pub fn sample(posterior: &[f32], u: f32) -> usize {
    let mut left = u;
    let mut last = 0;
    for (policy, &p) in posterior.iter().enumerate() {
        if p > 0.0 {
            last = policy;
            if left < p {
                return policy;
            }
            left -= p;
        }
    }
    last
}

/// A chosen policy and its probability.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Choice {
    /// The robot's own policy, by its place in the candidate list.
    pub policy: usize,
    /// The posterior probability of the chosen joint policy.
    pub joint: f32,
    /// The marginal posterior probability of the robot's own policy.
    pub marginal: f32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sequence_is_generated_once_in_order() {
        let policies: std::vec::Vec<_> = generated(3, 2).collect();
        let expected: std::vec::Vec<_> =
            (0..9).map(|number| Policy::new(&[number / 3, number % 3]).unwrap()).collect();
        assert_eq!(policies, expected);
        assert_eq!(generated(2, 0).count(), 1);
        assert_eq!((generated(0, 2).count(), generated(17, 1).count(), generated(2, 65).count()), (0, 0, 0));
    }
}
