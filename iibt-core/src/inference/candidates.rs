//! The joint policies among which a decision is made.

use super::error::{Argument, OutOfRange, at_most, below, exactly};
use super::model::{MAX_FACTORS, Model};
use super::policy::Policy;
use crate::actions::BYTES;

/// Joint policies: one action sequence for each control of a model.
///
/// ```
/// use iibt_core::inference::{Candidates, Habits, Policy};
///
/// // Two robots that may each stay or go, but not both go.
/// static CHOICES: [Policy; 2] = [Policy::of(&[0]), Policy::of(&[1])];
/// static EITHER: Candidates = Candidates::listed(&[&CHOICES, &CHOICES], &[0, 0, 0, 1, 1, 0]);
/// assert_eq!((EITHER.len(), EITHER.sequence(2, 0), EITHER.sequence(2, 1)), (3, 1, 0));
///
/// // The second robot has announced that it goes: what has it stay is ruled out.
/// let announced = EITHER.with_announced(&[None, Some(1)]);
/// assert_eq!(announced.ln_prior(1), 0.0);
/// assert_eq!(announced.ln_prior(2), f32::NEG_INFINITY);
///
/// // The first robot would rather stay.
/// let habits: [&[f32]; 1] = [&[0.0, -1.0]];
/// assert_eq!(EITHER.with_habits(Habits::PerSequence(&habits)).ln_prior(2), -1.0);
/// ```
#[doc(alias = "joint policies")]
#[doc(alias = "plan")]
#[derive(Clone, Copy, Debug)]
pub struct Candidates<'a> {
    /// For each control the action sequences that may be chosen for it, 65,535 at the most. An
    /// empty list, or none at all, stands for a control that stays.
    pub sequences: &'a [&'a [Policy]],
    /// The combinations of them that are considered.
    pub combinations: Combinations<'a>,
    /// ln E, their log prior.
    pub habits: Habits<'a>,
    /// For each control the number of the sequence that is fixed, as a teammate has announced it;
    /// the list may be shorter. A joint policy with another sequence is ruled out: its posterior is
    /// zero.
    pub announced: &'a [Option<u16>],
}

/// The combinations of action sequences that are joint policies.
#[derive(Clone, Copy, Debug)]
pub enum Combinations<'a> {
    /// All of them, the last control's sequences running fastest.
    All,
    /// The listed ones: for each joint policy the number of a sequence for each control.
    Listed(&'a [u16]),
}

/// ln E, the log prior of policies, up to a constant.
#[doc(alias = "E")]
#[doc(alias = "policy prior")]
#[derive(Clone, Copy, Debug)]
pub enum Habits<'a> {
    /// A flat prior.
    Flat,
    /// One for each joint policy.
    Joint(&'a [f32]),
    /// One for each sequence of each control, which add up.
    PerSequence(&'a [&'a [f32]]),
}

/// The number of the sequence that a joint policy has for each control.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointPolicy([u16; MAX_FACTORS]);

impl JointPolicy {
    #[inline]
    pub(super) fn get(&self, control: usize) -> usize {
        self.0.get(control).copied().map_or(0, usize::from)
    }

    fn set(&mut self, control: usize, number: usize) {
        if let Some(slot) = self.0.get_mut(control) {
            *slot = number as u16;
        }
    }
}

