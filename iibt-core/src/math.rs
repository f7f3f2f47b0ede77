//! Logarithms, exponentials and functions built from them: the only module with transcendental
//! functions.
//!
//! Everything is `f32` and returns the same bits on every target: no fused operations, no
//! reordering by the compiler. Sums of long lists run in four lanes, element `i` in lane `i % 4`,
//! so that a vector unit can carry them out and the order is still fixed.

/// The natural logarithm; minus infinity at zero, NaN below. Accurate to one unit in the last
/// place.
#[must_use]
pub const fn ln(x: f32) -> f32 {
    match x {
        f32::INFINITY => x,
        _ if x >= f32::MIN_POSITIVE => ln_normal(x),
        _ if x > 0.0 => ln_normal(x * TWO_25) - 25.0 * core::f32::consts::LN_2,
        _ if x == 0.0 => f32::NEG_INFINITY,
        _ => f32::NAN,
    }
}

const TWO_25: f32 = 33_554_432.0;

/// The logarithm of a positive normal number, without a branch; finite and meaningless for anything
/// else.
///
/// x = 2^k (1 + f) with 1 + f between sqrt(1/2) and sqrt(2), and ln(1 + f) = f - f²/2 + s (f²/2 +
/// R(s²)) with s = f / (2 + f), where R is the polynomial of Sun's fdlibm.
const fn ln_normal(x: f32) -> f32 {
    const SQRT_HALF: u32 = 0x3f35_04f3;
    const ONE: u32 = 0x3f80_0000;
    const LN_2_HIGH: f32 = 0.693_138_1;
    const LN_2_LOW: f32 = 9.058_001e-6;
    const R: [f32; 4] = [0.666_666_6, 0.400_009_72, 0.284_987_87, 0.242_790_79];

    let bits = x.to_bits().wrapping_add(ONE - SQRT_HALF);
    let k = ((bits >> 23) as i32 - 127) as f32;
    let f = f32::from_bits((bits & 0x007f_ffff) + SQRT_HALF) - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let r = w * (R[1] + w * R[3]) + z * (R[0] + w * R[2]);
    let half = 0.5 * f * f;
    s * (half + r) + k * LN_2_LOW - half + f + k * LN_2_HIGH
}

/// The exponential function, without a branch; accurate to one unit in the last place.
///
/// e^x = 2^k e^r with |r| at most ln(2) / 2. What a polynomial makes of r is scaled in two steps,
/// so that the result runs out evenly into infinity and into the subnormal numbers.
#[inline]
#[must_use]
pub const fn exp(x: f32) -> f32 {
    // Adding and taking away 3 * 2^22 rounds to an integer, which is then in the last bits of the
    // sum.
    const ROUND: f32 = 12_582_912.0;
    const LN_2_HIGH: f32 = 0.693_359_4;
    const LN_2_LOW: f32 = -2.121_944_4e-4;
    const C: [f32; 6] = [0.5, 0.166_666_65, 4.166_579_6e-2, 8.333_452e-3, 1.398_199_9e-3, 1.987_569_1e-4];

    // Comparisons that NaN passes through.
    let x = if x < -105.0 { -105.0 } else { x };
    let x = if x > 90.0 { 90.0 } else { x };
    let rounded = x * core::f32::consts::LOG2_E + ROUND;
    let k = rounded.to_bits() as i32 - ROUND.to_bits() as i32;
    let whole = rounded - ROUND;
    let r = (x - whole * LN_2_HIGH) - whole * LN_2_LOW;
    let polynomial = ((((C[5] * r + C[4]) * r + C[3]) * r + C[2]) * r + C[1]) * r + C[0];
    let e = polynomial * (r * r) + r + 1.0;
    e * power_of_two(k >> 1) * power_of_two(k - (k >> 1))
}

/// 2^k for a `k` that a normal number has; something else for others.
const fn power_of_two(k: i32) -> f32 {
    f32::from_bits((k.wrapping_add(127) as u32) << 23)
}

/// `p ln p`, with the limit 0 at `p = 0`.
#[must_use]
pub const fn p_ln_p(p: f32) -> f32 {
    // Zero times a finite number; below the normal numbers the error is beyond the last place of
    // any sum.
    p * ln_normal(p)
}

/// The Shannon entropy `H = -Σ p ln p` of a distribution, in nats.
#[must_use]
pub const fn entropy(distribution: &[f32]) -> f32 {
    let mut sum = 0.0;
    let mut index = 0;
    while index < distribution.len() {
        sum += p_ln_p(distribution[index]);
        index += 1;
    }
    -sum
}

