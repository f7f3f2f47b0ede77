//! q(s), what a robot believes about the hidden factors, and how actions and observations change it.

use super::evidence::Evidence;
use super::estimation::{self, Impossible, Update};
use super::model::Model;
use crate::actions::Action;
use crate::math;

/// A distribution over the states of each factor of a model, one after the other in a list of `N` numbers, the sum of
/// the factors' states. Every method keeps them distributions: finite, not negative, summing to one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beliefs<const N: usize>([f32; N]);

impl<const N: usize> Beliefs<N> {
    /// D, the belief before the first observation. With fewer than [`Model::states`] numbers, factors that find no room have
    /// no belief, and nothing is inferred about them.
    #[must_use]
    pub fn prior(model: &Model) -> Self {
        let mut flat = [0.0; N];
        for factor in 0..model.factors().len() {
            let part = model.part_mut(&mut flat, factor);
            part.iter_mut().zip(model.prior(factor)).for_each(|(q, d)| *q = *d);
        }
        Self(flat)
    }

    /// The belief about one factor; empty where there is no such factor.
    #[must_use]
    pub fn of(&self, model: &Model, factor: usize) -> &[f32] {
        model.part(&self.0, factor)
    }

    /// All beliefs, factor after factor.
    #[must_use]
    pub const fn as_flat(&self) -> &[f32; N] {
        &self.0
    }

    pub(super) const fn as_flat_mut(&mut self) -> &mut [f32; N] {
        &mut self.0
    }

    /// The most probable state of one factor and its probability; the first of equals.
    #[must_use]
    pub fn most_likely(&self, model: &Model, factor: usize) -> (usize, f32) {
        let part = self.of(model, factor);
        let state = math::argmax(part);
        (state, part.get(state).copied().unwrap_or(0.0))
    }

    /// Replaces the belief about one factor by one in proportion to `weights`; returns whether it did. It does not when
    /// there are not as many weights as states, or they are no weights or sum to nothing.
    pub fn set(&mut self, model: &Model, factor: usize, weights: &[f32]) -> bool {
        let part = model.part_mut(&mut self.0, factor);
        let sum: f32 = weights.iter().sum();
        let sound = weights.iter().all(|weight| *weight >= 0.0) && sum > 0.0 && sum.is_finite();
        if !sound || part.len() != weights.len() {
            return false;
        }
        part.iter_mut().zip(weights).for_each(|(q, weight)| *q = weight / sum);
        true
    }

    /// The beliefs after one step, in which `actions` holds an action for each of the model's action sequences, or `None`
    /// for a robot that stays: q(s') = Σ_s B_u(s', s) q(s). Uncontrolled factors change by themselves.
    pub fn predict(&mut self, model: &Model, actions: &[Option<Action>]) {
        let from = self.0;
        for factor in 0..model.factors().len() {
            let action = match model.control_of(factor) {
                Some(control) => actions.get(control).copied().flatten(),
                None => Some(0),
            };
            if let Some(action) = action {
                let to = model.part_mut(&mut self.0, factor);
                model.move_factor(factor, action, &from, to);
                if math::normalise(to).is_none() {
                    to.iter_mut().zip(model.part(&from, factor)).for_each(|(to, from)| *to = *from);
                }
            }
        }
    }

    /// The beliefs after an observation, with `evidence` for each modality; a modality left out is missing.
    ///
    /// Factors that no observed modality couples are updated by Bayes' rule. Factors that one couples are updated together:
    /// exactly, without storing their product, where that takes no more than [`EXACT_LIMIT`](super::EXACT_LIMIT) steps, else
    /// by coordinate ascent on the free energy. See [`Update`] for what is returned.
    ///
    /// # Errors
    /// [`Impossible`] when the observation has probability zero; the beliefs are left as they were.
    pub fn update(&mut self, model: &Model, evidence: &[Evidence]) -> Result<Update, Impossible> {
        estimation::update(self, model, evidence, estimation::Method::Exact)
    }

    /// The same, coupled factors always by coordinate ascent.
    ///
    /// # Errors
    /// [`Impossible`] as for [`update`](Self::update).
    pub fn update_by_ascent(&mut self, model: &Model, evidence: &[Evidence]) -> Result<Update, Impossible> {
        estimation::update(self, model, evidence, estimation::Method::CoordinateAscent)
    }
}
