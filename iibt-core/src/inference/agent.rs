//! The agent: a model, the beliefs about it, and the memory of a decision in one value.

mod decision;
mod room;

pub use decision::Decision;
pub use room::Room;

use super::belief::Beliefs;
use super::candidates::Candidates;
use super::error::{Argument, DecisionError, ObservationError, OutOfRange, at_most, below, exactly};
use super::estimation::Update;
use super::evaluation::Evaluation;
use super::evidence::Evidence;
use super::free_energy::{Scoring, Terms};
use super::model::Model;
use super::problem::Problem;
use crate::actions::Action;

/// An active-inference agent: a [`Model`], the beliefs about its hidden states, and the memory of a
/// decision.
///
/// Its sizes follow from the model and from what there is to choose from, so write it with
/// [`agent!`](crate::agent) where the model is a `static`, and name its type with
/// [`Agent!`](crate::Agent). Where the model is only known at run time, choose sizes that are large
/// enough: [`try_new`](Self::try_new) says when they are not.
///
/// | call | symbol | |
/// |---|---|---|
/// | [`observe`](Self::observe) | q(s) ∝ P(o \| s) q(s) | state inference; free energy F |
/// | [`decide`](Self::decide) | q(π) = softmax(ln E - γ G) | policy inference; free energy G |
/// | [`act`](Self::act) | q(s') = Σ B_u q(s) | what the action does to the belief |
///
/// ```
/// use iibt_core::agent;
/// use iibt_core::inference::{
///     Candidates, Evidence, Factor, IdentityNoise, Modality, Model, NextState, Policy,
/// };
///
/// // A door that is open or shut, a sensor that is right nine times in ten, and the actions wait,
/// // push.
/// static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 2);
/// static PUSH: NextState = NextState::with_slip(&[0, 1, 0, 0], 2, 0.2);
/// static FACTORS: [Factor; 1] = [Factor::new(&PUSH, PUSH.shape(), &[0.5, 0.5])];
/// static MODALITIES: [Modality; 1] = [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[2.0, 0.0])];
/// static DOOR: Model = Model::new(&FACTORS, &MODALITIES);
/// static POLICIES: [Policy; 2] = [Policy::of(&[0]), Policy::of(&[1])];
///
/// let mut agent = agent!(DOOR, 2);
/// agent.observe(&[Evidence::Outcome(1)])?; // it looks shut
/// assert!(agent.belief(0)?[1] > 0.89);
/// let decision = agent.decide(Candidates::all(&[&POLICIES]))?;
/// assert_eq!(decision.sequence(0), 1); // push
/// agent.act(&[Some(1)])?;
/// assert!(agent.belief(0)?[0] > 0.8); // and it should be open
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// What does not fit is a typed error, and nothing is left out or cut off:
///
/// ```
/// # use iibt_core::agent;
/// # use iibt_core::inference::{
/// #     Candidates, Evidence, Factor, IdentityNoise, Modality, Model, NextState, Policy,
/// # };
/// # static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 2);
/// # static PUSH: NextState = NextState::with_slip(&[0, 1, 0, 0], 2, 0.2);
/// # static FACTORS: [Factor; 1] = [Factor::new(&PUSH, PUSH.shape(), &[0.5, 0.5])];
/// # static MODALITIES: [Modality; 1] =
/// #     [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[2.0, 0.0])];
/// # static DOOR: Model = Model::new(&FACTORS, &MODALITIES);
/// let mut agent = agent!(DOOR, 2);
/// let error = agent.observe(&[Evidence::Outcome(2)]).unwrap_err();
/// assert_eq!(error.to_string(), "modality 0 has no outcome 2: there are 2, from 0");
/// let three = [Policy::of(&[0]), Policy::of(&[1]), Policy::of(&[1, 1])];
/// let error = agent.decide(Candidates::all(&[&three])).unwrap_err();
/// assert_eq!(error.to_string(), "there are 3 joint policies, but the evaluation has room for 2");
/// let error = agent.act(&[Some(2)]).unwrap_err();
/// assert_eq!(error.to_string(), "control 0 has no action 2: there are 2, from 0");
/// ```
#[doc(alias = "POMDP")]
#[doc(alias = "active inference")]
#[derive(Clone, Debug)]
pub struct Agent<'m, const S: usize, const G: usize, const R: usize, const P: usize> {
    model: &'m Model<'m>,
    scoring: Scoring,
    horizon: Option<u16>,
    beliefs: Beliefs<S, G>,
    /// Once concluded: its scores are the posterior of the last decision.
    evaluation: Evaluation<S, G, R, P>,
}

