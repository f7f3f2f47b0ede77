//! q(s), the belief about the hidden factors, and its updates by actions and observations.

use super::error::{Argument, ObservationError, OutOfRange, at_most, below, exactly};
use super::estimation::{self, Method, Update, Work};
use super::evidence::Evidence;
use super::model::Model;
use crate::actions::Action;
use crate::math;

/// A distribution over the states of each factor of a model, one after the other.
///
/// There is room for `G` groups of `S` states each, a group being what moves together, one robot
/// for example; factors of different sizes share that room. Every method keeps them distributions:
/// finite, not negative, summing to one.
///
/// ```
/// use iibt_core::inference::{
///     Beliefs, Evidence, Factor, IdentityNoise, Modality, Model, NextState,
/// };
///
/// static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 3);
/// static MOVES: NextState = NextState::new(&[0, 0, 1, 1, 2, 2], 3);
/// static FACTORS: [Factor; 1] = [Factor::new(&MOVES, MOVES.shape(), &[0.5, 0.5, 0.0])];
/// static MODALITIES: [Modality; 1] = [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0; 3])];
/// static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
///
/// let mut beliefs = Beliefs::<3, 1>::prior(&MODEL);
/// assert_eq!(beliefs.of(&MODEL, 0)?, [0.5, 0.5, 0.0]);
/// beliefs.predict(&MODEL, &[Some(1)])?; // right
/// assert_eq!(beliefs.of(&MODEL, 0)?, [0.0, 0.5, 0.5]);
/// beliefs.update(&MODEL, &[Evidence::Outcome(1)])?;
/// assert_eq!(beliefs.most_likely(&MODEL, 0)?.0, 1);
///
/// beliefs.set(&MODEL, 0, &[1.0, 0.0, 3.0])?; // in proportion
/// assert_eq!(beliefs.of(&MODEL, 0)?, [0.25, 0.0, 0.75]);
/// beliefs.mix(&Beliefs::prior(&MODEL), 0.5);
/// assert_eq!(beliefs.of(&MODEL, 0)?, [0.375, 0.25, 0.375]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "posterior over states")]
#[doc(alias = "hidden state")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beliefs<const S: usize, const G: usize>([[f32; S]; G]);

impl<const S: usize, const G: usize> Beliefs<S, G> {
    /// The number of states that fit.
    pub const CAPACITY: usize = S * G;

    /// An empty belief, as working memory.
    pub(crate) const EMPTY: Self = Self([[0.0; S]; G]);

    /// D, the belief before the first observation.
    ///
    /// # Panics
    /// When the model has more states than the [`CAPACITY`](Self::CAPACITY); in a `const` or
    /// `static` this fails the build. For a model that is only known at run time there is
    /// [`try_prior`](Self::try_prior).
    #[must_use]
    pub const fn prior(model: &Model) -> Self {
        match Self::try_prior(model) {
            Ok(prior) => prior,
            Err(_) => panic!("the model has more states than these beliefs have room for"),
        }
    }

    /// D for a model that is only known at run time.
    ///
    /// # Errors
    /// [`OutOfRange`] when the model has more states than the [`CAPACITY`](Self::CAPACITY).
    pub const fn try_prior(model: &Model) -> Result<Self, OutOfRange> {
        let mut prior = Self::EMPTY;
        match model.write_prior(prior.as_flat_mut()) {
            Ok(()) => Ok(prior),
            Err(error) => Err(error),
        }
    }

    /// The belief about one factor.
    ///
    /// # Errors
    /// [`OutOfRange`] when there is no such factor.
    pub fn of(&self, model: &Model, factor: usize) -> Result<&[f32], OutOfRange> {
        below(Argument::Factor, 0, factor, model.factors().len())?;
        Ok(self.part(model, factor))
    }

    /// The belief about a factor that the model has; empty for another.
    #[inline]
    pub(crate) fn part(&self, model: &Model, factor: usize) -> &[f32] {
        model.part(self.as_flat(), factor)
    }

    /// All beliefs, factor after factor.
    #[must_use]
    pub const fn as_flat(&self) -> &[f32] {
        self.0.as_flattened()
    }

    pub(crate) const fn as_flat_mut(&mut self) -> &mut [f32] {
        self.0.as_flattened_mut()
    }

    /// The most probable state of one factor, the first of equals, and its probability.
    ///
    /// # Errors
    /// [`OutOfRange`] when there is no such factor.
    pub fn most_likely(&self, model: &Model, factor: usize) -> Result<(usize, f32), OutOfRange> {
        let part = self.of(model, factor)?;
        let state = math::argmax(part);
        Ok((state, part.get(state).copied().unwrap_or(0.0)))
    }

