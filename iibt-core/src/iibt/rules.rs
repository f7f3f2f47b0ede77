//! f_L: by how much evidence for an unmet precondition is preferred (the paper's tables 2 and 5).

/// The size of a raise: how strongly evidence is preferred or avoided.
///
/// ```
/// use iibt_core::iibt::rules::Raise;
///
/// assert_eq!(Raise::AboveAll.amount(2.0), 3.0); // one more than the largest preference
/// assert_eq!(Raise::By(-1.0).amount(2.0), -1.0);
/// ```
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn evidence_is_raised_above_everything_wanted() {
        assert_eq!(Raise::AboveAll.amount(1.0), 2.0);
        assert_eq!(Raise::By(-1.0).amount(7.0), -1.0);
    }
}
