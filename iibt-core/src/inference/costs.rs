//! The choice of one joint policy from a list that all robots of a team have in common, by what
//! each policy costs in time.
//!
//! With ln C = -β x ticks, the expected free energy of a policy is β times what it costs, and its
//! prior probability can be expressed in ticks as well. All terms are therefore whole eighths of a
//! tick, so that robots of every make add them up to the same sum and choose the same policy.

mod explanation;

pub use explanation::{CostExplanation, RankedPolicy};

use super::error::{Argument, OutOfRange};
use super::policy::{self, Choice};
use heapless::Vec;

/// A time in eighths of a tick.
pub type Eighths = u16;

/// What one joint policy costs, term by term, in eighths of a tick.
///
/// ```
/// use iibt_core::inference::PolicyCost;
///
/// let cost = PolicyCost { time: 6 * 8, delay: 12, ..PolicyCost::FREE };
/// assert_eq!(cost.total(), 60);
/// assert_eq!(PolicyCost { price: 3, ..PolicyCost::IMPOSSIBLE }.total(), u32::MAX);
/// ```
#[doc(alias = "expected free energy")]
#[doc(alias = "cost function")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PolicyCost {
    /// The expected time until the policy is done, over the worlds of the common belief
    /// ([`expected_time`]): the pragmatic value with its sign changed.
    pub time: Eighths,
    /// What is saved of that because the team goes on by what it sees on the way
    /// ([`ExpectedTime`](super::ExpectedTime)): the epistemic value.
    pub epistemic: Eighths,
    /// The habit, -ln E / β ([`worth_of_nats`]).
    pub habit: Eighths,
    /// The largest delay that one of the robots it needs expects.
    pub delay: Eighths,
    /// The sum of what it costs each robot: battery, wear.
    pub price: Eighths,
    /// Whether a robot that it needs cannot carry it out.
    pub is_impossible: bool,
}

impl PolicyCost {
    /// A policy that costs nothing.
    pub const FREE: Self = Self { time: 0, epistemic: 0, habit: 0, delay: 0, price: 0, is_impossible: false };

    /// A policy that cannot be carried out.
    pub const IMPOSSIBLE: Self = Self { is_impossible: true, ..Self::FREE };

    /// Returns the sum of all terms, less the epistemic value; `u32::MAX` for an impossible policy.
    #[must_use]
    pub const fn total(self) -> u32 {
        if self.is_impossible {
            return u32::MAX;
        }
        // Four numbers of 16 bits do not overflow 32.
        self.time.saturating_sub(self.epistemic) as u32
            + self.habit as u32
            + self.delay as u32
            + self.price as u32
    }

    /// Returns this cost with what one more robot adds to it: delays combine by their maximum,
    /// since the last to arrive ends the policy, and prices by their sum.
    ///
    /// ```
    /// use iibt_core::inference::{PolicyCost, PrivateCost};
    ///
    /// let robot = |delay| PrivateCost { delay, price: Some(3), is_needed: true };
    /// let cost = PolicyCost { time: 40, ..PolicyCost::FREE };
    /// assert_eq!(cost.with(robot(Some(8))).with(robot(Some(12))).total(), 40 + 12 + 6);
    /// assert!(cost.with(robot(None)).is_impossible);
    /// let spare = PrivateCost { is_needed: false, ..robot(None) };
    /// assert_eq!(cost.with(spare).total(), 43, "it may come as late as it likes");
    /// ```
    #[must_use]
    pub fn with(self, robot: PrivateCost) -> Self {
        let delay = if robot.is_needed { robot.delay } else { Some(0) };
        let Some((delay, price)) = delay.zip(robot.price) else {
            return Self { is_impossible: true, ..self };
        };
        Self { delay: self.delay.max(delay), price: self.price.saturating_add(price), ..self }
    }
}

/// What a joint policy costs one robot, by what only that robot knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrivateCost {
    /// How much later than the policy's end the robot expects to be done; `None` if it cannot be.
    pub delay: Option<Eighths>,
    /// What else the policy costs it; `None` if it cannot follow the policy.
    pub price: Option<Eighths>,
    /// Whether the policy needs the robot's part: whether its delay counts.
    pub is_needed: bool,
}

