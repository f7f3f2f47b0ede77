//! The belief updates behind other people's numbers, kept to reproduce them.

use super::belief::Beliefs;
use super::estimation::Update;
use super::evidence::Evidence;
use super::likelihood;
use super::model::{MAX_FACTORS, Modality, Model};
use crate::math;

/// Simultaneous mean-field sweeps from uniform beliefs: q_f ∝ exp(ln D_f + E ln P(o | s)), all factors from the beliefs before
/// the sweep.
///
/// An approximation that can oscillate and lose a robot's own position; use [`Beliefs::update`] for anything but
/// reproduction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sweeps {
    /// How many at the most.
    pub most: u8,
    /// They end when the free energy has changed by less than this, in nats.
    pub tolerance: f32,
    /// Where the floor is.
    pub floor: Floor,
}

/// Where a floor keeps the logarithms finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Floor {
    /// Under the product of all modalities' likelihoods: ln(Π A + 1e-16). Costs a visit of every combination of states.
    Product,
    /// Under each modality's likelihood: Σ ln max(A, 2.2e-16).
    Each,
}

impl Floor {
    /// ln p of a belief or prior, kept finite.
    fn ln(self, p: f32) -> f32 {
        match self {
            Self::Product => math::ln(p + FLOOR),
            Self::Each => math::ln(p.max(likelihood::FLOOR)),
        }
    }
}

impl Sweeps {
    /// One sweep: what the paper's numbers need.
    pub const PAPER: Self = Self { most: 1, tolerance: 0.0, floor: Floor::Product };

    /// numpy pymdp 0.0.7: ten sweeps at the most, ended when the free energy changes by less than 0.001.
    pub const NUMPY_PYMDP: Self = Self { most: 10, tolerance: 1e-3, floor: Floor::Product };

    /// JAX pymdp 1.0: sixteen sweeps.
    pub const JAX_PYMDP: Self = Self { most: 16, tolerance: 0.0, floor: Floor::Each };
}

impl<const S: usize, const G: usize> Beliefs<S, G> {
    /// What an observation says, by the sweeps of the field's older tools, which update all factors at once from uniform beliefs: kept to
    /// reproduce their numbers, and the paper's. They may not come to rest, or at a bad place; see [`Sweeps`].
    /// Nothing is impossible to them, because every probability has a floor.
    pub fn update_in_parallel(&mut self, model: &Model, evidence: &[Evidence], sweeps: Sweeps) -> Update {
        update(self, model, evidence, sweeps)
    }
}

/// What counts as no change for sweeps without a tolerance, when they say whether they came to rest.
const AT_REST: f32 = 1e-3;

fn update<const S: usize, const G: usize>(
    beliefs: &mut Beliefs<S, G>,
    model: &Model,
    evidence: &[Evidence],
    sweeps: Sweeps,
) -> Update {
    let prior = *beliefs;
    for factor in 0..model.factors().len() {
        let part = model.part_mut(beliefs.as_flat_mut(), factor);
        part.fill(1.0 / part.len().max(1) as f32);
    }
    let observed = Observed { model, evidence, floor: sweeps.floor };
    let mut update = Update {
        free_energy: complexity(beliefs, &prior, model, sweeps.floor),
        exact: false,
        converged: false,
        sweeps: 0,
    };
    let mut change = f32::INFINITY;
    while update.sweeps < sweeps.most && change >= sweeps.tolerance {
        *beliefs = sweep(beliefs, &prior, &observed);
        let now = complexity(beliefs, &prior, model, sweeps.floor) - observed.accuracy(beliefs);
        change = (update.free_energy - now).abs();
        update.free_energy = now;
        update.sweeps += 1;
    }
    update.converged = change < sweeps.tolerance.max(AT_REST);
    update
}

/// Every factor's best belief given the others' old ones.
fn sweep<const S: usize, const G: usize>(
    beliefs: &Beliefs<S, G>,
    prior: &Beliefs<S, G>,
    observed: &Observed,
) -> Beliefs<S, G> {
    let mut scores = observed.log_messages(beliefs);
    for factor in 0..observed.model.factors().len() {
        let part = observed.model.part_mut(scores.as_flat_mut(), factor);
        for (score, p) in part.iter_mut().zip(prior.of(observed.model, factor)) {
            *score += observed.floor.ln(*p);
        }
        math::softmax(part);
    }
    scores
}

/// The floor of numpy pymdp.
const FLOOR: f32 = 1e-16;

