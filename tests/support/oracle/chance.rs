//! What random models are drawn from.
//!
//! The numbers come from the simulator's generator, which shares nothing with what is tested.

use host_sim::Random;

/// Draws of a seed.
#[derive(Clone, Debug)]
pub struct Chance(Random);

impl Chance {
    /// The draws of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(Random::new(seed))
    }

    /// The next 32 bits.
    pub fn bits(&mut self) -> u32 {
        self.0.bits()
    }

    /// A number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        self.0.below(count)
    }

    /// A number from `from` to `to`, both included.
    pub fn within(&mut self, from: usize, to: usize) -> usize {
        from + self.below(to - from + 1)
    }

    /// A number from 0 to 1, 1 excluded.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / (1_u32 << 24) as f32
    }

    /// A number between two others.
    pub fn between(&mut self, from: f32, to: f32) -> f32 {
        from + (to - from) * self.unit()
    }

    /// True once in `times`.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    /// One of a list.
    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }

    /// The numbers below `count` in a random order.
    pub fn order(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            order.swap(last, self.below(last + 1));
        }
        order
    }

    /// A distribution: even, concentrated, with zeros, or certain.
    pub fn distribution(&mut self, count: usize) -> Vec<f32> {
        let style = self.below(8);
        let mut weights: Vec<f32> = (0..count)
            .map(|_| match style {
                0..3 => self.between(0.05, 1.0),
                3..5 => self.unit().powi(6) + 1e-4,
                5..7 if self.once_in(2) => 0.0,
                5..7 => self.between(0.05, 1.0),
                _ => 0.0,
            })
            .collect();
        if weights.iter().sum::<f32>() == 0.0 {
            weights[self.below(count)] = 1.0;
        }
        let sum: f32 = weights.iter().sum();
        weights.iter().map(|weight| weight / sum).collect()
    }
}
