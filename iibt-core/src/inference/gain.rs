//! The joint information gain: what all modalities together are expected to tell about all states.

use super::belief::Beliefs;
use super::evidence::Evidence;
use super::model::{MAX_FACTORS, MAX_MODALITIES, Modality, Model};
use super::shape::{MAX_CONDITIONS, Shape};
use crate::math;

/// Modalities that have factors in common, directly or by way of others, a bit for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Component {
    pub(super) members: u64,
    /// The groups of factors that they depend on, a bit for each.
    pub(super) groups: u16,
}

/// The components of the modalities in `all`. What different components tell is independent, so their gains add up.
pub(super) fn components(model: &Model, all: u64) -> impl Iterator<Item = Component> {
    let mut left = all;
    core::iter::from_fn(move || {
        let first = left.trailing_zeros();
        if first >= u64::BITS {
            return None;
        }
        let mut members = 1 << first;
        loop {
            let reached = reach(model, left, factors(model, members));
            if reached == members {
                left &= !members;
                let groups = numbers(members).fold(0, |groups, number| groups | model.scope(number));
                return Some(Component { members, groups });
            }
            members = reached;
        }
    })
}

fn numbers(members: u64) -> impl Iterator<Item = usize> {
    (0..MAX_MODALITIES).filter(move |number| members >> number & 1 == 1)
}

fn members_of<'m>(model: &Model<'m>, members: u64) -> impl Iterator<Item = &'m Modality<'m>> {
    let numbered = model.modalities().iter().enumerate();
    numbered.filter(move |(number, _)| members >> number & 1 == 1).map(|(_, modality)| modality)
}

fn factors(model: &Model, members: u64) -> u32 {
    members_of(model, members)
        .flat_map(|modality| modality.factors())
        .fold(0, |factors, factor| factors | 1 << factor)
}

/// The modalities of `left` that depend on one of `factors`.
fn reach(model: &Model, left: u64, among: u32) -> u64 {
    let numbered = model.modalities().iter().enumerate().filter(|(number, _)| left >> number & 1 == 1);
    numbered
        .filter(|(_, modality)| modality.factors().iter().any(|factor| among >> factor & 1 == 1))
        .fold(0, |reached, (number, _)| reached | 1 << number)
}

impl Component {
    /// I(o_1, ..., o_M; s) = H[q(o_1, ..., o_M)] - Σ_m ambiguity_m, under independent beliefs.
    ///
    /// Every combination of outcomes is visited, but for those of the modality with the most conditions, which are predicted
    /// from the beliefs that the others leave. With one modality that couples factors a visit costs the factors' states and
    /// a prediction; with more, every combination of states.
    pub(super) fn gain<const S: usize, const G: usize>(&self, model: &Model, beliefs: &Beliefs<S, G>) -> f32 {
        let mut ambiguity = 0.0;
        for modality in members_of(model, self.members) {
            let parts = model.parts(beliefs.as_flat(), modality.factors());
            let expected =
                modality.likelihood().expect(modality.shape(), parts.as_slice(), modality.preference());
            ambiguity += expected.ambiguity;
            if self.members.is_power_of_two() {
                return expected.entropy() - ambiguity;
            }
        }
        self.entropy(model, beliefs) - ambiguity
    }

    /// H[q(o_1, ..., o_M)].
    fn entropy<const S: usize, const G: usize>(&self, model: &Model, beliefs: &Beliefs<S, G>) -> f32 {
        let last = self.last(model);
        let others = self.members & !(1 << last);
        let couples = members_of(model, others).any(|modality| modality.factors().len() > 1);
        let mut outcomes = Outcomes::new(model, others);
        // Thousands of small terms: what a sum loses is carried on to the next.
        let (mut entropy, mut lost) = (0.0, 0.0);
        loop {
            let term = if couples {
                outcomes.entropy_by_states(model, beliefs, last)
            } else {
                outcomes.entropy_of_last(model, beliefs, last)
            } - lost;
            let sum = entropy + term;
            lost = (sum - entropy) - term;
            entropy = sum;
            if !outcomes.advance() {
                return entropy;
            }
        }
    }

    /// The modality with the most conditions.
    fn last(&self, model: &Model) -> usize {
        let numbered =
            model.modalities().iter().enumerate().filter(|(number, _)| self.members >> number & 1 == 1);
        numbered.max_by_key(|(_, modality)| modality.factors().len()).map_or(0, |(number, _)| number)
    }
}

/// A combination of outcomes of some modalities.
struct Outcomes<'m> {
    model: Model<'m>,
    members: u64,
    now: [u16; MAX_MODALITIES],
}

