//! The joint policies that a decision is made among.

use super::policy::Policy;

/// Joint policies: one action sequence for each control of a model.
#[derive(Clone, Copy, Debug)]
pub struct Candidates<'a> {
    /// For each control the action sequences that may be chosen for it. A teammate that has announced what it will do
    /// has one; an empty list, or none at all, stands for a control that stays.
    pub sequences: &'a [&'a [Policy]],
    /// Which combinations of them are considered.
    pub combinations: Combinations<'a>,
    /// ln E, what is thought of them beforehand.
    pub habits: Habits<'a>,
}

/// Which combinations of action sequences are joint policies.
#[derive(Clone, Copy, Debug)]
pub enum Combinations<'a> {
    /// All of them, the last control's sequences running fastest.
    All,
    /// These: for each joint policy the number of a sequence for each control.
    Listed(&'a [u8]),
}

/// ln E, the log prior of policies, up to a constant.
#[derive(Clone, Copy, Debug)]
pub enum Habits<'a> {
    /// All are alike.
    Flat,
    /// One for each joint policy.
    Joint(&'a [f32]),
    /// One for each sequence of each control, which add up.
    PerSequence(&'a [&'a [f32]]),
}

impl<'a> Candidates<'a> {
    /// All combinations of these sequences, all alike.
    #[must_use]
    pub const fn all(sequences: &'a [&'a [Policy]]) -> Self {
        Self { sequences, combinations: Combinations::All, habits: Habits::Flat }
    }

    /// The listed combinations of these sequences, all alike.
    #[must_use]
    pub const fn listed(sequences: &'a [&'a [Policy]], rows: &'a [u8]) -> Self {
        Self { sequences, combinations: Combinations::Listed(rows), habits: Habits::Flat }
    }

    /// How many joint policies there are.
    #[must_use]
    pub fn len(&self) -> usize {
        match self.combinations {
            Combinations::All => {
                (0..self.sequences.len()).map(|control| self.choices(control)).fold(1, usize::saturating_mul)
            }
            Combinations::Listed(rows) => rows.len() / self.sequences.len().max(1),
        }
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The longest sequence, in steps.
    #[must_use]
    pub fn horizon(&self) -> usize {
        self.sequences.iter().flat_map(|list| list.iter()).map(Policy::len).max().unwrap_or(0)
    }

    /// How many sequences a control has to choose from; one, to stay, where none is given.
    pub(super) fn choices(&self, control: usize) -> usize {
        self.sequences.get(control).map_or(1, |list| list.len().max(1))
    }

    /// The number of a control's sequence in a joint policy.
    #[must_use]
    pub fn sequence(&self, policy: usize, control: usize) -> usize {
        match self.combinations {
            Combinations::All => {
                let faster = (control + 1..self.sequences.len()).map(|control| self.choices(control));
                policy / faster.fold(1, usize::saturating_mul) % self.choices(control)
            }
            Combinations::Listed(rows) => {
                rows.get(policy * self.sequences.len() + control).copied().map_or(0, usize::from)
            }
        }
    }

    /// A control's sequence of this number; without actions where there is none.
    #[must_use]
    pub fn actions(&self, control: usize, sequence: usize) -> Policy {
        self.sequences.get(control).and_then(|list| list.get(sequence)).copied().unwrap_or(Policy::EMPTY)
    }

    /// ln E of a joint policy, up to a constant.
    #[must_use]
    pub fn ln_prior(&self, policy: usize) -> f32 {
        match self.habits {
            Habits::Flat => 0.0,
            Habits::Joint(habits) => habits.get(policy).copied().unwrap_or(0.0),
            Habits::PerSequence(habits) => {
                let of =
                    |(control, list): (usize, &&[f32])| list.get(self.sequence(policy, control)).copied();
                habits.iter().enumerate().filter_map(of).sum()
            }
        }
    }
}
