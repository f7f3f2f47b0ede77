//! The weighing of a round's joint policies: what all know of each, and the scores of all members.

use crate::inference::{PolicyCost, PrivateCost, WeighedPolicies, cheapest};
use crate::team::RobotId;
use crate::team::rounds::{JointPolicies, Score};

/// The policy that costs the team least, the first of equal ones; `None` if each is impossible for
/// some member: what a list [chooses](JointPolicies::choose).
///
/// A score that is missing is [impossible](Score::CANNOT). Costs one pass over the members for each
/// policy.
///
/// ```
/// use iibt_core::iibt::cheapest_policy;
/// use iibt_core::team::RobotId;
/// use iibt_core::team::rounds::{JointPolicies, Score};
///
/// /// Two tables: the second takes four ticks longer, but needs the first robot only.
/// struct Tables;
///
/// impl JointPolicies for Tables {
///     type Claim = ();
///
///     fn len(&self) -> usize {
///         2
///     }
///     fn cost(&self, policy: usize) -> u16 {
///         [40, 72][policy]
///     }
///     fn needs(&self, policy: usize, robot: RobotId) -> bool {
///         policy == 0 || robot == RobotId(0)
///     }
///     fn claim(&self, _: usize, _: RobotId, _: u16) {}
///     fn moves(&self, _: usize, _: RobotId) -> u16 {
///         1
///     }
///     fn is_clear(&self, _: usize, _: RobotId, _: u16, _: RobotId, _: u16) -> bool {
///         true
///     }
///     fn choose<'s>(&self, members: impl Iterator<Item = (RobotId, &'s [Score])> + Clone) -> Option<usize> {
///         cheapest_policy(self, members)
///     }
/// }
///
/// let late = |delay| [Score { delay, price: 0 }; 2];
/// let decide = |first: [Score; 2], second: [Score; 2]| {
///     Tables.choose([(RobotId(0), &first[..]), (RobotId(1), &second[..])].into_iter())
/// };
/// assert_eq!(decide(late(0), late(32)), Some(0), "72 against 72: the first");
/// assert_eq!(decide(late(0), late(33)), Some(1), "the second robot would be too late");
/// assert_eq!(decide([Score::CANNOT; 2], late(0)), None);
/// ```
#[must_use]
pub fn cheapest_policy<'s, L: JointPolicies>(
    list: &L,
    members: impl Iterator<Item = (RobotId, &'s [Score])> + Clone,
) -> Option<usize> {
    cheapest(costs(list, members))
}

/// The posterior over the first `K` policies of a list, and what each costs the team, with a
/// precision in nats per tick. Its choice is that of [`cheapest_policy`].
#[must_use]
pub fn weigh<'s, L: JointPolicies, const K: usize>(
    list: &L,
    members: impl Iterator<Item = (RobotId, &'s [Score])> + Clone,
    precision: f32,
) -> WeighedPolicies<K> {
    // There is room: no more than K.
    WeighedPolicies::new(costs(list, members).take(K), precision).unwrap_or_default()
}

fn costs<'s, L: JointPolicies>(
    list: &L,
    members: impl Iterator<Item = (RobotId, &'s [Score])> + Clone,
) -> impl Iterator<Item = PolicyCost> {
    (0..list.len()).map(move |policy| {
        let (time, epistemic, habit) = (list.cost(policy), list.epistemic(policy), list.habit(policy));
        let known = PolicyCost { time, epistemic, habit, ..PolicyCost::FREE };
        let private = members.clone().map(|(robot, scores)| {
            let score = scores.get(policy).copied().unwrap_or(Score::CANNOT);
            private(score, list.needs(policy, robot))
        });
        private.fold(known, PolicyCost::with)
    })
}

fn private(score: Score, is_needed: bool) -> PrivateCost {
    let finite = |value: u8| (value != Score::IMPOSSIBLE).then(|| value.into());
    PrivateCost { delay: finite(score.delay), price: finite(score.price), is_needed }
}