impl<'m> Outcomes<'m> {
    fn new(model: &Model<'m>, members: u64) -> Self {
        Self { model: *model, members, now: [0; MAX_MODALITIES] }
    }

    /// The members with their outcomes.
    fn iter(&self) -> impl Iterator<Item = (&'m Modality<'m>, usize)> + '_ {
        let numbered = self.model.modalities().iter().zip(&self.now).enumerate();
        numbered
            .filter(|(number, _)| self.members >> number & 1 == 1)
            .map(|(_, (modality, &outcome))| (modality, usize::from(outcome)))
    }

    /// Goes on to the next combination; `false` after the last.
    fn advance(&mut self) -> bool {
        for (number, (modality, now)) in self.model.modalities().iter().zip(&mut self.now).enumerate() {
            if self.members >> number & 1 == 1 {
                *now += 1;
                if usize::from(*now) < modality.shape().values() {
                    return true;
                }
                *now = 0;
            }
        }
        false
    }

    /// -Σ p ln p over the outcomes of `last` and these, when these depend on one factor each: they leave weights that are
    /// independent.
    fn entropy_of_last<const S: usize, const G: usize>(
        &self,
        model: &Model,
        beliefs: &Beliefs<S, G>,
        last: usize,
    ) -> f32 {
        let mut weights = *beliefs;
        for (modality, outcome) in self.iter() {
            let &[factor] = modality.factors() else { continue };
            for (state, weight) in model.part_mut(weights.as_flat_mut(), factor).iter_mut().enumerate() {
                *weight *= modality.likelihood().probability(outcome, &[state]);
            }
        }
        let Some(last) = model.modalities().get(last) else { return 0.0 };
        let parts = model.parts(weights.as_flat(), last.factors());
        let rest = self.mass_elsewhere(model, &weights, last);
        let expected = last.likelihood().expect(last.shape(), parts.as_slice(), last.preference());
        let mass = parts.as_slice().iter().map(|part| math::sum(part)).product::<f32>();
        // With p = rest * w: -Σ p ln p = rest * (-Σ w ln w) - Σ w * rest ln rest.
        rest * expected.entropy() - mass * math::p_ln_p(rest)
    }

    /// The mass of the factors that these depend on and `last` does not.
    fn mass_elsewhere<const S: usize, const G: usize>(
        &self,
        model: &Model,
        weights: &Beliefs<S, G>,
        last: &Modality,
    ) -> f32 {
        let mut seen = last.factors().iter().fold(0_u32, |seen, factor| seen | 1 << factor);
        let mut mass = 1.0;
        for factor in self.iter().flat_map(|(modality, _)| modality.factors()) {
            if seen >> factor & 1 == 0 {
                seen |= 1 << factor;
                mass *= math::sum(weights.of(model, *factor));
            }
        }
        mass
    }

    /// The same for any modalities, by a visit of every combination of states.
    fn entropy_by_states<const S: usize, const G: usize>(
        &self,
        model: &Model,
        beliefs: &Beliefs<S, G>,
        last: usize,
    ) -> f32 {
        let Some(last) = model.modalities().get(last) else { return 0.0 };
        let (factors, shape) = match self.product(model, last) {
            Some(product) => product,
            None => return 0.0,
        };
        let mut entropy = 0.0;
        for outcome in 0..last.shape().values() {
            let mut p = 0.0;
            shape.for_each_column(|_, states| {
                let mut now = [0; MAX_FACTORS];
                let mut mass = 1.0;
                for (&factor, &state) in factors.iter().zip(states) {
                    if let Some(now) = now.get_mut(factor) {
                        *now = state;
                    }
                    mass *= beliefs.of(model, factor).get(state).copied().unwrap_or(0.0);
                }
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

    /// The factors that these and `last` depend on, and the shape of their product.
    fn product(
        &self,
        model: &Model,
        last: &Modality,
    ) -> Option<(heapless::Vec<usize, MAX_CONDITIONS>, Shape)> {
        let all = self.iter().flat_map(|(modality, _)| modality.factors()).chain(last.factors());
        let all = all.fold(0_u32, |all, factor| all | 1 << factor);
        let (mut factors, mut states) = (heapless::Vec::new(), heapless::Vec::<_, MAX_CONDITIONS>::new());
        for (number, factor) in
            model.factors().iter().enumerate().filter(|(number, _)| all >> number & 1 == 1)
        {
            factors.push(number).ok()?;
            states.push(factor.states()).ok()?;
        }
        Some((factors, Shape::new(1, &states)?))
    }
}
