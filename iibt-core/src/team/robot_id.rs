//! The robots of a team by number.

use serde::{Deserialize, Serialize};

/// The largest team.
pub const MAX_TEAM: usize = 8;

/// A robot by its place in the team, from zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RobotId(pub u8);

impl RobotId {
    /// The place as an index into tables with one entry per robot.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// A robot in a team of a known size.
///
/// ```
/// use iibt_core::team::{Member, MemberError, RobotId};
///
/// let second = Member::new(RobotId(1), 3)?;
/// assert_eq!((second.robot(), second.team()), (RobotId(1), 3));
/// assert_eq!(Member::new(RobotId(3), 3), Err(MemberError::NotInTeam));
/// assert_eq!(Member::new(RobotId(0), 9), Err(MemberError::TeamTooLarge));
/// # Ok::<(), MemberError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Member {
    robot: RobotId,
    team: u8,
}

/// The reason why a team has no such member.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MemberError {
    /// The team is larger than [`MAX_TEAM`].
    #[error("a team has at most {MAX_TEAM} robots")]
    TeamTooLarge,
    /// The robot's number is not below the size of its team.
    #[error("the robot's number is not below the size of its team")]
    NotInTeam,
}

impl Member {
    /// The only robot of its team.
    pub(crate) const ALONE: Self = Self { robot: RobotId(0), team: 1 };

    /// Robot `robot` in a team of `team` robots, itself included.
    ///
    /// # Errors
    /// [`MemberError`] when the team is too large or the robot not in it.
    pub const fn new(robot: RobotId, team: usize) -> Result<Self, MemberError> {
        if team > MAX_TEAM {
            return Err(MemberError::TeamTooLarge);
        }
        if robot.index() >= team {
            return Err(MemberError::NotInTeam);
        }
        Ok(Self { robot, team: team as u8 })
    }

    /// The robot.
    #[must_use]
    pub const fn robot(self) -> RobotId {
        self.robot
    }

    /// The number of robots in the team, this one included.
    #[must_use]
    pub const fn team(self) -> usize {
        self.team as usize
    }
}
