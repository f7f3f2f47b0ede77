//! The terms of one joint policy by modality and by step, which the core sums up.

use super::numpy::Floors;
use iibt_core::inference::explanation::{Source, trace};
use iibt_core::inference::{Gain, OutOfRange, Problem, Scoring, Terms};

/// The terms of one policy, in parts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tally {
    /// Summed over steps.
    pub(super) by_modality: Vec<Terms>,
    /// Summed over modalities.
    pub(super) by_step: Vec<Terms>,
    /// The addition of numpy's floors to the joint information gain.
    pub(super) floors: f64,
}

impl Tally {
    /// Rolls out one of a problem's joint policies by itself, every modality's gain its own.
    pub(super) fn of<const S: usize, const G: usize>(
        problem: &Problem<'_, S, G>,
        policy: usize,
        floors: Option<&Floors>,
    ) -> Result<Self, OutOfRange> {
        let mut tally = Self {
            by_modality: vec![Terms::ZERO; problem.model.modalities().len()],
            by_step: vec![Terms::ZERO; problem.horizon],
            floors: floors.map_or(Ok(0.0), |floors| correction(problem, policy, floors))?,
        };
        let scoring = Scoring { gain: Gain::PerModality, ..problem.scoring };
        trace(&Problem { scoring, ..*problem }, policy, |part| {
            if let Source::Modality(modality) = part.source {
                tally.by_modality[modality] += part.terms;
            }
            tally.by_step[part.step - 1] += part.terms;
        })?;
        Ok(tally)
    }
}

/// The addition of numpy's floors to the joint information gain of a policy.
fn correction<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
    policy: usize,
    floors: &Floors,
) -> Result<f64, OutOfRange> {
    let (model, candidates) = (problem.model, problem.candidates);
    let mut predicted = *problem.beliefs;
    let step = |step: usize| {
        let of = |control| candidates.actions(control, candidates.sequence(policy, control));
        let actions: Vec<Option<u8>> = (0..model.controls()).map(|control| of(control).get(step)).collect();
        predicted.predict(model, &actions)?;
        let parts = (0..model.factors().len()).map(|factor| predicted.of(model, factor));
        Ok(floors.correction(&parts.collect::<Result<Vec<_>, _>>()?))
    };
    (0..problem.horizon).map(step).sum()
}
