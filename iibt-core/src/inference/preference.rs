//! C, the preferences of a robot over observations.

use super::error::{Argument, OutOfRange};

/// A preference per outcome on a log scale: P(o) = softmax(C).
///
/// [`raise`](Self::raise) adds to it: C + L. A task that raises for a while raises a copy, and
/// drops it to roll back.
///
/// ```
/// use iibt_core::inference::Preference;
///
/// let preference = Preference::new([0.0, 1.0, -2.0]);
/// let mut raised = preference;
/// raised.raise(0, 3.0)?;
/// assert_eq!((raised.values(), raised.largest()), ([3.0, 1.0, -2.0], 3.0));
/// assert_eq!(raised.negative(), [0.0, 0.0, -2.0]);
///
/// let error = raised.raise(3, 1.0).unwrap_err();
/// assert_eq!(error.to_string(), "there is no outcome 3 to prefer: there are 3, from 0");
/// # Ok::<(), iibt_core::inference::OutOfRange>(())
/// ```
#[doc(alias = "C")]
#[doc(alias = "prior preference")]
#[doc(alias = "goal")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preference<const O: usize> {
    values: [f32; O],
}

impl<const O: usize> Preference<O> {
    /// A preference from its log-scale values.
    ///
    /// # Panics
    /// When there are no outcomes or a value is not finite; in a `const` this fails the build, as
    /// does a value too many or too few.
    #[must_use]
    pub const fn new(values: [f32; O]) -> Self {
        assert!(O > 0, "C, the preference, has no outcomes");
        let mut outcome = 0;
        while outcome < O {
            assert!(values[outcome].is_finite(), "C, the preference, has a value that is not finite");
            outcome += 1;
        }
        Self { values }
    }

    /// A preference computed for each outcome; a value that is not finite counts as zero.
    #[must_use]
    pub fn from_fn(mut value: impl FnMut(usize) -> f32) -> Self {
        let finite = |outcome| Some(value(outcome)).filter(|value| value.is_finite()).unwrap_or(0.0);
        Self { values: core::array::from_fn(finite) }
    }

    /// The largest preference: max(C).
    #[must_use]
    pub fn largest(&self) -> f32 {
        self.values.into_iter().fold(f32::NEG_INFINITY, f32::max)
    }

    /// Adds a preference, which may be negative, to that for one outcome: C := C + L.
    ///
    /// # Errors
    /// [`OutOfRange`] for an outcome that does not exist and for a sum that is not finite. Nothing
    /// is changed.
    pub fn raise(&mut self, outcome: usize, by: f32) -> Result<(), OutOfRange> {
        let unknown = OutOfRange::new(Argument::PreferredOutcome, 0, outcome, O);
        let value = self.values.get_mut(outcome).ok_or(unknown)?;
        if !(*value + by).is_finite() {
            return Err(OutOfRange::new(Argument::Raise, 0, outcome, O));
        }
        *value += by;
        Ok(())
    }

    /// C, for each outcome.
    #[must_use]
    pub const fn values(&self) -> [f32; O] {
        self.values
    }

    /// The negative preferences alone: positive ones count as zero. See
    /// [`PreferenceTiming`](super::PreferenceTiming).
    #[must_use]
    pub fn negative(&self) -> [f32; O] {
        self.values.map(|value| value.min(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn raises_of_an_outcome_add_up() {
        let mut preference = Preference::new([0.5, 0.25, 0.75]);
        for (outcome, by) in [(1, 8.0), (1, -0.5), (2, 1.25)] {
            preference.raise(outcome, by).unwrap();
        }
        assert_eq!((preference.values(), preference.largest()), ([0.5, 7.75, 2.0], 7.75));
    }

    #[test]
    fn nonsense_raises_nothing_and_is_named() {
        let mut preference = Preference::new([0.0, 1.0]);
        for by in [f32::NAN, f32::INFINITY] {
            assert_eq!(preference.raise(0, by), Err(OutOfRange::new(Argument::Raise, 0, 0, 2)));
        }
        assert_eq!(preference.raise(9, 1.0), Err(OutOfRange::new(Argument::PreferredOutcome, 0, 9, 2)));
        assert_eq!(preference.values(), [0.0, 1.0]);
        let odd = Preference::from_fn(|outcome| if outcome == 0 { f32::INFINITY } else { 1.0 });
        assert_eq!(odd, preference);
    }

    #[test]
    fn aversions_leave_likes_out() {
        assert_eq!(Preference::new([2.0, 0.0, -1.0]).negative(), [0.0, 0.0, -1.0]);
    }
}
