//! A Dirichlet distribution: the knowledge about a distribution, in counts.

use crate::math;

/// The most counts that one distribution holds: beyond it all are scaled down together, which keeps
/// their proportions and forgets a little. A single count is a hundred times the last place of an
/// `f32` of this size.
pub const MOST: f32 = 65_536.0;

/// The least counts that one distribution holds: with fewer it becomes one count, spread evenly.
pub const LEAST: f32 = 1e-6;

/// A Dirichlet distribution over distributions of `K` values, given by its counts: finite, not
/// negative, between [`LEAST`] and [`MOST`] in all.
///
/// A value with count zero is impossible, until it is counted.
///
/// ```
/// use iibt_core::inference::learning::Dirichlet;
///
/// let mut coin = Dirichlet::new([1.0, 1.0]);
/// let unknown = coin.novelty();
/// coin.add(6.0, &[1.0, 0.0]); // six times heads
/// assert_eq!(coin.expected(), [0.875, 0.125]);
/// assert!(coin.novelty() < unknown); // another toss tells less
/// coin.forget(1.0, &Dirichlet::new([1.0, 1.0]));
/// assert_eq!(coin.total(), 2.0);
/// ```
#[doc(alias = "concentration parameters")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dirichlet<const K: usize> {
    counts: [f32; K],
    total: f32,
}

impl<const K: usize> Dirichlet<K> {
    /// No counts, as working memory.
    pub(super) const EMPTY: Self = Self { counts: [0.0; K], total: 0.0 };

    /// A distribution from its counts. Counts that are negative or NaN count as zero, and all are
    /// brought between the limits.
    #[must_use]
    pub fn new(counts: [f32; K]) -> Self {
        const { assert!(K > 0, "a distribution has at least one value") }
        let mut new = Self { counts, total: 1.0 };
        new.settle();
        new
    }

    /// The counts.
    #[must_use]
    pub const fn counts(&self) -> &[f32; K] {
        &self.counts
    }

    /// Their sum, a0.
    #[must_use]
    pub const fn total(&self) -> f32 {
        self.total
    }

    /// a / a0, the expected probability of a value; zero for one that does not exist.
    #[must_use]
    pub fn probability(&self, value: usize) -> f32 {
        self.counts.get(value).map_or(0.0, |count| count / self.total)
    }

    /// The expected distribution, a / a0.
    #[must_use]
    pub fn expected(&self) -> [f32; K] {
        self.counts.map(|count| count / self.total)
    }

    /// The expected distribution on a log scale, no value below `least`, which is held to -80..=0,
    /// and zero for NaN.
    #[must_use]
    pub fn ln_expected(&self, least: f32) -> [f32; K] {
        let least = -super::held(-least, 80.0);
        self.expected().map(|p| math::ln(p).max(least).min(0.0))
    }

    /// I(o; θ), the expected information of the next value about the distribution θ itself, in
    /// nats: exactly
    ///
    /// H\[E θ\] - E H\[θ\] = Σ_k a_k/a0 (ψ(a_k + 1) - ln a_k) - (ψ(a0 + 1) - ln a0).
    ///
    /// The logarithms of large counts cancel before they are taken, so nothing is lost when counts
    /// grow. Between 0 and ln `K`, and (`K` - 1) / 2 a0 when there are many counts, which is what
    /// the usual approximation Σ_k a_k/a0 (1/a_k - 1/a0) / 2 comes to at any number (Da Costa et
    /// al. 2020, "Active inference on discrete state-spaces").
    #[must_use]
    pub fn novelty(&self) -> f32 {
        // x (ψ(x + 1) - ln x) goes to zero with x.
        let part = |x: f32| if x > 0.0 { x * math::digamma_excess(x) } else { 0.0 };
        let known = part(self.total);
        let sum: f32 = self.counts.iter().map(|&count| part(count)).sum();
        ((sum - known) / self.total).max(0.0)
    }

    /// Moves the counts by a `share` towards those of `prior`; 0 changes nothing, and 1 forgets
    /// all.
    pub fn forget(&mut self, share: f32, prior: &Self) {
        let kept = 1.0 - super::held(share, 1.0);
        for (count, prior) in self.counts.iter_mut().zip(&prior.counts) {
            *count = prior + kept * (*count - prior);
        }
        self.settle();
    }

    /// Adds `weight` counts, distributed by `shares`. What is negative or NaN counts as zero.
    pub fn add(&mut self, weight: f32, shares: &[f32; K]) {
        for (count, share) in self.counts.iter_mut().zip(shares) {
            *count += super::held(weight * share, MOST);
        }
        self.settle();
    }

    /// Brings the counts between the limits, and sums them.
    fn settle(&mut self) {
        self.counts = self.counts.map(|count| super::held(count, MOST));
        let sum = math::sum(&self.counts);
        if sum < LEAST {
            self.counts = [1.0 / K as f32; K];
        } else if sum > MOST {
            self.counts = self.counts.map(|count| count * (MOST / sum));
        }
        self.total = math::sum(&self.counts);
    }
}

