//! The expected free energy of joint policies, evaluated factored.
//!
//! G of a joint policy is the sum of each robot's own part and of parts that couple two robots. Each robot's
//! candidates are rolled out once, all in step; only the coupled outcomes are looked at pair by pair. For `P`
//! candidates a robot, `S` states and `T` steps that is `2 P T` predictions instead of `2 P P T`.

use super::{
    Belief, Credit, Gain, Likelihood, OutcomeTable, Padding, Policy, Preference, Scoring, Terms, Transition,
};
use crate::actions::Action;
use crate::math;

/// One robot's part in a joint decision.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a, A, B, const S: usize> {
    /// A: how this robot's state is observed.
    pub likelihood: &'a A,
    /// B: how this robot moves.
    pub transition: &'a B,
    /// q(s): where it is.
    pub belief: &'a Belief<S>,
    /// C: what it would like to observe.
    pub preference: &'a Preference<S>,
    /// Its candidate policies.
    pub policies: &'a [Policy],
}

/// What couples two robots.
#[derive(Clone, Copy, Debug)]
pub struct Interaction<'a, const S: usize, const L: usize, const K: usize> {
    /// The outcome that both robots' states determine.
    pub outcomes: &'a OutcomeTable<S, L, K>,
    /// C for that outcome.
    pub preference: &'a Preference<K>,
    /// The preference for two robots in one state, or changing places in one step: zero or less, on the log
    /// scale of C. Zero leaves collisions out.
    pub collision: f32,
}

/// The memory of an evaluation: predicted beliefs and values of up to `P` candidates of each robot.
#[derive(Clone, Debug)]
pub struct Workspace<const S: usize, const P: usize> {
    first: Rollout<S, P>,
    second: Rollout<S, P>,
    pairs: [[f32; P]; P],
}

/// One robot's candidates, rolled out in step.
#[derive(Clone, Debug)]
struct Rollout<const S: usize, const P: usize> {
    beliefs: [[f32; S]; P],
    terms: [Terms; P],
}

impl<const S: usize, const P: usize> Workspace<S, P> {
    /// An empty workspace; usable in a `static`.
    #[must_use]
    pub const fn new() -> Self {
        Self { first: Rollout::EMPTY, second: Rollout::EMPTY, pairs: [[0.0; P]; P] }
    }