/// ψ(x + 1) - ln x, by which the digamma function exceeds a logarithm: positive, falling from
/// infinity at zero to `1 / 2x` for large `x`, where the difference of the two would be lost in
/// their last places; NaN below zero.
///
/// The asymptotic series from four on; below, ψ(x + 1) = ψ(x + n + 1) - Σ_k 1 / (x + k) leads
/// there.
#[must_use]
pub const fn digamma_excess(x: f32) -> f32 {
    const FAR: f32 = 4.0;
    if x.is_nan() || x < 0.0 {
        return f32::NAN;
    }
    let (mut y, mut reciprocals) = (x, 0.0);
    while y < FAR {
        y += 1.0;
        reciprocals += 1.0 / y;
    }
    let z = 1.0 / (y * y);
    let series = 0.5 / y - z * (1.0 / 12.0 - z * (1.0 / 120.0 - z * (1.0 / 252.0 - z / 240.0)));
    if x < FAR { ln(y) - ln(x) - reciprocals + series } else { series }
}

/// Copies as many values as both lists have.
pub fn assign(to: &mut [f32], from: &[f32]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
}

/// The sum of a list, in four lanes.
#[inline]
#[must_use]
pub fn sum(values: &[f32]) -> f32 {
    let (blocks, rest) = values.as_chunks::<LANES>();
    let mut lanes = [0.0; LANES];
    for block in blocks {
        lanes.iter_mut().zip(block).for_each(|(lane, value)| *lane += value);
    }
    lanes.iter_mut().zip(rest).for_each(|(lane, value)| *lane += value);
    let [a, b, c, d] = lanes;
    (a + b) + (c + d)
}

/// The entropy of a predicted distribution of outcomes, and the expectation of the preferences
/// under it, gathered outcome by outcome.
///
/// ```
/// use iibt_core::math::Prediction;
///
/// let prediction = Prediction::of(&[0.5, 0.5], &[1.0, 0.0], |p| p);
/// assert!((prediction.entropy() - core::f32::consts::LN_2).abs() < 1e-6);
/// assert_eq!(prediction.utility(), 0.5);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Prediction {
    entropy: [f32; LANES],
    utility: [f32; LANES],
}

/// The lanes that sums of long lists run in.
const LANES: usize = 4;

impl Prediction {
    /// An empty prediction.
    #[must_use]
    pub const fn new() -> Self {
        Self { entropy: [0.0; LANES], utility: [0.0; LANES] }
    }

    /// The prediction of outcomes whose probabilities `probability` computes from `values`, with
    /// the preference for each.
    #[inline]
    #[must_use]
    pub fn of(values: &[f32], preferences: &[f32], probability: impl Fn(f32) -> f32) -> Self {
        let mut prediction = Self::new();
        let (values, values_left) = values.as_chunks::<LANES>();
        let (preferences, preferences_left) = preferences.as_chunks::<LANES>();
        for (values, preferences) in values.iter().zip(preferences) {
            prediction.add(&values.map(&probability), preferences);
        }
        if !values_left.is_empty() {
            prediction.add_some(values_left.iter().map(|&value| probability(value)), preferences_left);
        }
        prediction
    }

    /// Adds the next four outcomes.
    // A function of its own, from memory to memory, is what the compiler turns into vector
    // operations.
    #[inline(never)]
    pub fn add(&mut self, probabilities: &[f32; LANES], preferences: &[f32; LANES]) {
        let information = probabilities.map(p_ln_p);
        self.entropy.iter_mut().zip(&information).for_each(|(sum, term)| *sum -= term);
        let liked = probabilities.iter().zip(preferences);
        self.utility.iter_mut().zip(liked).for_each(|(sum, (p, preference))| *sum += p * preference);
    }

    /// Adds the last outcomes, of which there are no more than four.
    #[inline]
    pub fn add_some(&mut self, probabilities: impl Iterator<Item = f32>, preferences: &[f32]) {
        let lanes = self.entropy.iter_mut().zip(&mut self.utility);
        for ((entropy, utility), (p, preference)) in lanes.zip(probabilities.zip(preferences)) {
            *entropy -= p_ln_p(p);
            *utility += p * preference;
        }
    }

    /// The entropy, in nats.
    #[must_use]
    pub const fn entropy(&self) -> f32 {
        let [a, b, c, d] = self.entropy;
        (a + b) + (c + d)
    }

    /// The expected preference.
    #[must_use]
    pub const fn utility(&self) -> f32 {
        let [a, b, c, d] = self.utility;
        (a + b) + (c + d)
    }
}

/// The expectation `Σ p x` of `values` under a distribution.
#[must_use]
pub fn expectation(distribution: &[f32], values: &[f32]) -> f32 {
    distribution.iter().zip(values).map(|(p, x)| p * x).sum()
}

