//! The posterior over joint policies, and the choice from it.

use super::motion::{Odds, ln_kept};
use super::world::{Collision, OWN, PEER, TEAM, World};
use super::{Candidate, Mission};
use crate::bounded::up_to;
use crate::grid::Cell;
use crate::inference::{
    Beliefs, Candidates, Choice, Combinations, Evaluation, Evidence, Habits, Model, PairPreference, Policy,
    Preference, Problem, Scoring, StarOfPairs, Terms,
};
use crate::math;
use crate::team::RobotId;
use heapless::Vec;

/// The generative model for joint policies, and the last evaluation.
#[derive(Clone, Debug)]
pub struct NavigationDecision<const S: usize, const P: usize> {
    world: World<S>,
    scoring: Scoring,
    collision: f32,
    lateness_cost: f32,
    evaluation: Evaluation<S, 2, P, P>,
    star: StarOfPairs<P>,
    /// ln E - F - γ G of the robot's own policies.
    own: [f32; P],
    /// The same for the last teammate's policies, including its pairs with this robot's.
    rows: [[f32; P]; P],
    counts: (usize, usize),
}

/// One robot's side of a decision: its preference, its candidates and the success odds of its
/// moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct RobotCandidates<'a, const S: usize> {
    pub(super) preference: &'a Preference<S>,
    pub(super) candidates: &'a [Candidate],
    pub(super) odds: &'a Odds,
}

/// The steps of a decision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timing {
    /// The number of steps that are evaluated.
    pub(super) horizon: usize,
    /// The earliest step at which the team could arrive together.
    pub(super) earliest: usize,
}

impl<const S: usize, const P: usize> NavigationDecision<S, P> {
    pub(super) fn new<const W: usize>(mission: &Mission<'_, W>, robot: RobotId) -> Self {
        Self {
            world: World::new(mission, robot),
            scoring: mission.scoring,
            collision: mission.collision,
            lateness_cost: mission.lateness_cost,
            evaluation: Evaluation::new(),
            star: StarOfPairs::new([]),
            own: [f32::NEG_INFINITY; P],
            rows: [[f32::NEG_INFINITY; P]; P],
            counts: (0, 0),
        }
    }

    /// Returns the robot's own generative model, which it uses for its teammates too.
    pub(super) const fn world(&self) -> &World<S> {
        &self.world
    }

    /// Sets the preference for each goal.
    pub(super) fn set_goal_preferences(&mut self, goals: &[Cell], values: &[f32]) {
        self.world.set_goal_preferences(goals, values);
    }

    /// Sets the probability that the next teammate's announced position is correct.
    pub(super) fn set_peer_reliability(&mut self, word: f32) {
        self.world.set_peer_reliability(word);
    }

    /// Returns the beliefs over this robot's state, most likely `here`, and the state of a teammate
    /// that announced `cell`, with the team's outcome coupled to both.
    pub(super) fn beliefs(&self, own: &[f32], here: Cell, cell: Cell) -> Beliefs<S, 2> {
        let outcome = self.world.outcome(here, cell);
        let update = |model: &Model| {
            let mut beliefs = Beliefs::try_prior(model).unwrap_or(Beliefs::EMPTY);
            let _ = beliefs.set(model, OWN, self.world.cells(own));
            // An impossible announcement leaves the prior, which is all that is then known of the
            // teammate.
            let _ = beliefs.observe(model, PEER, Evidence::Outcome(cell.index()));
            let _ = beliefs.observe(model, TEAM, Evidence::Outcome(outcome));
            beliefs
        };
        self.world.with_pair_model(update).unwrap_or(Beliefs::EMPTY)
    }

    /// Forgets the last decision, so that another can begin.
    pub(super) fn clear(&mut self) {
        self.counts = (0, 0);
    }

    /// Decides without teammates.
    pub(super) fn decide_alone(&mut self, own: &[f32], ours: RobotCandidates<'_, S>, timing: Timing) {
        let beliefs = self.world.with_pair_model(|model| {
            let mut beliefs = Beliefs::try_prior(model).unwrap_or(Beliefs::EMPTY);
            let _ = beliefs.set(model, OWN, self.world.cells(own));
            beliefs
        });
        self.evaluate(&beliefs.unwrap_or(Beliefs::EMPTY), ours, None, timing);
        self.begin(ours, timing);
    }

    /// Adds a teammate with all its candidate policies.
    pub(super) fn join(
        &mut self,
        beliefs: &Beliefs<S, 2>,
        ours: RobotCandidates<'_, S>,
        theirs: RobotCandidates<'_, S>,
        timing: Timing,
    ) {
        self.evaluate(beliefs, ours, Some(theirs), timing);
        if self.counts.0 == 0 {
            self.begin(ours, timing);
        }
        let count = theirs.candidates.len().min(P);
        let own = self.evaluation.own_terms(OWN).zip(ours.candidates);
        let scores = self.evaluation.scores().chunks_exact(count.max(1));
        for ((row, scores), (terms, candidate)) in self.rows.iter_mut().zip(scores).zip(own) {
            let own =
                score_of(&self.scoring, ln_prior(self.lateness_cost, ours.odds, candidate, timing), terms);
            row.iter_mut().zip(scores).for_each(|(score, total)| *score = total - own);
        }
        self.counts.1 = count;
        self.star.join(self.rows.iter().filter_map(|row| row.get(..count)));
    }

