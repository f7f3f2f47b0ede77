//! The parallel belief updates behind other tools' numbers and the paper's.

use iibt_core::inference::{Beliefs, Evidence, Modality, Model, Update, likelihood};
use iibt_core::math;

/// Simultaneous mean-field sweeps from uniform beliefs: q_f ∝ exp(ln D_f + E ln P(o | s)), all
/// factors from the beliefs before the sweep.
///
/// This approximation can oscillate and lose a robot's own position; robots use
/// [`Beliefs::update`]. Nothing is impossible to it, because every probability has a floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweeps {
    /// The most sweeps.
    pub most: u8,
    /// They end when the free energy has changed by less than this, in nats.
    pub tolerance: f32,
    /// The floor.
    pub floor: ProbabilityFloor,
}

/// The floor that keeps logarithms finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbabilityFloor {
    /// Under the product of all modalities' likelihoods: ln(Π A + 1e-16). Costs a visit of every
    /// combination of states.
    Product,
    /// Under each modality's likelihood: Σ ln max(A, 2.2e-16).
    Each,
}

impl ProbabilityFloor {
    /// ln p of a belief or prior, kept finite.
    fn ln(self, p: f32) -> f32 {
        match self {
            Self::Product => math::ln(p + FLOOR),
            Self::Each => math::ln(p.max(likelihood::FLOOR)),
        }
    }
}

/// The floor of numpy pymdp.
const FLOOR: f32 = 1e-16;

/// The change below which sweeps without a tolerance count as converged.
const AT_REST: f32 = 1e-3;

/// The beliefs about each factor.
type Marginals = Vec<Vec<f32>>;

impl Sweeps {
    /// One sweep: what the paper's numbers need.
    pub const PAPER: Self = Self { most: 1, tolerance: 0.0, floor: ProbabilityFloor::Product };

    /// numpy pymdp 0.0.7: ten sweeps at the most, ended when the free energy changes by less than
    /// 0.001.
    pub const NUMPY_PYMDP: Self = Self { most: 10, tolerance: 1e-3, floor: ProbabilityFloor::Product };

    /// JAX pymdp 1.0: sixteen sweeps.
    pub const JAX_PYMDP: Self = Self { most: 16, tolerance: 0.0, floor: ProbabilityFloor::Each };

    /// Updates beliefs by an observation, with evidence for each modality.
    ///
    /// # Panics
    /// When the beliefs are those of another model.
    pub fn update<const S: usize, const G: usize>(
        self,
        beliefs: &mut Beliefs<S, G>,
        model: &Model,
        evidence: &[Evidence],
    ) -> Update {
        let factors = 0..model.factors().len();
        let prior: Marginals = factors
            .clone()
            .map(|factor| beliefs.of(model, factor).expect("the model has it").to_vec())
            .collect();
        let observed = SweptEvidence { model, evidence, floor: self.floor };
        let mut q: Marginals = prior.iter().map(|p| vec![1.0 / p.len() as f32; p.len()]).collect();
        let mut update =
            Update { free_energy: self.complexity(&q, &prior), exact: false, converged: false, sweeps: 0 };
        let mut change = f32::INFINITY;
        while update.sweeps < self.most && change >= self.tolerance {
            q = observed.sweep(&q, &prior);
            let now = self.complexity(&q, &prior) - observed.accuracy(&q);
            change = (update.free_energy - now).abs();
            update.free_energy = now;
            update.sweeps += 1;
        }
        update.converged = change < self.tolerance.max(AT_REST);
        for factor in factors {
            beliefs.set(model, factor, &q[factor]).expect("a softmax is a distribution");
        }
        update
    }

    /// Σ_f KL[q_f || p_f], with the floor.
    fn complexity(self, q: &Marginals, prior: &Marginals) -> f32 {
        let of = |(q, p): (&Vec<f32>, &Vec<f32>)| -> f32 {
            q.iter().zip(p).map(|(&q, &p)| q * (self.floor.ln(q) - self.floor.ln(p))).sum()
        };
        q.iter().zip(prior).map(of).sum()
    }
}

/// The observation, and the way its logarithm is taken.
struct SweptEvidence<'a, 'm, 'e> {
    model: &'a Model<'m>,
    evidence: &'a [Evidence<'e>],
    floor: ProbabilityFloor,
}