#[cfg(test)]
mod tests {
    use super::super::sampling::Dice;
    use super::*;
    use crate::math::tests::digamma;
    use std::vec::Vec;

    /// H[E θ] - E H[θ] as it is defined, in double precision.
    fn novelty(counts: &[f32]) -> f64 {
        let counts: Vec<f64> =
            counts.iter().map(|&count| f64::from(count)).filter(|count| *count > 0.0).collect();
        let total: f64 = counts.iter().sum();
        let entropy: f64 = counts.iter().map(|a| -a / total * (a / total).ln()).sum();
        let expected: f64 =
            counts.iter().map(|a| -a / total * (digamma(a + 1.0) - digamma(total + 1.0))).sum();
        entropy - expected
    }

    #[test]
    fn novelty_agrees_with_double_precision_over_ten_decades() {
        let mut dice = Dice::new(1);
        let mut worst = 0.0_f64;
        for _ in 0..20_000 {
            let mut counts = core::array::from_fn::<_, 5, _>(|_| math::exp(dice.between(-13.0, 9.0)));
            if dice.even() < 0.2 {
                counts[0] = 0.0;
            }
            let dirichlet = Dirichlet::new(counts);
            let error = (f64::from(dirichlet.novelty()) - novelty(dirichlet.counts())).abs();
            worst = worst.max(error * f64::from(dirichlet.total().max(1.0)));
        }
        // In nats, of one count; a thousandth of that for a thousand counts.
        assert!(worst < 4e-6, "{worst:e}");
    }

    #[test]
    fn novelty_is_what_integration_finds() {
        // E H[θ] under a Beta distribution, by the midpoint rule.
        let (a, b) = (2.0_f64, 3.5);
        let steps = 200_000;
        let (mut mass, mut entropy) = (0.0, 0.0);
        for step in 0..steps {
            let p = (f64::from(step) + 0.5) / f64::from(steps);
            let density = p.powf(a - 1.0) * (1.0 - p).powf(b - 1.0);
            mass += density;
            entropy -= density * (p * p.ln() + (1.0 - p) * (1.0 - p).ln());
        }
        let mean = a / (a + b);
        let wanted = -mean * mean.ln() - (1.0 - mean) * (1.0 - mean).ln() - entropy / mass;
        let found = f64::from(Dirichlet::new([2.0, 3.5]).novelty());
        assert!((found - wanted).abs() < 1e-6, "{found} for {wanted}");
    }

    #[test]
    fn novelty_lies_between_zero_and_all_and_falls_with_data() {
        let mut dirichlet = Dirichlet::new([1e-3; 3]);
        let mut dice = Dice::new(2);
        let mut before = dirichlet.novelty();
        assert!(before > 0.0 && before <= math::ln(3.0) + 1e-6);
        for _ in 0..2000 {
            dirichlet.add(1.0, &dice.one_of(&[0.2, 0.3, 0.5]));
            let now = dirichlet.novelty();
            assert!(now >= 0.0 && now < math::ln(3.0));
            before = before.min(now);
        }
        // (K - 1) / 2 a0 when there is much data.
        assert!((dirichlet.novelty() * 2000.0 - 1.0).abs() < 0.01);
        assert_eq!(dirichlet.novelty(), before);
        assert_eq!(Dirichlet::new([7.0]).novelty(), 0.0);
        assert_eq!(Dirichlet::new([7.0, 0.0]).novelty(), 0.0);
    }

    #[test]
    fn a_full_column_keeps_its_proportions_and_goes_on_learning() {
        let mut dirichlet = Dirichlet::new([f32::INFINITY, f32::MAX]);
        assert_eq!(dirichlet.expected(), [0.5, 0.5]);
        assert!(dirichlet.total() <= MOST);
        for _ in 0..2 * MOST as usize {
            dirichlet.add(1.0, &[1.0, 0.0]);
        }
        // All but exp(-2) of what was there is forgotten.
        assert!((dirichlet.probability(1) - 0.5 * math::exp(-2.0)).abs() < 0.01, "{dirichlet:?}");
    }

    #[test]
    fn whatever_is_added_or_forgotten_it_stays_a_distribution() {
        let odd =
            [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 0.0, -0.0, 1e-45, 1e-30, f32::MAX, 1.0, 0.3];
        let mut dice = Dice::new(3);
        let mut dirichlet = Dirichlet::new([1.0; 4]);
        for _ in 0..50_000 {
            let mut pick = || odd[dice.below(odd.len())];
            if pick() > 0.5 {
                dirichlet.add(pick(), &[pick(), pick(), pick(), pick()]);
            } else {
                dirichlet.forget(pick(), &Dirichlet::new([pick(), pick(), pick(), pick()]));
            }
            assert!(math::is_distribution(&dirichlet.expected()), "{dirichlet:?}");
            assert!(dirichlet.ln_expected(-16.0).iter().all(|c| (-16.0..=0.0).contains(c)));
            assert!(dirichlet.novelty().is_finite() && dirichlet.total() <= MOST * 1.001, "{dirichlet:?}");
        }
    }
}