impl<'m, const S: usize, const G: usize, const R: usize, const P: usize> Agent<'m, S, G, R, P> {
    /// An agent with the beliefs D and no decision yet.
    ///
    /// # Panics
    /// When the model has more states or groups of factors than there is room for; in a `const` or
    /// `static` this fails the build. [`agent!`](crate::agent) calls it there, with sizes that fit.
    #[must_use]
    pub const fn new(model: &'m Model<'m>) -> Self {
        match Self::try_new(model) {
            Ok(agent) => agent,
            Err(_) => panic!("the model has more states, or groups of factors, than this agent has room for"),
        }
    }

    /// An agent for a model that is only known at run time.
    ///
    /// # Errors
    /// [`OutOfRange`] when the model has more states or groups of factors than there is room for.
    pub const fn try_new(model: &'m Model<'m>) -> Result<Self, OutOfRange> {
        if let Err(error) = at_most(Argument::Groups, 0, model.groups(), G) {
            return Err(error);
        }
        match Beliefs::try_prior(model) {
            Ok(beliefs) => Ok(Self {
                model,
                scoring: Scoring::DEFAULT,
                horizon: None,
                beliefs,
                evaluation: Evaluation::new(),
            }),
            Err(error) => Err(error),
        }
    }

    /// Sets the scoring of policies.
    #[must_use]
    pub const fn with_scoring(mut self, scoring: Scoring) -> Self {
        self.scoring = scoring;
        self
    }

    /// Sets the horizon in steps, 64 at the most, in place of the length of the longest policy: a
    /// robot stays after a shorter policy, and a longer one is judged by its first steps.
    #[must_use]
    pub const fn with_horizon(mut self, steps: usize) -> Self {
        self.horizon = Some(if steps > u16::MAX as usize { u16::MAX } else { steps as u16 });
        self
    }

    /// The generative model.
    #[must_use]
    pub const fn model(&self) -> &'m Model<'m> {
        self.model
    }

    /// The beliefs about all factors.
    #[must_use]
    pub const fn beliefs(&self) -> &Beliefs<S, G> {
        &self.beliefs
    }

    /// The beliefs about all factors, mutably.
    pub const fn beliefs_mut(&mut self) -> &mut Beliefs<S, G> {
        &mut self.beliefs
    }

    /// q(s), the belief about the states of one factor.
    ///
    /// # Errors
    /// [`OutOfRange`] when there is no such factor.
    #[doc(alias = "hidden state")]
    pub fn belief(&self, factor: usize) -> Result<&[f32], OutOfRange> {
        self.beliefs.of(self.model, factor)
    }

    /// The most probable state of one factor, the first of equals, and its probability.
    ///
    /// # Errors
    /// [`OutOfRange`] when there is no such factor.
    pub fn most_likely(&self, factor: usize) -> Result<(usize, f32), OutOfRange> {
        self.beliefs.most_likely(self.model, factor)
    }

    /// Updates the beliefs by an observation, with evidence for each modality; one left out at the
    /// end is missing.
    ///
    /// # Errors
    /// As [`Beliefs::update`]. The beliefs are left as they were.
    #[doc(alias = "infer_states")]
    #[doc(alias = "variational free energy")]
    pub fn observe(&mut self, evidence: &[Evidence]) -> Result<Update, ObservationError> {
        self.beliefs.update(self.model, evidence)
    }

    /// Updates the beliefs by the actions that were taken: an action for each control, or `None`
    /// for one that stays.
    ///
    /// # Errors
    /// As [`Beliefs::predict`]. The beliefs are left as they were.
    pub fn act(&mut self, actions: &[Option<Action>]) -> Result<(), OutOfRange> {
        self.beliefs.predict(self.model, actions)
    }

    /// Resets the beliefs to D.
    pub fn reset(&mut self) {
        // There is room: that was asked when the agent was made.
        let _ = self.model.write_prior(self.beliefs.as_flat_mut());
    }

    /// Chooses among joint policies exactly: all of them are evaluated with the model's own
    /// preferences.
    ///
    /// # Errors
    /// [`DecisionError::OutOfRange`] when the candidates do not fit the model or there is no room
    /// for all of them, and [`DecisionError::NoPolicy`] when none of them can be chosen.
    #[doc(alias = "infer_policies")]
    #[doc(alias = "expected free energy")]
    pub fn decide(&mut self, candidates: Candidates) -> Result<Decision, DecisionError> {
        self.decide_with(candidates, &[], &[])
    }

