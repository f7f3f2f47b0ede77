//! Errors of use, apart from events of the world.

use core::fmt::{Display, Formatter, Result as Formatted};
use thiserror::Error;

/// The observation has probability zero under the beliefs and the model. The beliefs were left as
/// they were.
///
/// ```
/// use iibt_core::inference::{
///     Beliefs, Evidence, Factor, IdentityNoise, Impossible, Modality, Model, NextState,
/// };
///
/// # static STAY: NextState = NextState::new(&[0, 1], 2);
/// static SURE: IdentityNoise = IdentityNoise::new(1.0, 2);
/// static FACTORS: [Factor; 1] = [Factor::new(&STAY, STAY.shape(), &[1.0, 0.0])];
/// static MODALITIES: [Modality; 1] = [Modality::new(&SURE, SURE.shape(), &[0], &[0.0; 2])];
/// static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
/// let mut beliefs = Beliefs::<2, 1>::prior(&MODEL);
/// let event = beliefs.update(&MODEL, &[Evidence::Outcome(1)]);
/// assert_eq!(event, Err(Impossible { modality: 0 }.into()));
/// assert_eq!(beliefs.of(&MODEL, 0)?, [1.0, 0.0]);
/// # Ok::<(), iibt_core::inference::OutOfRange>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the observation of modality {modality} has probability zero under the beliefs and the model")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Impossible {
    /// The modality that cannot be explained together with those before it.
    pub modality: usize,
}

/// An argument that does not fit the model or the memory.
///
/// This is an error of use, and says nothing about the world: an observation that cannot be
/// explained is [`Impossible`]. Nothing was changed by the call.
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
    /// The argument that does not fit.
    pub what: Argument,
    /// The number of the modality, factor, control or group that it belongs to; zero where it
    /// belongs to none.
    pub index: usize,
    /// The value that was given.
    pub value: usize,
    /// The limit: the number that exists or that fits.
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
    /// The place of a weight of a belief that is negative or not finite.
    BeliefWeight,
    /// The weights of a belief, which sum to no number above zero.
    BeliefSum,
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
    /// The number of an outcome whose preference is asked for or raised.
    PreferredOutcome,
    /// The outcome whose raised preference is not finite.
    Raise,
    /// A group in the scope.
    Scope,
    /// The horizon, in steps.
    Horizon,
    /// The prior of an unknown, which is no distribution.
    Prior,
    /// The number of unknowns of some worlds.
    Unknowns,
    /// The number of worlds.
    Worlds,
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
        let mut parts = self.what.message().split('%');
        f.write_str(parts.next().unwrap_or_default())?;
        parts.try_for_each(|part| {
            let mut rest = part.chars();
            let number = match rest.next() {
                Some('i') => self.index,
                Some('v') => self.value,
                _ => self.limit,
            };
            write!(f, "{number}{}", rest.as_str())
        })
    }
}

impl Argument {
    /// The message of an [`OutOfRange`], with `%i` for its index, `%v` for its value and `%l` for
    /// its limit.
    const fn message(self) -> &'static str {
        match self {
            Self::States => "the model has %v states, but the beliefs have room for %l",
            Self::Groups => "the model has %v groups of factors, but the evaluation has room for %l",
            Self::Policies => "there are %v joint policies, but the evaluation has room for %l",
            Self::Modality => "there is no modality %v: there are %l, from 0",
            Self::Factor => "there is no factor %v: there are %l, from 0",
            Self::Control => "there is no control %v: there are %l, from 0",
            Self::Controls => "something is given for %v controls, but the model has %l",
            Self::Policy => "there is no joint policy %v: there are %l, from 0",
            Self::Evidence => "evidence for %v modalities, but the model has %l",
            Self::Outcome => "modality %i has no outcome %v: there are %l, from 0",
            Self::Weights => "modality %i has %l outcomes, but %v weights are given",
            Self::Weight => "modality %i: weight %v is negative or not finite",
            Self::Belief => "the belief about factor %i has %l entries, but %v weights are given",
            Self::BeliefWeight => "the belief about factor %i: weight %v is negative or not finite",
            Self::BeliefSum => "the weights of the belief about factor %i sum to no number above zero",
            Self::Action => "control %i has no action %v: there are %l, from 0",
            Self::Sequences => "control %i has %v action sequences, but there can be %l",
            Self::Sequence => "control %i has no action sequence %v: there are %l, from 0",
            Self::Rows => "%v numbers of action sequences are no list of policies of %l controls",
            Self::Combinations => "group %i is moved by %v combinations, but there can be %l",
            Self::Habits => "%v habits, but there are %l joint policies",
            Self::HabitsOfControl => "control %i has %l action sequences, but %v habits are given",
            Self::Preferences => "preferences for %v modalities, but the model has %l",
            Self::Preference => "modality %i has %l outcomes, but %v preferences are given",
            Self::PreferenceValue => "modality %i: the preference for outcome %v is not finite",
            Self::PreferredOutcome => "there is no outcome %v to prefer: there are %l, from 0",
            Self::Raise => "the preference for outcome %v is raised to no finite number",
            Self::Scope => "the scope names group %v: there are %l, from 0",
            Self::Prior => "the prior of unknown %i, with %v values, is no distribution",
            Self::Unknowns => "there are %v unknowns, but there can be %l",
            Self::Worlds => "the unknowns have %v worlds, but there is room for %l",
            Self::Horizon => "a horizon of %v steps, but there can be %l",
        }
    }
}

impl core::error::Error for OutOfRange {}

/// The reason why an observation changed no belief.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ObservationError {
    /// An event of the world: the observation has probability zero under the beliefs and the model.
    #[error(transparent)]
    Impossible(#[from] Impossible),
    /// An error of use: the observation is none of the model's.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
}

/// The reason why no policy was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecisionError {
    /// No joint policy can be chosen: there are none, or each is ruled out or has a score that is
    /// no number.
    #[error("no joint policy can be chosen: none is given, or all are ruled out")]
    NoPolicy,
    /// An error of use: the candidates do not fit the model or the memory.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
}