impl<'m, 'e> SweptEvidence<'_, 'm, 'e> {
    /// Every factor's best belief given the others' old ones.
    fn sweep(&self, q: &Marginals, prior: &Marginals) -> Marginals {
        let mut scores = match self.floor {
            ProbabilityFloor::Product => self.messages_of_product(q),
            ProbabilityFloor::Each => self.messages_of_each(q),
        };
        for (scores, prior) in scores.iter_mut().zip(prior) {
            scores.iter_mut().zip(prior).for_each(|(score, p)| *score += self.floor.ln(*p));
            math::softmax(scores);
        }
        scores
    }

    fn modalities(&self) -> impl Iterator<Item = (&'m Modality<'m>, Evidence<'e>)> + '_ {
        let observed = self.model.modalities().iter().zip(self.evidence.iter().copied());
        observed.filter(|(_, evidence)| !evidence.is_missing())
    }

    /// E_q ln P(o | s).
    fn accuracy(&self, q: &Marginals) -> f32 {
        match self.floor {
            ProbabilityFloor::Product => {
                let mut total = 0.0;
                self.for_each_state(q, |_, mass, ln| total += mass * ln);
                total
            }
            ProbabilityFloor::Each => {
                let of = |(modality, evidence): (&Modality, Evidence)| {
                    let first = &q[modality.factors()[0]];
                    let mut scores = vec![0.0; first.len()];
                    log_message(modality, evidence, q, 0, &mut scores);
                    math::expectation(first, &scores)
                };
                self.modalities().map(of).sum()
            }
        }
    }

    /// E ln P(o | s) over all factors but one, for each factor's states.
    fn messages_of_each(&self, q: &Marginals) -> Marginals {
        let mut messages = zeros(q);
        for (modality, evidence) in self.modalities() {
            for (condition, &factor) in modality.factors().iter().enumerate() {
                log_message(modality, evidence, q, condition, &mut messages[factor]);
            }
        }
        messages
    }

    /// The messages of the product of all likelihoods.
    fn messages_of_product(&self, q: &Marginals) -> Marginals {
        let mut messages = zeros(q);
        self.for_each_state(q, |states, mass, ln| {
            for (factor, &state) in states.iter().enumerate() {
                if q[factor][state] > 0.0 {
                    messages[factor][state] += mass / q[factor][state] * ln;
                }
            }
        });
        messages
    }

    /// Visits every combination of all factors' states with its mass and ln(Π A + floor).
    fn for_each_state(&self, q: &Marginals, mut visit: impl FnMut(&[usize], f32, f32)) {
        let mut states = vec![0; q.len()];
        loop {
            let mass = q.iter().zip(&states).fold(1.0, |mass, (q, &state)| mass * q[state]);
            visit(&states, mass, math::ln(self.likelihood(&states) + FLOOR));
            let Some(next) = states.iter().zip(q).rposition(|(&state, q)| state + 1 < q.len()) else {
                return;
            };
            states[next] += 1;
            states[next + 1..].fill(0);
        }
    }

    /// Π_m P(o_m | s).
    fn likelihood(&self, states: &[usize]) -> f32 {
        let of = |(modality, evidence): (&Modality, Evidence)| {
            let given: Vec<usize> = modality.factors().iter().map(|&factor| states[factor]).collect();
            let p = |outcome| modality.likelihood().probability(outcome, &given);
            match evidence {
                Evidence::Missing => 1.0,
                Evidence::Outcome(outcome) => p(outcome),
                Evidence::Soft(weights) => {
                    weights.iter().enumerate().map(|(outcome, w)| w * p(outcome)).sum()
                }
            }
        };
        self.modalities().map(of).product()
    }
}

fn zeros(like: &Marginals) -> Marginals {
    like.iter().map(|of| vec![0.0; of.len()]).collect()
}

fn log_message(modality: &Modality, evidence: Evidence, q: &Marginals, condition: usize, to: &mut [f32]) {
    let beliefs: Vec<&[f32]> = modality.factors().iter().map(|&factor| q[factor].as_slice()).collect();
    modality.likelihood().log_message(modality.shape(), evidence, &beliefs, condition, to);
}
