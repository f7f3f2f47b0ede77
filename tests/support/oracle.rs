//! Inference the long way, in double precision: every table written out over the joint states of
//! all factors, every combination of states and outcomes visited, no structure used and nothing
//! factored.

pub mod chance;
pub mod decision;
pub mod description;
pub mod evaluation;
pub mod generator;

/// A model with every table written out. A joint state numbers the combinations of all factors'
/// states, the last factor running fastest.
#[derive(Clone, Debug)]
pub struct Tables {
    /// How many states each factor has.
    pub states: Vec<usize>,
    /// P(o | s): for each modality and joint state a distribution over outcomes.
    pub likelihood: Vec<Vec<Vec<f64>>>,
    /// P(s' | s, u): for each factor, action and joint state a distribution over the factor's next
    /// states.
    pub transition: Vec<Vec<Vec<Vec<f64>>>>,
}

/// q(s) of each factor.
pub type Marginals = Vec<Vec<f64>>;

impl Tables {
    /// How many joint states there are.
    #[must_use]
    pub fn joint_states(&self) -> usize {
        self.states.iter().product()
    }

    /// The states of all factors in a joint state.
    #[must_use]
    pub fn states_of(&self, joint: usize) -> Vec<usize> {
        let mut rest = joint;
        let mut states: Vec<usize> = self
            .states
            .iter()
            .rev()
            .map(|&count| {
                let state = rest % count;
                rest /= count;
                state
            })
            .collect();
        states.reverse();
        states
    }

    /// The probability of every joint state under independent beliefs.
    #[must_use]
    pub fn joint(&self, beliefs: &Marginals) -> Vec<f64> {
        let mass = |joint| self.states_of(joint).iter().zip(beliefs).map(|(&s, q)| q[s]).product();
        (0..self.joint_states()).map(mass).collect()
    }

    /// The marginals of weights over joint states, not normalised.
    #[must_use]
    pub fn marginals(&self, joint: &[f64]) -> Marginals {
        let mut marginals: Marginals = self.states.iter().map(|&count| vec![0.0; count]).collect();
        for (joint, mass) in joint.iter().enumerate() {
            for (state, marginal) in self.states_of(joint).into_iter().zip(&mut marginals) {
                marginal[state] += mass;
            }
        }
        marginals
    }

    /// The beliefs after a step, with an action for each factor or `None` for one that stays, as
    /// one does on an action that it does not have. Columns written in single precision do not sum
    /// to one exactly, so beliefs are normalised.
    #[must_use]
    pub fn predict(&self, beliefs: &Marginals, actions: &[Option<u8>]) -> Marginals {
        let joint = self.joint(beliefs);
        let moved = |factor: usize| {
            let table = self.transition[factor].get(usize::from(actions[factor]?))?;
            let mut next = vec![0.0; self.states[factor]];
            for (mass, column) in joint.iter().zip(table) {
                next.iter_mut().zip(column).for_each(|(next, p)| *next += mass * p);
            }
            Some(normalised(&next))
        };
        (0..self.states.len())
            .map(|factor| moved(factor).unwrap_or_else(|| beliefs[factor].clone()))
            .collect()
    }

    /// P(e | s) of each joint state, for a weight per outcome of one modality; every probability
    /// raised to `floor`.
    #[must_use]
    pub fn explains(&self, modality: usize, weights: &[f64], floor: f64) -> Vec<f64> {
        let of = |column: &Vec<f64>| column.iter().zip(weights).map(|(p, w)| p * w).sum::<f64>().max(floor);
        self.likelihood[modality].iter().map(of).collect()
    }

    /// The exact posterior and -ln P(e) by Bayes' rule over all joint states; `None` where the
    /// evidence, a weight for each outcome of each modality that was observed, is impossible.
    #[must_use]
    pub fn update(&self, beliefs: &Marginals, evidence: &[(usize, Vec<f64>)]) -> Option<(Marginals, f64)> {
        let mut joint = self.joint(beliefs);
        for (modality, weights) in evidence {
            let explained = self.explains(*modality, weights, 0.0);
            joint.iter_mut().zip(explained).for_each(|(mass, p)| *mass *= p);
        }
        let total: f64 = joint.iter().sum();
        joint.iter_mut().for_each(|mass| *mass /= total);
        (total > 0.0).then(|| (self.marginals(&joint), -total.ln()))
    }

    /// F = E_q [ln q(s) - ln p(s) - Σ_m ln max(P(e_m | s), floor)], the free energy of any
    /// independent beliefs.
    #[must_use]
    pub fn free_energy(
        &self,
        beliefs: &Marginals,
        prior: &Marginals,
        evidence: &[(usize, Vec<f64>)],
        floor: f64,
    ) -> f64 {
        let (q, p) = (self.joint(beliefs), self.joint(prior));
        let explained: Vec<Vec<f64>> = evidence.iter().map(|(m, w)| self.explains(*m, w, floor)).collect();
        let mut total = 0.0;
        for (joint, (&q, &p)) in q.iter().zip(&p).enumerate() {
            if q > 0.0 {
                total += q * (q / p).ln() - q * explained.iter().map(|of| of[joint].ln()).sum::<f64>();
            }
        }
        total
    }
}

/// Weights as a distribution.
#[must_use]
pub fn normalised(weights: &[f64]) -> Vec<f64> {
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}

/// Single precision written out in double.
#[must_use]
pub fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().map(|&value| f64::from(value)).collect()
}

/// `p ln p`, zero at zero.
#[must_use]
pub fn p_ln_p(p: f64) -> f64 {
    if p > 0.0 { p * p.ln() } else { 0.0 }
}

/// x - ln Σ exp x.
#[must_use]
pub fn log_softmax(values: &[f64]) -> Vec<f64> {
    let total = values.iter().map(|x| x.exp()).sum::<f64>().ln();
    values.iter().map(|x| x - total).collect()
}

/// exp x / Σ exp x, by way of the largest.
#[must_use]
pub fn softmax(values: &[f64]) -> Vec<f64> {
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    normalised(&values.iter().map(|x| (x - largest).exp()).collect::<Vec<_>>())
}