/// Returns the cheapest of some policies by its place in their order, the first of equals; `None`
/// when none is possible.
///
/// It compares whole numbers: no precision and no rounding changes the choice.
///
/// ```
/// use iibt_core::inference::{PolicyCost, cheapest};
///
/// let costs = [48, 40, 40].map(|time| PolicyCost { time, ..PolicyCost::FREE });
/// assert_eq!(cheapest(costs), Some(1));
/// assert_eq!(cheapest([PolicyCost::IMPOSSIBLE]), None);
/// ```
#[doc(alias = "argmin")]
#[doc(alias = "policy selection")]
pub fn cheapest(costs: impl IntoIterator<Item = PolicyCost>) -> Option<usize> {
    let possible = costs.into_iter().enumerate().filter(|(_, cost)| !cost.is_impossible);
    possible.min_by_key(|(_, cost)| cost.total()).map(|(policy, _)| policy)
}

/// Returns the time that counts as much as some nats at a precision of β nats per tick, nats / β,
/// in eighths of a tick: what a [habit](PolicyCost::habit) -ln E or a missed preference adds to a
/// cost.
///
/// The result is rounded to the nearest eighth and at most [`Eighths::MAX`]. Nats below zero and
/// NaN are worth nothing.
///
/// ```
/// use iibt_core::inference::worth_of_nats;
///
/// assert_eq!(worth_of_nats(-0.25_f32.ln(), 0.5), 22); // 1.386 nats are 2.77 ticks
/// ```
#[doc(alias = "prior over policies")]
#[must_use]
pub fn worth_of_nats(nats: f32, precision: f32) -> Eighths {
    (8.0 * nats / precision + 0.5) as Eighths // saturates, and a NaN becomes zero
}

/// Returns the expectation of a time, in eighths of a tick, over worlds with these probabilities.
///
/// The result is rounded to the nearest eighth and at most [`Eighths::MAX`]. Worlds without a time
/// count as zero, and so do times without a probability.
///
/// ```
/// use iibt_core::inference::expected_time;
///
/// assert_eq!(expected_time(&[0.75, 0.25], &[80, 160]), 100);
/// assert_eq!(expected_time(&[1.0], &[33]), 33);
/// ```
#[must_use]
pub fn expected_time(belief: &[f32], times: &[Eighths]) -> Eighths {
    let expected: f32 = belief.iter().zip(times).map(|(p, &time)| p * f32::from(time)).sum();
    (expected + 0.5) as Eighths // saturates, and a NaN becomes zero
}

/// The posterior over the joint policies of a list, and what each of them costs.
///
/// P(k) ∝ exp(-β x cost(k)), where β is a number of nats per tick. [`choose`](Self::choose) returns
/// the cheapest policy, the first of equals; it compares whole numbers, so all robots that know the
/// same costs choose alike, whatever the precision. Memory is 18 bytes a policy; weighing costs one
/// exponential a policy.
///
/// ```
/// use iibt_core::inference::{PolicyCost, WeighedPolicies};
///
/// let costs = [48, 40, 56].map(|time| PolicyCost { time, ..PolicyCost::FREE });
/// let mut weighed = WeighedPolicies::<4>::new(costs, 1.0)?;
/// let choice = weighed.choose().expect("a policy is possible");
/// assert_eq!(choice.policy, 1);
/// assert!((choice.joint - 0.665).abs() < 1e-3); // 1 / (1 + e^-1 + e^-2)
/// # Ok::<(), iibt_core::inference::OutOfRange>(())
/// ```
#[doc(alias = "posterior over policies")]
#[doc(alias = "softmax")]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WeighedPolicies<const K: usize> {
    costs: Vec<PolicyCost, K>,
    posterior: Vec<f32, K>,
}

impl<const K: usize> WeighedPolicies<K> {
    /// No policies.
    pub const NONE: Self = Self { costs: Vec::new(), posterior: Vec::new() };

