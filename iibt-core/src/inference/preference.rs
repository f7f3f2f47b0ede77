//! C, the preferences of a robot over observations.

use super::error::{Argument, OutOfRange};

/// A preference per outcome on a log scale: P(o) = softmax(C).
///
/// The base is what the task wants; [`raise`](Self::raise) adds a temporary preference on top of
/// it, and [`roll_back`](Self::roll_back) takes all of them away again and leaves exactly the base.
///
/// ```
/// use iibt_core::inference::Preference;
///
/// let mut preference = Preference::new([0.0, 1.0, -2.0]);
/// preference.raise(0, 3.0)?; // for a while
/// assert!(preference.is_raised());
/// assert_eq!((preference.get(0), preference.largest()), (Some(3.0), 3.0));
/// assert_eq!(preference.negative(), [0.0, 0.0, -2.0]);
/// preference.roll_back();
/// assert_eq!(preference.values(), [0.0, 1.0, -2.0]);
///
/// let error = preference.raise(3, 1.0).unwrap_err();
/// assert_eq!(error.to_string(), "there is no outcome 3 to prefer: there are 3, from 0");
/// # Ok::<(), iibt_core::inference::OutOfRange>(())
/// ```
#[doc(alias = "C")]
#[doc(alias = "prior preference")]
#[doc(alias = "goal")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preference<const O: usize> {
    base: [f32; O],
    raised: [f32; O],
}

impl<const O: usize> Preference<O> {
    /// A preference from its log-scale values.
    ///
    /// # Panics
    /// When there are no outcomes or a value is not finite; in a `const` this fails the build, as
    /// does a value too many or too few.
    #[must_use]
    pub const fn new(base: [f32; O]) -> Self {
        assert!(O > 0, "C, the preference, has no outcomes");
        let mut outcome = 0;
        while outcome < O {
            assert!(base[outcome].is_finite(), "C, the preference, has a value that is not finite");
            outcome += 1;
        }
        Self { base, raised: [0.0; O] }
    }

    /// A preference computed for each outcome; a value that is not finite counts as zero.
    #[must_use]
    pub fn from_fn(mut value: impl FnMut(usize) -> f32) -> Self {
        let finite = |outcome| Some(value(outcome)).filter(|value| value.is_finite()).unwrap_or(0.0);
        Self { base: core::array::from_fn(finite), raised: [0.0; O] }
    }

    /// The preference for one outcome, temporary raise included; `None` outside the table.
    #[must_use]
    pub fn get(&self, outcome: usize) -> Option<f32> {
        Some(self.base.get(outcome)? + self.raised.get(outcome)?)
    }

    /// The largest preference, temporary raises included: max(C).
    #[must_use]
    pub fn largest(&self) -> f32 {
        self.values().into_iter().fold(f32::NEG_INFINITY, f32::max)
    }

    /// Adds a temporary preference, which may be negative, to one outcome: C := C + L.
    ///
    /// # Errors
    /// [`OutOfRange`] for an outcome that does not exist and for a sum that is not finite. Nothing
    /// is changed.
    pub fn raise(&mut self, outcome: usize, by: f32) -> Result<(), OutOfRange> {
        let unknown = OutOfRange::new(Argument::PreferredOutcome, 0, outcome, O);
        let raised = self.raised.get_mut(outcome).ok_or(unknown)?;
        if !(*raised + by).is_finite() {
            return Err(OutOfRange::new(Argument::Raise, 0, outcome, O));
        }
        *raised += by;
        Ok(())
    }

    /// Whether a temporary preference is in place.
    #[must_use]
    pub fn is_raised(&self) -> bool {
        self.raised.iter().any(|&raised| raised != 0.0)
    }

    /// Removes every temporary preference: C := C - L, exactly.
    pub fn roll_back(&mut self) {
        self.raised = [0.0; O];
    }

    /// The current C, temporary raises included.
    #[must_use]
    pub fn values(&self) -> [f32; O] {
        core::array::from_fn(|outcome| self.get(outcome).unwrap_or(0.0))
    }

    /// The negative preferences alone: positive ones count as zero. See
    /// [`PreferenceTiming`](super::PreferenceTiming).
    #[must_use]
    pub fn negative(&self) -> [f32; O] {
        self.values().map(|value| value.min(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_raise_is_rolled_back_to_the_last_bit() {
        let base = Preference::new([0.1, 0.2, 0.3]);
        let mut preference = base;
        for (outcome, by) in [(1, 1e7), (1, -0.7), (2, 1.3)] {
            preference.raise(outcome, by).unwrap();
        }
        assert!(preference.is_raised());
        assert_eq!(Some(preference.largest()), preference.get(1));
        preference.roll_back();
        assert_eq!(preference, base);
    }

    #[test]
    fn nonsense_raises_nothing_and_is_named() {
        let mut preference = Preference::new([0.0, 1.0]);
        for by in [f32::NAN, f32::INFINITY] {
            assert_eq!(preference.raise(0, by), Err(OutOfRange::new(Argument::Raise, 0, 0, 2)));
        }
        assert_eq!(preference.raise(9, 1.0), Err(OutOfRange::new(Argument::PreferredOutcome, 0, 9, 2)));
        assert_eq!(preference.get(2), None);
        assert!(!preference.is_raised());
        let odd = Preference::from_fn(|outcome| if outcome == 0 { f32::INFINITY } else { 1.0 });
        assert_eq!(odd, preference);
    }

    #[test]
    fn aversions_leave_likes_out() {
        assert_eq!(Preference::new([2.0, 0.0, -1.0]).negative(), [0.0, 0.0, -1.0]);
    }
}
