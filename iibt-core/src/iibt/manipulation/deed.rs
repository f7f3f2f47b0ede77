//! What a robot can do and be: the four actions, the four states, and the paper's table 5.

use super::mission::Place;
use crate::iibt::rules::{Raise, Rule};
use crate::iibt::{Condition, Literal, Logic};
use crate::inference::Policy;

/// An action, U in the paper; its code is the index of the state that it brings about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Deed {
    /// moveTo(place).
    MoveTo,
    /// pick(object).
    Pick,
    /// place(object).
    Place,
    /// Nothing.
    #[default]
    Idle,
}

/// A semantic state of a robot, s^i in the paper (table 4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum State {
    /// It is where its object is.
    Loc,
    /// It holds its object.
    Hold,
    /// It has placed its object.
    Place,
    /// None of these.
    #[default]
    Free,
}

/// How many states there are, and how many actions.
pub const STATES: usize = 4;

/// How many joint policies there are.
pub const JOINT: usize = STATES * STATES;

/// A joint policy: π with the number 4 a1 + a2, an action of robot 0 and one of robot 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Joint(pub [Deed; 2]);

impl Deed {
    /// All, in the order of their codes.
    pub const ALL: [Self; STATES] = [Self::MoveTo, Self::Pick, Self::Place, Self::Idle];

    /// The action with a code.
    #[must_use]
    pub fn of(code: usize) -> Option<Self> {
        Self::ALL.get(code).copied()
    }

    /// The state that it brings about.
    #[must_use]
    pub const fn brings(self) -> State {
        match self {
            Self::MoveTo => State::Loc,
            Self::Pick => State::Hold,
            Self::Place => State::Place,
            Self::Idle => State::Free,
        }
    }

    /// It as a policy of one step.
    pub(super) fn policy(self) -> Policy {
        let mut policy = Policy::EMPTY;
        // There is room, and the code is below 16.
        let _ = policy.push(self as u8);
        policy
    }

    /// Table 5: what must hold before it is done.
    #[must_use]
    pub const fn precondition(self) -> Condition {
        match self {
            Self::MoveTo => Condition { all: Logic::of(&[TEAMMATE_FREE]), none: Logic::of(&[REACHED]) },
            Self::Pick => {
                Condition { all: Logic::of(&[REACHED, TEAMMATE_FREE]), none: Logic::of(&[HOLDING]) }
            }
            Self::Place => {
                Condition { all: Logic::of(&[REACHED, HOLDING, TEAMMATE_READY]), none: Logic::of(&[PLACED]) }
            }
            Self::Idle => Condition::ALWAYS,
        }
    }
}

impl State {
    /// All, in the order of their codes.
    pub const ALL: [Self; STATES] = [Self::Loc, Self::Hold, Self::Place, Self::Free];

    /// The state with a code.
    #[must_use]
    pub fn of(code: usize) -> Option<Self> {
        Self::ALL.get(code).copied()
    }
}

impl Joint {
    /// The joint policy with a number below [`JOINT`].
    #[must_use]
    pub fn of(number: usize) -> Option<Self> {
        Some(Self([Deed::of(number / STATES)?, Deed::of(number % STATES)?]))
    }

    /// Its number.
    #[must_use]
    pub const fn number(self) -> usize {
        let [first, second] = self.0;
        STATES * first as usize + second as usize
    }

    /// One robot's action.
    #[must_use]
    pub fn deed(self, robot: usize) -> Deed {
        self.0.get(robot).copied().unwrap_or_default()
    }
}

/// IsHolding(object). The first that is looked at: what is not held is fetched before it is brought anywhere.
pub const HOLDING: u8 = 0;
/// IsReached(place): the robot is where the action is done, or where the move leads.
pub const REACHED: u8 = 1;
/// IsPlaced(object).
pub const PLACED: u8 = 2;
/// The teammate is free (the first row of equation 12): it does nothing, and it does not go first.
pub const TEAMMATE_FREE: u8 = 3;
/// The teammate stands at the meeting place and holds what the object is placed on.
pub const TEAMMATE_READY: u8 = 4;

/// f_L: every precondition that is missing is wanted above all else, l = max(C) + 1.
pub const RULES: [Rule; 5] = [
    above_all(REACHED),
    above_all(HOLDING),
    above_all(PLACED),
    above_all(TEAMMATE_FREE),
    above_all(TEAMMATE_READY),
];

const fn above_all(variable: u8) -> Rule {
    Rule { missing: Literal { variable, value: true }, raise: Raise::AboveAll }
}

/// The own state that is evidence for a missing literal. Nothing that the robot can do makes a teammate free or
/// ready, so it wants to be free itself until then.
#[must_use]
pub const fn evidence(missing: Literal) -> State {
    match missing.variable {
        REACHED => State::Loc,
        HOLDING => State::Hold,
        PLACED => State::Place,
        _ => State::Free,
    }
}

/// What the body is told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Command {
    /// The action.
    pub deed: Deed,
    /// Where a move leads, or where the robot takes itself to be.
    pub place: Place,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn the_number_of_a_joint_policy_is_four_times_the_first_action_plus_the_second() {
        for number in 0..JOINT {
            assert_eq!(Joint::of(number).map(Joint::number), Some(number));
        }
        assert_eq!(Joint::of(3), Some(Joint([Deed::MoveTo, Deed::Idle])));
        assert_eq!(Joint::of(13), Some(Joint([Deed::Idle, Deed::Pick])));
        assert_eq!(Joint::of(16), None);
    }

    #[test]
    fn table_5_row_by_row() {
        // Every subset of the five variables, against the table read aloud.
        for bits in 0..32u8 {
            let on: Vec<u8> = (0..5).filter(|variable| bits >> variable & 1 == 1).collect();
            let logic = Logic::of(&on);
            let is = |variable: u8| on.contains(&variable);
            let may = |deed: Deed| deed.precondition().unmet(logic).is_none();
            assert_eq!(may(Deed::MoveTo), !is(REACHED) && is(TEAMMATE_FREE), "{on:?}");
            assert_eq!(may(Deed::Pick), is(REACHED) && !is(HOLDING) && is(TEAMMATE_FREE), "{on:?}");
            let place = is(REACHED) && is(HOLDING) && !is(PLACED) && is(TEAMMATE_READY);
            assert_eq!(may(Deed::Place), place, "{on:?}");
            assert!(may(Deed::Idle));
        }
    }

    #[test]
    fn every_missing_literal_raises_its_evidence_above_all() {
        let raised = |variable| {
            let missing = Literal { variable, value: true };
            let raise = crate::iibt::rules::raise_for(&RULES, missing);
            (evidence(missing), raise.map(|raise| raise.amount(1.0)))
        };
        assert_eq!(raised(REACHED), (State::Loc, Some(2.0)), "equation 11");
        assert_eq!(raised(HOLDING), (State::Hold, Some(2.0)));
        assert_eq!(raised(PLACED), (State::Place, Some(2.0)));
        assert_eq!(raised(TEAMMATE_FREE), (State::Free, Some(2.0)));
        assert_eq!(raised(TEAMMATE_READY), (State::Free, Some(2.0)));
        let unwanted = Literal { variable: REACHED, value: false };
        assert_eq!(crate::iibt::rules::raise_for(&RULES, unwanted), None);
    }
}