    /// Weighs policies by their costs, in the order of the list, with a precision β in nats per
    /// tick.
    ///
    /// A negative precision or NaN counts as zero: all possible policies are then equally probable.
    ///
    /// # Errors
    /// [`OutOfRange`] when there are more than `K` policies.
    pub fn new(costs: impl IntoIterator<Item = PolicyCost>, precision: f32) -> Result<Self, OutOfRange> {
        let mut weighed = Self { costs: Vec::new(), posterior: Vec::new() };
        // A NaN is not larger than zero.
        let beta = if precision > 0.0 { precision.min(f32::MAX) / 8.0 } else { 0.0 };
        for (index, cost) in costs.into_iter().enumerate() {
            let score = if cost.is_impossible { f32::NEG_INFINITY } else { -beta * cost.total() as f32 };
            let too_many = OutOfRange { what: Argument::Policies, index: 0, value: index + 1, limit: K };
            weighed.costs.push(cost).map_err(|_| too_many)?;
            weighed.posterior.push(score).map_err(|_| too_many)?;
        }
        policy::posterior(&mut weighed.posterior, f32::INFINITY);
        Ok(weighed)
    }

    /// Returns the cheapest policy, the first of equals; `None` when none is possible.
    #[must_use]
    pub fn choose(&self) -> Option<Choice> {
        let policy = cheapest(self.costs.iter().copied())?;
        let probability = self.probability(policy);
        Some(Choice { policy, joint: probability, marginal: probability })
    }

    /// Returns the posterior probability of a policy; zero for one that is not in the list.
    #[must_use]
    pub fn probability(&self, policy: usize) -> f32 {
        self.posterior.get(policy).copied().unwrap_or(0.0)
    }

    /// Returns the posterior, in the order of the list. It sums to one, or is all zeros when no
    /// policy is possible.
    #[must_use]
    pub fn posterior(&self) -> &[f32] {
        &self.posterior
    }

    /// Returns the costs, in the order of the list.
    #[must_use]
    pub fn costs(&self) -> &[PolicyCost] {
        &self.costs
    }

    /// Returns the term that speaks most for `policy` and against `other`, with the eighths of a
    /// tick by which the other one is dearer; `None` when no term does.
    ///
    /// ```
    /// use iibt_core::inference::{CostTerm, PolicyCost, WeighedPolicies};
    ///
    /// let near = PolicyCost { time: 40, price: 30, ..PolicyCost::FREE };
    /// let cheap = PolicyCost { time: 48, ..PolicyCost::FREE };
    /// let weighed = WeighedPolicies::<2>::new([near, cheap], 1.0)?;
    /// assert_eq!(weighed.reason(1, 0), Some((CostTerm::Price, 30)));
    /// assert_eq!(weighed.reason(0, 1), Some((CostTerm::Time, 8)));
    /// # Ok::<(), iibt_core::inference::OutOfRange>(())
    /// ```
    #[doc(alias = "explanation")]
    #[must_use]
    pub fn reason(&self, policy: usize, other: usize) -> Option<(CostTerm, Eighths)> {
        let (ours, theirs) = (self.costs.get(policy)?, self.costs.get(other)?);
        let gains = [
            (CostTerm::Time, theirs.time.saturating_sub(ours.time)),
            (CostTerm::Epistemic, ours.epistemic.saturating_sub(theirs.epistemic)),
            (CostTerm::Habit, theirs.habit.saturating_sub(ours.habit)),
            (CostTerm::Delay, theirs.delay.saturating_sub(ours.delay)),
            (CostTerm::Price, theirs.price.saturating_sub(ours.price)),
        ];
        let largest = gains.iter().map(|&(_, gain)| gain).max().filter(|&gain| gain > 0)?;
        gains.into_iter().find(|&(_, gain)| gain == largest)
    }
}

