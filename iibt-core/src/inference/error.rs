//! What a caller gets wrong, apart from what happens in the world.

use super::estimation::Impossible;
use core::fmt::{Display, Formatter, Result as Formatted};

/// An argument that does not fit the model or the memory.
///
/// This is an error of use, and says nothing about the world: an observation that cannot be explained is
/// [`Impossible`]. Nothing was changed by the call.
///
/// ```
/// use iibt_core::inference::{Argument, OutOfRange};
///
/// let error = OutOfRange { what: Argument::Outcome, index: 1, value: 7, limit: 3 };
/// assert_eq!(error.to_string(), "modality 1 has no outcome 7: there are 3, from 0");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OutOfRange {
    /// What does not fit.
    pub what: Argument,
    /// The number of the modality, factor, control or group that it belongs to; zero where it belongs to none.
    pub index: usize,
    /// What was given.
    pub value: usize,
    /// What there is, or what there is room for.
    pub limit: usize,
}

/// An argument of inference, as [`OutOfRange`] names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Argument {
    /// The model's states, for which beliefs have no room.
    States,
    /// The model's groups of factors, for which an evaluation has no room.
    Groups,
    /// The joint policies, for which an evaluation has no room.
    Policies,
    /// The number of a modality.
    Modality,
    /// The number of a factor.
    Factor,
    /// The number of a control.
    Control,
    /// Actions, action sequences or habits for more controls than there are.
    Controls,
    /// The number of a joint policy.
    Policy,
    /// Evidence for more modalities than there are.
    Evidence,
    /// The outcome observed through a modality.
    Outcome,
    /// The number of weights of a soft observation.
    Weights,
    /// The place of a weight that is negative or not finite.
    Weight,
    /// The number of entries of a belief.
    Belief,
    /// The place of a weight of a belief that is negative or not finite; past the last where they sum to no number above zero.
    BeliefWeight,
    /// An action of a control.
    Action,
    /// The number of action sequences of a control.
    Sequences,
    /// A listed joint policy's action sequence of a control.
    Sequence,
    /// The length of a list of joint policies, which is no multiple of the controls.
    Rows,
    /// The number of combinations of the action sequences that move one group.
    Combinations,
    /// The number of habits.
    Habits,
    /// The number of habits of a control.
    HabitsOfControl,
    /// Preferences for more modalities than there are.
    Preferences,
    /// The number of preferences for the outcomes of a modality.
    Preference,
    /// The outcome whose preference is not finite.
    PreferenceValue,
    /// A group in the scope.
    Scope,
    /// The horizon, in steps.
    Horizon,
}

impl OutOfRange {
    pub(super) const fn new(what: Argument, index: usize, value: usize, limit: usize) -> Self {
        Self { what, index, value, limit }
    }
}

/// Fails when `value` is not below `limit`.
pub(super) const fn below(
    what: Argument,
    index: usize,
    value: usize,
    limit: usize,
) -> Result<(), OutOfRange> {
    if value < limit { Ok(()) } else { Err(OutOfRange::new(what, index, value, limit)) }
}

/// Fails when `value` is more than `limit`.
pub(super) const fn at_most(
    what: Argument,
    index: usize,
    value: usize,
    limit: usize,
) -> Result<(), OutOfRange> {
    if value <= limit { Ok(()) } else { Err(OutOfRange::new(what, index, value, limit)) }
}

/// Fails when `value` is not `limit`.
pub(super) const fn exactly(
    what: Argument,
    index: usize,
    value: usize,
    limit: usize,
) -> Result<(), OutOfRange> {
    if value == limit { Ok(()) } else { Err(OutOfRange::new(what, index, value, limit)) }
}

