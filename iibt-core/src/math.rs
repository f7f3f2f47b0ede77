//! Logarithms, exponentials and what is built from them: the only room that calls a transcendental function.
//!
//! Everything is `f32`. `libm`'s `logf` and `expf` are accurate to one unit in the last place, use `f32`
//! operations only, and so return the same bits on every target. Sums run in index order.

/// The natural logarithm; minus infinity at zero, NaN below.
#[must_use]
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}

/// The exponential function.
#[must_use]
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// `p ln p`, with the limit 0 at `p = 0`.
#[must_use]
pub fn p_ln_p(p: f32) -> f32 {
    if p > 0.0 { p * ln(p) } else { 0.0 }
}

/// The Shannon entropy `H = -Σ p ln p` of a distribution, in nats.
#[must_use]
pub fn entropy(distribution: &[f32]) -> f32 {
    -distribution.iter().map(|&p| p_ln_p(p)).sum::<f32>()
}

/// The expectation `Σ p x` of `values` under a distribution.
#[must_use]
pub fn expectation(distribution: &[f32], values: &[f32]) -> f32 {
    distribution.iter().zip(values).map(|(p, x)| p * x).sum()
}

/// The Kullback-Leibler divergence `KL[q || p] = Σ q (ln q - ln p)`, in nats; infinite where `q` has mass
/// and `p` has none.
#[must_use]
pub fn kl(q: &[f32], p: &[f32]) -> f32 {
    q.iter().zip(p).filter(|(q, _)| **q > 0.0).map(|(&q, &p)| q * (ln(q) - ln(p))).sum()
}

/// Scales non-negative weights so that they sum to one, and returns what they summed to before.
///
/// Returns `None`, and changes nothing, when the sum is zero or not finite.
pub fn normalise(weights: &mut [f32]) -> Option<f32> {
    let sum: f32 = weights.iter().sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return None;
    }
    // A subnormal sum has an infinite reciprocal: divide instead of multiplying.
    weights.iter_mut().for_each(|weight| *weight /= sum);
    Some(sum)
}

/// `ln Σ exp(x)`, without overflow; minus infinity for no values.
#[must_use]
pub fn log_sum_exp(values: &[f32]) -> f32 {
    let largest = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    if !largest.is_finite() {
        return largest;
    }
    largest + ln(values.iter().map(|&x| exp(x - largest)).sum())
}

/// Turns values into their log-softmax `x - ln Σ exp(x)` in place.
pub fn log_softmax(values: &mut [f32]) {
    let total = log_sum_exp(values);
    values.iter_mut().for_each(|x| *x -= total);
}

/// Turns log weights into the distribution `softmax(x)` in place.
pub fn softmax(values: &mut [f32]) {
    let largest = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    values.iter_mut().for_each(|x| *x = exp(*x - largest));
    if normalise(values).is_none() {
        let share = 1.0 / values.len().max(1) as f32;
        values.fill(share);
    }
}

/// The index of the largest value; the first of equals, and zero for no values.
#[must_use]
pub fn argmax(values: &[f32]) -> usize {
    let first = (0, f32::NEG_INFINITY);
    values.iter().enumerate().fold(first, |best, (index, &x)| if x > best.1 { (index, x) } else { best }).0
}

/// Whether `distribution` has no negative or non-finite entry and sums to one within `1e-4`.
#[must_use]
pub const fn is_distribution(distribution: &[f32]) -> bool {
    let mut sum = 0.0;
    let mut index = 0;
    while index < distribution.len() {
        if !(distribution[index] >= 0.0 && distribution[index].is_finite()) {
            return false;
        }
        sum += distribution[index];
        index += 1;
    }
    sum > 1.0 - TOLERANCE && sum < 1.0 + TOLERANCE
}

const TOLERANCE: f32 = 1e-4;

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f32, b: f32) -> bool {
        (a - b).abs() <= 1e-6 * b.abs().max(1.0)
    }

    #[test]
    fn entropy_of_equal_chances_is_the_logarithm_of_their_number() {
        assert!(close(entropy(&[0.25; 4]), ln(4.0)));
        assert_eq!(entropy(&[1.0, 0.0]), 0.0);
    }

    #[test]
    fn divergence_is_zero_only_between_equals() {
        let (q, p) = ([0.2, 0.8], [0.5, 0.5]);
        assert_eq!(kl(&q, &q), 0.0);
        assert!(close(kl(&q, &p), 0.2 * ln(0.4) + 0.8 * ln(1.6)));
        assert_eq!(kl(&p, &[1.0, 0.0]), f32::INFINITY);
    }

    #[test]
    fn softmax_survives_large_and_hopeless_scores() {
        let mut scores = [1000.0, 1000.0, -1000.0];
        softmax(&mut scores);
        assert_eq!(scores, [0.5, 0.5, 0.0]);
        let mut hopeless = [f32::NEG_INFINITY; 4];
        softmax(&mut hopeless);
        assert_eq!(hopeless, [0.25; 4]);
        let mut broken = [f32::NAN, 0.0];
        softmax(&mut broken);
        assert_eq!(broken, [0.5; 2]);
    }

    #[test]
    fn log_softmax_is_the_logarithm_of_softmax() {
        let (mut logs, mut probabilities) = ([0.3, -2.0, 5.0], [0.3, -2.0, 5.0]);
        log_softmax(&mut logs);
        softmax(&mut probabilities);
        assert!(logs.iter().zip(probabilities).all(|(&x, p)| close(exp(x), p)));
    }

    #[test]
    fn nothing_is_normalised_without_mass() {
        let mut none = [0.0, 0.0];
        assert_eq!(normalise(&mut none), None);
        assert_eq!(none, [0.0, 0.0]);
        let mut tiny = [1e-45, 1e-45];
        assert!(normalise(&mut tiny).is_some());
        assert_eq!(tiny, [0.5, 0.5]);
    }

    #[test]
    fn the_first_of_equals_is_the_largest() {
        assert_eq!(argmax(&[1.0, 3.0, 3.0]), 1);
        assert_eq!(argmax(&[f32::NAN, 0.0]), 1);
        assert_eq!(argmax(&[]), 0);
    }

    #[test]
    fn distributions_are_told_from_other_tables() {
        assert!(is_distribution(&[0.97, 0.03]));
        for wrong in [[0.97, 0.0], [1.5, -0.5], [f32::NAN, 1.0], [f32::INFINITY, 0.0]] {
            assert!(!is_distribution(&wrong), "{wrong:?}");
        }
    }
}
