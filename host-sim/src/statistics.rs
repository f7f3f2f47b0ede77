//! Statistics of flights: ratios, means and differences with their 95 % intervals.

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// The normal deviate of a two-sided 95 % interval.
const Z: f64 = 1.959_963_984_540_054;

/// A proportion: a count of cases out of all.
///
/// ```
/// use host_sim::statistics::Share;
///
/// let arrived = Share::of([true, true, false, true], |arrived| arrived);
/// assert_eq!((arrived.count, arrived.of, arrived.ratio), (3, 4, 0.75));
/// let [low, high] = arrived.interval; // four flights do not say much
/// assert!(low < 0.35 && high > 0.95);
/// ```
#[doc(alias = "proportion")]
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    /// The number of cases.
    pub count: u32,
    /// The number of all.
    pub of: u32,
    /// The ratio; zero of zero is zero.
    pub ratio: f64,
    /// Wilson's score interval, 95 %; 0 to 1 of zero.
    pub interval: [f64; 2],
}

/// The distribution of a value over flights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Distribution {
    /// The number of values; all else is zero when there are none.
    pub count: u32,
    /// The mean.
    pub mean: f64,
    /// Student's interval of the mean, 95 %; the mean itself of a single number.
    pub interval: [f64; 2],
    /// The median: of an even number of values, the mean of the two in the middle.
    pub median: f64,
    /// The least value that 95 % of all do not exceed.
    pub p95: f64,
    /// The greatest value.
    pub most: f64,
}

/// The difference of paired values.
///
/// ```
/// use host_sim::statistics::Difference;
///
/// let ticks = Difference::of([4.0, 5.0, 3.0, 4.0]); // on the same seeds
/// assert_eq!((ticks.pairs, ticks.mean), (4, 4.0));
/// assert!(ticks.is_significant());
/// assert!(!Difference::of([1.0, -1.0, 2.0, -2.0]).is_significant());
/// ```
#[doc(alias = "paired test")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    /// The number of pairs; all else is zero when there are none.
    pub pairs: u32,
    /// The mean of the differences.
    pub mean: f64,
    /// Student's interval of that mean, 95 %; the mean itself of a single pair.
    pub interval: [f64; 2],
}

impl Share {
    /// Returns the proportion `count` out of `of`.
    #[must_use]
    pub fn new(count: u32, of: u32) -> Self {
        if of == 0 {
            return Self { count, of, ratio: 0.0, interval: [0.0, 1.0] };
        }
        let ratio = f64::from(count) / f64::from(of);
        Self { count, of, ratio, interval: wilson(ratio, f64::from(of)) }
    }

    /// Returns the proportion of the items for which `is_the_case` holds.
    pub fn of<T>(items: impl IntoIterator<Item = T>, is_the_case: impl Fn(T) -> bool) -> Self {
        let mut of = 0;
        let count =
            items.into_iter().inspect(|_| of += 1).filter_map(|item| is_the_case(item).then_some(())).count();
        Self::new(count as u32, of)
    }
}

impl Distribution {
    /// Returns the distribution of values, none of which is NaN.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        let (Some(mean), count) = (mean(&values), values.len()) else { return Self::default() };
        let median = f64::midpoint(values[(count - 1) / 2], values[count / 2]);
        let (p95, most) = (values[(count * 95).div_ceil(100) - 1], values[count - 1]);
        Self { count: count as u32, mean, interval: student(&values, mean), median, p95, most }
    }
}

impl Difference {
    /// Returns the statistics of the differences, one of each pair.
    pub fn of(differences: impl IntoIterator<Item = f64>) -> Self {
        let values: Vec<f64> = differences.into_iter().collect();
        let Some(mean) = mean(&values) else { return Self::default() };
        Self { pairs: values.len() as u32, mean, interval: student(&values, mean) }
    }

    /// Returns whether the interval excludes zero; a single pair has none.
    #[must_use]
    pub fn is_significant(&self) -> bool {
        self.pairs > 1 && (self.interval[0] > 0.0 || self.interval[1] < 0.0)
    }
}

