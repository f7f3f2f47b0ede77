//! The list that all members derive from the facts of a round.

use super::super::RobotId;
use super::{Claim, Score};

/// The list of joint policies that every member of a round derives from the same facts.
///
/// Everything here must be the same in every robot: a function of the facts, the view and the walls
/// alone. What only one robot knows goes into its [`Scores`](super::Scores).
///
/// A robot's path through a policy is a sequence of steps, counted from zero. A path that has ended
/// claims the place where it ends.
///
/// For the rounds to be safe, the paths of a policy must share no place in any step, nor swap two;
/// for them to be live, they must not rotate either. No path may enter a wall.
pub trait JointPolicies {
    /// What the robots of the task share.
    type Claim: Claim;

    /// The number of policies.
    fn len(&self) -> usize;

    /// Whether the list has no policy.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What the team pays for a policy, by what all know: expected ticks J, in 1/8 tick.
    fn cost(&self, policy: usize) -> u16;

    /// What of that the team saves because it goes on by what it sees on the way, in 1/8 tick.
    fn epistemic(&self, _policy: usize) -> u16 {
        0
    }

    /// What the team's habits add to that, -ln E / beta in 1/8 tick.
    fn habit(&self, _policy: usize) -> u16 {
        0
    }

    /// Whether the team needs the robot's arrival for the policy: whether its delay counts.
    fn needs(&self, _policy: usize, _robot: RobotId) -> bool {
        true
    }

    /// What the robot's path occupies from a step on, that step and the way to the next included.
    fn claim(&self, policy: usize, robot: RobotId, step: u16) -> Self::Claim;

    /// The number of steps up to the robot's last move; zero if it stands.
    fn moves(&self, policy: usize, robot: RobotId) -> u16;

    /// Whether the robot may make its step after `step`, if a teammate has reported `reported`
    /// steps: whether that has left what the step enters, as far as it is there earlier.
    ///
    /// Waiting enters nothing.
    fn is_clear(&self, policy: usize, robot: RobotId, step: u16, teammate: RobotId, reported: u16) -> bool;

    /// Whether the robots wait for each other before their last moves, to arrive together.
    fn is_together(&self, _policy: usize) -> bool {
        false
    }

    /// The policy that all choose, by the scores of all members in the order of their numbers;
    /// `None` if each is impossible for some member. Inference decides that:
    /// [`iibt::cheapest_policy`](crate::iibt::cheapest_policy).
    fn choose<'s>(&self, members: impl Iterator<Item = (RobotId, &'s [Score])> + Clone) -> Option<usize>;
}
