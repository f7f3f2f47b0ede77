//! Some of a model's modalities, and the factors that they have in common.

use super::{MAX_FACTORS, Modality, Model};
use crate::inference::shape::{MAX_CONDITIONS, Shape};
use heapless::Vec;

/// Some of a model's modalities, a bit for each.
#[derive(Clone, Copy)]
pub(in crate::inference) struct Members<'a, 'm> {
    pub(in crate::inference) model: &'a Model<'m>,
    pub(in crate::inference) bits: u64,
}

impl<'a, 'm> Members<'a, 'm> {
    /// The members with their numbers.
    pub(in crate::inference) fn iter(&self) -> impl Iterator<Item = (usize, &'m Modality<'m>)> + use<'a, 'm> {
        let bits = self.bits;
        self.model.modalities().iter().enumerate().filter(move |(number, _)| bits >> number & 1 == 1)
    }

    /// The factors that they depend on, a bit for each.
    pub(in crate::inference) fn factors(&self) -> u32 {
        self.iter().fold(0, |all, (_, modality)| all | factors_of(modality))
    }

    /// The groups of factors that they depend on, a bit for each.
    pub(in crate::inference) fn groups(&self) -> u16 {
        self.iter().fold(0, |all, (number, _)| all | self.model.scope(number))
    }

    /// Removes the first member and all that share factors with it, directly or through others.
    pub(in crate::inference) fn take_component(&mut self) -> Option<Self> {
        let mut component = Self { bits: self.bits & self.bits.wrapping_neg(), ..*self };
        // One that is left alone is not looked at.
        while component.bits != self.bits {
            let factors = component.factors();
            let joined = self.iter().filter(|(_, modality)| factors_of(modality) & factors != 0);
            let joined = joined.fold(0, |bits, (number, _)| bits | 1 << number);
            if joined == component.bits {
                break;
            }
            component.bits = joined;
        }
        self.bits &= !component.bits;
        (component.bits != 0).then_some(component)
    }

    /// The product of the factors that they depend on; `None` where there are too many to count.
    pub(in crate::inference) fn product(&self) -> Option<Product> {
        let all = self.factors();
        let (mut factors, mut states) = (Vec::new(), Vec::<usize, MAX_CONDITIONS>::new());
        let numbered = self.model.factors().iter().enumerate();
        for (number, factor) in numbered.filter(|(number, _)| all >> number & 1 == 1) {
            factors.push(number).ok()?;
            states.push(factor.states()).ok()?;
        }
        Some(Product { factors, shape: Shape::new(1, &states)? })
    }
}

/// The factors that a modality depends on, a bit for each.
fn factors_of(modality: &Modality) -> u32 {
    modality.factors().iter().fold(0, |bits, &factor| bits | 1 << factor)
}

/// The combinations of the states of a few factors.
pub(in crate::inference) struct Product {
    pub(in crate::inference) factors: Vec<usize, MAX_CONDITIONS>,
    pub(in crate::inference) shape: Shape,
}

impl Product {
    /// The probability of a combination of states under independent beliefs; they are put into
    /// `now`, which has a state for each factor of the model.
    pub(in crate::inference) fn mass(
        &self,
        model: &Model,
        beliefs: &[f32],
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
        mass
    }
}
