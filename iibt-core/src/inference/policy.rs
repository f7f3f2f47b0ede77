//! The posterior over policies and the choice of one.

use crate::actions::{Action, Actions, HORIZON};
use crate::math;

/// A policy: a sequence of actions, one per step.
pub type Policy = Actions;

/// Every policy of `steps` steps of the actions 0 to `actions` - 1, the last step's action running
/// fastest. There are `actions` to the power of `steps`; none where a policy cannot have such an
/// action or so many steps.
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

/// The posterior over one robot's policies and those of its teammates, who each interact with this
/// robot and not, for this decision, with each other: a star.
///
/// p(π, π_1, ..., π_n) ∝ exp(own(π)) Π_k exp(peer_k(π_k) + pair_k(π, π_k)). The sum and the maximum
/// over each teammate's policies are taken as it joins, so the product of the candidate sets is
/// never formed: memory is `2 P`, and a teammate costs its number of pairs. With one teammate this
/// is the exact joint posterior. Only navigation uses it; other decisions are exact, see
/// [`Agent::decide`](super::Agent::decide).
///
/// ```
/// use iibt_core::inference::StarOfPairs;
///
/// // Two policies of this robot; a teammate with two of its own, which goes well with our second.
/// let mut star = StarOfPairs::<2>::new([0.0, 0.0]);
/// star.join([&[0.0, 0.0][..], &[0.0, 3.0][..]]);
/// let choice = star.choose().expect("there are policies");
/// assert_eq!(choice.policy, 1);
/// assert!(choice.marginal > choice.joint && choice.joint > 0.8);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StarOfPairs<const P: usize> {
    count: usize,
    total: [f32; P],
    best: [f32; P],
}

impl<const P: usize> StarOfPairs<P> {
    /// A decision among policies with these scores ln E - F - γ G. More than `P` are cut off.
    #[must_use]
    pub fn new(scores: impl IntoIterator<Item = f32>) -> Self {
        let mut star = Self { count: 0, total: [f32::NEG_INFINITY; P], best: [f32::NEG_INFINITY; P] };
        for ((total, best), score) in star.total.iter_mut().zip(&mut star.best).zip(scores) {
            (*total, *best) = (score, score);
            star.count += 1;
        }
        star
    }

    /// Adds a teammate: for each own policy, the scores of the teammate's policies, pair part
    /// included.
    pub fn join<'a>(&mut self, rows: impl IntoIterator<Item = &'a [f32]>) {
        for ((total, best), row) in self.total.iter_mut().zip(&mut self.best).zip(rows) {
            *total += math::log_sum_exp(row);
            *best += row.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        }
    }

    /// The most probable joint policy: argmax, the first of equals. `None` without candidates.
    #[must_use]
    pub fn choose(&self) -> Option<Choice> {
        let (total, best) = (self.total.get(..self.count)?, self.best.get(..self.count)?);
        let policy = math::argmax(best);
        let normaliser = math::log_sum_exp(total);
        let probability = |score: f32| math::exp(score - normaliser).clamp(0.0, 1.0);
        Some(Choice {
            policy,
            joint: probability(*best.get(policy)?),
            marginal: probability(*total.get(policy)?),
        })
    }

    /// The marginal posterior over the robot's own policies; zero beyond the candidates.
    #[must_use]
    pub fn marginals(&self) -> [f32; P] {
        let mut posterior = self.total;
        math::softmax(&mut posterior);
        posterior
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_with_one_arm_is_the_joint_posterior() {
        let own = [0.3, -1.0, 0.2];
        let rows = [[1.0, -2.0], [0.5, 3.0], [-1.0, 0.7]];
        let weights: std::vec::Vec<f32> =
            own.iter().zip(rows).flat_map(|(own, row)| row.map(|pair| math::exp(own + pair))).collect();
        let sum: f32 = weights.iter().sum();

        let mut star = StarOfPairs::<4>::new(own);
        star.join(rows.iter().map(|row| &row[..]));
        let choice = star.choose().unwrap();

        assert_eq!(choice.policy, 1);
        assert!((choice.joint - weights[3] / sum).abs() < 1e-6);
        assert!((choice.marginal - (weights[2] + weights[3]) / sum).abs() < 1e-6);
        assert!((star.marginals()[1] - choice.marginal).abs() < 1e-6);
        assert_eq!(star.marginals()[3], 0.0);
    }

    #[test]
    fn two_arms_multiply() {
        let (left, right) = ([[0.0, 1.0], [2.0, 0.0]], [[0.5, 0.5], [0.0, -1.0]]);
        let mut sum = 0.0;
        let mut best = (0, 0.0);
        for own in 0..2 {
            for l in left[own] {
                for r in right[own] {
                    let weight = math::exp(l + r);
                    sum += weight;
                    best = if weight > best.1 { (own, weight) } else { best };
                }
            }
        }
        let mut star = StarOfPairs::<2>::new([0.0, 0.0]);
        star.join(left.iter().map(|row| &row[..]));
        star.join(right.iter().map(|row| &row[..]));
        let choice = star.choose().unwrap();
        assert_eq!(choice.policy, best.0);
        assert!((choice.joint - best.1 / sum).abs() < 1e-6);
    }

    #[test]
    fn every_sequence_is_generated_once_in_order() {
        let policies: std::vec::Vec<_> = generated(3, 2).collect();
        let expected: std::vec::Vec<_> =
            (0..9).map(|number| Policy::new(&[number / 3, number % 3]).unwrap()).collect();
        assert_eq!(policies, expected);
        assert_eq!(generated(2, 0).count(), 1);
        assert_eq!((generated(0, 2).count(), generated(17, 1).count(), generated(2, 65).count()), (0, 0, 0));
    }

    #[test]
    fn ties_go_to_the_first_and_nothing_to_nobody() {
        assert_eq!(StarOfPairs::<3>::new([1.0, 1.0, 1.0]).choose().map(|choice| choice.policy), Some(0));
        assert_eq!(StarOfPairs::<3>::new([]).choose(), None);
    }
}
