//! Logic variables of a task, and the preconditions of its policies.

/// A set of up to 16 logic variables that are true; the others are false.
#[doc(alias = "predicates")]
#[doc(alias = "symbolic state")]
#[doc(alias = "STRIPS")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Logic(u16);

/// One variable and the value it must have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Literal {
    /// The variable, 0 to 15.
    pub variable: u8,
    /// Whether it must be true.
    pub value: bool,
}

/// A conjunction of literals: the variables that must be true and those that must be false.
///
/// ```
/// use iibt_core::iibt::{Condition, Literal, Logic};
///
/// const AT_DOOR: u8 = 0;
/// const OPEN: u8 = 1;
/// const BLOCKED: u8 = 2;
///
/// // To go through: at the door, which is open, and nothing in the way.
/// let go = Condition { all: Logic::of(&[AT_DOOR, OPEN]), none: Logic::of(&[BLOCKED]) };
/// let mut logic = Logic::of(&[AT_DOOR]);
/// assert_eq!(go.unmet(logic), Some(Literal { variable: OPEN, value: true }));
/// logic = logic.with(OPEN, true).with(BLOCKED, true);
/// assert_eq!(go.unmet(logic), Some(Literal { variable: BLOCKED, value: false }));
/// assert_eq!(go.unmet(logic.with(BLOCKED, false)), None);
/// assert_eq!(Condition::ALWAYS.unmet(logic), None);
/// ```
#[doc(alias = "precondition")]
#[doc(alias = "guard")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Condition {
    /// The variables that must be true.
    pub all: Logic,
    /// The variables that must be false.
    pub none: Logic,
}

impl Logic {
    /// The empty set: no variable is true.
    pub const NONE: Self = Self(0);

    /// The set with these variables true; a variable beyond 15 is left out.
    #[must_use]
    pub const fn of(variables: &[u8]) -> Self {
        let mut set = Self::NONE;
        let mut index = 0;
        while index < variables.len() {
            set = set.with(variables[index], true);
            index += 1;
        }
        set
    }

    /// The set with one variable changed.
    #[must_use]
    pub const fn with(self, variable: u8, value: bool) -> Self {
        if variable >= 16 {
            return self;
        }
        let bit = 1 << variable;
        Self(if value { self.0 | bit } else { self.0 & !bit })
    }

    /// Whether a variable is true.
    #[must_use]
    pub const fn is(self, variable: u8) -> bool {
        variable < 16 && self.0 & (1 << variable) != 0
    }
}

impl Condition {
    /// The condition that always holds.
    pub const ALWAYS: Self = Self { all: Logic::NONE, none: Logic::NONE };

    /// The first literal that `logic` does not satisfy, by the number of its variable.
    #[must_use]
    pub const fn unmet(self, logic: Logic) -> Option<Literal> {
        let missing = self.all.0 & !logic.0;
        let unwanted = self.none.0 & logic.0;
        let wrong = missing | unwanted;
        if wrong == 0 {
            return None;
        }
        let variable = wrong.trailing_zeros() as u8;
        Some(Literal { variable, value: missing & (1 << variable) != 0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_wrong_variable_is_unmet() {
        let condition = Condition { all: Logic::of(&[1, 5]), none: Logic::of(&[3]) };
        let cases = [
            (Logic::of(&[1, 5]), None),
            (Logic::of(&[1, 5, 9]), None),
            (Logic::of(&[5]), Some((1, true))),
            (Logic::of(&[1, 3, 5]), Some((3, false))),
            (Logic::of(&[1, 3]), Some((3, false))),
            (Logic::of(&[1]), Some((5, true))),
        ];
        for (logic, expected) in cases {
            let literal = expected.map(|(variable, value)| Literal { variable, value });
            assert_eq!(condition.unmet(logic), literal, "{logic:?}");
        }
        assert_eq!(Condition::ALWAYS.unmet(Logic::NONE), None);
    }
}
