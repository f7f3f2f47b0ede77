//! The observations that couple factors, and which of them belong together.

use crate::inference::evidence::Evidence;
use crate::inference::model::{Modality, Model};

/// The observed modalities, a bit for each of `members`, that couple factors.
#[derive(Clone, Copy)]
pub(super) struct Couplings<'a, 'm, 'e> {
    pub(super) model: &'a Model<'m>,
    evidence: &'a [Evidence<'e>],
    members: u64,
}

/// One of them: its number, the modality, and what was observed.
pub(super) type Coupling<'m, 'e> = (usize, &'m Modality<'m>, Evidence<'e>);

impl<'a, 'm, 'e> Couplings<'a, 'm, 'e> {
    pub(super) fn all(model: &'a Model<'m>, evidence: &'a [Evidence<'e>]) -> Self {
        let all = Self { model, evidence, members: u64::MAX };
        let couples =
            |(_, modality, evidence): &Coupling| modality.factors().len() > 1 && !evidence.is_missing();
        let members = all.iter().filter(couples).fold(0, |members, (number, ..)| members | 1 << number);
        Self { members, ..all }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = Coupling<'m, 'e>> + '_ {
        let numbered = self.model.modalities().iter().zip(self.evidence).enumerate();
        numbered
            .filter(|(number, _)| self.members >> number & 1 == 1)
            .map(|(number, (modality, &evidence))| (number, modality, evidence))
    }

    /// Takes out everything that is coupled, directly or not, to the first member.
    pub(super) fn take_component(&mut self) -> Option<Self> {
        let (first, modality, _) = self.iter().next()?;
        let mut component = Self { members: 1 << first, ..*self };
        let mut factors = bits(modality);
        loop {
            let joined = self.iter().filter(|(_, modality, _)| bits(modality) & factors != 0);
            let (members, reached) = joined
                .fold((0, factors), |(m, f), (number, modality, _)| (m | 1 << number, f | bits(modality)));
            component.members = members;
            if reached == factors {
                self.members &= !members;
                return Some(component);
            }
            factors = reached;
        }
    }

    /// The factors that they couple, a bit for each.
    pub(super) fn factors(&self) -> u32 {
        self.iter().fold(0, |all, (_, modality, _)| all | bits(modality))
    }

    /// The only member.
    pub(super) fn single(&self) -> Option<Coupling<'m, 'e>> {
        self.iter().next().filter(|_| self.members.is_power_of_two())
    }
}

fn bits(modality: &Modality) -> u32 {
    modality.factors().iter().fold(0, |bits, &factor| bits | 1 << factor)
}