impl<'a> Candidates<'a> {
    /// All combinations of these sequences, with a flat prior.
    #[must_use]
    pub const fn all(sequences: &'a [&'a [Policy]]) -> Self {
        Self { sequences, combinations: Combinations::All, habits: Habits::Flat, announced: &[] }
    }

    /// The listed combinations of these sequences, with a flat prior.
    #[must_use]
    pub const fn listed(sequences: &'a [&'a [Policy]], rows: &'a [u16]) -> Self {
        Self { combinations: Combinations::Listed(rows), ..Self::all(sequences) }
    }

    /// Sets the habits, ln E.
    #[must_use]
    pub const fn with_habits(self, habits: Habits<'a>) -> Self {
        Self { habits, ..self }
    }

    /// Sets the sequences that teammates have announced, a number or `None` for each control.
    #[must_use]
    pub const fn with_announced(self, announced: &'a [Option<u16>]) -> Self {
        Self { announced, ..self }
    }

    /// The number of joint policies.
    #[must_use]
    pub const fn len(&self) -> usize {
        match self.combinations {
            Combinations::All => {
                let (mut count, mut control) = (1_usize, 0);
                while control < self.sequences.len() {
                    count = count.saturating_mul(self.choices(control));
                    control += 1;
                }
                count
            }
            Combinations::Listed(rows) => match rows.len().checked_div(self.sequences.len()) {
                Some(count) => count,
                None => rows.len(),
            },
        }
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The longest sequence, in steps.
    #[must_use]
    pub fn horizon(&self) -> usize {
        self.sequences.iter().flat_map(|list| list.iter()).map(Policy::len).max().unwrap_or(0)
    }

    /// The number of sequences of a control; one, to stay, where none is given.
    pub(super) const fn choices(&self, control: usize) -> usize {
        if control < self.sequences.len() && !self.sequences[control].is_empty() {
            self.sequences[control].len()
        } else {
            1
        }
    }

    /// The number of a control's sequence in a joint policy.
    #[must_use]
    pub fn sequence(&self, policy: usize, control: usize) -> usize {
        match self.combinations {
            Combinations::All => {
                let faster = (control.saturating_add(1)..self.sequences.len().min(MAX_FACTORS))
                    .fold(1_usize, |count, faster| count.saturating_mul(self.choices(faster)));
                policy.checked_div(faster).unwrap_or(0).checked_rem(self.choices(control)).unwrap_or(0)
            }
            Combinations::Listed(_) => self.listed_row(policy).get(control).copied().map_or(0, usize::from),
        }
    }

    /// The row of a joint policy in the list; empty where all combinations are meant.
    fn listed_row(&self, policy: usize) -> &'a [u16] {
        let Combinations::Listed(rows) = self.combinations else { return &[] };
        rows.chunks(self.sequences.len().max(1)).nth(policy).unwrap_or_default()
    }

    /// The number of each control's sequence in a joint policy.
    pub(super) fn row(&self, policy: usize) -> JointPolicy {
        let mut row = JointPolicy([0; MAX_FACTORS]);
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
    pub(super) fn go_on(&self, next: usize, row: &mut JointPolicy) {
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

    // Apart: inlined, its bounds are worked out for every policy where all combinations are meant.
    #[inline(never)]
    fn read(&self, policy: usize, row: &mut JointPolicy) {
        row.0.iter_mut().zip(self.listed_row(policy)).for_each(|(to, from)| *to = *from);
    }

    /// A control's sequence of this number; without actions where there is none.
    #[must_use]
    pub fn actions(&self, control: usize, sequence: usize) -> Policy {
        *self.policy(control, sequence)
    }

    /// The sequence of this number, if there is one.
    pub(super) fn policy(&self, control: usize, sequence: usize) -> &'a Policy {
        const STAY: &Policy = &Policy::EMPTY;
        self.sequences.get(control).and_then(|list| list.get(sequence)).unwrap_or(STAY)
    }

    fn is_as_announced(&self, policy: usize) -> bool {
        let fixed = self.announced.iter().enumerate();
        fixed
            .filter_map(|(control, number)| Some((control, (*number)?)))
            .all(|(control, number)| self.sequence(policy, control) == usize::from(number))
    }

    /// ln E of a joint policy, up to a constant; minus infinity for one that is ruled out by what
    /// was announced.
    #[inline]
    #[must_use]
    pub fn ln_prior(&self, policy: usize) -> f32 {
        if !self.announced.is_empty() && !self.is_as_announced(policy) {
            return f32::NEG_INFINITY;
        }
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

/// Checks of candidates before any of them is evaluated.
impl Candidates<'_> {
    /// The most sequences of one control.
    const MOST: usize = u16::MAX as usize;

    /// Whether these are joint policies of a model.
    pub(super) fn check(&self, model: &Model) -> Result<(), OutOfRange> {
        for (control, list) in self.sequences.iter().enumerate().filter(|(_, list)| !list.is_empty()) {
            below(Argument::Control, 0, control, model.controls())?;
            at_most(Argument::Sequences, control, list.len(), Self::MOST)?;
            check_actions(list, control, model.actions(control))?;
        }
        self.check_rows()?;
        self.check_habits()?;
        at_most(Argument::Controls, 0, self.announced.len(), self.sequences.len())?;
        for (control, number) in self.announced.iter().enumerate() {
            below(Argument::Sequence, control, number.map_or(0, usize::from), self.choices(control))?;
        }
        (0..model.groups()).try_for_each(|group| self.check_group(model, group))
    }

    fn check_rows(&self) -> Result<(), OutOfRange> {
        let Combinations::Listed(rows) = self.combinations else { return Ok(()) };
        let width = self.sequences.len().max(1);
        if !rows.len().is_multiple_of(width) {
            return Err(OutOfRange::new(Argument::Rows, 0, rows.len(), width));
        }
        let mut numbers = rows.chunks(width).flat_map(|row| row.iter().enumerate());
        numbers.try_for_each(|(control, &number)| {
            below(Argument::Sequence, control, number.into(), self.choices(control))
        })
    }

    fn check_habits(&self) -> Result<(), OutOfRange> {
        match self.habits {
            Habits::Flat => Ok(()),
            Habits::Joint(habits) => exactly(Argument::Habits, 0, habits.len(), self.len()),
            Habits::PerSequence(habits) => {
                at_most(Argument::Controls, 0, habits.len(), self.sequences.len())?;
                let mut given = habits.iter().enumerate().filter(|(_, habits)| !habits.is_empty());
                given.try_for_each(|(control, habits)| {
                    exactly(Argument::HabitsOfControl, control, habits.len(), self.choices(control))
                })
            }
        }
    }

    /// Whether what moves a group can be numbered.
    fn check_group(&self, model: &Model, group: usize) -> Result<(), OutOfRange> {
        let moved_by = model.moved_by(group);
        if moved_by & moved_by.wrapping_sub(1) == 0 {
            return Ok(());
        }
        let controls = (0..MAX_FACTORS).filter(|control| moved_by >> control & 1 == 1);
        let combinations = controls.fold(1, |all: usize, control| all.saturating_mul(self.choices(control)));
        at_most(Argument::Combinations, group, combinations, u32::MAX as usize - 1)
    }
}

/// Whether a control has all actions of its sequences.
fn check_actions(list: &[Policy], control: usize, actions: usize) -> Result<(), OutOfRange> {
    // The bits of all codes together are no less than any of the codes: mostly one look at them is
    // enough.
    let mut bits = [0; BYTES];
    list.iter().for_each(|policy| policy.gather_bits(&mut bits));
    let together = bits.iter().fold(0, |all, byte| all | byte);
    if usize::from((together | together >> 4) & 0xf) < actions {
        return Ok(());
    }
    let mut sequences = list.iter().filter(|policy| !policy.is_empty());
    sequences.try_for_each(|policy| below(Argument::Action, control, policy.largest().into(), actions))
}
