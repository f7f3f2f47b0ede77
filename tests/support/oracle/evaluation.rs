//! The terms of G by enumeration of joint states and outcomes, one joint policy at a time.

use super::decision::Decision;
use super::description::Description;
use super::{Marginals, Tables, log_softmax, p_ln_p, wide};
use iibt_core::actions::Action;
use iibt_core::inference::{Gain, PreferenceTiming};

/// The terms of a policy, in nats.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sums {
    /// E_q(o) C(o), normalised, with the preferences for pairs.
    pub utility: f64,
    /// I(o; s), by the states' posterior for every outcome.
    pub information_gain: f64,
    /// E_q(s) H[P(o | s)].
    pub ambiguity: f64,
    /// KL[q(o) || P(o)], less the preferences for pairs.
    pub risk: f64,
}

impl Sums {
    /// -G.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.utility + self.information_gain
    }
}

/// A described model and decision, with every table written out.
pub struct Reference<'a> {
    description: &'a Description,
    decision: &'a Decision,
    tables: Tables,
    groups: Vec<usize>,
}

/// A modality observed at one step: its number and C, normalised.
type Seen = (usize, Vec<f64>);

impl<'a> Reference<'a> {
    /// The reference for a decision.
    #[must_use]
    pub fn new(description: &'a Description, decision: &'a Decision) -> Self {
        Self { description, decision, tables: description.tables(), groups: description.groups() }
    }

    /// The terms of one joint policy, a sequence of actions per control.
    #[must_use]
    pub fn terms(&self, beliefs: &Marginals, policy: &[Vec<Action>]) -> Sums {
        let mut beliefs = beliefs.clone();
        let mut sums = Sums::default();
        for step in 0..self.decision.horizon {
            let actions: Vec<Option<Action>> =
                (0..self.groups.len()).map(|factor| self.action(factor, policy, step)).collect();
            let departing = self.meet(&beliefs, Some(&actions));
            beliefs = self.tables.predict(&beliefs, &actions);
            let worth = departing + self.meet(&beliefs, None);
            sums.utility += worth;
            sums.risk -= worth;
            self.observe(&beliefs, &self.seen(policy, step), &mut sums);
        }
        sums
    }

    fn is_in_scope(&self, group: usize) -> bool {
        self.decision.scope >> group & 1 == 1
    }

    fn action(&self, factor: usize, policy: &[Vec<Action>], step: usize) -> Option<Action> {
        if !self.is_in_scope(self.groups[factor]) {
            return None;
        }
        let Some(control) = self.description.factors[factor].control else { return Some(0) };
        policy.get(control).and_then(|actions| actions.get(step)).copied()
    }

    fn meet(&self, beliefs: &Marginals, actions: Option<&[Option<Action>]>) -> f64 {
        let mut worth = 0.0;
        for meeting in &self.decision.meetings {
            let [one, other] = meeting.pair;
            if !meeting.pair.iter().all(|&factor| self.is_in_scope(self.groups[factor])) {
                continue;
            }
            for (s, p) in beliefs[one].iter().enumerate() {
                for (t, q) in beliefs[other].iter().enumerate() {
                    let moves = actions.map(|actions| [actions[one], actions[other]]);
                    worth += p * q * f64::from(meeting.worth([s, t], moves));
                }
            }
        }
        worth
    }

    /// After how many steps a group has arrived: when the last of its sequences ends.
    fn arrival(&self, group: usize, policy: &[Vec<Action>]) -> usize {
        let horizon = self.decision.horizon;
        let mut arrivals = vec![];
        for (factor, of) in self.description.factors.iter().zip(&self.groups) {
            if let (Some(control), true) = (factor.control, *of == group) {
                let steps = policy.get(control).map_or(0, Vec::len);
                arrivals.push(if steps == 0 { horizon } else { steps.min(horizon) });
            }
        }
        arrivals.into_iter().max().unwrap_or(horizon)
    }

    /// What is observed after a step, and how it is liked.
    fn seen(&self, policy: &[Vec<Action>], step: usize) -> Vec<Seen> {
        let mut seen = vec![];
        for (number, sense) in self.description.modalities.iter().enumerate() {
            let mut groups: Vec<usize> = sense.factors.iter().map(|&factor| self.groups[factor]).collect();
            groups.sort_unstable();
            groups.dedup();
            if !groups.iter().all(|&group| self.is_in_scope(group)) {
                continue;
            }
            let first = groups.iter().map(|&group| self.arrival(group, policy)).min();
            let arrives = Some(step + 1) == first;
            let every_step = self.decision.scoring.timing == PreferenceTiming::EveryStep;
            // What several groups bring about together is judged and observed once, at the first
            // arrival.
            if groups.len() > 1 && !arrives && !every_step {
                continue;
            }
            let given = |list: &'a [Vec<f32>]| list.get(number);
            let full = given(&self.decision.preferences).unwrap_or(&sense.preference);
            let under_way = given(&self.decision.negative_preferences).unwrap_or(full);
            seen.push((number, log_softmax(&wide(if arrives || every_step { full } else { under_way }))));
        }
        seen
    }

    fn observe(&self, beliefs: &Marginals, seen: &[Seen], sums: &mut Sums) {
        let states = self.tables.joint(beliefs);
        if self.decision.scoring.gain == Gain::Joint {
            let together: Vec<&Seen> = seen.iter().collect();
            return self.add(&states, &together, sums);
        }
        for one in seen {
            self.add(&states, &[one], sums);
        }
    }

    /// Adds what the outcomes of these modalities, taken together, are expected to bring.
    fn add(&self, states: &[f64], seen: &[&Seen], sums: &mut Sums) {
        let counts: Vec<usize> = seen.iter().map(|(_, likes)| likes.len()).collect();
        let mut outcomes = vec![0; seen.len()];
        for _ in 0..counts.iter().product() {
            let like: f64 = outcomes.iter().zip(seen).map(|(&o, (_, likes))| likes[o]).sum();
            let p = |joint: usize| -> f64 {
                let of = |(&o, (m, _)): (&usize, &&Seen)| self.tables.likelihood[*m][joint][o];
                outcomes.iter().zip(seen).map(of).product()
            };
            let given: Vec<f64> = (0..states.len()).map(p).collect();
            let predicted: f64 = given.iter().zip(states).map(|(p, mass)| p * mass).sum();
            sums.utility += predicted * like;
            sums.risk += p_ln_p(predicted) - predicted * like;
            for (&p, mass) in given.iter().zip(states) {
                sums.ambiguity -= mass * p_ln_p(p);
                if p * mass > 0.0 {
                    sums.information_gain += mass * p * (p / predicted).ln();
                }
            }
            next(&mut outcomes, &counts);
        }
    }
}

/// Goes on to the next combination, the last running fastest.
fn next(now: &mut [usize], counts: &[usize]) {
    for (value, count) in now.iter_mut().zip(counts).rev() {
        *value += 1;
        if *value < *count {
            return;
        }
        *value = 0;
    }
}
