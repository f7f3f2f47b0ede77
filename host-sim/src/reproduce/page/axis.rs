//! An axis with round numbers on it.

/// The most steps of an axis.
const STEPS: f64 = 5.0;

/// The values that an axis covers, and the distance of its marks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axis {
    pub(super) low: f64,
    pub(super) high: f64,
    step: f64,
}

impl Axis {
    /// From the least to the largest value.
    pub(super) fn over(values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = values
            .into_iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = if high > low { (low, high) } else { (low.min(0.0), high.max(0.0) + 1.0) };
        Self { low, high, step: round_step((high - low) / STEPS) }
    }

    /// The axis extended to the next marks.
    pub(super) fn rounded(self) -> Self {
        let (low, high) = ((self.low / self.step).floor(), (self.high / self.step).ceil());
        Self { low: low * self.step, high: high * self.step, ..self }
    }

    /// The position of a value, as a part of the axis.
    pub(super) fn part(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// The marks, whole multiples of their distance.
    pub(super) fn marks(self) -> impl Iterator<Item = f64> {
        // What division loses must not cost the mark at the end.
        let [first, last] = [self.low / self.step - 1e-9, self.high / self.step + 1e-9];
        (first.ceil() as i64..=last.floor() as i64).map(move |mark| mark as f64 * self.step)
    }
}

/// The next of 1, 2 and 5 times a power of ten.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 5.0].map(|digit| digit * power);
    steps.into_iter().find(|&step| step >= least).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_round_and_cover_the_values() {
        for (values, low, high, marks) in [
            ([0.0, 51.5], 0.0, 60.0, vec![0.0, 20.0, 40.0, 60.0]),
            ([0.0, 79.0], 0.0, 80.0, vec![0.0, 20.0, 40.0, 60.0, 80.0]),
            ([0.0, 1.0], 0.0, 1.0, vec![0.0, 0.2, 0.4, 0.6, 0.8, 1.0]),
            ([-3.0, 7.0], -4.0, 8.0, vec![-4.0, -2.0, 0.0, 2.0, 4.0, 6.0, 8.0]),
        ] {
            let axis = Axis::over(values).rounded();
            assert_eq!((axis.low, axis.high), (low, high), "{values:?}");
            let found: Vec<_> = axis.marks().map(|mark| (mark * 10.0).round() / 10.0).collect();
            assert_eq!(found, marks, "{values:?}");
        }
    }

    #[test]
    fn an_axis_that_is_not_rounded_keeps_its_ends() {
        let axis = Axis::over([1.0, 30.0]);
        assert_eq!((axis.low, axis.high), (1.0, 30.0));
        assert_eq!(axis.marks().collect::<Vec<_>>(), [10.0, 20.0, 30.0]);
        assert_eq!([1.0, 30.0].map(|value| axis.part(value)), [0.0, 1.0]);
    }

    #[test]
    fn no_values_or_equal_ones_make_an_axis_all_the_same() {
        for values in [vec![], vec![0.0], vec![5.0, 5.0]] {
            let axis = Axis::over(values);
            assert!(axis.low < axis.high && axis.marks().count() >= 2, "{axis:?}");
        }
    }
}
