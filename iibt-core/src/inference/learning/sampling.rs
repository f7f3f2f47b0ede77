//! Seeded randomness for the tests of this folder.

use std::vec::Vec;

/// A linear congruential generator with Knuth's constants.
pub(super) struct Dice(u64);

impl Dice {
    pub(super) fn new(seed: u64) -> Self {
        let mut dice = Self(seed);
        dice.even();
        dice
    }

    /// From 0 up to but not including 1.
    pub(super) fn even(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.even()
    }

    pub(super) fn below(&mut self, count: usize) -> usize {
        ((self.even() * count as f32) as usize).min(count - 1)
    }

    /// A value drawn from a distribution.
    pub(super) fn draw(&mut self, distribution: &[f32]) -> usize {
        crate::inference::policy::sample(distribution, self.even())
    }

    /// The same as a list with a single one.
    pub(super) fn one_of<const K: usize>(&mut self, distribution: &[f32; K]) -> [f32; K] {
        one(self.draw(distribution))
    }

    /// A distribution, some of whose values may be impossible.
    pub(super) fn distribution(&mut self, values: usize) -> Vec<f32> {
        let mut weights: Vec<f32> = (0..values).map(|_| (self.even() - 0.2).max(0.0)).collect();
        if crate::math::normalise(&mut weights).is_none() {
            weights.fill(1.0 / values as f32);
        }
        weights
    }
}

/// Certainty of one value.
pub(super) fn one<const K: usize>(value: usize) -> [f32; K] {
    core::array::from_fn(|at| if at == value { 1.0 } else { 0.0 })
}
