//! State inference: what an observation says about the hidden factors.

use super::belief::Beliefs;
use super::evidence::Evidence;
use super::model::{MAX_FACTORS, Modality, Model};
use super::shape::{MAX_CONDITIONS, Shape};
use crate::math;
use heapless::Vec;

/// The most steps, which are combinations of coupled states or of their labels, that exact inference may take.
pub const EXACT_LIMIT: usize = 4096;

/// The most sweeps of coordinate ascent.
pub const MAX_SWEEPS: u8 = 32;

/// The largest change of a probability in a sweep after which coordinate ascent has converged.
const TOLERANCE: f32 = 2e-6;

/// How factors that are coupled by what was observed are inferred.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// Exactly while it fits the limit, else by coordinate ascent.
    Exact,
    /// By coordinate ascent in this many sweeps at the most.
    CoordinateAscent(u8),
}

/// How an update went.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Update {
    /// F, the variational free energy of the new beliefs, in nats: the surprise -ln P(o) where inference was exact,
    /// an upper bound of it elsewhere.
    pub free_energy: f32,
    /// Whether all coupled factors were inferred exactly.
    pub exact: bool,
    /// Whether coordinate ascent, where it was used, came to rest. F never rises from sweep to sweep.
    pub converged: bool,
    /// The sweeps it took.
    pub sweeps: u8,
}

/// The observation has probability zero under the beliefs and the model. The beliefs were left as they were.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Impossible {
    /// The modality that cannot be explained together with those before it.
    pub modality: usize,
}

impl core::fmt::Display for Impossible {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "the observation of modality {} has probability zero under the beliefs and the model",
            self.modality
        )
    }
}

impl core::error::Error for Impossible {}

/// The observed modalities, a bit for each of `members`, that couple factors.
#[derive(Clone, Copy)]
struct Couplings<'a, 'm, 'e> {
    model: &'a Model<'m>,
    evidence: &'a [Evidence<'e>],
    members: u64,
}

/// One of them: its number, the modality, and what was observed.
type Coupling<'m, 'e> = (usize, &'m Modality<'m>, Evidence<'e>);

impl<'a, 'm, 'e> Couplings<'a, 'm, 'e> {
    fn all(model: &'a Model<'m>, evidence: &'a [Evidence<'e>]) -> Self {
        let all = Self { model, evidence, members: u64::MAX };
        let couples =
            |(_, modality, evidence): &Coupling| modality.factors().len() > 1 && !evidence.is_missing();
        let members = all.iter().filter(couples).fold(0, |members, (number, ..)| members | 1 << number);
        Self { members, ..all }
    }

    fn iter(&self) -> impl Iterator<Item = Coupling<'m, 'e>> + '_ {
        let numbered = self.model.modalities().iter().zip(self.evidence).enumerate();
        numbered
            .filter(|(number, _)| self.members >> number & 1 == 1)
            .map(|(number, (modality, &evidence))| (number, modality, evidence))
    }

    /// Takes out everything that is coupled, directly or not, to the first member.
    fn take_component(&mut self) -> Option<Self> {
        let (first, modality, _) = self.iter().next()?;
        let mut component = Self { members: 1 << first, ..*self };
        let mut factors = bits(modality);
        loop {
            let joined = self.iter().filter(|(_, modality, _)| bits(modality) & factors != 0);
            let (members, reached) = joined
                .fold((0, factors), |(m, f), (number, modality, _)| (m | 1 << number, f | bits(modality)));
            component.members = members;
            if reached == factors {
                self.members &= !members;
                return Some(component);
            }
            factors = reached;
        }
    }

    /// The factors that they couple, a bit for each.
    fn factors(&self) -> u32 {
        self.iter().fold(0, |all, (_, modality, _)| all | bits(modality))
    }

    /// The only member.
    fn single(&self) -> Option<Coupling<'m, 'e>> {
        self.iter().next().filter(|_| self.members.is_power_of_two())
    }
}