    /// Evaluates one robot's candidates by themselves over `horizon` steps.
    pub fn evaluate_alone<A, B>(&mut self, side: &Side<'_, A, B, S>, scoring: &Scoring, horizon: usize)
    where
        A: Likelihood<S, S>,
        B: Transition<S>,
    {
        let likes = Likes::new(side.preference);
        self.first.begin(side);
        for step in 0..horizon {
            self.first.advance(side, scoring, step);
            self.first.observe(side, scoring, &likes, step, horizon);
        }
    }

    /// Evaluates both robots' candidates and every pair of them over `horizon` steps, which is the length of the
    /// longest policy at least.
    ///
    /// Costs `2 P` predictions and `P * P` coupled outcomes a step. Candidates beyond `P` are left out.
    pub fn evaluate<A, B, const L: usize, const K: usize>(
        &mut self,
        first: &Side<'_, A, B, S>,
        second: &Side<'_, A, B, S>,
        interaction: &Interaction<'_, S, L, K>,
        scoring: &Scoring,
        horizon: usize,
    ) where
        A: Likelihood<S, S>,
        B: Transition<S>,
    {
        let likes = (Likes::new(first.preference), Likes::new(second.preference));
        let team_likes = interaction.preference.ln_probabilities();
        let collisions = interaction.collision != 0.0;
        self.pairs = [[0.0; P]; P];
        self.first.begin(first);
        self.second.begin(second);
        for step in 0..horizon {
            if collisions {
                self.cross(first, second, interaction, scoring, step);
            }
            self.first.advance(first, scoring, step);
            self.second.advance(second, scoring, step);
            self.first.observe(first, scoring, &likes.0, step, horizon);
            self.second.observe(second, scoring, &likes.1, step, horizon);
            if collisions {
                self.collide(first, second, interaction);
            }
            self.meet(first, second, interaction, &team_likes, scoring, (step, horizon));
        }
    }

    /// The terms of the first robot's own part, per candidate.
    #[must_use]
    pub fn first_terms(&self) -> &[Terms; P] {
        &self.first.terms
    }

    /// The terms of the second robot's own part, per candidate.
    #[must_use]
    pub fn second_terms(&self) -> &[Terms; P] {
        &self.second.terms
    }

    /// -G of the coupled part, per pair: a row for each candidate of the first robot. Like the terms, it is not
    /// multiplied with the precision yet.
    ///
    /// The log posterior of a pair is, up to a constant, the [`score`](Scoring::score) of either robot's own -G
    /// plus the precision times this: what [`Star::join`](super::Star::join) takes, row by row.
    #[must_use]
    pub fn pairs(&self) -> &[[f32; P]; P] {
        &self.pairs
    }

    /// Charges pairs that change places in this step, with the beliefs from before it.
    fn cross<A, B, const L: usize, const K: usize>(
        &mut self,
        first: &Side<'_, A, B, S>,
        second: &Side<'_, A, B, S>,
        interaction: &Interaction<'_, S, L, K>,
        scoring: &Scoring,
        step: usize,
    ) where
        B: Transition<S>,
    {
        for ((row, policy), from) in self.pairs.iter_mut().zip(first.policies).zip(&self.first.beliefs) {
            let Some(action) = scoring.padding.action(policy, step) else { continue };
            let ways = |state: usize| first.transition.successor(action, state);
            for ((value, other), to) in row.iter_mut().zip(second.policies).zip(&self.second.beliefs) {
                let Some(reply) = scoring.padding.action(other, step) else { continue };
                let back = |state: usize| second.transition.successor(reply, state);
                *value += interaction.collision * exchange(from, ways, to, back);
            }
        }
    }

    /// Charges pairs that stand in one state, with the beliefs from after the step.
    fn collide<A, B, const L: usize, const K: usize>(
        &mut self,
        first: &Side<'_, A, B, S>,
        second: &Side<'_, A, B, S>,
        interaction: &Interaction<'_, S, L, K>,
    ) {
        for ((row, _), belief) in self.pairs.iter_mut().zip(first.policies).zip(&self.first.beliefs) {
            for ((value, _), other) in row.iter_mut().zip(second.policies).zip(&self.second.beliefs) {
                *value += interaction.collision * math::expectation(belief, other);
            }
        }
    }

    /// Adds what each pair expects to bring about together, at the steps at which it counts.
    fn meet<A, B, const L: usize, const K: usize>(
        &mut self,
        first: &Side<'_, A, B, S>,
        second: &Side<'_, A, B, S>,
        interaction: &Interaction<'_, S, L, K>,
        likes: &[f32; K],
        scoring: &Scoring,
        (step, horizon): (usize, usize),
    ) where
        A: Likelihood<S, S>,
    {
        let second_labels =
            self.second.beliefs.each_ref().map(|belief| interaction.outcomes.label_masses(belief));
        for ((row, policy), belief) in self.pairs.iter_mut().zip(first.policies).zip(&self.first.beliefs) {
            let labels = interaction.outcomes.label_masses(belief);
            let others = second.policies.iter().zip(&self.second.beliefs).zip(&second_labels);
            for (value, ((other, other_belief), other_labels)) in row.iter_mut().zip(others) {
                let first_arrival = arrival(policy, horizon).min(arrival(other, horizon));
                if scoring.credit == Credit::OnArrival && step + 1 != first_arrival {
                    continue;
                }
                let outcomes = interaction.outcomes.predict(&labels, other_labels);
                *value += math::expectation(&outcomes, likes);
                *value += match scoring.gain {
                    Gain::PerModality => math::entropy(&outcomes),
                    Gain::Joint => joint_gain(
                        (first.likelihood, belief),
                        (second.likelihood, other_belief),
                        interaction.outcomes,
                    ),
                };
            }
        }
    }
}

impl<const S: usize, const P: usize> Default for Workspace<S, P> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const S: usize, const P: usize> Rollout<S, P> {
    const EMPTY: Self = Self {
        beliefs: [[0.0; S]; P],
        terms: [Terms { utility: 0.0, information_gain: 0.0, ambiguity: 0.0 }; P],
    };

    fn begin<A, B>(&mut self, side: &Side<'_, A, B, S>) {
        self.beliefs = [*side.belief.probabilities(); P];
        self.terms = [Terms::default(); P];
    }

