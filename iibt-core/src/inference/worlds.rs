//! Worlds: what a team does not know and what does not change, in a list of which one is real.

use super::error::{Argument, OutOfRange, at_most};
use super::shape::Shape;
use crate::math;
use heapless::Vec;

/// The combinations of the values of some unknowns, with their prior probabilities.
///
/// An unknown is a hidden factor that keeps its value: a door that is open or shut, the one of four
/// goals that serves. A world is a value for each of them; the last unknown changes fastest from
/// one world to the next. Memory is four bytes for each of up to `H` worlds.
///
/// Evidence is a number of nats for each value of each unknown: the sum of the log-likelihoods of
/// all readings, up to a constant. Sums are the same in whatever order they are made, so robots
/// that announce their sums have one belief in common.
///
/// ```
/// use iibt_core::inference::Worlds;
///
/// // One of three goals serves; a door is shut with probability 1/4.
/// let worlds = Worlds::<8>::new(&[&[0.5, 0.3, 0.2], &[0.75, 0.25]])?;
/// assert_eq!(worlds.len(), 6);
/// assert_eq!((worlds.value(3, 0), worlds.value(3, 1)), (1, 1)); // the second goal, the door shut
///
/// let prior = worlds.belief(|_, _| 0.0);
/// assert!((prior[3] - 0.3 * 0.25).abs() < 1e-6);
///
/// // A reading that is nine times as likely where the door is shut.
/// let shut = |unknown, value| if (unknown, value) == (1, 1) { 9.0_f32.ln() } else { 0.0 };
/// let belief = worlds.belief(shut);
/// assert!((worlds.probability(&belief, 1, 1) - 0.75).abs() < 1e-6); // 1/4 x 9 to 3/4
/// assert!((worlds.probability(&belief, 0, 0) - 0.5).abs() < 1e-6);
/// # Ok::<(), iibt_core::inference::OutOfRange>(())
/// ```
#[doc(alias = "hidden state")]
#[doc(alias = "scenario tree")]
#[derive(Clone, Debug, PartialEq)]
pub struct Worlds<const H: usize> {
    shape: Option<Shape>,
    /// ln P of each world.
    prior: Vec<f32, H>,
}

impl<const H: usize> Worlds<H> {
    /// No world: a place to keep some.
    pub const NONE: Self = Self { shape: None, prior: Vec::new() };

    /// One world: nothing is unknown.
    #[must_use]
    pub fn certain() -> Self {
        Self { shape: None, prior: core::iter::once(0.0).take(H).collect() }
    }

    /// The worlds of unknowns with these priors, each a distribution over the values of one.
    ///
    /// # Errors
    /// [`OutOfRange`] when there are more worlds than `H` or more unknowns than
    /// [`MAX_CONDITIONS`](super::MAX_CONDITIONS), or a prior is no distribution.
    pub fn new(priors: &[&[f32]]) -> Result<Self, OutOfRange> {
        if priors.is_empty() {
            return Ok(Self::certain());
        }
        let mut sizes = [1; super::MAX_CONDITIONS];
        at_most(Argument::Unknowns, 0, priors.len(), sizes.len())?;
        for (unknown, (size, prior)) in sizes.iter_mut().zip(priors).enumerate() {
            *size = prior.len();
            if !math::is_distribution(prior) {
                return Err(OutOfRange::new(Argument::Prior, unknown, prior.len(), 0));
            }
        }
        let shape = Shape::new(1, sizes.get(..priors.len()).unwrap_or_default());
        let count = shape.and_then(|shape| shape.columns()).unwrap_or(usize::MAX);
        at_most(Argument::Worlds, 0, count, H)?;
        let mut worlds = Self { shape, prior: Vec::new() };
        for world in 0..count {
            let p = |(unknown, prior): (usize, &&[f32])| prior.get(worlds.value(world, unknown)).copied();
            let p: f32 = priors.iter().enumerate().filter_map(p).product();
            // There is room: that was asked.
            let _ = worlds.prior.push(math::ln(p));
        }
        Ok(worlds)
    }

    /// The number of worlds.
    #[must_use]
    pub fn len(&self) -> usize {
        self.prior.len()
    }