/// Σ_f KL[q_f || p_f], with the floor.
fn complexity<const S: usize, const G: usize>(
    beliefs: &Beliefs<S, G>,
    prior: &Beliefs<S, G>,
    model: &Model,
    floor: Floor,
) -> f32 {
    let of = |factor: usize| -> f32 {
        let pairs = beliefs.of(model, factor).iter().zip(prior.of(model, factor));
        pairs.map(|(&q, &p)| q * (floor.ln(q) - floor.ln(p))).sum()
    };
    (0..model.factors().len()).map(of).sum()
}

/// What was observed, and how its logarithm is taken.
struct Observed<'a, 'm, 'e> {
    model: &'a Model<'m>,
    evidence: &'a [Evidence<'e>],
    floor: Floor,
}

impl<'m, 'e> Observed<'_, 'm, 'e> {
    fn modalities(&self) -> impl Iterator<Item = (&'m Modality<'m>, Evidence<'e>)> + '_ {
        let observed = self.model.modalities().iter().zip(self.evidence.iter().copied());
        observed.filter(|(_, evidence)| !evidence.is_missing())
    }

    /// E_q ln P(o | s).
    fn accuracy<const S: usize, const G: usize>(&self, beliefs: &Beliefs<S, G>) -> f32 {
        match self.floor {
            Floor::Product => {
                let mut total = 0.0;
                self.for_each_state(beliefs, |_, mass, ln| total += mass * ln);
                total
            }
            Floor::Each => {
                let of = |(modality, evidence): (&Modality, Evidence)| {
                    let Some(&factor) = modality.factors().first() else { return 0.0 };
                    let mut scratch = Beliefs::<S, G>::EMPTY;
                    let scores = self.model.part_mut(scratch.as_flat_mut(), factor);
                    let parts = self.model.parts(beliefs.as_flat(), modality.factors());
                    modality.likelihood().log_message(
                        modality.shape(),
                        evidence,
                        parts.as_slice(),
                        0,
                        scores,
                    );
                    math::expectation(beliefs.of(self.model, factor), scores)
                };
                self.modalities().map(of).sum()
            }
        }
    }

    /// E ln P(o | s) over all factors but one, for each factor's states.
    fn log_messages<const S: usize, const G: usize>(&self, beliefs: &Beliefs<S, G>) -> Beliefs<S, G> {
        let mut messages = Beliefs::EMPTY;
        match self.floor {
            Floor::Product => self.add_product_messages(beliefs, &mut messages),
            Floor::Each => {
                for (modality, evidence) in self.modalities() {
                    let parts = self.model.parts(beliefs.as_flat(), modality.factors());
                    for (condition, &factor) in modality.factors().iter().enumerate() {
                        let scores = self.model.part_mut(messages.as_flat_mut(), factor);
                        let (form, shape) = (modality.likelihood(), modality.shape());
                        form.log_message(shape, evidence, parts.as_slice(), condition, scores);
                    }
                }
            }
        }
        messages
    }

    fn add_product_messages<const S: usize, const G: usize>(
        &self,
        beliefs: &Beliefs<S, G>,
        messages: &mut Beliefs<S, G>,
    ) {
        self.for_each_state(beliefs, |states, mass, ln| {
            for (factor, &state) in states.iter().enumerate().take(self.model.factors().len()) {
                let q = beliefs.of(self.model, factor).get(state).copied().unwrap_or(0.0);
                if let Some(score) = self.model.part_mut(messages.as_flat_mut(), factor).get_mut(state)
                    && q > 0.0
                {
                    *score += mass / q * ln;
                }
            }
        });
    }

    /// Visits every combination of all factors' states with its mass and ln(Π A + floor).
    fn for_each_state<const S: usize, const G: usize>(
        &self,
        beliefs: &Beliefs<S, G>,
        mut visit: impl FnMut(&[usize; MAX_FACTORS], f32, f32),
    ) {
        let mut now = [0; MAX_FACTORS];
        loop {
            let mut mass = 1.0;
            for (factor, &state) in now.iter().enumerate().take(self.model.factors().len()) {
                mass *= beliefs.of(self.model, factor).get(state).copied().unwrap_or(0.0);
            }
            visit(&now, mass, math::ln(self.likelihood(&now) + FLOOR));
            if !self.advance(&mut now) {
                return;
            }
        }
    }

    /// Π_m P(o_m | s).
    fn likelihood(&self, now: &[usize; MAX_FACTORS]) -> f32 {
        self.modalities().map(|(modality, evidence)| modality.probability(evidence, now)).product()
    }

    /// Goes on to the next combination of states; `false` after the last.
    fn advance(&self, now: &mut [usize; MAX_FACTORS]) -> bool {
        for (state, factor) in now.iter_mut().zip(self.model.factors()).rev() {
            *state += 1;
            if *state < factor.states() {
                return true;
            }
            *state = 0;
        }
        false
    }
}
