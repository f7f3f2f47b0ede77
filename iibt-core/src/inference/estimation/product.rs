//! Exact inference over every combination of the states of a few factors.

use super::couplings::Couplings;
use super::{EXACT_LIMIT, Impossible, Work};
use crate::inference::model::{MAX_FACTORS, Model};
use crate::inference::shape::{MAX_CONDITIONS, Shape};
use crate::math;
use heapless::Vec;

/// The factors of a component and the shape of their product.
pub(super) struct Product {
    factors: Vec<usize, MAX_CONDITIONS>,
    shape: Shape,
}

impl Product {
    /// The product of all factors that are coupled here; `None` when it has more combinations than the limit.
    pub(super) fn of(couplings: &Couplings) -> Option<Self> {
        let all = couplings.factors();
        let mut factors = Vec::new();
        let mut states = Vec::<usize, MAX_CONDITIONS>::new();
        let numbered = couplings.model.factors().iter().enumerate();
        for (number, factor) in numbered.filter(|(number, _)| all >> number & 1 == 1) {
            factors.push(number).ok()?;
            states.push(factor.states()).ok()?;
        }
        let shape = Shape::new(1, &states)?;
        shape.columns().filter(|&columns| columns <= EXACT_LIMIT)?;
        Some(Self { factors, shape })
    }

    /// The exact marginals, summed up in the scratch; returns the surprise.
    pub(super) fn update(&self, work: &mut Work, couplings: &Couplings) -> Result<f32, Impossible> {
        let model = couplings.model;
        for &factor in &self.factors {
            model.part_mut(work.scratch, factor).fill(0.0);
        }
        let mut now = [0; MAX_FACTORS];
        self.shape.for_each_column(|_, states| {
            let mass = self.mass(work.posterior, model, couplings, states, &mut now);
            for (&factor, &state) in self.factors.iter().zip(states) {
                if let Some(sum) = model.part_mut(work.scratch, factor).get_mut(state) {
                    *sum += mass;
                }
            }
        });
        let mut surprise = 0.0;
        for &factor in &self.factors {
            let part = model.part_mut(work.scratch, factor);
            let modality = couplings.iter().map(|(number, ..)| number).last().unwrap_or(0);
            surprise = -math::ln(math::normalise(part).ok_or(Impossible { modality })?);
            math::assign(model.part_mut(work.posterior, factor), part);
        }
        Ok(surprise)
    }

    /// The joint probability of these states and of what was observed.
    fn mass(
        &self,
        beliefs: &[f32],
        model: &Model,
        couplings: &Couplings,
        states: &[usize],
        now: &mut [usize; MAX_FACTORS],
    ) -> f32 {
        let mut mass = 1.0;
        for (&factor, &state) in self.factors.iter().zip(states) {
            if let Some(now) = now.get_mut(factor) {
                *now = state;
            }
            mass *= model.part(beliefs, factor).get(state).copied().unwrap_or(0.0);
        }
        for (_, modality, evidence) in couplings.iter() {
            if mass == 0.0 {
                break;
            }
            mass *= modality.probability(evidence, now);
        }
        mass
    }
}
