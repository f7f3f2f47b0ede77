//! What a robot infers by itself: what it would choose, and what the team's joint policies cost it.

use super::announcement::TableMessage;
use super::definition::{Postcondition, Role, Wish};
use super::joint::{List, MAX_POLICIES};
use super::model::{Question, Rows, believed};
use super::task::{JointDecision, Offered, TableTask, Wanted, row};
use crate::bounded::up_to;
use crate::inference::{Preference, Scoring, policy};
use crate::math;
use crate::team::{Message, Peers};
use heapless::Vec;

impl<'a, const S: usize, const N: usize, const P: usize, X> TableTask<'a, S, N, P, X> {
    /// The semantic state in a teammate's announcement.
    fn announced_state(&self, robot: usize) -> Option<usize> {
        let (said, role) = (self.teammate(robot)?, self.tables.role(robot)?);
        let known = |factor: &u8| said.state(usize::from(*factor)).is_some();
        let state = |factor| said.state(factor).map_or(0, usize::from);
        role.states.factors.iter().all(known).then(|| role.states.of(role.factors, state))
    }

    /// C of a teammate.
    pub(super) fn wish(&self, robot: usize, role: &Role<'_>) -> Preference<S> {
        match self.aim.teammates {
            Wish::Rows(rows) => row(rows.get(robot).copied().unwrap_or(&[])),
            Wish::AsAnnounced => {
                let operator = self.teammate(robot).map_or(role.idle, |said| said.operator());
                let brings = role.operators.get(usize::from(operator)).map(|operator| operator.brings);
                let Some(Postcondition::State(state, _) | Postcondition::Reset(state, ..)) = brings else {
                    return row(&[]);
                };
                Preference::from_fn(|of| if of == usize::from(state) { 1.0 } else { 0.0 })
            }
        }
    }

    /// The best of the joint policies in which the teammates do what they announced; the first of
    /// equals.
    fn best(&self, posterior: &[f32; P], announced: &[Option<u8>; N]) -> Option<u16> {
        let mut best: Option<(u16, f32)> = None;
        for (policy, &p) in (0..).zip(posterior.iter().take(self.tables.policies())) {
            let fits = |(robot, announced): (usize, &Option<u8>)| {
                announced.is_none_or(|announced| announced == self.tables.part(policy, robot))
            };
            if best.is_none_or(|(_, most)| p > most) && announced.iter().enumerate().all(fits) {
                best = Some((policy, p));
            }
        }
        best.map(|(policy, _)| policy)
    }

    /// The robot's own inference: what it would choose while its teammates do what they announced.
    /// `None` while the budget of the tick is not enough; it then goes on in the next, from the
    /// same beliefs and preferences.
    pub(super) fn think(&mut self, offered: &Offered<N>, wanted: &Wanted<S, N>) -> Option<u16> {
        let preferences = wanted.rows.each_ref().map(Preference::values);
        let (mut decision, from) = self.unfinished(&preferences).or_else(|| self.new_thought(preferences))?;
        let count = (self.tables.policies() as u32).saturating_sub(from.into()).min(self.left);
        self.left = self.left.saturating_sub(count);
        let until = from.saturating_add(count as u16);
        let mut scored = decision.posterior.iter_mut().skip(from.into());
        self.question(&decision.beliefs, &decision.preferences, offered.target).scores(
            from..until,
            &mut |score| {
                if let Some(place) = scored.next() {
                    *place = score;
                }
            },
        );
        let is_finished = usize::from(until) >= self.tables.policies();
        if is_finished {
            let all = decision.posterior.get_mut(..usize::from(until)).unwrap_or_default();
            policy::posterior(all, Scoring::DEFAULT.window);
            decision.choice = self.best(&decision.posterior, &offered.announced)?;
        }
        self.thinking = Some(until).filter(|_| !is_finished);
        self.is_current = is_finished;
        Some(self.decision.insert(decision).choice).filter(|_| is_finished)
    }

    /// The decision that an earlier tick has begun, and how many joint policies are scored: if it
    /// was for the same preferences, from the same state.
    fn unfinished(&mut self, preferences: &Rows<S, N>) -> Option<(JointDecision<S, N, P>, u16)> {
        let (from, decision) = self.thinking.take().zip(self.decision)?;
        let believed = math::argmax(decision.beliefs.get(self.own)?) == math::argmax(&self.states());
        (decision.preferences == *preferences && believed).then_some((decision, from))
    }

    fn new_thought(&self, preferences: Rows<S, N>) -> Option<(JointDecision<S, N, P>, u16)> {
        let beliefs = self.believed(&self.states())?;
        Some((JointDecision { preferences, beliefs, posterior: [0.0; P], choice: 0 }, 0))
    }

    /// q(s) of all robots, the own one being `states`.
    fn believed(&self, states: &[f32; S]) -> Option<Rows<S, N>> {
        let announced = core::array::from_fn(|robot| self.announced_state(robot));
        believed(self.tables, (self.own, states), &announced)
    }

    fn question<'q>(
        &self,
        beliefs: &'q Rows<S, N>,
        preferences: &'q Rows<S, N>,
        target: Option<u8>,
    ) -> Question<'q, 'a, S, N> {
        let possible = |operator: u8| self.unmet_of(operator, None, target).is_none();
        let outcome = self.role.outcome.as_ref().filter(|outcome| outcome.possible.is_none_or(possible));
        Question { tables: self.tables, own: self.own, beliefs, preferences, outcome }
    }

    /// Gives the team what its joint policies cost this robot, by what it believed and preferred
    /// when it was last sure. What the budget of the tick is not enough for is done in the next.
    pub(super) fn score(&mut self, peers: Peers<'_, TableMessage<X>>)
    where
        X: Message,
    {
        let (Some(settled), None) = (self.wanted, self.thinking) else { return };
        let Some(todo) = self.rounds.unvalued(peers, &mut self.left) else { return };
        let Some(beliefs) = self.believed(&settled.states) else { return };
        let (target, preferences) = (settled.target, [settled.preference; N]);
        let mut values = Vec::<f32, MAX_POLICIES>::new();
        let question = self.question(&beliefs, &preferences, target);
        question.own_values(todo.iter().copied(), &mut |value| {
            // There is room for the whole list.
            let _ = values.push(value);
        });
        // While it is not sure, what it was sure of is in its fact, and so in the list.
        let is_unsure = !self.is_settled();
        let is_possible =
            |policy| is_unsure || self.rounds.stays(policy) || self.unmet_in(policy, target).is_none();
        let listed = self.rounds.listed().iter().copied();
        let possible: List = up_to(listed.filter(|&policy| is_possible(policy)));
        self.rounds.value(&values, &possible, settled.operator, peers);
    }
}