/// The Kullback-Leibler divergence `KL[q || p] = Σ q (ln q - ln p)`, in nats; infinite where `q`
/// has mass and `p` has none.
#[must_use]
pub fn kl(q: &[f32], p: &[f32]) -> f32 {
    q.iter().zip(p).filter(|(q, _)| **q > 0.0).map(|(&q, &p)| q * (ln(q) - ln(p))).sum()
}

/// Scales non-negative weights so that they sum to one, and returns their former sum.
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
    let largest = largest(values);
    if !largest.is_finite() {
        return largest;
    }
    let mut sums = [0.0; LANES];
    for block in values.chunks(LANES) {
        let mut lanes = [f32::NEG_INFINITY; LANES];
        assign(&mut lanes, block);
        exp_below(&mut lanes, largest);
        sums.iter_mut().zip(lanes).for_each(|(sum, e)| *sum += e);
    }
    largest + ln(sum(&sums))
}

fn largest(values: &[f32]) -> f32 {
    values.iter().fold(f32::NEG_INFINITY, |most, &x| if x > most { x } else { most })
}

/// `exp(x - largest)` of four values, in place.
// A function of its own, from memory to memory, is what the compiler turns into vector operations.
#[inline(never)]
fn exp_below(lanes: &mut [f32; LANES], largest: f32) {
    *lanes = lanes.map(|x| exp(x - largest));
}

/// Turns log weights into the distribution `softmax(x)` in place.
pub fn softmax(values: &mut [f32]) {
    let largest = largest(values);
    let (blocks, rest) = values.as_chunks_mut::<LANES>();
    blocks.iter_mut().for_each(|block| exp_below(block, largest));
    rest.iter_mut().for_each(|x| *x = exp(*x - largest));
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
    is_one(sum)
}

/// Whether a sum of probabilities is one within `1e-4`, which is what rounding may take or add.
pub(crate) const fn is_one(sum: f32) -> bool {
    const TOLERANCE: f32 = 1e-4;
    sum > 1.0 - TOLERANCE && sum < 1.0 + TOLERANCE
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    fn close(a: f32, b: f32) -> bool {
        (a - b).abs() <= 1e-6 * b.abs().max(1.0)
    }

    /// ψ in double precision: the series from twenty on.
    pub(crate) fn digamma(x: f64) -> f64 {
        let (mut y, mut sum) = (x, 0.0);
        while y < 20.0 {
            sum -= 1.0 / y;
            y += 1.0;
        }
        let z = 1.0 / (y * y);
        sum + y.ln() - 0.5 / y - z * (1.0 / 12.0 - z * (1.0 / 120.0 - z * (1.0 / 252.0 - z / 240.0)))
    }

    #[test]
    fn what_digamma_exceeds_the_logarithm_by_keeps_its_places_far_out() {
        let mut x = 1e-6_f32;
        while x < 1e6 {
            let wanted = digamma(f64::from(x) + 1.0) - f64::from(x).ln();
            let error = (f64::from(digamma_excess(x)) - wanted).abs();
            // The double-precision reference itself loses places to the difference far out.
            let allowed = if x < 6.0 { 5e-7 * wanted.max(1.0) } else { 3e-7 * wanted + 1e-14 };
            assert!(error < allowed, "{x}: {error:e} of {wanted}");
            x *= 1.003;
        }
        assert_eq!((digamma_excess(0.0), digamma_excess(f32::INFINITY)), (f32::INFINITY, 0.0));
        assert!(digamma_excess(-0.5).is_nan());
    }

    #[test]
    fn the_exponential_function_is_accurate_to_a_unit_in_the_last_place() {
        for step in -1_050_000..=900_000 {
            let x = step as f32 * 1e-4;
            let (exact, ours) = (f64::from(x).exp(), exp(x));
            let last_place = (exact * f64::from(f32::EPSILON)).max(f64::from(f32::from_bits(1)));
            let largest = f64::from(f32::MAX);
            let fits = if exact > largest {
                ours == f32::INFINITY
            } else {
                (f64::from(ours) - exact).abs() <= last_place
            };
            assert!(fits, "exp({x}) is {ours:e}, not {exact:e}");
        }
        assert_eq!([exp(0.0), exp(-0.0), exp(f32::NEG_INFINITY)], [1.0, 1.0, 0.0]);
        assert_eq!([exp(f32::INFINITY), exp(f32::MAX), exp(f32::MIN)], [f32::INFINITY, f32::INFINITY, 0.0]);
        assert!(exp(f32::NAN).is_nan());
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
