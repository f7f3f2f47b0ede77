//! The message that robots exchange: where a robot stands, what it has chosen, and how far it is.

use super::Stamp;
use crate::grid::{Cell, Move, Path};
use crate::time::Instant;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The largest team.
pub const MAX_TEAM: usize = 8;

/// The most newly found obstacles one intention reports.
pub const MAX_HAZARDS: usize = 4;

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

/// The number of a joint decision; a larger number supersedes a smaller one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Round(pub u16);

/// What a robot is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Status {
    /// It stands still and has not chosen yet: the path is only where it stands.
    #[default]
    Deciding,
    /// It has chosen: the path is its policy of this round.
    Announced,
    /// It knows the path of every teammate in this round and follows its own.
    Agreed,
    /// It is where it wanted to be.
    Arrived,
    /// It looks after itself (charging) and takes no part.
    Away,
}

/// One robot's state and choice, as announced to its teammates at every tick.
///
/// Every intention is complete: whoever hears the newest one needs none of those before it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Intention {
    /// Who says so: below [`MAX_TEAM`].
    pub robot: RobotId,
    /// Counts the sender's starts, so that numbers from before a restart are told apart.
    pub epoch: u32,
    /// Counts the sender's frames in this epoch.
    pub sequence: u32,
    /// The sender's clock when it sent this.
    pub tick: Instant,
    /// The joint decision this belongs to.
    pub round: Round,
    /// What the sender is doing.
    pub status: Status,
    /// The digest of the joint plan the sender has agreed to, or of a teammate's leave that it has acknowledged; else
    /// zero.
    pub plan: u32,
    /// The goal of the chosen policy.
    pub goal: Option<Cell>,
    /// The chosen policy as a path, from where the sender stood when the round began.
    pub path: Path,
    /// How many moves of the path are done: at most its length.
    pub step: u8,
    /// The posterior probability of the choice, 0 to 1.
    pub probability: f32,
    /// Obstacles the sender found that the map does not show, newest last.
    pub hazards: Vec<Cell, MAX_HAZARDS>,
}

/// Which value of an intention no robot can mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Invalid {
    /// The robot is not below [`MAX_TEAM`].
    Robot,
    /// An action code of the path is no [`Move`].
    Move,
    /// More moves are done than the path has.
    Step,
    /// The probability is not a number from 0 to 1.
    Probability,
}

impl core::fmt::Display for Invalid {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Robot => "the robot's number is not below the largest team",
            Self::Move => "an action code of the path is no move",
            Self::Step => "more moves are done than the path has",
            Self::Probability => "the probability is not a number from 0 to 1",
        })
    }
}

impl core::error::Error for Invalid {}

impl Intention {
    /// Where this intention stands in the order of everything its sender has said.
    #[must_use]
    pub const fn stamp(&self) -> Stamp {
        Stamp { epoch: self.epoch, sequence: self.sequence }
    }

    /// Whether every value is one that a robot can mean. Frames carry no other intentions.
    ///
    /// # Errors
    /// The first value that is out of its range, in the order of [`Invalid`].
    pub fn validate(&self) -> Result<(), Invalid> {
        if self.robot.index() >= MAX_TEAM {
            return Err(Invalid::Robot);
        }
        if self.path.actions.iter().any(|code| Move::from_code(code).is_none()) {
            return Err(Invalid::Move);
        }
        if usize::from(self.step) > self.path.len() {
            return Err(Invalid::Step);
        }
        if !(0.0..=1.0).contains(&self.probability) {
            return Err(Invalid::Probability);
        }
        Ok(())
    }

    /// Whether the start of the path, the goal and the hazards are cells of a map with `cells` cells.
    ///
    /// A frame cannot tell, as it does not carry the map; whoever draws an intention on a map asks first.
    #[must_use]
    pub fn fits(&self, cells: usize) -> bool {
        let named = [self.path.start].into_iter().chain(self.goal).chain(self.hazards.iter().copied());
        named.into_iter().all(|cell| cell.index() < cells)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn standing() -> Intention {
        Intention {
            robot: RobotId(1),
            epoch: 3,
            sequence: 9,
            tick: Instant(40),
            round: Round(2),
            status: Status::Deciding,
            plan: 0,
            goal: None,
            path: Path::at(Cell(5)),
            step: 0,
            probability: 1.0,
            hazards: Vec::new(),
        }
    }

    #[test]
    fn names_the_value_that_is_out_of_range() {
        let with = |change: fn(&mut Intention)| {
            let mut intention = standing();
            change(&mut intention);
            intention.validate()
        };
        assert_eq!(with(|_| ()), Ok(()));
        assert_eq!(with(|i| i.robot = RobotId(MAX_TEAM as u8 - 1)), Ok(()));
        assert_eq!(with(|i| i.robot = RobotId(MAX_TEAM as u8)), Err(Invalid::Robot));
        assert_eq!(with(|i| i.path.actions.push(5).unwrap()), Err(Invalid::Move));
        assert_eq!(with(|i| i.step = 1), Err(Invalid::Step));
        for probability in [f32::NAN, f32::INFINITY, -f32::MIN_POSITIVE, 1.000_000_1] {
            let intention = Intention { probability, ..standing() };
            assert_eq!(intention.validate(), Err(Invalid::Probability), "{probability}");
        }
    }

    #[test]
    fn fits_a_map_that_has_every_cell_it_names() {
        let mut intention = standing();
        assert!(intention.fits(6) && !intention.fits(5));
        intention.goal = Some(Cell(6));
        assert!(intention.fits(7) && !intention.fits(6));
        intention.hazards.push(Cell(u16::MAX)).unwrap();
        assert!(intention.fits(65536) && !intention.fits(65535));
    }
}
