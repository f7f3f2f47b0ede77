//! A decision problem: a model, beliefs, candidates and scoring.

use super::belief::Beliefs;
use super::candidates::Candidates;
use super::error::{Argument, OutOfRange, at_most, below, exactly};
use super::free_energy::{PreferenceTiming, Scoring};
use super::model::{Modality, Model};
use super::policy::Policy;
use crate::actions::{Action, HORIZON};

/// A decision problem.
///
/// [`Evaluation::begin`](super::Evaluation::begin) checks it as a whole: what does not fit is an
/// [`OutOfRange`] error, and nothing is left out or cut off.
///
/// ```
/// use iibt_core::inference::{
///     Beliefs, Candidates, Evaluation, Factor, IdentityNoise, Modality, Model, NextState, Policy,
///     Problem, Scoring,
/// };
///
/// # static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 3);
/// # static MOVES: NextState = NextState::new(&[0, 0, 1, 1, 2, 2], 3);
/// # static FACTORS: [Factor; 1] = [Factor::new(&MOVES, MOVES.shape(), &[0.0, 1.0, 0.0])];
/// # static MODALITIES: [Modality; 1] =
/// #     [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 0.0, 2.0])];
/// # static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
/// # static POLICIES: [Policy; 2] = [Policy::of(&[0]), Policy::of(&[1])];
/// # static CANDIDATES: Candidates = Candidates::all(&[&POLICIES]);
/// let beliefs = Beliefs::<3, 1>::prior(&MODEL);
/// let problem = Problem::new(&MODEL, &beliefs, CANDIDATES, Scoring::DEFAULT);
/// assert_eq!((problem.horizon, problem.scope), (1, 0b1));
///
/// // Today the left cell is wanted.
/// let today = Problem { preferences: &[&[2.0, 0.0, 0.0]], ..problem };
/// let mut evaluation = Evaluation::<3, 1, 2, 1>::new();
/// evaluation.evaluate(&today)?;
/// assert_eq!(evaluation.best(), Some(0));
///
/// // A preference is missing.
/// let error =
///     evaluation.evaluate(&Problem { preferences: &[&[2.0, 0.0]], ..problem }).unwrap_err();
/// assert_eq!(error.to_string(), "modality 0 has 3 outcomes, but 2 preferences are given");
/// # Ok::<(), iibt_core::inference::OutOfRange>(())
/// ```
#[derive(Clone, Copy)]
pub struct Problem<'a, const S: usize, const G: usize> {
    /// The generative model.
    pub model: &'a Model<'a>,
    /// The current beliefs.
    pub beliefs: &'a Beliefs<S, G>,
    /// The joint policies to choose from.
    pub candidates: Candidates<'a>,
    /// Their scoring.
    pub scoring: Scoring,
    /// The horizon in steps, [`HORIZON`] at the most: after a shorter sequence a robot stays. It is
    /// the length of the longest sequence unless it is set to something else; set to less, it has
    /// longer sequences judged by their first steps.
    pub horizon: usize,
    /// C as it is now for each modality, in place of the model's; a modality without an entry, or
    /// with an empty one, keeps the model's.
    pub preferences: &'a [&'a [f32]],
    /// The part of C that counts before a policy arrives, for each modality, with
    /// [`PreferenceTiming::OnArrival`]; a modality without an entry, or with an empty one, has all
    /// of it count.
    pub negative_preferences: &'a [&'a [f32]],
    /// Preferences for the moves of two factors, beyond any outcome.
    pub pair_preferences: &'a [&'a dyn PairPreference],
    /// Only modalities that depend on nothing but these groups are looked at, and only these groups
    /// move; a bit for each.
    pub scope: u16,
}