    fn advance<A, B>(&mut self, side: &Side<'_, A, B, S>, scoring: &Scoring, step: usize)
    where
        B: Transition<S>,
    {
        for (belief, policy) in self.beliefs.iter_mut().zip(side.policies) {
            if let Some(action) = scoring.padding.action(policy, step) {
                let from = *belief;
                side.transition.predict(action, &from, belief);
            }
        }
    }

    fn observe<A, B>(
        &mut self,
        side: &Side<'_, A, B, S>,
        scoring: &Scoring,
        likes: &Likes<S>,
        step: usize,
        horizon: usize,
    ) where
        A: Likelihood<S, S>,
    {
        for ((terms, belief), policy) in self.terms.iter_mut().zip(&self.beliefs).zip(side.policies) {
            let ln_preference = likes.at(scoring.credit, arrival(policy, horizon), step);
            let mut now = Terms::of_modality(belief, side.likelihood, ln_preference);
            if scoring.gain == Gain::Joint {
                // Counted once for all modalities, with the pair; the ambiguity with it.
                (now.information_gain, now.ambiguity) = (0.0, 0.0);
            }
            *terms += now;
        }
    }
}

/// ln P(o) as it counts on arrival and at every other step.
struct Likes<const O: usize> {
    arrival: [f32; O],
    under_way: [f32; O],
}

impl<const O: usize> Likes<O> {
    fn new(preference: &Preference<O>) -> Self {
        Self { arrival: preference.ln_probabilities(), under_way: preference.ln_aversions() }
    }

    /// ln P(o) after `step`, counted from zero, when the arrival comes after `arrival` actions.
    fn at(&self, credit: Credit, arrival: usize, step: usize) -> &[f32; O] {
        match credit {
            Credit::OnArrival if step + 1 != arrival => &self.under_way,
            _ => &self.arrival,
        }
    }
}

/// After how many steps a policy arrives; one without actions never does, and is judged at the horizon.
const fn arrival(policy: &Policy, horizon: usize) -> usize {
    if policy.is_empty() { horizon } else { policy.len() }
}

impl Padding {
    /// What a robot with this policy does at `step`; `None` when it stays.
    fn action(self, policy: &Policy, step: usize) -> Option<Action> {
        policy.get(step).or(match self {
            Self::Stay => None,
            Self::Repeat(action) => Some(action),
        })
    }
}

/// The probability that two robots change places: one goes from s to s' while the other goes from s' to s.
fn exchange<const S: usize>(
    from: &[f32; S],
    ways: impl Fn(usize) -> usize,
    to: &[f32; S],
    back: impl Fn(usize) -> usize,
) -> f32 {
    let mut total = 0.0;
    for (state, p) in from.iter().enumerate() {
        let next = ways(state);
        if next != state && back(next) == state {
            total += p * to.get(next).copied().unwrap_or(0.0);
        }
    }
    total
}

/// The mutual information of both robots' states with all three outcomes at once: the entropy of the joint
/// distribution of the outcomes, less the ambiguity of both sensors (the coupled outcome has none).
///
/// Costs `S * S * (L * L + K)`.
fn joint_gain<A, const S: usize, const L: usize, const K: usize>(
    first: (&A, &[f32; S]),
    second: (&A, &[f32; S]),
    table: &OutcomeTable<S, L, K>,
) -> f32
where
    A: Likelihood<S, S>,
{
    let by_label = |(likelihood, belief): (&A, &[f32; S])| -> [[f32; S]; L] {
        core::array::from_fn(|label| {
            let mut part = *belief;
            for (state, q) in part.iter_mut().enumerate() {
                *q *= f32::from(u8::from(table.label(state) == label));
            }
            likelihood.predict(&part)
        })
    };
    let (ours, theirs) = (by_label(first), by_label(second));
    let column = |parts: &[[f32; S]; L], outcome: usize| -> [f32; L] {
        core::array::from_fn(|label| {
            parts.get(label).and_then(|part| part.get(outcome)).copied().unwrap_or(0.0)
        })
    };
    let mut entropy = 0.0;
    for one in 0..S {
        let labels = column(&ours, one);
        for other in 0..S {
            entropy += math::entropy(&table.predict(&labels, &column(&theirs, other)));
        }
    }
    entropy - first.0.ambiguity(first.1) - second.0.ambiguity(second.1)
}
