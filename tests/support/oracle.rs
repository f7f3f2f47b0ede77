//! Inference the long way, in double precision: no structure used, nothing factored.

use iibt_core::inference::{Convention, Credit, Gain, Padding, Scoring};

/// The exact beliefs of two robots and the surprise of what was observed.
pub struct JointBelief {
    /// q(s1).
    pub first: Vec<f64>,
    /// q(s2).
    pub second: Vec<f64>,
    /// -ln P(o).
    pub surprise: f64,
}

/// Weights as a distribution.
#[must_use]
pub fn normalised(weights: &[f32]) -> Vec<f64> {
    let sum: f64 = weights.iter().map(|&weight| f64::from(weight)).sum();
    weights.iter().map(|&weight| f64::from(weight) / sum).collect()
}

/// The beliefs of two robots by enumeration of all pairs of states; `None` when what was observed is impossible.
pub fn joint_belief(
    priors: (&[f32], &[f32]),
    first: impl Fn(usize) -> f64,
    second: impl Fn(usize) -> f64,
    matches: impl Fn(usize, usize) -> bool,
) -> Option<JointBelief> {
    let mut belief =
        JointBelief { first: vec![0.0; priors.0.len()], second: vec![0.0; priors.1.len()], surprise: 0.0 };
    let mut total = 0.0;
    for (s, &p) in priors.0.iter().enumerate() {
        for (t, &q) in priors.1.iter().enumerate() {
            let mass =
                f64::from(p) * first(s) * f64::from(q) * second(t) * f64::from(u8::from(matches(s, t)));
            belief.first[s] += mass;
            belief.second[t] += mass;
            total += mass;
        }
    }
    belief.first.iter_mut().chain(&mut belief.second).for_each(|mass| *mass /= total);
    belief.surprise = -total.ln();
    (total > 0.0).then_some(belief)
}

/// Two robots with identity-plus-noise sensors and next-state motion, every table written out.
pub struct Reference {
    /// The next state per action and state.
    pub next: Vec<Vec<usize>>,
    /// The label of each state.
    pub labels: Vec<usize>,
    /// The team's outcome per pair of labels.
    pub outcomes: Vec<Vec<usize>>,
    /// q(s) of both robots.
    pub beliefs: [Vec<f64>; 2],
    /// C of both robots.
    pub preferences: [Vec<f64>; 2],
    /// C of the team's outcome.
    pub team: Vec<f64>,
    /// The preference for a collision.
    pub collision: f64,
    /// The probability of a right reading, per robot.
    pub sensors: [f64; 2],
    /// How to score.
    pub scoring: Scoring,
}

impl Reference {
    /// -G of one joint policy over `horizon` steps, rolled out by itself.
    #[must_use]
    pub fn value(&self, first: &[u8], second: &[u8], horizon: usize) -> f64 {
        let (mut p, mut q) = (self.beliefs[0].clone(), self.beliefs[1].clone());
        let mut value = 0.0;
        for step in 0..horizon {
            let actions = [self.action(first, step), self.action(second, step)];
            value += self.collision * self.exchange(&p, actions[0], &q, actions[1]);
            (p, q) = (self.advance(&p, actions[0]), self.advance(&q, actions[1]));
            value += self.collision * p.iter().zip(&q).map(|(p, q)| p * q).sum::<f64>();
            let arrivals =
                [first, second].map(|policy| if policy.is_empty() { horizon } else { policy.len() });
            value += self.own(0, &p, arrivals[0], step) + self.own(1, &q, arrivals[1], step);
            let judged = step + 1 == arrivals[0].min(arrivals[1]);
            if judged || self.scoring.credit == Credit::EveryStep {
                value += self.together(&p, &q);
            }
        }
        value
    }

    fn action(&self, policy: &[u8], step: usize) -> Option<usize> {
        let padding = match self.scoring.padding {
            Padding::Stay => None,
            Padding::Repeat(action) => Some(action),
        };
        policy.get(step).copied().or(padding).map(usize::from)
    }

    fn successor(&self, action: Option<usize>, state: usize) -> usize {
        action.map_or(state, |action| self.next[action][state])
    }

    fn advance(&self, belief: &[f64], action: Option<usize>) -> Vec<f64> {
        let mut next = vec![0.0; belief.len()];
        for (state, mass) in belief.iter().enumerate() {
            next[self.successor(action, state)] += mass;
        }
        next
    }

