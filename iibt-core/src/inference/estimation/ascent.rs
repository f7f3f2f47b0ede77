//! Coordinate ascent: approximate inference for couplings that are too large for exact inference.

use super::couplings::{Coupling, Couplings};
use super::{Update, Work};
use crate::inference::error::Impossible;
use crate::math;

/// The largest change of a probability in a sweep after which coordinate ascent has converged.
const TOLERANCE: f32 = 2e-6;

/// Sequential coordinate ascent from the beliefs that each factor's own evidence gives: every
/// factor in turn takes the belief that minimises F given the others, q(s_f) ∝ p(s_f) exp Σ_m E ln
/// P(e_m | s_f, s'), in `most` sweeps at the most.
pub(super) fn update(work: &mut Work, couplings: &Couplings, most: u8) -> Result<Update, Impossible> {
    for coupling in couplings.iter() {
        if !is_possible(work, couplings, coupling) {
            return Err(Impossible { modality: coupling.0 });
        }
    }
    math::assign(work.prior, work.posterior);
    let mut update = Update { free_energy: f32::INFINITY, exact: false, converged: false, sweeps: 0 };
    while !update.converged && update.sweeps < most {
        let change =
            factors(couplings).fold(0.0_f32, |most, factor| most.max(ascend(work, couplings, factor)));
        update.sweeps += 1;
        update.converged = change <= TOLERANCE;
    }
    update.free_energy = free_energy(work, couplings);
    Ok(update)
}

fn factors(couplings: &Couplings) -> impl Iterator<Item = usize> {
    let coupled = couplings.members.factors();
    (0..couplings.members.model.factors().len()).filter(move |factor| coupled >> factor & 1 == 1)
}

/// Whether an observation has any probability under the beliefs.
fn is_possible(work: &mut Work, couplings: &Couplings, (_, modality, evidence): Coupling) -> bool {
    let Some(&factor) = modality.factors().first() else { return false };
    let message = couplings.members.model.part_mut(work.scratch, factor);
    let conditions = couplings.members.model.parts(work.posterior, modality.factors());
    message.fill(0.0);
    modality.likelihood().message(modality.shape(), evidence, conditions.as_slice(), 0, message);
    math::expectation(couplings.members.model.part(work.posterior, factor), message) > 0.0
}

/// Sets the belief of one factor to the best one given the others; returns the largest change of a
/// probability.
fn ascend(work: &mut Work, couplings: &Couplings, factor: usize) -> f32 {
    let model = couplings.members.model;
    let scores = model.part_mut(work.scratch, factor);
    scores.fill(0.0);
    for (_, modality, evidence) in couplings.iter() {
        if let Some(condition) = modality.factors().iter().position(|&of| of == factor) {
            let conditions = model.parts(work.posterior, modality.factors());
            let (form, shape) = (modality.likelihood(), modality.shape());
            form.log_message(shape, evidence, conditions.as_slice(), condition, scores);
        }
    }
    for (score, p) in scores.iter_mut().zip(model.part(work.prior, factor)) {
        *score += math::ln(*p);
    }
    math::softmax(scores);
    let belief = model.part_mut(work.posterior, factor);
    let changes = belief.iter().zip(scores.iter()).map(|(old, new)| (old - new).abs());
    let change = changes.fold(0.0_f32, f32::max);
    math::assign(belief, scores);
    change
}

/// F = Σ_f KL[q_f || p_f] - Σ_m E_q ln max(P(e_m | s), floor), over the factors and observations of
/// a component.
fn free_energy(work: &mut Work, couplings: &Couplings) -> f32 {
    let model = couplings.members.model;
    let mut total = 0.0;
    for factor in factors(couplings) {
        total += math::kl(model.part(work.posterior, factor), model.part(work.prior, factor));
    }
    for (_, modality, evidence) in couplings.iter() {
        let Some(&factor) = modality.factors().first() else { continue };
        let scores = model.part_mut(work.scratch, factor);
        let conditions = model.parts(work.posterior, modality.factors());
        scores.fill(0.0);
        modality.likelihood().log_message(modality.shape(), evidence, conditions.as_slice(), 0, scores);
        total -= math::expectation(model.part(work.posterior, factor), scores);
    }
    total
}
