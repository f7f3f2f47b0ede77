//! f_L: the preference that would make an unmet precondition true (the paper's tables 2 and 5).

use super::Literal;

/// The size of a raise: how strongly evidence is preferred or avoided.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Raise {
    /// One more than the largest preference so far: l = max(C) + 1.
    AboveAll,
    /// A fixed value, negative for what is to be avoided.
    By(f32),
}

impl Raise {
    /// The value to add to a preference whose largest entry is `largest`.
    #[must_use]
    pub fn amount(self, largest: f32) -> f32 {
        match self {
            Self::AboveAll => largest + 1.0,
            Self::By(amount) => amount,
        }
    }
}

/// One row of a task's table: the literal that is missing, and the raise of the evidence for it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rule {
    /// The unmet literal.
    pub missing: Literal,
    /// The raise of the preference for its evidence.
    pub raise: Raise,
}

/// The raise for an unmet literal; `None` when no evidence could make it true.
///
/// ```
/// use iibt_core::iibt::Literal;
/// use iibt_core::iibt::rules::{Raise, Rule, raise_for};
///
/// let (open, clear) =
///     (Literal { variable: 0, value: true }, Literal { variable: 1, value: false });
/// let rules = [
///     Rule { missing: open, raise: Raise::AboveAll },
///     Rule { missing: clear, raise: Raise::By(-1.0) },
/// ];
/// let raise = raise_for(&rules, open).expect("a rule for it");
/// assert_eq!(raise.amount(2.0), 3.0); // one more than the largest preference
/// assert_eq!(raise_for(&rules, clear).map(|raise| raise.amount(2.0)), Some(-1.0));
/// assert_eq!(raise_for(&rules, Literal { variable: 2, value: true }), None); // the node waits
/// ```
#[must_use]
pub fn raise_for(rules: &[Rule], missing: Literal) -> Option<Raise> {
    rules.iter().find(|rule| rule.missing == missing).map(|rule| rule.raise)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn evidence_is_raised_above_everything_wanted() {
        assert_eq!(Raise::AboveAll.amount(1.0), 2.0);
        assert_eq!(Raise::By(-1.0).amount(7.0), -1.0);
    }

    #[test]
    fn a_rule_answers_its_own_literal_only() {
        let clear = Literal { variable: 0, value: false };
        let rules = [Rule { missing: clear, raise: Raise::By(-1.0) }];
        assert_eq!(raise_for(&rules, clear), Some(Raise::By(-1.0)));
        assert_eq!(raise_for(&rules, Literal { value: true, ..clear }), None);
    }
}
