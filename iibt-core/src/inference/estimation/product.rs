//! Exact inference over every combination of the states of a few factors.

use super::Work;
use super::couplings::Couplings;
use crate::inference::error::Impossible;
use crate::inference::model::{MAX_FACTORS, Product};
use crate::math;

/// The exact marginals over the product of all factors that are coupled, summed up in the scratch;
/// returns the surprise.
pub(super) fn update(work: &mut Work, couplings: &Couplings, product: &Product) -> Result<f32, Impossible> {
    let model = couplings.members.model;
    for &factor in &product.factors {
        model.part_mut(work.scratch, factor).fill(0.0);
    }
    let mut now = [0; MAX_FACTORS];
    // The last modality that was looked at for any states: where none has any mass, the one that
    // cannot be explained.
    let mut furthest = 0;
    product.shape.for_each_column(|_, states| {
        let mut mass = product.mass(model, work.posterior, states, &mut now);
        for (number, modality, evidence) in couplings.iter() {
            if mass == 0.0 {
                break;
            }
            furthest = number.max(furthest);
            mass *= modality.probability(evidence, &now);
        }
        for (&factor, &state) in product.factors.iter().zip(states) {
            if let Some(sum) = model.part_mut(work.scratch, factor).get_mut(state) {
                *sum += mass;
            }
        }
    });
    let mut surprise = 0.0;
    for &factor in &product.factors {
        let part = model.part_mut(work.scratch, factor);
        surprise = -math::ln(math::normalise(part).ok_or(Impossible { modality: furthest })?);
        math::assign(model.part_mut(work.posterior, factor), part);
    }
    Ok(surprise)
}
