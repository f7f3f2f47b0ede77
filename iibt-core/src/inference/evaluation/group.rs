//! The candidates of one group of factors that are rolled out side by side.

use crate::inference::free_energy::Terms;

/// The row of each group's candidate.
pub(super) type Places<const G: usize> = [u8; G];

/// The candidates of one group that are in the rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group<const R: usize> {
    pub(super) used: u8,
    /// The only control that moves it, if there is one: the number of its sequence is then the
    /// candidate's key.
    pub(super) control: Option<u8>,
    /// The factors that move together in it, a bit for each.
    pub(super) factors: u32,
    pub(super) candidates: [Rollout; R],
}

/// One candidate of a group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rollout {
    /// The key that identifies it.
    pub(super) key: u32,
    /// A joint policy that it is part of.
    pub(super) policy: u16,
    /// The step at which it arrives.
    pub(super) arrival: u8,
    /// Its own part of G.
    pub(super) terms: Terms,
}

impl<const R: usize> Group<R> {
    pub(super) const EMPTY: Self = Self {
        used: 0,
        control: None,
        factors: 0,
        candidates: [Rollout { key: 0, policy: 0, arrival: 0, terms: Terms::ZERO }; R],
    };

    /// The number of candidates in the rows.
    pub(super) const fn used(&self) -> usize {
        self.used as usize
    }

    /// The row of the candidate with this key.
    #[inline]
    pub(super) fn find(&self, key: u32) -> Option<usize> {
        let used = self.candidates.get(..self.used())?;
        match used.get(key as usize) {
            Some(in_order) if in_order.key == key => Some(key as usize),
            _ => used.iter().position(|candidate| candidate.key == key),
        }
    }

    /// Assigns a row to a new candidate; `None` when there is no room.
    pub(super) fn add(&mut self, candidate: Rollout) -> Option<usize> {
        let row = self.used();
        *self.candidates.get_mut(row)? = candidate;
        self.used += 1;
        Some(row)
    }
}
