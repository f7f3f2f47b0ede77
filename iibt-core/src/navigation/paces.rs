//! The paces of the robots: steps of a plan for one move.

use crate::team::RobotId;
use core::num::NonZero;

/// The most steps that one move takes.
pub const MAX_PACE: u8 = 8;

/// The number of steps of a plan that one move of each robot takes, in the order of their numbers;
/// 1 for a robot without an entry.
///
/// A step of a plan takes at least a tick, so a drive that is busy for `d` ticks with one move has
/// the pace `d`.
///
/// ```
/// use iibt_core::navigation::Paces;
/// use iibt_core::team::RobotId;
///
/// let paces = Paces::new(&[1, 3]); // robot 1 is slow
/// assert_eq!(paces.of(RobotId(1)).get(), 3);
/// assert_eq!(paces.of(RobotId(2)).get(), 1); // without an entry
/// assert!(paces.are_sound() && !Paces::new(&[0]).are_sound());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Paces<'a>(&'a [u8]);

impl<'a> Paces<'a> {
    /// Every robot makes a move in a step.
    pub const EVEN: Paces<'static> = Paces(&[]);

    /// Creates paces from a list.
    #[must_use]
    pub const fn new(paces: &'a [u8]) -> Self {
        Self(paces)
    }

    /// Returns the number of steps that one move of a robot takes: at least one.
    #[must_use]
    pub fn of(self, robot: RobotId) -> NonZero<usize> {
        let pace = self.0.get(robot.index()).copied().unwrap_or(1);
        NonZero::new(usize::from(pace)).unwrap_or(NonZero::<usize>::MIN)
    }

    /// Returns whether every pace is from 1 to [`MAX_PACE`].
    #[must_use]
    pub fn are_sound(self) -> bool {
        self.0.iter().all(|pace| (1..=MAX_PACE).contains(pace))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_without_a_pace_makes_a_move_in_a_step() {
        let paces = Paces::new(&[3, 0]);
        assert_eq!([0, 1, 2].map(|robot| paces.of(RobotId(robot)).get()), [3, 1, 1]);
        assert!(!paces.are_sound() && Paces::EVEN.are_sound() && Paces::new(&[1, MAX_PACE]).are_sound());
        assert!(!Paces::new(&[MAX_PACE + 1]).are_sound());
    }
}