    /// Replaces the belief about one factor by one in proportion to `weights`.
    ///
    /// # Errors
    /// [`OutOfRange`] when there is no such factor, when there are not as many weights as states,
    /// or when a weight is negative or not finite or they sum to nothing. The belief is left as it
    /// was.
    pub fn set(&mut self, model: &Model, factor: usize, weights: &[f32]) -> Result<(), OutOfRange> {
        below(Argument::Factor, 0, factor, model.factors().len())?;
        let part = model.part_mut(self.as_flat_mut(), factor);
        exactly(Argument::Belief, factor, weights.len(), part.len())?;
        let wrong = weights.iter().position(|weight| !(weight.is_finite() && *weight >= 0.0));
        if let Some(at) = wrong {
            return Err(OutOfRange::new(Argument::BeliefWeight, factor, at, part.len()));
        }
        let sum: f32 = weights.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return Err(OutOfRange::new(Argument::BeliefSum, factor, weights.len(), part.len()));
        }
        part.iter_mut().zip(weights).for_each(|(q, weight)| *q = weight / sum);
        Ok(())
    }

    /// Predicts the beliefs after one step, in which `actions` holds an action for each of the
    /// model's controls, or `None` for a robot that stays, as one left out does: q(s') = Σ_s
    /// B_u(s', s) q(s). Uncontrolled factors change by themselves.
    ///
    /// # Errors
    /// [`OutOfRange`] for more actions than controls, and for an action that a control does not
    /// have. The beliefs are left as they were.
    pub fn predict(&mut self, model: &Model, actions: &[Option<Action>]) -> Result<(), OutOfRange> {
        model.check_room(Self::CAPACITY)?;
        at_most(Argument::Controls, 0, actions.len(), model.controls())?;
        for (control, action) in actions.iter().enumerate() {
            let action = action.map_or(0, usize::from);
            if action > 0 {
                below(Argument::Action, control, action, model.actions(control))?;
            }
        }
        let before = *self;
        let from = before.as_flat();
        for factor in 0..model.factors().len() {
            let action = match model.control(factor) {
                Some(control) => actions.get(control).copied().flatten(),
                None => Some(0),
            };
            if let Some(action) = action {
                let to = model.part_mut(self.as_flat_mut(), factor);
                model.move_factor(factor, action, from, to);
                if math::normalise(to).is_none() {
                    math::assign(to, model.part(from, factor));
                }
            }
        }
        Ok(())
    }

    /// Mixes in a share of other beliefs: q := (1 - share) q + share other. `share` is held to
    /// 0..=1, NaN is none.
    pub fn mix(&mut self, other: &Self, share: f32) {
        let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
        for (q, p) in self.as_flat_mut().iter_mut().zip(other.as_flat()) {
            *q += share * (p - *q);
        }
    }

    /// Updates the beliefs by an observation, with `evidence` for each modality; one left out at
    /// the end of the list is missing.
    ///
    /// Factors that no observed modality couples are updated by Bayes' rule. Factors that one
    /// couples are updated together: exactly, without storing their product, where that takes no
    /// more than [`EXACT_LIMIT`](super::EXACT_LIMIT) steps, else by coordinate ascent on the free
    /// energy. See [`Update`] for what is returned.
    ///
    /// # Errors
    /// [`ObservationError::Impossible`] when the observation has probability zero, which is an
    /// event of the world, and [`ObservationError::OutOfRange`] for evidence that is none of the
    /// model's. The beliefs are left as they were.
    pub fn update(&mut self, model: &Model, evidence: &[Evidence]) -> Result<Update, ObservationError> {
        self.infer(model, evidence, Method::Exact)
    }

    /// Updates the beliefs by an observation through one modality, by its messages to the factors
    /// that it depends on: exactly, at any cost. Returns the surprise -ln P(o), in nats.
    ///
    /// Less code than [`update`](Self::update), which it equals where a model's modalities have no
    /// coupled factors in common.
    ///
    /// # Errors
    /// As [`update`](Self::update), and [`ObservationError::OutOfRange`] for a modality that does
    /// not exist.
    pub fn observe(
        &mut self,
        model: &Model,
        modality: usize,
        evidence: Evidence,
    ) -> Result<f32, ObservationError> {
        model.check_room(Self::CAPACITY)?;
        model.check_evidence(modality, &evidence)?;
        let (mut posterior, mut scratch) = (*self, Self::EMPTY);
        let mut work =
            Work { posterior: posterior.as_flat_mut(), prior: &mut [], scratch: scratch.as_flat_mut() };
        let surprise = estimation::observe(&mut work, model, modality, evidence)?;
        *self = posterior;
        Ok(surprise)
    }

    /// Updates as [`update`](Self::update), but coupled factors always by coordinate ascent, in at
    /// most `sweeps` sweeps: a bound on time that is held to 1..=[`MAX_SWEEPS`](super::MAX_SWEEPS).
    /// More sweeps never end at a higher free energy.
    ///
    /// # Errors
    /// As [`update`](Self::update), but each coupled modality is looked at by itself: several that
    /// contradict each other end at a free energy beyond 36 nats, -ln of the floor under a
    /// probability.
    pub fn update_by_ascent(
        &mut self,
        model: &Model,
        evidence: &[Evidence],
        sweeps: u8,
    ) -> Result<Update, ObservationError> {
        self.infer(model, evidence, Method::CoordinateAscent(sweeps))
    }

    fn infer(
        &mut self,
        model: &Model,
        evidence: &[Evidence],
        method: Method,
    ) -> Result<Update, ObservationError> {
        model.check_room(Self::CAPACITY)?;
        model.check_all_evidence(evidence)?;
        let (mut posterior, mut prior, mut scratch) = (*self, Self::EMPTY, Self::EMPTY);
        let mut work = Work {
            posterior: posterior.as_flat_mut(),
            prior: prior.as_flat_mut(),
            scratch: scratch.as_flat_mut(),
        };
        let update = estimation::update(&mut work, model, evidence, method)?;
        *self = posterior;
        Ok(update)
    }
}
