//! A sensor that reads the state itself, with equally probable errors.

use super::Likelihood;
use crate::inference::evidence::{Evidence, sound};
use crate::inference::{Shape, Terms};
use crate::math::{self, Prediction};

/// A = off + (correct - off) I.
///
/// Four numbers whatever the number of states, and every method costs that number at the most.
///
/// ```
/// use iibt_core::inference::{IdentityNoise, Likelihood};
///
/// static LOCALISER: IdentityNoise = IdentityNoise::new(0.9, 5);
/// assert_eq!(LOCALISER.probability(2, &[2]), 0.9);
/// assert!((LOCALISER.probability(3, &[2]) - 0.025).abs() < 1e-7);
///
/// // A number that is only known at run time is held to its range.
/// assert_eq!(IdentityNoise::among(1.7, 5).correct(), 1.0);
/// ```
#[doc(alias = "localiser")]
#[doc(alias = "confusion matrix")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct IdentityNoise {
    correct: f32,
    off: f32,
    states: usize,
    column_entropy: f32,
}

impl IdentityNoise {
    /// A sensor over `states` states that is right with probability `correct`; each other reading
    /// has an equal share of the rest.
    ///
    /// # Panics
    /// When there are fewer than two states or `correct` is no probability; in a `const` this fails
    /// the build.
    #[must_use]
    pub const fn new(correct: f32, states: usize) -> Self {
        assert!(states > 1, "A, the likelihood of an identity with noise, needs two states");
        assert!(correct >= 0.0 && correct <= 1.0, "A, the likelihood: `correct` is no probability");
        Self::among(correct, states)
    }

    /// Builds it from numbers that are only known at run time: `correct` is held to 0..=1, where
    /// NaN is a sensor that knows nothing, and `states` to two at least.
    #[must_use]
    pub const fn among(correct: f32, states: usize) -> Self {
        let states = if states < 2 { 2 } else { states };
        let correct = if correct.is_nan() { 1.0 / states as f32 } else { correct.clamp(0.0, 1.0) };
        let off = (1.0 - correct) / (states - 1) as f32;
        let column_entropy = -math::p_ln_p(correct) - (states - 1) as f32 * math::p_ln_p(off);
        Self { correct, off, states, column_entropy }
    }

    /// The probability of the right reading.
    #[must_use]
    pub const fn correct(&self) -> f32 {
        self.correct
    }

    /// The probability of each single wrong reading.
    #[must_use]
    pub const fn off(&self) -> f32 {
        self.off
    }

    /// Its shape: as many outcomes as states.
    ///
    /// # Panics
    /// When there are more than 65,535 states; in a `const` this fails the build.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        match Shape::new(self.states, &[self.states]) {
            Some(shape) => shape,
            None => panic!("A, the likelihood of an identity with noise, has too many states"),
        }
    }

    fn read(&self, outcome: usize, state: usize) -> f32 {
        match outcome {
            _ if outcome >= self.states || state >= self.states => 0.0,
            _ if outcome == state => self.correct,
            _ => self.off,
        }
    }
}

impl Likelihood for IdentityNoise {
    fn probability(&self, outcome: usize, states: &[usize]) -> f32 {
        states.first().map_or(0.0, |&state| self.read(outcome, state))
    }

    fn expect(&self, _shape: &Shape, beliefs: &[&[f32]], preference: &[f32]) -> Terms {
        let belief = beliefs.first().copied().unwrap_or(&[]);
        let mass = math::sum(belief);
        let (background, signal) = (self.off * mass, self.correct - self.off);
        let prediction = Prediction::of(belief, preference, |q| background + signal * q);
        Terms::of(&prediction, self.column_entropy * mass)
    }

    fn message(&self, shape: &Shape, evidence: Evidence, _: &[&[f32]], _: usize, message: &mut [f32]) {
        match evidence {
            Evidence::Soft(weights) => {
                let weights = || weights.iter().map(|&weight| sound(weight));
                let background = self.off * weights().take(self.states).sum::<f32>();
                let signal = self.correct - self.off;
                message.iter_mut().for_each(|sum| *sum += background);
                message.iter_mut().zip(weights()).for_each(|(sum, weight)| *sum += signal * weight);
            }
            Evidence::Outcome(outcome) if outcome < shape.values() => {
                for (state, sum) in message.iter_mut().enumerate() {
                    *sum += if state == outcome { self.correct } else { self.off };
                }
            }
            Evidence::Outcome(_) => {}
            Evidence::Missing => message.iter_mut().for_each(|sum| *sum += 1.0),
        }
    }
}
