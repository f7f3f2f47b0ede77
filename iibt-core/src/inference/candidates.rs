//! The joint policies that a decision is made among.

use super::model::MAX_FACTORS;
use super::policy::Policy;

/// Joint policies: one action sequence for each control of a model.
#[derive(Clone, Copy, Debug)]
pub struct Candidates<'a> {
    /// For each control the action sequences that may be chosen for it. A teammate that has announced what it will do
    /// has one; an empty list, or none at all, stands for a control that stays. A control has 256 at the most.
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

/// The number of the sequence that a joint policy has for each control.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row([u8; MAX_FACTORS]);

impl Row {
    #[inline]
    pub(super) fn get(&self, control: usize) -> usize {
        self.0.get(control).copied().map_or(0, usize::from)
    }

    fn set(&mut self, control: usize, number: usize) {
        if let Some(slot) = self.0.get_mut(control) {
            *slot = number as u8;
        }
    }
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
        self.row(policy).get(control)
    }

    /// The number of each control's sequence in a joint policy.
    pub(super) fn row(&self, policy: usize) -> Row {
        let mut row = Row([0; MAX_FACTORS]);
        match self.combinations {
            Combinations::All => {
                let mut rest = policy;
                for control in (0..self.sequences.len().min(MAX_FACTORS)).rev() {
                    let choices = self.choices(control);
                    row.set(control, rest.checked_rem(choices).unwrap_or(0));
                    rest = rest.checked_div(choices).unwrap_or(0);
                }
            }
            Combinations::Listed(_) => self.read(policy, &mut row),
        }
        row
    }

    /// Makes the row of joint policy `next` from that of the one before it.
    #[inline]
    pub(super) fn go_on(&self, next: usize, row: &mut Row) {
        match self.combinations {
            Combinations::All => {
                for (control, list) in self.sequences.iter().enumerate().rev() {
                    let Some(number) = row.0.get_mut(control) else { continue };
                    *number += 1;
                    if usize::from(*number) < list.len() {
                        return;
                    }
                    *number = 0;
                }
            }
            Combinations::Listed(_) => self.read(next, row),
        }
    }

    fn read(&self, policy: usize, row: &mut Row) {
        let Combinations::Listed(rows) = self.combinations else { return };
        let width = self.sequences.len().max(1);
        row.0.iter_mut().zip(rows.iter().skip(policy * width).take(width)).for_each(|(to, from)| *to = *from);
    }

    /// A control's sequence of this number; without actions where there is none.
    #[must_use]
    pub fn actions(&self, control: usize, sequence: usize) -> Policy {
        *self.policy(control, sequence)
    }

    /// The same where it is.
    pub(super) fn policy(&self, control: usize, sequence: usize) -> &'a Policy {
        const STAY: &Policy = &Policy::EMPTY;
        self.sequences.get(control).and_then(|list| list.get(sequence)).unwrap_or(STAY)
    }

    /// ln E of one sequence of one control, where habits are about sequences.
    pub(super) fn habit_of(&self, control: usize, sequence: usize) -> f32 {
        match self.habits {
            Habits::PerSequence(habits) => {
                habits.get(control).and_then(|list| list.get(sequence)).copied().unwrap_or(0.0)
            }
            Habits::Flat | Habits::Joint(_) => 0.0,
        }
    }

    /// ln E of a joint policy, up to a constant.
    #[inline]
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