    /// Whether there is no world: where there is no room for one.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.prior.is_empty()
    }

    /// The number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.shape.map_or(0, |shape| shape.conditions())
    }

    /// The number of values of an unknown; one where there is no such unknown.
    #[must_use]
    pub fn values(&self, unknown: usize) -> usize {
        self.shape.map_or(1, |shape| shape.states(unknown))
    }

    /// The value of an unknown in a world; zero where there is no such unknown or world.
    #[must_use]
    pub fn value(&self, world: usize, unknown: usize) -> usize {
        let faster = (unknown + 1..self.unknowns()).map(|other| self.values(other)).product::<usize>();
        (world / faster.max(1)).checked_rem(self.values(unknown)).unwrap_or(0)
    }

    /// The belief over the worlds: P(h) ∝ prior(h) exp(sum of the evidence for its values).
    ///
    /// `evidence` gives nats for an unknown and one of its values. Evidence that is not finite is
    /// none. Costs an exponential a world.
    #[must_use]
    pub fn belief(&self, evidence: impl Fn(usize, usize) -> f32) -> Vec<f32, H> {
        let mut belief = self.prior.clone();
        for (world, p) in belief.iter_mut().enumerate() {
            let nats = (0..self.unknowns()).map(|unknown| evidence(unknown, self.value(world, unknown)));
            *p += nats.filter(|nats| nats.is_finite()).sum::<f32>();
        }
        math::softmax(&mut belief);
        belief
    }

    /// The probability that an unknown has a value, by a belief over the worlds.
    #[must_use]
    pub fn probability(&self, belief: &[f32], unknown: usize, value: usize) -> f32 {
        let has_value = |(world, _): &(usize, &f32)| self.value(*world, unknown) == value;
        belief.iter().enumerate().filter(has_value).map(|(_, p)| p).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_belief_is_bayes_rule_over_all_combinations() {
        let priors: [&[f32]; 3] = [&[0.2, 0.8], &[0.5, 0.25, 0.25], &[0.9, 0.1]];
        let worlds = Worlds::<12>::new(&priors).unwrap();
        let nats = |unknown: usize, value: usize| (unknown as f32 - 1.0) * (value as f32 + 0.5);
        let belief = worlds.belief(nats);
        let mut weights = std::vec::Vec::new();
        for first in 0..2 {
            for second in 0..3 {
                for third in 0..2 {
                    let values = [first, second, third];
                    let world = weights.len();
                    assert_eq!([0, 1, 2].map(|unknown| worlds.value(world, unknown)), values);
                    let weight: f32 =
                        (0..3).map(|at| priors[at][values[at]] * math::exp(nats(at, values[at]))).product();
                    weights.push(weight);
                }
            }
        }
        let sum: f32 = weights.iter().sum();
        assert!(belief.iter().zip(&weights).all(|(p, weight)| (p - weight / sum).abs() < 1e-6));
        let marginal = worlds.probability(&belief, 1, 2);
        let brute: f32 = (0..12).filter(|world| world / 2 % 3 == 2).map(|world| weights[world] / sum).sum();
        assert!((marginal - brute).abs() < 1e-6);
    }

    #[test]
    fn what_is_impossible_stays_impossible_and_odd_evidence_is_none() {
        let worlds = Worlds::<4>::new(&[&[1.0, 0.0], &[0.5, 0.5]]).unwrap();
        let belief =
            worlds.belief(|unknown, value| if unknown == 0 { 50.0 * value as f32 } else { f32::NAN });
        assert_eq!(belief.as_slice(), [0.5, 0.5, 0.0, 0.0]);
    }

    #[test]
    fn too_many_worlds_and_priors_that_are_none_are_refused() {
        let error = Worlds::<3>::new(&[&[0.5; 2], &[0.5; 2]]).unwrap_err();
        assert_eq!(error, OutOfRange { what: Argument::Worlds, index: 0, value: 4, limit: 3 });
        assert!(Worlds::<4>::new(&[&[0.5, 0.6]]).is_err() && Worlds::<4>::new(&[&[]]).is_err());
        assert!(Worlds::<4>::new(&[&[1.0][..]; 9]).is_err());
        let certain = Worlds::<1>::new(&[]).unwrap();
        assert_eq!((certain.len(), certain.value(0, 0), certain.belief(|_, _| 1.0)[0]), (1, 0, 1.0));
    }
}
