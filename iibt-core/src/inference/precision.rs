//! γ, the weight of the expected free energy in a choice, updated by how well it predicted the
//! choice.

use crate::math;

/// The steps of one update.
const ITERATIONS: usize = 16;

/// The largest number that an update takes; larger ones are cut off.
const LARGEST: f32 = 1e30;

/// The precision γ = 1/β of policies with a gamma prior of mean 1/β0, as in SPM's `spm_MDP_VB_X`
/// and Friston et al. 2017 ("Active inference: a process theory"):
///
/// β = β0 + (π - π0) · G, with π0 = softmax(ln E - γ G) and π = softmax(ln E - F - γ G).
///
/// F is what each policy failed to explain of what was observed since it could have been begun.
/// Where that speaks for the policies that G was for, the mean of G falls from π0 to π, and γ
/// rises; where it speaks against them, γ falls. With equal F, as where all policies have the same
/// past, γ comes to its prior.
///
/// ```
/// use iibt_core::inference::{Precision, Scoring};
///
/// let mut precision = Precision::new(2.0);
/// // The first policy was the better one, and explains the observations better than the second.
/// let gamma = precision.update(&[], &[0.1, 3.0], &[1.0, 2.0]);
/// assert!(gamma > 2.0);
/// let scoring = Scoring { precision: gamma, ..Scoring::DEFAULT };
/// # let _ = scoring;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Precision {
    prior: f32,
    beta: f32,
    least: f32,
    most: f32,
}

impl Precision {
    /// The least and the largest γ unless [`within`](Self::within) says otherwise.
    pub const RANGE: (f32, f32) = (1.0 / 64.0, 1024.0);

    /// A precision with this prior, held to the range; NaN counts as one.
    #[must_use]
    pub const fn new(prior: f32) -> Self {
        let prior = if prior.is_nan() { 1.0 } else { prior };
        let new = Self { prior: 1.0, beta: 1.0, least: 1.0 / Self::RANGE.1, most: 1.0 / Self::RANGE.0 };
        let beta = 1.0 / prior.clamp(Self::RANGE.0, Self::RANGE.1);
        Self { prior: beta, beta, ..new }
    }

    /// Limits γ to a range between 1e-6 and 1e6; a NaN or an empty range changes nothing.
    #[must_use]
    pub const fn within(self, least: f32, most: f32) -> Self {
        if least.is_nan() || most.is_nan() || least > most {
            return self;
        }
        let (least, most) = (1.0 / most.clamp(1e-6, 1e6), 1.0 / least.clamp(1e-6, 1e6));
        Self { prior: self.prior.max(least).min(most), beta: self.beta.max(least).min(most), least, most }
    }

    /// γ, positive and finite.
    #[must_use]
    pub const fn gamma(&self) -> f32 {
        1.0 / self.beta
    }

    /// Updates γ, and returns it, from ln E, F and G of each policy, in nats, G lower is better. A
    /// list that is too short goes on with zeros, so an empty `ln_prior` is no habit; there are as
    /// many policies as `expected`.
    ///
    /// From where γ is, sixteen steps, each half of the way, as in SPM. A policy with a NaN is left
    /// out, one whose ln E is minus infinity is never chosen, and without policies γ comes to its
    /// prior. Costs 32 exponentials for each policy.
    pub fn update(&mut self, ln_prior: &[f32], free_energies: &[f32], expected: &[f32]) -> f32 {
        for _ in 0..ITERATIONS {
            let gamma = self.gamma();
            let after = mean(gamma, ln_prior, free_energies, expected);
            let before = mean(gamma, ln_prior, &[], expected);
            let target = self.prior + (after - before);
            self.beta = (0.5 * (self.beta + target)).max(self.least).min(self.most);
        }
        self.gamma()
    }

    /// Puts γ back to its prior.
    pub const fn reset(&mut self) {
        self.beta = self.prior;
    }
}

impl Default for Precision {
    /// A prior of one.
    fn default() -> Self {
        Self::new(1.0)
    }
}