    fn exchange(&self, p: &[f64], first: Option<usize>, q: &[f64], second: Option<usize>) -> f64 {
        let mut total = 0.0;
        for (s, p) in p.iter().enumerate() {
            for (t, q) in q.iter().enumerate() {
                let swap = s != t && self.successor(first, s) == t && self.successor(second, t) == s;
                total += p * q * f64::from(u8::from(swap));
            }
        }
        total
    }

    fn likelihood(&self, robot: usize, outcome: usize, state: usize) -> f64 {
        let states = self.labels.len() as f64;
        if outcome == state { self.sensors[robot] } else { (1.0 - self.sensors[robot]) / (states - 1.0) }
    }

    fn ambiguity(&self, robot: usize, belief: &[f64]) -> f64 {
        let column =
            |state: usize| (0..belief.len()).map(|o| -p_ln_p(self.likelihood(robot, o, state))).sum::<f64>();
        belief.iter().enumerate().map(|(state, q)| q * column(state)).sum()
    }

    /// One robot's own part at one step.
    fn own(&self, robot: usize, belief: &[f64], arrival: usize, step: usize) -> f64 {
        let full = self.scoring.credit == Credit::EveryStep || step + 1 == arrival;
        let wanted =
            self.preferences[robot].iter().map(|&c| if full { c } else { c.min(0.0) }).collect::<Vec<_>>();
        let likes = log_softmax(&wanted);
        let outcomes: Vec<f64> = (0..belief.len())
            .map(|o| belief.iter().enumerate().map(|(s, q)| self.likelihood(robot, o, s) * q).sum())
            .collect();
        let utility: f64 = outcomes.iter().zip(&likes).map(|(q, like)| q * like).sum();
        if self.scoring.gain == Gain::Joint {
            return utility;
        }
        let ambiguity = self.ambiguity(robot, belief);
        let entropy: f64 = outcomes.iter().map(|&q| -p_ln_p(q)).sum();
        // G = KL + ambiguity, or KL - ambiguity as printed, where KL = -utility - entropy.
        utility
            + entropy
            + match self.scoring.convention {
                Convention::Standard => -ambiguity,
                Convention::AsPrinted => ambiguity,
            }
    }

    /// The coupled outcome at one step.
    fn together(&self, p: &[f64], q: &[f64]) -> f64 {
        let mut team = vec![0.0; self.team.len()];
        for (s, p) in p.iter().enumerate() {
            for (t, q) in q.iter().enumerate() {
                team[self.outcomes[self.labels[s]][self.labels[t]]] += p * q;
            }
        }
        let utility: f64 = team.iter().zip(log_softmax(&self.team)).map(|(q, like)| q * like).sum();
        utility
            + match self.scoring.gain {
                Gain::PerModality => team.iter().map(|&q| -p_ln_p(q)).sum::<f64>(),
                Gain::Joint => self.joint_gain(p, q),
            }
    }

    /// H[q(o1, o2, team)] less the ambiguities, summed over every combination of outcomes and states.
    fn joint_gain(&self, p: &[f64], q: &[f64]) -> f64 {
        let mut entropy = 0.0;
        for (one, other, team) in combinations(p.len(), self.team.len()) {
            let mut mass = 0.0;
            for (s, p) in p.iter().enumerate() {
                for (t, q) in q.iter().enumerate() {
                    if self.outcomes[self.labels[s]][self.labels[t]] == team {
                        mass += p * q * self.likelihood(0, one, s) * self.likelihood(1, other, t);
                    }
                }
            }
            entropy -= p_ln_p(mass);
        }
        entropy - self.ambiguity(0, p) - self.ambiguity(1, q)
    }
}

fn combinations(states: usize, outcomes: usize) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..states).flat_map(move |one| {
        (0..states).flat_map(move |other| (0..outcomes).map(move |team| (one, other, team)))
    })
}

fn p_ln_p(p: f64) -> f64 {
    if p > 0.0 { p * p.ln() } else { 0.0 }
}

fn log_softmax(values: &[f64]) -> Vec<f64> {
    let total = values.iter().map(|x| x.exp()).sum::<f64>().ln();
    values.iter().map(|x| x - total).collect()
}
