//! The terms of one joint policy by modality and by step, which the core sums up.

use super::numpy::Floors;
use iibt_core::inference::{Beliefs, Model, Terms};
use iibt_core::math;

/// The terms of one policy, in parts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tally {
    /// Summed over steps.
    pub(super) by_modality: Vec<Terms>,
    /// Summed over modalities.
    pub(super) by_step: Vec<Terms>,
    /// What numpy's floors add to the joint information gain.
    pub(super) floors: f64,
}

impl Tally {
    /// Rolls out one policy, an action of each factor by step, over `horizon` steps.
    pub(super) fn of<const S: usize, const G: usize>(
        model: &Model,
        beliefs: &Beliefs<S, G>,
        policy: &[Vec<u8>],
        horizon: usize,
        floors: Option<&Floors>,
    ) -> Self {
        let mut tally = Self {
            by_modality: vec![Terms::ZERO; model.modalities().len()],
            by_step: Vec::new(),
            floors: 0.0,
        };
        let mut predicted = *beliefs;
        for step in 0..horizon {
            let actions: Vec<Option<u8>> =
                (0..model.factors().len()).map(|factor| policy.get(step).map(|row| row[factor])).collect();
            predicted.predict(model, &actions);
            tally.add(model, &predicted);
            if let Some(floors) = floors {
                let parts: Vec<_> =
                    (0..model.factors().len()).map(|factor| predicted.of(model, factor)).collect();
                tally.floors += floors.correction(&parts);
            }
        }
        tally
    }

    fn add<const S: usize, const G: usize>(&mut self, model: &Model, predicted: &Beliefs<S, G>) {
        let mut sum = Terms::ZERO;
        for (modality, total) in model.modalities().iter().zip(&mut self.by_modality) {
            let parts: Vec<_> =
                modality.factors().iter().map(|&factor| predicted.of(model, factor)).collect();
            let preference = modality.preference();
            let mut terms = modality.likelihood().expect(modality.shape(), &parts, preference);
            terms.utility -= math::log_sum_exp(preference);
            *total += terms;
            sum += terms;
        }
        self.by_step.push(sum);
    }
}
