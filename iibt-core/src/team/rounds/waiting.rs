//! What a robot waits for.

use super::super::RobotId;

/// Why a robot does not go on, and which teammate it waits for.
///
/// ```
/// use iibt_core::team::RobotId;
/// use iibt_core::team::rounds::Waiting;
///
/// let waiting = Waiting::Quorum(RobotId(2));
/// assert_eq!(waiting.to_string(), "waiting for robot 2: it is lost, and the others are no quorum");
/// assert_eq!(waiting.robot(), Some(RobotId(2)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Waiting {
    /// The teammate was not heard since this robot started, so it may be anywhere.
    #[error("waiting for robot {}: it was never heard, so it may be anywhere", .0.0)]
    Unheard(RobotId),
    /// The teammate's fact of this round is missing.
    #[error("waiting for robot {}: its fact of this round is missing", .0.0)]
    Fact(RobotId),
    /// The teammate knows the round with another view or other walls.
    #[error("waiting for robot {}: it knows the round with other members or walls", .0.0)]
    Proposal(RobotId),
    /// Two members claim the same place: one of the two messages is outdated.
    #[error("waiting for robot {}: it claims a place that another member claims", .0.0)]
    Overlap(RobotId, RobotId),
    /// The claim of this robot left out is smaller than where it may be.
    #[error("waiting for robot {}: it is left out with less than where it may be", .0.0)]
    Wall(RobotId),
    /// The robot's own list is not ready.
    #[error("working on the list of policies")]
    List,
    /// The teammate's scores are missing.
    #[error("waiting for robot {}: its scores are missing", .0.0)]
    Scores(RobotId),
    /// The teammate has started again since, or has scored other facts.
    #[error("waiting for robot {}: it has started again or scored other facts", .0.0)]
    Outdated(RobotId),
    /// The teammate has not reported that it has left a place that this robot enters after it.
    #[error("waiting for robot {}: it has not left a cell that comes next", .0.0)]
    Order(RobotId),
    /// The teammate is not yet ready for the last move, which all make together.
    #[error("waiting for robot {}: all make the last move together", .0.0)]
    Barrier(RobotId),
    /// The teammate has not reported the end of its path; this robot's own is done.
    #[error("waiting for robot {}: its path is not done", .0.0)]
    Arrival(RobotId),
    /// Every policy is impossible for some member.
    #[error("no policy is possible for every member")]
    Policy,
    /// The other members have left this robot out.
    #[error("left out by the members")]
    Members,
    /// The teammate is lost, and the others are no quorum without it.
    #[error("waiting for robot {}: it is lost, and the others are no quorum", .0.0)]
    Quorum(RobotId),
    /// Another robot has the number of this one, so the teammates cannot tell the two apart.
    #[error("another robot has the number of this one")]
    Twin,
    /// The numbers of rounds are used up.
    #[error("no numbers of rounds are left")]
    Rounds,
}

impl Waiting {
    /// Whether all members follow one plan, and the robot waits for another's moves in it.
    #[must_use]
    pub const fn is_in_plan(self) -> bool {
        matches!(self, Self::Order(_) | Self::Barrier(_) | Self::Arrival(_))
    }

    /// Whether the present round does not end it: it is worth a line in a log.
    #[must_use]
    pub const fn outlasts_round(self) -> bool {
        matches!(
            self,
            Self::Unheard(_) | Self::Policy | Self::Members | Self::Quorum(_) | Self::Twin | Self::Rounds
        )
    }

    /// The teammate that the robot waits for.
    #[must_use]
    pub const fn robot(self) -> Option<RobotId> {
        match self {
            Self::Unheard(robot)
            | Self::Fact(robot)
            | Self::Proposal(robot)
            | Self::Overlap(robot, _)
            | Self::Wall(robot)
            | Self::Scores(robot)
            | Self::Outdated(robot)
            | Self::Order(robot)
            | Self::Barrier(robot)
            | Self::Arrival(robot)
            | Self::Quorum(robot) => Some(robot),
            Self::List | Self::Policy | Self::Members | Self::Twin | Self::Rounds => None,
        }
    }
}