fn bits(modality: &Modality) -> u32 {
    modality.factors().iter().fold(0, |bits, &factor| bits | 1 << factor)
}

pub(super) fn update<const S: usize, const G: usize>(
    beliefs: &mut Beliefs<S, G>,
    model: &Model,
    evidence: &[Evidence],
    method: Method,
) -> Result<Update, Impossible> {
    let mut posterior = *beliefs;
    let mut update = Update { free_energy: 0.0, exact: true, converged: true, sweeps: 0 };
    update.free_energy = own_evidence(&mut posterior, model, evidence)?;
    let mut left = Couplings::all(model, evidence);
    while let Some(together) = left.take_component() {
        let part = update_together(&mut posterior, model, &together, method)?;
        update.free_energy += part.free_energy;
        update.exact &= part.exact;
        update.converged &= part.converged;
        update.sweeps = update.sweeps.max(part.sweeps);
    }
    *beliefs = posterior;
    Ok(update)
}

/// Bayes' rule for every modality that depends on one factor; returns its part of the surprise.
fn own_evidence<const S: usize, const G: usize>(
    beliefs: &mut Beliefs<S, G>,
    model: &Model,
    evidence: &[Evidence],
) -> Result<f32, Impossible> {
    let mut surprise = 0.0;
    for (number, (modality, &evidence)) in model.modalities().iter().zip(evidence).enumerate() {
        let &[factor] = modality.factors() else { continue };
        if evidence.is_missing() {
            continue;
        }
        surprise -= multiply_by_message(beliefs, model, (modality, evidence), (factor, 0), &[&[]])
            .map(math::ln)
            .ok_or(Impossible { modality: number })?;
    }
    Ok(surprise)
}

/// Multiplies a factor's belief with the message from one observation, normalises it, and returns the evidence; `None`,
/// and an unchanged belief, when there is none.
fn multiply_by_message<const S: usize, const G: usize>(
    beliefs: &mut Beliefs<S, G>,
    model: &Model,
    (modality, evidence): (&Modality, Evidence),
    (factor, condition): (usize, usize),
    conditions: &[&[f32]],
) -> Option<f32> {
    let belief = model.part_mut(beliefs.as_flat_mut(), factor);
    let mut scratch = Beliefs::<S, G>::EMPTY;
    let message = scratch.as_flat_mut().get_mut(..belief.len())?;
    modality.likelihood().message(modality.shape(), evidence, conditions, condition, message);
    message.iter_mut().zip(belief.iter()).for_each(|(message, q)| *message *= q);
    let evidence = math::normalise(message)?;
    math::assign(belief, message);
    Some(evidence)
}

fn update_together<const S: usize, const G: usize>(
    beliefs: &mut Beliefs<S, G>,
    model: &Model,
    couplings: &Couplings,
    method: Method,
) -> Result<Update, Impossible> {
    let exact = |surprise| Update { free_energy: surprise, exact: true, converged: true, sweeps: 0 };
    let sweeps = match method {
        Method::Exact => MAX_SWEEPS,
        Method::CoordinateAscent(sweeps) => sweeps.clamp(1, MAX_SWEEPS),
    };
    if method == Method::Exact {
        if let Some(coupling) = couplings.single() {
            if coupling.1.likelihood().effort(coupling.1.shape()) <= EXACT_LIMIT {
                return by_messages(beliefs, model, coupling).map(exact);
            }
        } else if let Some(product) = Product::of(model, couplings) {
            return product.update(beliefs, model, couplings).map(exact);
        }
    }
    by_coordinate_ascent(beliefs, model, couplings, sweeps)
}