/// A preference for how two factors move relative to each other that no modality's outcome
/// expresses, on the log scale of C: two robots in one place, or changing places.
///
/// ```
/// use iibt_core::inference::PairPreference;
///
/// /// Two robots that should not be in one cell.
/// struct Apart;
///
/// impl PairPreference for Apart {
///     fn factors(&self) -> [usize; 2] {
///         [0, 1]
///     }
///
///     fn departing(&self, _: [&[f32]; 2], _: [Option<u8>; 2]) -> f32 {
///         0.0
///     }
///
///     fn arrived(&self, [one, other]: [&[f32]; 2]) -> f32 {
///         -4.0 * one.iter().zip(other).map(|(p, q)| p * q).sum::<f32>()
///     }
/// }
///
/// assert_eq!(Apart.arrived([&[1.0, 0.0], &[0.5, 0.5]]), -2.0);
/// ```
#[doc(alias = "collision")]
pub trait PairPreference: Sync {
    /// The two factors.
    fn factors(&self) -> [usize; 2];

    /// The preference for moves from these beliefs by these actions; `None` is to stay.
    fn departing(&self, beliefs: [&[f32]; 2], actions: [Option<Action>; 2]) -> f32;

    /// The preference for having arrived at these beliefs.
    fn arrived(&self, beliefs: [&[f32]; 2]) -> f32;
}

impl<'a, const S: usize, const G: usize> Problem<'a, S, G> {
    /// A decision among `candidates` over the length of the longest, with the model's preferences.
    #[must_use]
    pub fn new(
        model: &'a Model<'a>,
        beliefs: &'a Beliefs<S, G>,
        candidates: Candidates<'a>,
        scoring: Scoring,
    ) -> Self {
        Self {
            model,
            beliefs,
            candidates,
            scoring,
            horizon: candidates.horizon(),
            preferences: &[],
            negative_preferences: &[],
            pair_preferences: &[],
            scope: model.all_groups(),
        }
    }

    /// The C of a modality as it counts at a step at which a policy arrives, or at another.
    pub(super) fn preference(&self, number: usize, modality: &Modality<'a>, arrives: bool) -> &'a [f32] {
        let given = |list: &'a [&'a [f32]]| list.get(number).copied().filter(|given| !given.is_empty());
        let under_way = if arrives || self.scoring.timing == PreferenceTiming::EveryStep {
            None
        } else {
            given(self.negative_preferences)
        };
        under_way.or_else(|| given(self.preferences)).unwrap_or(modality.preference())
    }

    /// The modalities in scope, with their numbers and groups.
    pub(super) fn modalities(&self) -> impl Iterator<Item = (usize, &'a Modality<'a>, u16)> + '_ {
        let numbered = self.model.modalities().iter().enumerate();
        numbered
            .map(|(number, modality)| (number, modality, self.model.scope(number)))
            .filter(|(_, _, groups)| groups & !self.scope == 0)
    }

    /// The step at which an action sequence arrives; one without actions never does, and is judged
    /// at the horizon.
    pub(super) fn arrival(&self, actions: &Policy) -> usize {
        if actions.is_empty() { self.horizon } else { actions.len().min(self.horizon) }
    }

    /// Whether everything fits the model.
    pub(super) fn check(&self) -> Result<(), OutOfRange> {
        self.model.check_room(Beliefs::<S, G>::CAPACITY)?;
        at_most(Argument::Groups, 0, self.model.groups(), G)?;
        at_most(Argument::Horizon, 0, self.horizon, HORIZON)?;
        if let Some(beyond) = (self.scope & !self.model.all_groups()).checked_ilog2() {
            return Err(OutOfRange::new(Argument::Scope, 0, beyond as usize, self.model.groups()));
        }
        for factor in self.pair_preferences.iter().flat_map(|pair| pair.factors()) {
            below(Argument::Factor, 0, factor, self.model.factors().len())?;
        }
        check_preferences(self.model, self.preferences)?;
        check_preferences(self.model, self.negative_preferences)?;
        self.candidates.check(self.model)
    }
}

/// Whether there is a finite preference for each outcome of each modality, or none for any.
fn check_preferences(model: &Model, given: &[&[f32]]) -> Result<(), OutOfRange> {
    at_most(Argument::Preferences, 0, given.len(), model.modalities().len())?;
    let lists = given.iter().zip(model.modalities()).enumerate();
    for (number, (values, modality)) in lists.filter(|(_, (values, _))| !values.is_empty()) {
        exactly(Argument::Preference, number, values.len(), modality.shape().values())?;
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            return Err(OutOfRange::new(Argument::PreferenceValue, number, at, values.len()));
        }
    }
    Ok(())
}
