//! Active inference as it is written first: dense tables over both factors, every joint policy
//! rolled out by itself, in double precision. What the benchmarks measure the core against.

use firmware::bench::Benchmark;
use iibt_core::actions::Action;

/// A model of two factors with every table written out.
pub struct Dense {
    states: [usize; 2],
    /// P(o | s1, s2) of each modality: outcome by outcome, pair by pair.
    likelihoods: Vec<Vec<Vec<f64>>>,
    /// H[P(o | s1, s2)] of each modality.
    entropies: Vec<Vec<f64>>,
    /// P(s' | s, u) of each factor: action, next state, state.
    transitions: [Vec<Vec<Vec<f64>>>; 2],
    /// ln P(o) of each modality.
    preferences: Vec<Vec<f64>>,
    priors: [Vec<f64>; 2],
    policies: Vec<Vec<[Action; 2]>>,
    outcomes: Vec<usize>,
}

impl Dense {
    /// The tables of a benchmark, entry by entry.
    #[must_use]
    pub fn of<const S: usize>(benchmark: &Benchmark<S>, actions: u8, observed: [usize; 3]) -> Self {
        let model = benchmark.model;
        let states = [0, 1].map(|factor: usize| model.factors()[factor].states());
        let pairs = || (0..states[0]).flat_map(|s| (0..states[1]).map(move |t| [s, t]));
        let likelihoods: Vec<Vec<Vec<f64>>> = model
            .modalities()
            .iter()
            .map(|modality| {
                let of = |outcome: usize| {
                    let p = |pair: [usize; 2]| {
                        let on: Vec<usize> = modality.factors().iter().map(|&factor| pair[factor]).collect();
                        f64::from(modality.likelihood().probability(outcome, &on))
                    };
                    pairs().map(p).collect()
                };
                (0..modality.shape().values()).map(of).collect()
            })
            .collect();
        let entropy = |table: &Vec<Vec<f64>>| {
            (0..states[0] * states[1]).map(|pair| table.iter().map(|row| -p_ln_p(row[pair])).sum()).collect()
        };
        let transitions = [0, 1].map(|factor: usize| {
            let entry =
                |action, next, state| f64::from(model.factors()[factor].probability(action, next, &[state]));
            let row = |action, next| (0..states[factor]).map(|state| entry(action, next, state)).collect();
            (0..actions).map(|action| (0..states[factor]).map(|next| row(action, next)).collect()).collect()
        });
        let candidates = benchmark.candidates;
        let actions_of = |policy: usize, control| {
            let actions = candidates.actions(control, candidates.sequence(policy, control));
            actions.iter().collect::<Vec<Action>>()
        };
        let policies = (0..candidates.len()).map(|policy| {
            let [first, second] = [0, 1].map(|control| actions_of(policy, control));
            first.into_iter().zip(second).map(|(first, second)| [first, second]).collect()
        });
        Self {
            states,
            entropies: likelihoods.iter().map(entropy).collect(),
            likelihoods,
            transitions,
            preferences: model
                .modalities()
                .iter()
                .map(|modality| log_softmax(modality.preference()))
                .collect(),
            priors: [0, 1].map(|factor| model.prior(factor).iter().map(|&p| f64::from(p)).collect()),
            policies: policies.collect(),
            outcomes: observed.to_vec(),
        }
    }

    /// One belief update and the posterior over the policies.
    #[must_use]
    pub fn run(&self, precision: f64) -> Vec<f64> {
        let beliefs = self.beliefs();
        let scores: Vec<f64> =
            self.policies.iter().map(|policy| precision * self.value(&beliefs, policy)).collect();
        let largest = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = scores.iter().map(|score| (score - largest).exp()).collect();
        let sum: f64 = weights.iter().sum();
        weights.iter().map(|weight| weight / sum).collect()
    }

    /// The marginals of the exact joint posterior.
    fn beliefs(&self) -> [Vec<f64>; 2] {
        let mut beliefs = self.states.map(|states| vec![0.0; states]);
        for s in 0..self.states[0] {
            for t in 0..self.states[1] {
                let mut mass = self.priors[0][s] * self.priors[1][t];
                for (table, &outcome) in self.likelihoods.iter().zip(&self.outcomes) {
                    mass *= table[outcome][s * self.states[1] + t];
                }
                beliefs[0][s] += mass;
                beliefs[1][t] += mass;
            }
        }
        beliefs.map(|belief| {
            let sum: f64 = belief.iter().sum();
            belief.iter().map(|mass| mass / sum).collect()
        })
    }

    /// -G of one policy.
    fn value(&self, beliefs: &[Vec<f64>; 2], policy: &[[Action; 2]]) -> f64 {
        let mut now = beliefs.clone();
        let mut value = 0.0;
        for actions in policy {
            for ((belief, transition), &action) in now.iter_mut().zip(&self.transitions).zip(actions) {
                let next = |row: &Vec<f64>| row.iter().zip(belief.iter()).map(|(p, q)| p * q).sum();
                *belief = transition[usize::from(action)].iter().map(next).collect();
            }
            let joint: Vec<f64> = now[0].iter().flat_map(|p| now[1].iter().map(move |q| p * q)).collect();
            let expectation = |values: &Vec<f64>| joint.iter().zip(values).map(|(q, x)| q * x).sum::<f64>();
            for ((table, entropies), likes) in
                self.likelihoods.iter().zip(&self.entropies).zip(&self.preferences)
            {
                for (row, like) in table.iter().zip(likes) {
                    let q = expectation(row);
                    value += q * like - p_ln_p(q);
                }
                value -= expectation(entropies);
            }
        }
        value
    }
}

fn p_ln_p(p: f64) -> f64 {
    if p > 0.0 { p * p.ln() } else { 0.0 }
}

fn log_softmax(values: &[f32]) -> Vec<f64> {
    let total = values.iter().map(|&x| f64::from(x).exp()).sum::<f64>().ln();
    values.iter().map(|&x| f64::from(x) - total).collect()
}