impl Display for OutOfRange {
    fn fmt(&self, f: &mut Formatter<'_>) -> Formatted {
        let Self { what, index, value, limit } = *self;
        match what {
            Argument::States => {
                write!(f, "the model has {value} states, but the beliefs have room for {limit}")
            }
            Argument::Groups => {
                write!(f, "the model has {value} groups of factors, but the evaluation has room for {limit}")
            }
            Argument::Policies => {
                write!(f, "there are {value} joint policies, but the evaluation has room for {limit}")
            }
            Argument::Modality => write!(f, "there is no modality {value}: there are {limit}, from 0"),
            Argument::Factor => write!(f, "there is no factor {value}: there are {limit}, from 0"),
            Argument::Control => write!(f, "there is no control {value}: there are {limit}, from 0"),
            Argument::Controls => {
                write!(f, "something is given for {value} controls, but the model has {limit}")
            }
            Argument::Policy => write!(f, "there is no joint policy {value}: there are {limit}, from 0"),
            Argument::Evidence => write!(f, "evidence for {value} modalities, but the model has {limit}"),
            Argument::Outcome => {
                write!(f, "modality {index} has no outcome {value}: there are {limit}, from 0")
            }
            Argument::Weights => {
                write!(f, "modality {index} has {limit} outcomes, but {value} weights are given")
            }
            Argument::Weight => write!(f, "modality {index}: weight {value} is negative or not finite"),
            Argument::Belief => {
                write!(
                    f,
                    "the belief about factor {index} has {limit} entries, but {value} weights are given"
                )
            }
            Argument::BeliefWeight if value == limit => {
                write!(f, "the weights of the belief about factor {index} sum to no number above zero")
            }
            Argument::BeliefWeight => {
                write!(f, "the belief about factor {index}: weight {value} is negative or not finite")
            }
            Argument::Action => write!(f, "control {index} has no action {value}: there are {limit}, from 0"),
            Argument::Sequences => {
                write!(f, "control {index} has {value} action sequences, but there can be {limit}")
            }
            Argument::Sequence => {
                write!(f, "control {index} has no action sequence {value}: there are {limit}, from 0")
            }
            Argument::Rows => {
                write!(f, "{value} numbers of action sequences are no list of policies of {limit} controls")
            }
            Argument::Combinations => {
                write!(f, "group {index} is moved by {value} combinations, but there can be {limit}")
            }
            Argument::Habits => write!(f, "{value} habits, but there are {limit} joint policies"),
            Argument::HabitsOfControl => {
                write!(f, "control {index} has {limit} action sequences, but {value} habits are given")
            }
            Argument::Preferences => {
                write!(f, "preferences for {value} modalities, but the model has {limit}")
            }
            Argument::Preference => {
                write!(f, "modality {index} has {limit} outcomes, but {value} preferences are given")
            }
            Argument::PreferenceValue => {
                write!(f, "modality {index}: the preference for outcome {value} is not finite")
            }
            Argument::Scope => write!(f, "the scope names group {value}: there are {limit}, from 0"),
            Argument::Horizon => write!(f, "a horizon of {value} steps, but there can be {limit}"),
        }
    }
}

impl core::error::Error for OutOfRange {}

/// Why an observation changed no belief.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ObservationError {
    /// An event of the world: the observation has probability zero under the beliefs and the model.
    Impossible(Impossible),
    /// An error of use: the observation is none of the model's.
    OutOfRange(OutOfRange),
}

impl From<Impossible> for ObservationError {
    fn from(impossible: Impossible) -> Self {
        Self::Impossible(impossible)
    }
}

impl From<OutOfRange> for ObservationError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl Display for ObservationError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Formatted {
        match self {
            Self::Impossible(impossible) => impossible.fmt(f),
            Self::OutOfRange(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ObservationError {}

/// Why nothing was decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecisionError {
    /// No joint policy can be chosen: there are none, or each is ruled out or has a score that is no number.
    NoPolicy,
    /// An error of use: the candidates do not fit the model or the memory.
    OutOfRange(OutOfRange),
}

impl From<OutOfRange> for DecisionError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl Display for DecisionError {
    fn fmt(&self, f: &mut Formatter<'_>) -> Formatted {
        match self {
            Self::NoPolicy => {
                f.write_str("no joint policy can be chosen: none is given, or all are ruled out")
            }
            Self::OutOfRange(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for DecisionError {}
