//! Why a joint policy was chosen from a list, and not the next best.

use super::{CostTerm, Eighths, PolicyCost, WeighedPolicies, cheapest};

/// A joint policy of a list with its probability and its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankedPolicy {
    /// Its place in the list, from zero.
    pub policy: usize,
    /// Its posterior probability.
    pub probability: f32,
    /// What it costs, term by term.
    pub cost: PolicyCost,
}

/// The explanation of a choice from a list: the chosen policy, the next best one, and the term that
/// sets that back most.
///
/// ```
/// use iibt_core::inference::{CostTerm, PolicyCost, WeighedPolicies};
///
/// let late = PolicyCost { time: 40, delay: 24, ..PolicyCost::FREE };
/// let costs = [late, PolicyCost { time: 48, ..PolicyCost::FREE }, PolicyCost::IMPOSSIBLE];
/// let why = WeighedPolicies::<4>::new(costs, 1.0)?.explain().expect("two are possible");
/// assert_eq!((why.policies, why.chosen.policy, why.chosen.cost.total()), (3, 1, 48));
/// assert_eq!(why.next.map(|next| next.policy), Some(0));
/// assert_eq!((why.lead(), why.decided_by), (16, Some((CostTerm::Delay, 24))));
/// # Ok::<(), iibt_core::inference::OutOfRange>(())
/// ```
#[doc(alias = "interpretability")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostExplanation {
    /// The number of policies in the list.
    pub policies: usize,
    /// The chosen policy.
    pub chosen: RankedPolicy,
    /// The cheapest of the others; `None` when no other is possible.
    pub next: Option<RankedPolicy>,
    /// The term by which the next best is dearer most, with the eighths of a tick; `None` when it
    /// costs as much and only comes later in the list.
    pub decided_by: Option<(CostTerm, Eighths)>,
}

impl CostExplanation {
    /// Returns by how much the next best policy is dearer, in eighths of a tick; zero without one.
    #[must_use]
    pub const fn lead(&self) -> u32 {
        match self.next {
            Some(next) => next.cost.total().saturating_sub(self.chosen.cost.total()),
            None => 0,
        }
    }
}

impl<const K: usize> WeighedPolicies<K> {
    /// Explains the [choice](Self::choose); `None` when no policy is possible. Costs two passes
    /// over the list.
    #[must_use]
    pub fn explain(&self) -> Option<CostExplanation> {
        let chosen = cheapest(self.costs.iter().copied())?;
        let costs = self.costs.iter().enumerate();
        let others =
            costs.map(|(policy, &cost)| if policy == chosen { PolicyCost::IMPOSSIBLE } else { cost });
        let next = cheapest(others);
        Some(CostExplanation {
            policies: self.costs.len(),
            chosen: self.ranked(chosen)?,
            next: next.and_then(|next| self.ranked(next)),
            decided_by: next.and_then(|next| self.reason(chosen, next)),
        })
    }

    fn ranked(&self, policy: usize) -> Option<RankedPolicy> {
        let cost = *self.costs.get(policy)?;
        Some(RankedPolicy { policy, probability: self.probability(policy), cost })
    }
}

/// `policy 1 with 0.665 at 48/8 ticks (time 44, epistemic 4, habit 0, delay 8, price 0)`.
#[cfg(feature = "defmt")]
impl defmt::Format for RankedPolicy {
    fn format(&self, f: defmt::Formatter<'_>) {
        let PolicyCost { time, epistemic, habit, delay, price, .. } = self.cost;
        defmt::write!(
            f,
            "policy {=usize} with {=f32} at {=u32}/8 ticks (time {=u16}, epistemic {=u16}, habit {=u16}, delay {=u16}, price {=u16})",
            self.policy,
            self.probability,
            self.cost.total(),
            time,
            epistemic,
            habit,
            delay,
            price
        );
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for CostExplanation {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "{} of {=usize}; ", self.chosen, self.policies);
        match (self.next, self.decided_by) {
            (None, _) => defmt::write!(f, "no other is possible"),
            (Some(next), Some((term, by))) => {
                let lead = self.lead();
                defmt::write!(f, "next {}, dearer by {=u32}, most by {} ({=u16})", next, lead, term, by);
            }
            (Some(next), None) => defmt::write!(f, "next {}, as dear and later in the list", next),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn explained(costs: &[PolicyCost]) -> Option<CostExplanation> {
        WeighedPolicies::<4>::new(costs.iter().copied(), 1.0).unwrap().explain()
    }

    #[test]
    fn the_next_best_is_the_cheapest_of_the_others() {
        let of = |time| PolicyCost { time, ..PolicyCost::FREE };
        let why = explained(&[of(50), of(41), of(40), of(60)]).unwrap();
        assert_eq!((why.chosen.policy, why.next.unwrap().policy, why.lead()), (2, 1, 1));
        assert_eq!(why.decided_by, Some((CostTerm::Time, 1)));
        assert!(why.chosen.probability > why.next.unwrap().probability);
        let even = explained(&[of(40), of(40)]).unwrap();
        assert_eq!((even.chosen.policy, even.next.unwrap().policy, even.lead()), (0, 1, 0));
        assert_eq!(even.decided_by, None, "it only comes later in the list");
    }

    #[test]
    fn a_choice_without_an_alternative_has_no_next_best() {
        let why = explained(&[PolicyCost::IMPOSSIBLE, PolicyCost::FREE]).unwrap();
        assert_eq!((why.chosen.policy, why.next, why.lead(), why.decided_by), (1, None, 0, None));
        assert_eq!(explained(&[PolicyCost::IMPOSSIBLE]), None);
        assert_eq!(explained(&[]), None);
    }
}
