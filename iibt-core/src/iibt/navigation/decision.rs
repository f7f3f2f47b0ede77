//! The choice of a policy together with the teammates: the posterior over joint policies.

use super::mission::{LABELS, OUTCOMES};
use super::{Candidate, Mission};
use crate::bounded::up_to;
use crate::grid::Cell;
use crate::inference::belief::update_pair;
use crate::inference::{
    Belief, Choice, IdentityNoise, Interaction, Model, NextState, OutcomeTable, Policy, Preference, Scoring,
    Side, Star, Terms, Workspace,
};
use crate::math;
use heapless::Vec;

/// The model that joint policies are judged by, and the last judgement.
#[derive(Clone, Debug)]
pub struct Decision<const S: usize, const P: usize> {
    model: Model<IdentityNoise<S>, NextState<S, 5>, S, S>,
    peer_sensor: IdentityNoise<S>,
    outcomes: OutcomeTable<S, LABELS, OUTCOMES>,
    scoring: Scoring,
    collision: f32,
    haste: f32,
    workspace: Workspace<S, P>,
    star: Star<P>,
    /// ln E - F - γ G of the robot's own policies.
    own: [f32; P],
    /// The same of the last teammate's policies, its pairs with ours included.
    rows: [[f32; P]; P],
    counts: (usize, usize),
}

/// A robot in a decision: what is believed of its place, and what it could do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Party<'a, const S: usize> {
    pub(super) belief: &'a Belief<S>,
    pub(super) preference: &'a Preference<S>,
    pub(super) candidates: &'a [Candidate],
}

/// The steps of a decision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timing {
    /// How many are looked at.
    pub(super) horizon: usize,
    /// After how many the team could arrive together at the earliest.
    pub(super) earliest: usize,
}

impl<const S: usize, const P: usize> Decision<S, P> {
    pub(super) fn new<const W: usize>(mission: &Mission<'_, W>) -> Self {
        Self {
            model: mission.model(),
            peer_sensor: IdentityNoise::among(mission.peer_sensor, mission.map.len()),
            outcomes: mission.outcomes(),
            scoring: mission.scoring,
            collision: mission.collision,
            haste: mission.haste,
            workspace: Workspace::new(),
            star: Star::new([]),
            own: [f32::NEG_INFINITY; P],
            rows: [[f32::NEG_INFINITY; P]; P],
            counts: (0, 0),
        }
    }

    /// The robot's own generative model, by which its teammates are judged too.
    pub(super) const fn model(&self) -> &Model<IdentityNoise<S>, NextState<S, 5>, S, S> {
        &self.model
    }

    /// What is believed of a teammate that announced to stand at `cell`, and what that says about this robot,
    /// which takes itself to be at `here`: both beliefs given what the two cells mean for the team.
    pub(super) fn beliefs(&self, own: &Belief<S>, here: Cell, cell: Cell) -> (Belief<S>, Belief<S>) {
        let (mut own, mut peer) = (*own, self.model.initial());
        let outcome = self.outcomes.outcome(here.index(), cell.index());
        // An impossible announcement leaves the prior, which is what is then known of the teammate.
        let _ = peer.update(&self.peer_sensor, cell.index());
        let _ = update_pair(&mut own, &mut peer, &self.outcomes, outcome);
        (own, peer)
    }

    /// Forgets the last decision, so that another can begin.
    pub(super) fn clear(&mut self) {
        self.counts = (0, 0);
    }

    /// Decides without teammates.
    pub(super) fn decide_alone(&mut self, own: Party<'_, S>, timing: Timing) {
        let policies = policies::<P>(own.candidates);
        let side = side(&self.model.likelihood, &self.model.transition, own, &policies);
        self.workspace.evaluate_alone(&side, &self.scoring, timing.horizon);
        self.begin(own, timing);
    }

    /// Begins a decision with the values of the robot's own candidates, which are in the workspace.
    fn begin(&mut self, own: Party<'_, S>, timing: Timing) {
        self.own = [f32::NEG_INFINITY; P];
        let parts = self.workspace.first_terms().iter().zip(own.candidates);
        for (score, (terms, candidate)) in self.own.iter_mut().zip(parts) {
            *score = score_of(&self.scoring, ln_prior(self.haste, candidate, timing), terms);
        }
        self.star = Star::new(self.own.iter().copied().take(own.candidates.len().min(P)));
        self.counts = (own.candidates.len().min(P), 0);
    }

    /// Adds a teammate with all the policies it may have.
    pub(super) fn join(&mut self, own: Party<'_, S>, peer: Party<'_, S>, timing: Timing) {
        let (ours, theirs) = (policies::<P>(own.candidates), policies::<P>(peer.candidates));
        let own_side = side(&self.model.likelihood, &self.model.transition, own, &ours);
        let peer_side = side(&self.peer_sensor, &self.model.transition, peer, &theirs);
        let interaction = Interaction {
            outcomes: &self.outcomes,
            preference: &Mission::<0>::OUTCOME_PREFERENCE,
            collision: self.collision,
        };
        self.workspace.evaluate(&own_side, &peer_side, &interaction, &self.scoring, timing.horizon);
        if self.counts.0 == 0 {
            self.begin(own, timing);
        }
        self.counts.1 = peer.candidates.len().min(P);
        for (row, pairs) in self.rows.iter_mut().zip(self.workspace.pairs()) {
            let parts = pairs.iter().zip(self.workspace.second_terms()).zip(peer.candidates);
            for (score, ((pair, terms), candidate)) in row.iter_mut().zip(parts) {
                let ln_prior = ln_prior(self.haste, candidate, timing);
                *score = self.scoring.precision * pair + score_of(&self.scoring, ln_prior, terms);
            }
        }
        let count = self.counts.1;
        self.star.join(self.rows.iter().filter_map(|row| row.get(..count)));
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

fn side<'a, const S: usize>(
    likelihood: &'a IdentityNoise<S>,
    transition: &'a NextState<S, 5>,
    party: Party<'a, S>,
    policies: &'a [Policy],
) -> Side<'a, IdentityNoise<S>, NextState<S, 5>, S> {
    Side { likelihood, transition, belief: party.belief, preference: party.preference, policies }
}

fn policies<const P: usize>(candidates: &[Candidate]) -> Vec<Policy, P> {
    up_to(candidates.iter().map(|candidate| candidate.path.actions))
}

/// ln E: arriving later than the team could costs.
fn ln_prior(haste: f32, candidate: &Candidate, timing: Timing) -> f32 {
    -haste * candidate.path.len().saturating_sub(timing.earliest) as f32
}

/// ln E - F - γ G of one candidate by itself. F is the same for all candidates of a decision and cancels.
fn score_of(scoring: &Scoring, ln_prior: f32, terms: &Terms) -> f32 {
    scoring.score(ln_prior, 0.0, -terms.expected_free_energy(scoring.convention))
}