    /// Chooses as [`decide`](Self::decide) does, with preferences C in place of the model's, a list
    /// for each modality; an empty list keeps the model's. `negative` is the part of C that counts
    /// before a policy has arrived, see [`Problem`].
    ///
    /// # Errors
    /// As [`decide`](Self::decide).
    pub fn decide_with(
        &mut self,
        candidates: Candidates,
        preferences: &[&[f32]],
        negative: &[&[f32]],
    ) -> Result<Decision, DecisionError> {
        let problem = problem(self.model, &self.beliefs, candidates, self.scoring, self.horizon);
        self.evaluation.evaluate(&Problem { preferences, negative_preferences: negative, ..problem })?;
        let policy = self.evaluation.conclude().ok_or(DecisionError::NoPolicy)?;
        let probability = self.posterior().get(policy).copied().unwrap_or(0.0);
        Ok(Decision::new(&candidates, self.model.controls(), policy, probability))
    }

    /// q(π), the posterior over the joint policies of the last decision; empty before one, and
    /// after one that failed.
    #[must_use]
    pub fn posterior(&self) -> &[f32] {
        self.evaluation.scores()
    }

    /// The terms of the expected free energy of the joint policies of the last decision, in nats.
    #[doc(alias = "epistemic value")]
    #[doc(alias = "pragmatic value")]
    #[must_use]
    pub fn terms(&self) -> &[Terms] {
        self.evaluation.terms()
    }

    /// The marginal posterior probability of a control's action sequence in the last decision,
    /// which was among `candidates`. Costs a visit of all joint policies.
    ///
    /// # Errors
    /// [`OutOfRange`] when there is no such control or sequence, or the last decision had another
    /// number of joint policies.
    pub fn marginal(
        &self,
        candidates: &Candidates,
        control: usize,
        sequence: usize,
    ) -> Result<f32, OutOfRange> {
        below(Argument::Control, 0, control, self.model.controls())?;
        below(Argument::Sequence, control, sequence, candidates.choices(control))?;
        exactly(Argument::Policies, 0, candidates.len(), self.posterior().len())?;
        let numbered = self.posterior().iter().enumerate();
        let same = numbered.filter(|(policy, _)| candidates.sequence(*policy, control) == sequence);
        Ok(same.map(|(_, p)| p).sum::<f32>().min(1.0))
    }

    /// The decision as a [`Problem`], for [`Evaluation`] a few policies a tick, and for
    /// explanations.
    #[must_use]
    pub fn problem<'c>(&'c self, candidates: Candidates<'c>) -> Problem<'c, S, G> {
        problem(self.model, &self.beliefs, candidates, self.scoring, self.horizon)
    }
}

fn problem<'c, const S: usize, const G: usize>(
    model: &'c Model<'c>,
    beliefs: &'c Beliefs<S, G>,
    candidates: Candidates<'c>,
    scoring: Scoring,
    horizon: Option<u16>,
) -> Problem<'c, S, G> {
    let problem = Problem::new(model, beliefs, candidates, scoring);
    Problem { horizon: horizon.map_or(problem.horizon, usize::from), ..problem }
}

#[cfg(test)]
mod tests {
    use super::super::{Factor, Habits, IdentityNoise, Modality, NextState, Policy};
    use super::*;

    /// One control, two policies that are worth the same: the habit alone decides, and the second
    /// is as good as any.
    #[test]
    fn a_habit_decides_between_policies_that_are_worth_the_same() {
        static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 2);
        static STAY: NextState = NextState::new(&[0, 1, 0, 1], 2);
        static FACTORS: [Factor; 1] = [Factor::new(&STAY, STAY.shape(), &[0.5, 0.5])];
        static MODALITIES: [Modality; 1] = [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[1.0, 0.0])];
        static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
        static POLICIES: [Policy; 2] = [Policy::of(&[0]), Policy::of(&[1])];
        let lists: [&[Policy]; 1] = [&POLICIES];
        let mut agent = crate::agent!(MODEL, 2);
        for habits in [Habits::Joint(&[0.0, 1.0]), Habits::PerSequence(&[&[0.0, 1.0]])] {
            let decision = agent.decide(Candidates::all(&lists).with_habits(habits)).expect("it fits");
            assert_eq!(decision.policy(), 1);
            // softmax(0, 1)
            assert!((decision.probability() - 0.731_058_6).abs() < 1e-5, "{}", decision.probability());
        }
    }
}
