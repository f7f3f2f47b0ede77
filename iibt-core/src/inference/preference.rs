//! C, what a robot would like to observe.

/// A preference per outcome on a log scale: P(o) = softmax(C).
///
/// The base is what the task wants; [`raise`](Self::raise) adds a temporary preference on top of it, and
/// [`roll_back`](Self::roll_back) takes all of them away again and leaves exactly the base.
///
/// ```
/// use iibt_core::inference::Preference;
///
/// let mut preference = Preference::new([0.0, 1.0, -2.0]);
/// preference.raise(0, 3.0); // for a while
/// assert!(preference.is_raised());
/// assert_eq!((preference.get(0), preference.largest()), (3.0, 3.0));
/// assert_eq!(preference.negative(), [0.0, 0.0, -2.0]);
/// preference.roll_back();
/// assert_eq!(preference.values(), [0.0, 1.0, -2.0]);
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
    /// When there are no outcomes or a value is not finite; in a `const` this fails the build, as does a
    /// value too many or too few.
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

    /// A preference worked out per outcome; a value that is not finite counts as zero.
    #[must_use]
    pub fn from_fn(mut value: impl FnMut(usize) -> f32) -> Self {
        let finite = |outcome| Some(value(outcome)).filter(|value| value.is_finite()).unwrap_or(0.0);
        Self { base: core::array::from_fn(finite), raised: [0.0; O] }
    }

    /// The preference for one outcome, temporary raise included; zero outside the table.
    #[must_use]
    pub fn get(&self, outcome: usize) -> f32 {
        let at = |values: &[f32; O]| values.get(outcome).copied().unwrap_or(0.0);
        at(&self.base) + at(&self.raised)
    }

    /// The largest preference, temporary raises included: max(C).
    #[must_use]
    pub fn largest(&self) -> f32 {
        (0..O).map(|outcome| self.get(outcome)).fold(f32::NEG_INFINITY, f32::max)
    }

    /// Adds a temporary preference, which may be negative, to one outcome: C := C + L. A value that is not
    /// finite or an outcome that does not exist changes nothing.
    pub fn raise(&mut self, outcome: usize, by: f32) {
        if let Some(raised) = self.raised.get_mut(outcome)
            && (*raised + by).is_finite()
        {
            *raised += by;
        }
    }

    /// Whether a temporary preference is in place.
    #[must_use]
    pub fn is_raised(&self) -> bool {
        self.raised.iter().any(|&raised| raised != 0.0)
    }

    /// Takes every temporary preference away: C := C - L, exactly.
    pub fn roll_back(&mut self) {
        self.raised = [0.0; O];
    }

    /// C as it is now, temporary raises included.
    #[must_use]
    pub fn values(&self) -> [f32; O] {
        core::array::from_fn(|outcome| self.get(outcome))
    }

    /// The negative preferences alone: positive ones count as zero. See [`PreferenceTiming`](super::PreferenceTiming).
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
        preference.raise(1, 1e7);
        preference.raise(1, -0.7);
        preference.raise(2, 1.3);
        assert!(preference.is_raised());
        assert_eq!(preference.largest(), preference.get(1));
        preference.roll_back();
        assert_eq!(preference, base);
    }

    #[test]
    fn nonsense_raises_nothing() {
        let mut preference = Preference::new([0.0, 1.0]);
        preference.raise(0, f32::NAN);
        preference.raise(0, f32::INFINITY);
        preference.raise(9, 1.0);
        assert!(!preference.is_raised());
        let odd = Preference::from_fn(|outcome| if outcome == 0 { f32::INFINITY } else { 1.0 });
        assert_eq!(odd, preference);
    }

    #[test]
    fn aversions_leave_likes_out() {
        assert_eq!(Preference::new([2.0, 0.0, -1.0]).negative(), [0.0, 0.0, -1.0]);
    }
}
