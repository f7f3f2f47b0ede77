//! Which robots of a team decide together.

use super::super::{MAX_TEAM, RobotId};
use serde::{Deserialize, Serialize};

/// The members of a round: a set of robots, one bit each.
///
/// Who is not in the view is left out: its claim is a wall to the others, and it stands.
///
/// ```
/// use iibt_core::team::RobotId;
/// use iibt_core::team::rounds::View;
///
/// let view = View::full(3).without(RobotId(1));
/// assert!(view.iter().eq([RobotId(0), RobotId(2)]));
/// assert!(view.is_quorum(3), "two of three");
/// assert!(View::full(1).is_quorum(2), "half of the team, with robot 0");
/// assert!(!View::full(2).without(RobotId(0)).is_quorum(2), "the other half");
/// ```
#[doc(alias = "membership")]
#[doc(alias = "group view")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct View(u8);

impl View {
    /// The view without members.
    pub const EMPTY: Self = Self(0);

    /// The view of a whole team of `team` robots; of [`MAX_TEAM`] if there are more.
    #[must_use]
    pub const fn full(team: usize) -> Self {
        let spare = MAX_TEAM.saturating_sub(team) as u32;
        Self(if spare < u8::BITS { u8::MAX >> spare } else { 0 })
    }

    /// Whether the robot is a member.
    #[must_use]
    pub const fn contains(self, robot: RobotId) -> bool {
        self.0 & bit(robot) != 0
    }

    /// This view and the robot; unchanged for a robot that no team has.
    #[must_use]
    pub const fn with(self, robot: RobotId) -> Self {
        Self(self.0 | bit(robot))
    }

    /// This view without the robot.
    #[must_use]
    pub const fn without(self, robot: RobotId) -> Self {
        Self(self.0 & !bit(robot))
    }

    /// The robots of either view.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The robots of this view that are not in the other.
    #[must_use]
    pub const fn difference(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// The number of members.
    #[must_use]
    pub const fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Whether there is no member.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The members in the order of their numbers.
    pub fn iter(self) -> impl Iterator<Item = RobotId> + Clone {
        (0..MAX_TEAM as u8).map(RobotId).filter(move |&robot| self.contains(robot))
    }

    /// The place of a member in the order of the numbers, from zero; `None` for another robot.
    #[must_use]
    pub const fn place(self, robot: RobotId) -> Option<usize> {
        let bit = bit(robot);
        if self.0 & bit == 0 { None } else { Some((self.0 & bit.wrapping_sub(1)).count_ones() as usize) }
    }

    /// Whether the members may decide without the others: more than half of a team of `team`
    /// robots, or half of it with robot 0.
    ///
    /// Any two quorums have a member in common.
    #[doc(alias = "majority")]
    #[must_use]
    pub const fn is_quorum(self, team: usize) -> bool {
        let twice = self.len() * 2;
        twice > team || (twice == team && self.contains(RobotId(0)))
    }

    /// Whether no member is outside of a team of `team` robots.
    #[must_use]
    pub const fn fits(self, team: usize) -> bool {
        self.difference(Self::full(team)).is_empty()
    }
}

impl FromIterator<RobotId> for View {
    fn from_iter<I: IntoIterator<Item = RobotId>>(robots: I) -> Self {
        robots.into_iter().fold(Self::EMPTY, Self::with)
    }
}

const fn bit(robot: RobotId) -> u8 {
    if robot.index() < MAX_TEAM { 1 << robot.0 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_two_quorums_meet() {
        for team in 1..=MAX_TEAM {
            let quorums = || (0..=u8::MAX).map(View).filter(|view| view.fits(team) && view.is_quorum(team));
            for one in quorums() {
                assert!(
                    one.len() * 2 >= team && quorums().all(|other| one.0 & other.0 != 0),
                    "{one:?} of {team}"
                );
            }
        }
    }

    #[test]
    fn holds_the_robots_that_were_added() {
        let view: View = [RobotId(7), RobotId(0), RobotId(8), RobotId(255)].into_iter().collect();
        assert!(view.iter().eq([RobotId(0), RobotId(7)]));
        assert_eq!([0, 1, 7, 8].map(|robot| view.place(RobotId(robot))), [Some(0), None, Some(1), None]);
        assert_eq!((view.len(), view.without(RobotId(7)), view.without(RobotId(9))), (2, View(1), view));
        assert!(!view.contains(RobotId(8)) && !view.fits(7) && view.fits(8));
        assert_eq!((View::full(0), View::full(8), View::full(99)), (View::EMPTY, View(255), View(255)));
    }
}