/// The mean of G under softmax(ln E - F - γ G); zero without policies.
fn mean(gamma: f32, ln_prior: &[f32], free_energies: &[f32], expected: &[f32]) -> f32 {
    let zeros = || core::iter::repeat(&0.0);
    let policies =
        expected.iter().zip(ln_prior.iter().chain(zeros())).zip(free_energies.iter().chain(zeros()));
    let scored = policies
        .map(|((g, ln_e), f)| {
            let [g, ln_e, f] = [g, ln_e, f].map(|x| x.clamp(-LARGEST, LARGEST));
            (ln_e - f - gamma * g, g)
        })
        .filter(|(score, _)| !score.is_nan());
    let best = scored.clone().map(|(score, _)| score).fold(f32::NEG_INFINITY, f32::max);
    let (mut mass, mut sum) = (0.0, 0.0);
    for (score, g) in scored {
        let weight = math::exp(score - best);
        mass += weight;
        sum += weight * g;
    }
    if mass > 0.0 { sum / mass } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// The fixed point of β = β0 + (π - π0) · G in double precision, by many small steps.
    fn reference(prior: f64, ln_e: &[f64], f: &[f64], g: &[f64]) -> f64 {
        let mean = |gamma: f64, with: f64| {
            let weights: Vec<f64> =
                (0..g.len()).map(|i| (ln_e[i] - with * f[i] - gamma * g[i]).exp()).collect();
            weights.iter().zip(g).map(|(w, g)| w * g).sum::<f64>() / weights.iter().sum::<f64>()
        };
        let mut beta = 1.0 / prior;
        for _ in 0..20_000 {
            let target = 1.0 / prior + mean(1.0 / beta, 1.0) - mean(1.0 / beta, 0.0);
            beta = (beta + 0.01 * (target - beta)).max(1.0 / 1024.0);
        }
        1.0 / beta
    }

    #[test]
    fn gamma_comes_to_the_fixed_point() {
        let (ln_e, g) = ([-0.5, -1.5, -2.0], [0.9, 0.4, 1.1]);
        for f in [[0.0, 0.0, 0.0], [0.6, 0.1, 0.4], [0.0, 0.9, 0.2], [3.0, 3.2, 2.9]] {
            let wanted = reference(2.0, &ln_e.map(f64::from), &f.map(f64::from), &g.map(f64::from));
            let mut precision = Precision::new(2.0);
            let gamma = f64::from(precision.update(&ln_e, &f, &g));
            assert!((gamma / wanted - 1.0).abs() < 1e-3, "{gamma} for {wanted}");
        }
    }

    #[test]
    fn gamma_rises_with_what_bears_g_out_and_falls_with_what_does_not() {
        let g = [1.0, 2.0, 3.0];
        let mut precision = Precision::new(1.0);
        assert!(precision.update(&[], &[0.0, 1.0, 2.0], &g) > 1.05);
        precision.reset();
        assert!(precision.update(&[], &[2.0, 1.0, 0.0], &g) < 0.95);
        // Without evidence it comes back to the prior: half of the way in each step.
        assert!((precision.update(&[], &[], &g) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn gamma_stays_in_its_range_whatever_is_given() {
        let odd =
            [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 0.0, 1.0, -1.0, 1e-45, 5.0];
        let mut seed = 9_u32;
        let mut pick = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            odd[(seed >> 16) as usize % odd.len()]
        };
        for _ in 0..5000 {
            let (least, most) = (pick(), pick());
            let mut precision = Precision::new(pick()).within(least, most);
            for _ in 0..4 {
                let gamma =
                    precision.update(&[pick(), pick()], &[pick(), pick(), pick()], &[pick(), pick(), pick()]);
                assert!(gamma > 0.9e-6 && gamma < 1.1e6, "{gamma}");
                if least <= most && least >= 1e-6 && most <= 1e6 {
                    assert!(gamma >= 0.999 * least && gamma <= 1.001 * most, "{gamma} in {least}..={most}");
                }
            }
        }
        assert_eq!(Precision::default().update(&[], &[], &[]), 1.0);
    }
}
