//! The message of navigating robots: position, choice and progress.

use crate::grid::{Cell, Move, Path};
use crate::team::{Envelope, Invalid, Message};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The most newly found obstacles one intention reports.
pub const MAX_HAZARDS: usize = 4;

/// An intention with its sender and number.
pub type Said = Envelope<Intention>;

/// The number of a joint decision; a larger number supersedes a smaller one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Round(pub u16);

/// What a robot is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Stage {
    /// It stands still and has not chosen yet: the path is only where it stands.
    #[default]
    Deciding,
    /// It has chosen: the path is its policy of this round.
    Announced,
    /// It knows the path of every teammate in this round and follows its own.
    Agreed,
    /// It stands on its goal.
    Arrived,
    /// It drives alone, to charge or to step aside, and takes no part in decisions.
    Away,
}

/// One robot's state and choice, as announced to its teammates at every tick.
///
/// Every intention is complete: a receiver of the newest one needs none of those before it.
#[doc(alias = "plan sharing")]
#[doc(alias = "commitment")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Intention {
    /// The joint decision this belongs to.
    pub round: Round,
    /// What the sender is doing.
    pub stage: Stage,
    /// The digest of the joint plan the sender has agreed to, or of a teammate's request that it
    /// has granted; else zero.
    pub plan: u32,
    /// The goal of the chosen policy.
    pub goal: Option<Cell>,
    /// The chosen policy as a path, from where the sender stood when the round began.
    pub path: Path,
    /// The number of moves of the path that are done: at most its length.
    pub step: u8,
    /// The posterior probability of the choice, 0 to 1.
    pub probability: f32,
    /// Obstacles the sender found that the map does not show, newest last.
    pub hazards: Vec<Cell, MAX_HAZARDS>,
}

impl Message for Intention {
    const SCHEMA: &'static str = "round u16; stage Deciding Announced Agreed Arrived Away; plan u32; \
        goal option cell u16; path start u16 moves count u8 nibbles Up Down Left Right Wait; step u8; \
        probability f32; hazards sequence cell u16";

    const MAX_BYTES: usize = 67;

    fn validate(&self) -> Result<(), Invalid> {
        if self.path.actions.iter().any(|code| Move::from_code(code).is_none()) {
            return Err(Self::NO_MOVE);
        }
        if usize::from(self.step) > self.path.len() {
            return Err(Self::STEP_BEYOND_PATH);
        }
        if !(0.0..=1.0).contains(&self.probability) {
            return Err(Self::NO_PROBABILITY);
        }
        Ok(())
    }

    fn takes_part(&self) -> bool {
        self.stage != Stage::Away
    }
}

impl Intention {
    /// An action code of the path is no [`Move`].
    pub const NO_MOVE: Invalid = Invalid("an action code of the path is no move");
    /// More moves are done than the path has.
    pub const STEP_BEYOND_PATH: Invalid = Invalid("more moves are done than the path has");
    /// The probability is not a number from 0 to 1.
    pub const NO_PROBABILITY: Invalid = Invalid("the probability is not a number from 0 to 1");

    /// Returns whether the start of the path, the goal and the hazards are cells of a map with
    /// `cells` cells.
    ///
    /// Decoding cannot check this, because a frame does not carry the map. Check it before drawing
    /// an intention on a map.
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
            round: Round(2),
            stage: Stage::Deciding,
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
        assert_eq!(with(|i| i.path.actions.push(5).unwrap()), Err(Intention::NO_MOVE));
        assert_eq!(with(|i| i.step = 1), Err(Intention::STEP_BEYOND_PATH));
        for probability in [f32::NAN, f32::INFINITY, -f32::MIN_POSITIVE, 1.000_000_1] {
            let intention = Intention { probability, ..standing() };
            assert_eq!(intention.validate(), Err(Intention::NO_PROBABILITY), "{probability}");
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
