//! The choice that every member makes alike from the list and all scores.

use super::super::RobotId;
use super::{JointPolicies, Score};

/// What a policy costs the team, in 1/8 tick; `None` if it is impossible for a member.
///
/// The sum of the [cost](JointPolicies::cost) and the [habit](JointPolicies::habit) that all know,
/// the largest delay among the members that the policy needs, and the prices of all members. A
/// score that is missing is [impossible](Score::CANNOT).
pub fn total<'a, L: JointPolicies>(
    list: &L,
    policy: usize,
    members: impl Iterator<Item = (RobotId, &'a [Score])>,
) -> Option<u32> {
    let mut latest = 0;
    let mut sum = u32::from(list.cost(policy)).saturating_add(list.habit(policy).into());
    for (robot, scores) in members {
        let score = scores.get(policy).copied().unwrap_or(Score::CANNOT);
        let delay = if list.needs(policy, robot) { score.delay } else { 0 };
        if delay == Score::IMPOSSIBLE || score.price == Score::IMPOSSIBLE {
            return None;
        }
        latest = delay.max(latest);
        sum = sum.saturating_add(score.price.into());
    }
    Some(sum.saturating_add(latest.into()))
}

/// The policy with the least [total]: the first of equal ones; `None` if all are impossible.
///
/// Costs one pass over the members for each policy.
///
/// ```
/// use iibt_core::team::RobotId;
/// use iibt_core::team::rounds::{JointPolicies, Score, choose};
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
/// }
///
/// let late = |delay| [Score { delay, price: 0 }; 2];
/// let decide = |first: [Score; 2], second: [Score; 2]| {
///     choose(&Tables, [(RobotId(0), &first[..]), (RobotId(1), &second[..])].into_iter())
/// };
/// assert_eq!(decide(late(0), late(32)), Some(0), "72 against 72: the first");
/// assert_eq!(decide(late(0), late(33)), Some(1), "the second robot would be too late");
/// assert_eq!(decide([Score::CANNOT; 2], late(0)), None);
/// ```
#[doc(alias = "argmin")]
#[doc(alias = "policy selection")]
pub fn choose<'a, L: JointPolicies>(
    list: &L,
    members: impl Iterator<Item = (RobotId, &'a [Score])> + Clone,
) -> Option<usize> {
    let totals = (0..list.len()).filter_map(|policy| Some((total(list, policy, members.clone())?, policy)));
    totals.min().map(|(_, policy)| policy)
}