/// The exact marginals after one observation that couples factors: q(s_f) ∝ p(s_f) Σ Π p(s_g) P(e | s).
fn by_messages<const S: usize, const G: usize>(
    beliefs: &mut Beliefs<S, G>,
    model: &Model,
    (number, modality, evidence): Coupling,
) -> Result<f32, Impossible> {
    let before = *beliefs;
    let conditions = model.parts(before.as_flat(), modality.factors());
    let mut surprise = 0.0;
    for (condition, &factor) in modality.factors().iter().enumerate() {
        let at = (factor, condition);
        let evidence = multiply_by_message(beliefs, model, (modality, evidence), at, conditions.as_slice());
        surprise = -math::ln(evidence.ok_or(Impossible { modality: number })?);
    }
    Ok(surprise)
}

/// The factors of a component and the shape of their product.
struct Product {
    factors: Vec<usize, MAX_CONDITIONS>,
    shape: Shape,
}

impl Product {
    /// The product of all factors that are coupled here; `None` when it has more combinations than the limit.
    fn of(model: &Model, couplings: &Couplings) -> Option<Self> {
        let all = couplings.factors();
        let mut factors = Vec::new();
        let mut states = Vec::<usize, MAX_CONDITIONS>::new();
        for (number, factor) in
            model.factors().iter().enumerate().filter(|(number, _)| all >> number & 1 == 1)
        {
            factors.push(number).ok()?;
            states.push(factor.states()).ok()?;
        }
        let shape = Shape::new(1, &states)?;
        shape.columns().filter(|&columns| columns <= EXACT_LIMIT)?;
        Some(Self { factors, shape })
    }

    /// The exact marginals by a visit of every combination of states.
    fn update<const S: usize, const G: usize>(
        &self,
        beliefs: &mut Beliefs<S, G>,
        model: &Model,
        couplings: &Couplings,
    ) -> Result<f32, Impossible> {
        let mut posterior = Beliefs::<S, G>::EMPTY;
        let mut now = [0; MAX_FACTORS];
        let mut furthest = None;
        self.shape.for_each_column(|_, states| {
            let mut mass = 1.0;
            for (&factor, &state) in self.factors.iter().zip(states) {
                if let Some(now) = now.get_mut(factor) {
                    *now = state;
                }
                mass *= beliefs.of(model, factor).get(state).copied().unwrap_or(0.0);
            }
            for (number, modality, evidence) in couplings.iter() {
                if mass == 0.0 {
                    return;
                }
                furthest = furthest.max(Some(number));
                mass *= modality.probability(evidence, &now);
            }
            for (&factor, &state) in self.factors.iter().zip(states) {
                if let Some(sum) = model.part_mut(posterior.as_flat_mut(), factor).get_mut(state) {
                    *sum += mass;
                }
            }
        });
        let mut surprise = 0.0;
        for &factor in &self.factors {
            let part = model.part_mut(posterior.as_flat_mut(), factor);
            let impossible = Impossible { modality: furthest.unwrap_or(0) };
            surprise = -math::ln(math::normalise(part).ok_or(impossible)?);
        }
        for &factor in &self.factors {
            math::assign(model.part_mut(beliefs.as_flat_mut(), factor), posterior.of(model, factor));
        }
        Ok(surprise)
    }
}

/// Sequential coordinate ascent from the beliefs that each factor's own evidence gives: every factor in turn takes the
/// belief that minimises F given the others, q(s_f) ∝ p(s_f) exp Σ_m E ln P(e_m | s_f, s').
fn by_coordinate_ascent<const S: usize, const G: usize>(
    beliefs: &mut Beliefs<S, G>,
    model: &Model,
    couplings: &Couplings,
    most: u8,
) -> Result<Update, Impossible> {
    for (number, modality, evidence) in couplings.iter() {
        if !is_possible(beliefs, model, modality, evidence) {
            return Err(Impossible { modality: number });
        }
    }
    let prior = *beliefs;
    let factors = couplings.factors();
    let mut update = Update { free_energy: f32::INFINITY, exact: false, converged: false, sweeps: 0 };
    while !update.converged && update.sweeps < most {
        let mut change = 0.0_f32;
        for factor in (0..model.factors().len()).filter(|factor| factors >> factor & 1 == 1) {
            change = change.max(ascend(beliefs, model, couplings, &prior, factor));
        }
        update.sweeps += 1;
        update.converged = change <= TOLERANCE;
    }
    update.free_energy = free_energy(beliefs, model, couplings, &prior, factors);
    Ok(update)
}

