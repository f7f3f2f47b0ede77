//! What a robot infers by itself: what it would choose, and what the team's joint policies cost it.

use super::announcement::TableMessage;
use super::definition::{Postcondition, Role, Wish};
use super::joint::{operator_of, prices};
use super::model::Question;
use super::task::{JointDecision, Offered, TableTask, Wanted, row};
use crate::inference::Preference;
use crate::team::{Message, Peers};

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
                announced.is_none_or(|announced| announced == operator_of(self.tables, policy, robot))
            };
            if best.is_none_or(|(_, most)| p > most) && announced.iter().enumerate().all(fits) {
                best = Some((policy, p));
            }
        }
        best.map(|(policy, _)| policy)
    }

    /// The robot's own inference: what it would choose while its teammates do what they announced.
    pub(super) fn decide(
        &self,
        offered: &Offered<N>,
        wanted: &Wanted<S, N>,
    ) -> Option<JointDecision<S, N, P>> {
        let (beliefs, posterior) = self.ask(wanted, |question| question.answer())?;
        let choice = self.best(&posterior, &offered.announced)?;
        let preferences = wanted.rows.each_ref().map(Preference::values);
        Some(JointDecision { preferences, beliefs, posterior, choice })
    }

    fn ask<T>(
        &self,
        wanted: &Wanted<S, N>,
        answer: impl Fn(&Question<'_, 'a, S, N>) -> Option<T>,
    ) -> Option<T> {
        let states = self.states();
        let possible = |operator: u8| self.unmet_of(operator, None, wanted.target).is_none();
        let outcome = self.role.outcome.as_ref().filter(|outcome| outcome.possible.is_none_or(possible));
        answer(&Question {
            tables: self.tables,
            own: self.own,
            states: states.get(..self.role.states.names.len())?,
            announced: &core::array::from_fn(|robot| self.announced_state(robot)),
            preferences: &wanted.rows,
            outcome,
        })
    }

    /// Gives the team what its joint policies cost this robot, by the own belief and preferences.
    pub(super) fn score(&mut self, wanted: &Wanted<S, N>, operator: u8, peers: Peers<'_, TableMessage<X>>)
    where
        X: Message,
    {
        if !self.rounds.prepare(peers) {
            return;
        }
        let Some(values) = self.ask(wanted, |question| question.own_values::<P>()) else { return };
        // While it is not sure, what it was sure of is in its fact, and so in the list.
        let is_unsure = !self.is_settled();
        let is_possible =
            |policy| is_unsure || self.rounds.stays(policy) || self.unmet_in(policy, wanted.target).is_none();
        let value = |policy: u16| values.get(usize::from(policy)).copied().filter(|_| is_possible(policy));
        let scores = prices(self.rounds.listed(), value);
        self.rounds.give(scores, operator, peers);
    }
}