    /// Evaluates this robot's candidates with those of a teammate, or by themselves.
    fn evaluate(
        &mut self,
        beliefs: &Beliefs<S, 2>,
        ours: RobotCandidates<'_, S>,
        theirs: Option<RobotCandidates<'_, S>>,
        timing: Timing,
    ) {
        let parties = [Some(ours), theirs];
        let policies = parties.map(|robot| policies::<P>(robot.map_or(&[], |robot| robot.candidates)));
        let sequences = policies.each_ref().map(|policies| policies.as_slice());
        let priors = parties.map(|robot| self.ln_priors(robot, timing));
        let habits = priors.each_ref().map(|priors| priors.as_slice());
        let wanted = parties.map(|robot| robot.map_or([0.0; S], |robot| robot.preference.values()));
        let unwanted = parties.map(|robot| robot.map_or([0.0; S], |robot| robot.preference.negative()));
        let collision = Collision { motion: self.world.motion(), preference: self.collision };
        let pair_preferences: [&dyn PairPreference; 1] = [&collision];
        let evaluation = &mut self.evaluation;
        let (scoring, avoids) = (self.scoring, self.collision != 0.0);
        self.world.with_pair_model(|model| {
            evaluation.evaluate_fitting(&Problem {
                preferences: &wanted.each_ref().map(|values| self.world.cells(values)),
                negative_preferences: &unwanted.each_ref().map(|values| self.world.cells(values)),
                pair_preferences: if avoids { &pair_preferences } else { &[] },
                horizon: timing.horizon,
                scope: if theirs.is_some() { model.all_groups() } else { 1 << OWN },
                ..Problem::new(
                    model,
                    beliefs,
                    Candidates {
                        sequences: &sequences,
                        combinations: Combinations::All,
                        habits: Habits::PerSequence(&habits),
                        announced: &[],
                    },
                    scoring,
                )
            });
        });
    }

    fn ln_priors<'a>(&'a self, robot: Option<RobotCandidates<'a, S>>, timing: Timing) -> Vec<f32, P> {
        let of = |robot: RobotCandidates<'a, S>| {
            let ln_prior = move |candidate| ln_prior(self.lateness_cost, robot.odds, candidate, timing);
            robot.candidates.iter().map(ln_prior)
        };
        up_to(robot.into_iter().flat_map(of))
    }

    /// Begins a decision with the values of the robot's own candidates from the evaluation.
    fn begin(&mut self, ours: RobotCandidates<'_, S>, timing: Timing) {
        self.own = [f32::NEG_INFINITY; P];
        let parts = self.evaluation.own_terms(OWN).zip(ours.candidates);
        for (score, (terms, candidate)) in self.own.iter_mut().zip(parts) {
            *score =
                score_of(&self.scoring, ln_prior(self.lateness_cost, ours.odds, candidate, timing), terms);
        }
        let count = ours.candidates.len().min(P);
        self.star = StarOfPairs::new(self.own.iter().copied().take(count));
        self.counts = (count, 0);
    }

    /// Returns the most probable joint policy; `None` without candidates.
    pub(super) fn choose(&self) -> Option<Choice> {
        self.star.choose()
    }

    /// Returns the marginal posterior probability of each own candidate; zero beyond them.
    #[must_use]
    pub fn marginals(&self) -> [f32; P] {
        self.star.marginals()
    }

    /// Returns the posterior over the joint policies of this robot and the last teammate that
    /// joined, a row per own candidate; exact in a team of two. Zero beyond the candidates, and
    /// before any decision.
    #[must_use]
    pub fn joint(&self) -> [[f32; P]; P] {
        let (ours, theirs) = self.counts;
        let mut joint = [[f32::NEG_INFINITY; P]; P];
        for ((line, row), own) in joint.iter_mut().zip(&self.rows).zip(self.own).take(ours) {
            for (score, pair) in line.iter_mut().zip(row).take(theirs) {
                *score = own + pair;
            }
        }
        if ours * theirs == 0 {
            return [[0.0; P]; P];
        }
        math::softmax(joint.as_flattened_mut());
        joint
    }
}

fn policies<const P: usize>(candidates: &[Candidate]) -> Vec<Policy, P> {
    up_to(candidates.iter().map(|candidate| candidate.path.actions))
}

/// Returns ln E: the lateness cost of a candidate and the log odds that it is kept in time.
fn ln_prior(lateness_cost: f32, odds: &Odds, candidate: &Candidate, timing: Timing) -> f32 {
    let late = candidate.path.len().saturating_sub(timing.earliest) as f32;
    ln_kept(odds, &candidate.path) - lateness_cost * late
}

/// Returns ln E - F - γ G of one candidate by itself, less F, which is the same for all candidates
/// of a decision and cancels.
fn score_of(scoring: &Scoring, ln_prior: f32, terms: &Terms) -> f32 {
    scoring.score(ln_prior, 0.0, -terms.expected_free_energy())
}