/// Returns the score interval of a ratio, 95 % (Wilson 1927).
#[must_use]
pub fn wilson(ratio: f64, tries: f64) -> [f64; 2] {
    let z2 = Z * Z / tries;
    let middle = ratio + z2 / 2.0;
    let spread = Z * (ratio * (1.0 - ratio) / tries + z2 / (4.0 * tries)).sqrt();
    let [low, high] =
        [(middle - spread) / (1.0 + z2), (middle + spread) / (1.0 + z2)].map(|bound| bound.clamp(0.0, 1.0));
    // Rounding leaves a rest of the difference of two equal numbers, which is not chance.
    [if ratio == 0.0 { 0.0 } else { low }, if ratio == 1.0 { 1.0 } else { high }]
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The interval of the mean of normal values, 95 %.
fn student(values: &[f64], mean: f64) -> [f64; 2] {
    if values.len() < 2 {
        return [mean; 2];
    }
    let freedom = values.len() as f64 - 1.0;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / freedom;
    let spread = quantile(freedom) * (variance / values.len() as f64).sqrt();
    [mean - spread, mean + spread]
}

/// The 97.5 % quantile of Student's distribution.
///
/// Nine digits are right up to ten thousand degrees of freedom, four up to a million.
fn quantile(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |student| student.inverse_cdf(0.975))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_near(found: f64, expected: f64, tolerance: f64) -> bool {
        (found - expected).abs() <= tolerance
    }

    #[test]
    fn the_interval_of_a_ratio_is_wilson_s() {
        // 81 of 263: Newcombe 1998, "Two-sided confidence intervals for the single proportion",
        // table I.
        let [low, high] = Share::new(81, 263).interval;
        assert!(is_near(low, 0.2553, 5e-5) && is_near(high, 0.3662, 5e-5), "{low} {high}");
        for of in [20, 500, 1000] {
            assert_eq!((Share::new(0, of).interval[0], Share::new(of, of).interval[1]), (0.0, 1.0));
        }
        assert!(is_near(Share::new(0, 20).interval[1], 0.1611, 5e-5));
        assert_eq!(Share::new(0, 0).interval, [0.0, 1.0]);
        assert_eq!(Share::of([1, 2, 3, 4], |number| number > 3), Share::new(1, 4));
    }

    #[test]
    fn the_quantile_is_student_s() {
        // R: qt(0.975, df), to ten digits.
        for (freedom, t) in [
            (1, 12.706_204_736),
            (2, 4.302_652_729_9),
            (3, 3.182_446_305_3),
            (4, 2.776_445_105_2),
            (9, 2.262_157_162_9),
            (30, 2.042_272_456_3),
            (499, 1.964_729_391_0),
            (9_999, 1.960_201_263_6),
        ] {
            let found = quantile(f64::from(freedom));
            assert!(is_near(found, t, 1e-8), "{freedom} degrees: {found}, not {t}");
        }
        assert!(is_near(quantile(1e6), Z, 2e-4), "many degrees of freedom make it the normal one");
    }

    #[test]
    fn a_distribution_is_described_by_mean_median_and_quantile() {
        let of = Distribution::of([2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]);
        // Their standard deviation is the square root of 32 / 7, and t is 2.3646 for seven degrees
        // of freedom.
        assert_eq!((of.count, of.mean, of.median, of.p95), (8, 5.0, 4.5, 9.0));
        assert!(is_near(of.interval[1], 5.0 + 2.3646 * (32.0_f64 / 7.0 / 8.0).sqrt(), 1e-3), "{of:?}");
        let hundred = Distribution::of((1..=100).map(f64::from));
        assert_eq!((hundred.median, hundred.p95), (50.5, 95.0));
        assert_eq!(Distribution::of([3.0]).interval, [3.0, 3.0]);
        assert_eq!(Distribution::of([]), Distribution::default());
    }

    #[test]
    fn a_difference_is_significant_when_its_interval_leaves_zero_out() {
        assert!(
            Difference::of([1.0, 1.1, 0.9]).is_significant() && Difference::of([-2.0, -2.1]).is_significant()
        );
        assert!(!Difference::of([1.0, -1.0, 0.5]).is_significant());
        assert!(!Difference::of([]).is_significant() && !Difference::of([3.0]).is_significant());
    }
}