/// A term of a [`PolicyCost`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CostTerm {
    /// The expected time if what is seen changes nothing.
    Time,
    /// What is saved by going on by what is seen.
    Epistemic,
    /// The habit.
    Habit,
    /// The delay of the slowest robot.
    Delay,
    /// The robots' prices.
    Price,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times<const N: usize>(times: [Eighths; N]) -> [PolicyCost; N] {
        times.map(|time| PolicyCost { time, ..PolicyCost::FREE })
    }

    #[test]
    fn equal_policies_are_equally_probable_and_the_first_is_chosen() {
        let weighed = WeighedPolicies::<4>::new(times([8, 8, 9]), 0.0).unwrap();
        assert!(weighed.posterior().iter().all(|p| (p - 1.0 / 3.0).abs() < 1e-6));
        assert_eq!(weighed.choose().map(|choice| choice.policy), Some(0));
        for odd in [f32::NAN, -1.0, f32::INFINITY] {
            let weighed = WeighedPolicies::<4>::new(times([9, 8, 8]), odd).unwrap();
            assert_eq!(weighed.choose().map(|choice| choice.policy), Some(1), "{odd}");
            assert!((weighed.posterior().iter().sum::<f32>() - 1.0).abs() < 1e-6, "{odd}");
        }
    }

    #[test]
    fn every_term_decides_where_the_others_are_equal() {
        let with = |change: fn(&mut PolicyCost)| {
            let mut dear = PolicyCost { time: 1, habit: 1, delay: 1, price: 1, ..PolicyCost::FREE };
            let even = dear;
            change(&mut dear);
            WeighedPolicies::<2>::new([dear, even], 1.0).unwrap().choose().map(|choice| choice.policy)
        };
        assert_eq!(with(|_| ()), Some(0));
        let changes: [fn(&mut PolicyCost); 5] = [
            |cost| cost.time += 1,
            |cost| cost.habit += 1,
            |cost| cost.delay += 1,
            |cost| cost.price += 1,
            |cost| cost.is_impossible = true,
        ];
        assert!(changes.into_iter().all(|change| with(change) == Some(1)));
    }

    #[test]
    fn impossible_policies_have_no_probability_and_are_never_chosen() {
        let [only] = times([Eighths::MAX]);
        let weighed = WeighedPolicies::<3>::new([PolicyCost::IMPOSSIBLE, only], 1.0).unwrap();
        assert_eq!((weighed.posterior(), weighed.choose().unwrap().policy), (&[0.0, 1.0][..], 1));
        let none = WeighedPolicies::<3>::new([PolicyCost::IMPOSSIBLE; 2], 1.0).unwrap();
        assert_eq!((none.posterior(), none.choose()), (&[0.0, 0.0][..], None));
        assert_eq!(WeighedPolicies::<3>::new([], 1.0).unwrap().choose(), None);
    }

    #[test]
    fn more_policies_than_there_is_room_for_are_an_error() {
        let error = OutOfRange { what: Argument::Policies, index: 0, value: 3, limit: 2 };
        assert_eq!(WeighedPolicies::<2>::new(times([1; 3]), 1.0), Err(error));
    }

    #[test]
    fn terms_at_their_limits_do_not_overflow() {
        let most = Eighths::MAX;
        let dear = PolicyCost { time: most, habit: most, delay: most, price: most, ..PolicyCost::FREE };
        let weighed = WeighedPolicies::<2>::new([dear, PolicyCost::FREE], f32::MAX).unwrap();
        assert_eq!((weighed.posterior(), weighed.choose().unwrap().policy), (&[0.0, 1.0][..], 1));
        assert_eq!(expected_time(&[1.0, 1.0], &[most, most]), most);
        assert_eq!(expected_time(&[f32::NAN], &[most]), 0);
        let costly = PrivateCost { delay: Some(most), price: Some(most), is_needed: true };
        assert_eq!(dear.with(costly).with(costly), dear);
        let worth = |nats, precision| worth_of_nats(nats, precision);
        assert_eq!(
            [worth(1.0, 0.0), worth(-1.0, 1.0), worth(0.0, 0.0), worth(1e30, 1.0)],
            [most, 0, 0, most]
        );
    }
}
