//! The observations that couple factors, and which of them belong together.

use crate::inference::evidence::Evidence;
use crate::inference::model::{Members, Modality, Model};

/// The observed modalities that couple factors, with what was observed.
#[derive(Clone, Copy)]
pub(super) struct Couplings<'a, 'm, 'e> {
    pub(super) members: Members<'a, 'm>,
    evidence: &'a [Evidence<'e>],
}

/// One of them: its number, the modality, and what was observed.
pub(super) type Coupling<'m, 'e> = (usize, &'m Modality<'m>, Evidence<'e>);

impl<'a, 'm, 'e> Couplings<'a, 'm, 'e> {
    pub(super) fn all(model: &'a Model<'m>, evidence: &'a [Evidence<'e>]) -> Self {
        let modalities = model.modalities().iter().zip(evidence).enumerate();
        let coupled =
            modalities.filter(|(_, (of, evidence))| of.factors().len() > 1 && !evidence.is_missing());
        let bits = coupled.fold(0, |bits, (number, _)| bits | 1 << number);
        Self { members: Members { model, bits }, evidence }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = Coupling<'m, 'e>> {
        self.members.iter().map(|(number, modality)| {
            (number, modality, self.evidence.get(number).copied().unwrap_or_default())
        })
    }

    /// Removes everything that is coupled, directly or not, to the first member.
    pub(super) fn take_component(&mut self) -> Option<Self> {
        Some(Self { members: self.members.take_component()?, ..*self })
    }

    /// The only member.
    pub(super) fn single(&self) -> Option<Coupling<'m, 'e>> {
        self.iter().next().filter(|_| self.members.bits.is_power_of_two())
    }
}
