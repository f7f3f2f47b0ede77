//! The joint information gain: the expected information of all modalities together about all
//! states.

use super::belief::Beliefs;
use super::evidence::Evidence;
use super::model::{MAX_FACTORS, MAX_MODALITIES, Members, Modality, Model};
use crate::math;

/// The components of some modalities, a bit for each. What different components tell is
/// independent, so their gains add up.
pub(super) fn components<'a, 'm>(model: &'a Model<'m>, bits: u64) -> impl Iterator<Item = Members<'a, 'm>> {
    let mut left = Members { model, bits };
    core::iter::from_fn(move || left.take_component())
}

/// I(o_1, ..., o_M; s) = H[q(o_1, ..., o_M)] - Σ_m ambiguity_m of a component, under independent
/// beliefs.
///
/// Every combination of outcomes is visited, but for those of the modality with the most
/// conditions, which are predicted from the beliefs that the others leave. With one modality that
/// couples factors a visit costs the factors' states and a prediction; with more, every combination
/// of states.
pub(super) fn of<const S: usize, const G: usize>(component: &Members, beliefs: &Beliefs<S, G>) -> f32 {
    let mut ambiguity = 0.0;
    for (_, modality) in component.iter() {
        let parts = component.model.parts(beliefs.as_flat(), modality.factors());
        let expected =
            modality.likelihood().expect(modality.shape(), parts.as_slice(), modality.preference());
        ambiguity += expected.ambiguity;
        if component.bits.is_power_of_two() {
            return expected.entropy() - ambiguity;
        }
    }
    entropy(component, beliefs) - ambiguity
}

/// H[q(o_1, ..., o_M)].
fn entropy<const S: usize, const G: usize>(component: &Members, beliefs: &Beliefs<S, G>) -> f32 {
    // The modality with the most conditions.
    let Some((last, of)) = component.iter().max_by_key(|(_, of)| of.factors().len()) else { return 0.0 };
    let others = Members { bits: component.bits & !(1 << last), ..*component };
    let couples = others.iter().any(|(_, modality)| modality.factors().len() > 1);
    let mut outcomes = Outcomes { members: others, now: [0; MAX_MODALITIES] };
    // Thousands of small terms: what a sum loses is carried on to the next.
    let (mut entropy, mut lost) = (0.0, 0.0);
    loop {
        let term = if couples {
            outcomes.entropy_by_states(component, beliefs, of)
        } else {
            outcomes.entropy_of_last(beliefs, of)
        } - lost;
        let sum = entropy + term;
        lost = (sum - entropy) - term;
        entropy = sum;
        if !outcomes.advance() {
            return entropy;
        }
    }
}

/// A combination of outcomes of some modalities.
struct Outcomes<'a, 'm> {
    members: Members<'a, 'm>,
    now: [u16; MAX_MODALITIES],
}

impl<'m> Outcomes<'_, 'm> {
    /// The members with their outcomes.
    fn iter(&self) -> impl Iterator<Item = (&'m Modality<'m>, usize)> {
        let outcome = |number: usize| self.now.get(number).copied().map_or(0, usize::from);
        self.members.iter().map(move |(number, modality)| (modality, outcome(number)))
    }

    /// Moves to the next combination; `false` after the last.
    fn advance(&mut self) -> bool {
        for (number, modality) in self.members.iter() {
            let Some(now) = self.now.get_mut(number) else { continue };
            *now += 1;
            if usize::from(*now) < modality.shape().values() {
                return true;
            }
            *now = 0;
        }
        false
    }

    /// -Σ p ln p over the outcomes of `last` and these, when these depend on one factor each: they
    /// leave weights that are independent.
    fn entropy_of_last<const S: usize, const G: usize>(
        &self,
        beliefs: &Beliefs<S, G>,
        last: &Modality,
    ) -> f32 {
        let (model, mut weights) = (self.members.model, *beliefs);
        for (modality, outcome) in self.iter() {
            let &[factor] = modality.factors() else { continue };
            for (state, weight) in model.part_mut(weights.as_flat_mut(), factor).iter_mut().enumerate() {
                *weight *= modality.likelihood().probability(outcome, &[state]);
            }
        }
        let parts = model.parts(weights.as_flat(), last.factors());
        // The mass of the factors that these depend on and `last` does not.
        let elsewhere =
            last.factors().iter().fold(self.members.factors(), |left, factor| left & !(1 << factor));
        let elsewhere = (0..MAX_FACTORS).filter(|factor| elsewhere >> factor & 1 == 1);
        let rest = elsewhere.map(|factor| math::sum(weights.part(model, factor))).product::<f32>();
        let expected = last.likelihood().expect(last.shape(), parts.as_slice(), last.preference());
        let mass = parts.as_slice().iter().map(|part| math::sum(part)).product::<f32>();
        // With p = rest * w: -Σ p ln p = rest * (-Σ w ln w) - Σ w * rest ln rest.
        rest * expected.entropy() - mass * math::p_ln_p(rest)
    }

    /// The entropy for any modalities, by a visit of every combination of the states of the
    /// component's factors.
    fn entropy_by_states<const S: usize, const G: usize>(
        &self,
        component: &Members,
        beliefs: &Beliefs<S, G>,
        last: &Modality,
    ) -> f32 {
        let Some(product) = component.product() else { return 0.0 };
        let mut entropy = 0.0;
        for outcome in 0..last.shape().values() {
            let (mut p, mut now) = (0.0, [0; MAX_FACTORS]);
            product.shape.for_each_column(|_, states| {
                let mut mass = product.mass(component.model, beliefs.as_flat(), states, &mut now);
                for (modality, outcome) in self.iter().chain(core::iter::once((last, outcome))) {
                    if mass > 0.0 {
                        mass *= modality.probability(Evidence::Outcome(outcome), &now);
                    }
                }
                p += mass;
            });
            entropy -= math::p_ln_p(p);
        }
        entropy
    }
}
