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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Waiting {
    /// The teammate was not heard since this robot started, so it may be anywhere.
    Unheard(RobotId),
    /// The teammate's fact of this round is missing.
    Fact(RobotId),
    /// The teammate knows the round with another view or other walls.
    Proposal(RobotId),
    /// Two members claim the same place: one of the two messages is outdated.
    Overlap(RobotId, RobotId),
    /// The claim of this robot left out is smaller than where it may be.
    Wall(RobotId),
    /// The robot's own list is not ready.
    List,
    /// The teammate's scores are missing.
    Scores(RobotId),
    /// The teammate has started again since, or has scored other facts.
    Outdated(RobotId),
    /// The teammate has not reported that it has left a place that this robot enters after it.
    Order(RobotId),
    /// The teammate is not yet ready for the last move, which all make together.
    Barrier(RobotId),
    /// The teammate has not reported the end of its path; this robot's own is done.
    Arrival(RobotId),
    /// Every policy is impossible for some member.
    Policy,
    /// The other members have left this robot out.
    Members,
    /// The teammate is lost, and the others are no quorum without it.
    Quorum(RobotId),
    /// The numbers of rounds are used up.
    Rounds,
}

impl Waiting {
    /// Whether all members follow one plan, and the robot waits for another's moves in it.
    #[must_use]
    pub const fn is_in_plan(self) -> bool {
        matches!(self, Self::Order(_) | Self::Barrier(_) | Self::Arrival(_))
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
            Self::List | Self::Policy | Self::Members | Self::Rounds => None,
        }
    }
}

impl core::error::Error for Waiting {}

impl core::fmt::Display for Waiting {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if let Some(RobotId(robot)) = self.robot() {
            write!(f, "waiting for robot {robot}: ")?;
        }
        f.write_str(match self {
            Self::Unheard(_) => "it was never heard, so it may be anywhere",
            Self::Fact(_) => "its fact of this round is missing",
            Self::Proposal(_) => "it knows the round with other members or walls",
            Self::Overlap(..) => "it claims a place that another member claims",
            Self::Wall(_) => "it is left out with less than where it may be",
            Self::List => "working on the list of policies",
            Self::Scores(_) => "its scores are missing",
            Self::Outdated(_) => "it has started again or scored other facts",
            Self::Order(_) => "it has not left a cell that comes next",
            Self::Barrier(_) => "all make the last move together",
            Self::Arrival(_) => "its path is not done",
            Self::Policy => "no policy is possible for every member",
            Self::Members => "left out by the members",
            Self::Quorum(_) => "it is lost, and the others are no quorum",
            Self::Rounds => "no numbers of rounds are left",
        })
    }
}
