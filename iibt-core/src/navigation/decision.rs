//! The choice of a policy together with the teammates: the posterior over joint policies.

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

/// The model that joint policies are judged by, and the last judgement.
#[derive(Clone, Debug)]
pub struct NavigationDecision<const S: usize, const P: usize> {
    world: World<S>,
    scoring: Scoring,
    collision: f32,
    haste: f32,
    evaluation: Evaluation<S, 2, P, P>,
    star: StarOfPairs<P>,
    /// ln E - F - γ G of the robot's own policies.
    own: [f32; P],
    /// The same of the last teammate's policies, its pairs with ours included.
    rows: [[f32; P]; P],
    counts: (usize, usize),
}

/// A robot in a decision: what it would like, what it could do, and how likely its moves are made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Party<'a, const S: usize> {
    pub(super) preference: &'a Preference<S>,
    pub(super) candidates: &'a [Candidate],
    pub(super) odds: &'a Odds,
}

/// The steps of a decision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timing {
    /// How many are looked at.
    pub(super) horizon: usize,
    /// After how many the team could arrive together at the earliest.
    pub(super) earliest: usize,
}

impl<const S: usize, const P: usize> NavigationDecision<S, P> {
    pub(super) fn new<const W: usize>(mission: &Mission<'_, W>, robot: RobotId) -> Self {
        Self {
            world: World::new(mission, robot),
            scoring: mission.scoring,
            collision: mission.collision,
            haste: mission.haste,
            evaluation: Evaluation::new(),
            star: StarOfPairs::new([]),
            own: [f32::NEG_INFINITY; P],
            rows: [[f32::NEG_INFINITY; P]; P],
            counts: (0, 0),
        }
    }

    /// The robot's own generative model, by which its teammates are judged too.
    pub(super) const fn world(&self) -> &World<S> {
        &self.world
    }

    /// Has the goals worth so much.
    pub(super) fn prefer(&mut self, goals: &[Cell], values: &[f32]) {
        self.world.prefer(goals, values);
    }

    /// Has the next teammate's word right with this probability.
    pub(super) fn trust(&mut self, word: f32) {
        self.world.trust(word);
    }

    /// What is believed of this robot, which takes itself to be at `here`, and of a teammate that announced to stand at
    /// `cell`, given what the two cells mean for the team.
    pub(super) fn beliefs(&self, own: &[f32], here: Cell, cell: Cell) -> Beliefs<S, 2> {
        let outcome = self.world.outcome(here, cell);
        let update = |model: &Model| {
            let mut beliefs = Beliefs::try_prior(model).unwrap_or(Beliefs::EMPTY);
            let _ = beliefs.set(model, OWN, self.world.cells(own));
            // An impossible announcement leaves the prior, which is what is then known of the teammate.
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
    pub(super) fn decide_alone(&mut self, own: &[f32], ours: Party<'_, S>, timing: Timing) {
        let beliefs = self.world.with_pair_model(|model| {
            let mut beliefs = Beliefs::try_prior(model).unwrap_or(Beliefs::EMPTY);
            let _ = beliefs.set(model, OWN, self.world.cells(own));
            beliefs
        });
        self.evaluate(&beliefs.unwrap_or(Beliefs::EMPTY), ours, None, timing);
        self.begin(ours, timing);
    }

    /// Adds a teammate with all the policies it may have.
    pub(super) fn join(
        &mut self,
        beliefs: &Beliefs<S, 2>,
        ours: Party<'_, S>,
        theirs: Party<'_, S>,
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
            let own = score_of(&self.scoring, ln_prior(self.haste, ours.odds, candidate, timing), terms);
            row.iter_mut().zip(scores).for_each(|(score, total)| *score = total - own);
        }
        self.counts.1 = count;
        self.star.join(self.rows.iter().filter_map(|row| row.get(..count)));
    }

    /// Evaluates this robot's candidates with those of a teammate, or by themselves.
    fn evaluate(
        &mut self,
        beliefs: &Beliefs<S, 2>,
        ours: Party<'_, S>,
        theirs: Option<Party<'_, S>>,
        timing: Timing,
    ) {
        let parties = [Some(ours), theirs];
        let policies = parties.map(|party| policies::<P>(party.map_or(&[], |party| party.candidates)));
        let sequences = policies.each_ref().map(|policies| policies.as_slice());
        let priors = parties.map(|party| self.ln_priors(party, timing));
        let habits = priors.each_ref().map(|priors| priors.as_slice());
        let wanted = parties.map(|party| party.map_or([0.0; S], |party| party.preference.values()));
        let unwanted = parties.map(|party| party.map_or([0.0; S], |party| party.preference.negative()));
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

    fn ln_priors<'a>(&'a self, party: Option<Party<'a, S>>, timing: Timing) -> Vec<f32, P> {
        let of = |party: Party<'a, S>| {
            let ln_prior = move |candidate| ln_prior(self.haste, party.odds, candidate, timing);
            party.candidates.iter().map(ln_prior)
        };
        up_to(party.into_iter().flat_map(of))
    }

    /// Begins a decision with the values of the robot's own candidates, which are in the evaluation.
    fn begin(&mut self, ours: Party<'_, S>, timing: Timing) {
        self.own = [f32::NEG_INFINITY; P];
        let parts = self.evaluation.own_terms(OWN).zip(ours.candidates);
        for (score, (terms, candidate)) in self.own.iter_mut().zip(parts) {
            *score = score_of(&self.scoring, ln_prior(self.haste, ours.odds, candidate, timing), terms);
        }
        let count = ours.candidates.len().min(P);
        self.star = StarOfPairs::new(self.own.iter().copied().take(count));
        self.counts = (count, 0);
    }

    /// The most probable joint policy; `None` without candidates.
    pub(super) fn choose(&self) -> Option<Choice> {
        self.star.choose()
    }

    /// The posterior probability of each own candidate, whatever the teammates do; zero beyond them.
    #[must_use]
    pub fn marginals(&self) -> [f32; P] {
        self.star.marginals()
    }

    /// The posterior over the joint policies of this robot and the last teammate that joined, a row per own
    /// candidate; exact in a team of two. Zero beyond the candidates, and before any decision.
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

/// ln E: arriving later than the team could costs, and so do moves that are likely to fail.
fn ln_prior(haste: f32, odds: &Odds, candidate: &Candidate, timing: Timing) -> f32 {
    let late = candidate.path.len().saturating_sub(timing.earliest) as f32;
    ln_kept(odds, &candidate.path) - haste * late
}

/// ln E - F - γ G of one candidate by itself. F is the same for all candidates of a decision and cancels.
fn score_of(scoring: &Scoring, ln_prior: f32, terms: &Terms) -> f32 {
    scoring.score(ln_prior, 0.0, -terms.expected_free_energy())
}