/// Whether an observation has any probability under the beliefs.
fn is_possible<const S: usize, const G: usize>(
    beliefs: &Beliefs<S, G>,
    model: &Model,
    modality: &Modality,
    evidence: Evidence,
) -> bool {
    let Some(&factor) = modality.factors().first() else { return false };
    let conditions = model.parts(beliefs.as_flat(), modality.factors());
    let mut scratch = Beliefs::<S, G>::EMPTY;
    let belief = beliefs.of(model, factor);
    let Some(message) = scratch.as_flat_mut().get_mut(..belief.len()) else { return false };
    modality.likelihood().message(modality.shape(), evidence, conditions.as_slice(), 0, message);
    math::expectation(belief, message) > 0.0
}

/// Gives one factor the belief that is best given the others; returns the largest change of a probability.
fn ascend<const S: usize, const G: usize>(
    beliefs: &mut Beliefs<S, G>,
    model: &Model,
    couplings: &Couplings,
    prior: &Beliefs<S, G>,
    factor: usize,
) -> f32 {
    let mut scratch = Beliefs::<S, G>::EMPTY;
    let Some(scores) = scratch.as_flat_mut().get_mut(..beliefs.of(model, factor).len()) else { return 0.0 };
    add_log_messages(beliefs, model, couplings, factor, scores);
    for (score, p) in scores.iter_mut().zip(prior.of(model, factor)) {
        *score += math::ln(*p);
    }
    math::softmax(scores);
    let belief = model.part_mut(beliefs.as_flat_mut(), factor);
    let change =
        belief.iter().zip(scores.iter()).fold(0.0_f32, |most, (old, new)| most.max((old - new).abs()));
    math::assign(belief, scores);
    change
}

fn add_log_messages<const S: usize, const G: usize>(
    beliefs: &Beliefs<S, G>,
    model: &Model,
    couplings: &Couplings,
    factor: usize,
    scores: &mut [f32],
) {
    for (_, modality, evidence) in couplings.iter() {
        if let Some(condition) = modality.factors().iter().position(|&of| of == factor) {
            let conditions = model.parts(beliefs.as_flat(), modality.factors());
            modality.likelihood().log_message(
                modality.shape(),
                evidence,
                conditions.as_slice(),
                condition,
                scores,
            );
        }
    }
}

/// F = Σ_f KL[q_f || p_f] - Σ_m E_q ln max(P(e_m | s), floor), over the factors and observations of a component.
fn free_energy<const S: usize, const G: usize>(
    beliefs: &Beliefs<S, G>,
    model: &Model,
    couplings: &Couplings,
    prior: &Beliefs<S, G>,
    factors: u32,
) -> f32 {
    let mut total = 0.0;
    for factor in (0..model.factors().len()).filter(|factor| factors >> factor & 1 == 1) {
        total += math::kl(beliefs.of(model, factor), prior.of(model, factor));
    }
    for (_, modality, evidence) in couplings.iter() {
        let Some(&factor) = modality.factors().first() else { continue };
        let belief = beliefs.of(model, factor);
        let mut scratch = Beliefs::<S, G>::EMPTY;
        let Some(scores) = scratch.as_flat_mut().get_mut(..belief.len()) else { continue };
        let conditions = model.parts(beliefs.as_flat(), modality.factors());
        modality.likelihood().log_message(modality.shape(), evidence, conditions.as_slice(), 0, scores);
        total -= math::expectation(belief, scores);
    }
    total
}
