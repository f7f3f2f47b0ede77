//! State inference: beliefs about the hidden factors from observations.

mod ascent;
mod couplings;
mod product;

use self::couplings::{Coupling, Couplings};
use super::error::Impossible;
use super::evidence::Evidence;
use super::model::Model;
use crate::math;

/// The most steps, which are combinations of coupled states or of their labels, that exact
/// inference may take.
pub const EXACT_LIMIT: usize = 4096;

/// The most sweeps of coordinate ascent.
pub const MAX_SWEEPS: u8 = 32;

/// The method for factors that an observation couples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// Exactly while it fits the limit, else by coordinate ascent.
    Exact,
    /// By coordinate ascent in this many sweeps at the most.
    CoordinateAscent(u8),
}

/// The result of an update.
///
/// ```
/// use iibt_core::inference::{
///     Beliefs, Evidence, Factor, IdentityNoise, Modality, Model, NextState,
/// };
///
/// # static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 2);
/// # static STAY: NextState = NextState::new(&[0, 1], 2);
/// # static FACTORS: [Factor; 1] = [Factor::new(&STAY, STAY.shape(), &[0.5, 0.5])];
/// # static MODALITIES: [Modality; 1] = [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0; 2])];
/// # static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
/// let mut beliefs = Beliefs::<2, 1>::prior(&MODEL);
/// let update = beliefs.update(&MODEL, &[Evidence::Outcome(0)])?;
/// // Both readings were equally probable: the surprise is ln 2.
/// assert!((update.free_energy - core::f32::consts::LN_2).abs() < 1e-6);
/// assert!(update.exact && update.converged && update.sweeps == 0);
/// # Ok::<(), iibt_core::inference::ObservationError>(())
/// ```
#[doc(alias = "variational free energy")]
#[doc(alias = "surprise")]
#[doc(alias = "evidence lower bound")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Update {
    /// F, the variational free energy of the new beliefs, in nats: the surprise -ln P(o) where
    /// inference was exact, an upper bound of it elsewhere.
    pub free_energy: f32,
    /// Whether all coupled factors were inferred exactly.
    pub exact: bool,
    /// Whether coordinate ascent, where it was used, came to rest. F never rises from sweep to
    /// sweep.
    pub converged: bool,
    /// The sweeps it took.
    pub sweeps: u8,
}

/// The beliefs that are being updated, with working memory of twice their size; exact inference
/// needs no `prior`.
pub(super) struct Work<'b> {
    pub(super) posterior: &'b mut [f32],
    pub(super) prior: &'b mut [f32],
    pub(super) scratch: &'b mut [f32],
}

/// Updates the beliefs; where it fails they are left half done.
pub(super) fn update(
    work: &mut Work,
    model: &Model,
    evidence: &[Evidence],
    method: Method,
) -> Result<Update, Impossible> {
    let mut update = Update { free_energy: 0.0, exact: true, converged: true, sweeps: 0 };
    update.free_energy = own_evidence(work, model, evidence)?;
    let mut left = Couplings::all(model, evidence);
    while let Some(together) = left.take_component() {
        let part = update_together(work, &together, method)?;
        update.free_energy += part.free_energy;
        update.exact &= part.exact;
        update.converged &= part.converged;
        update.sweeps = update.sweeps.max(part.sweeps);
    }
    Ok(update)
}

/// The exact marginals after one observation.
pub(super) fn observe(
    work: &mut Work,
    model: &Model,
    number: usize,
    evidence: Evidence,
) -> Result<f32, Impossible> {
    match model.modalities().get(number) {
        Some(modality) if !evidence.is_missing() => by_messages(work, model, (number, modality, evidence)),
        _ => Ok(0.0),
    }
}

/// Bayes' rule for every modality that depends on one factor; returns its part of the surprise.
fn own_evidence(work: &mut Work, model: &Model, evidence: &[Evidence]) -> Result<f32, Impossible> {
    let mut surprise = 0.0;
    for (number, (modality, &evidence)) in model.modalities().iter().zip(evidence).enumerate() {
        if modality.factors().len() == 1 && !evidence.is_missing() {
            surprise += by_messages(work, model, (number, modality, evidence))?;
        }
    }
    Ok(surprise)
}

fn update_together(work: &mut Work, couplings: &Couplings, method: Method) -> Result<Update, Impossible> {
    let exact = |surprise| Update { free_energy: surprise, exact: true, converged: true, sweeps: 0 };
    if method == Method::Exact {
        if let Some(coupling) = couplings.single() {
            if coupling.1.likelihood().effort(coupling.1.shape()) <= EXACT_LIMIT {
                return by_messages(work, couplings.members.model, coupling).map(exact);
            }
        } else if let Some(product) = couplings.members.product()
            && product.shape.columns().is_some_and(|columns| columns <= EXACT_LIMIT)
        {
            return product::update(work, couplings, &product).map(exact);
        }
    }
    let sweeps = match method {
        Method::Exact => MAX_SWEEPS,
        Method::CoordinateAscent(sweeps) => sweeps.clamp(1, MAX_SWEEPS),
    };
    ascent::update(work, couplings, sweeps)
}

/// The exact marginals after one observation: Bayes' rule, and for one that couples factors q(s_f)
/// ∝ p(s_f) Σ Π p(s_g) P(e | s). Returns the surprise.
fn by_messages(
    work: &mut Work,
    model: &Model,
    (number, modality, evidence): Coupling,
) -> Result<f32, Impossible> {
    let (form, shape) = (modality.likelihood(), modality.shape());
    {
        // All messages first: each is under the beliefs before the observation.
        let beliefs = model.parts(work.posterior, modality.factors());
        for (condition, &factor) in modality.factors().iter().enumerate() {
            let message = model.part_mut(work.scratch, factor);
            message.fill(0.0);
            form.message(shape, evidence, &beliefs, condition, message);
        }
    }
    let mut probability = 1.0;
    for &factor in modality.factors() {
        let (belief, message) =
            (model.part_mut(work.posterior, factor), model.part_mut(work.scratch, factor));
        belief.iter_mut().zip(message.iter()).for_each(|(q, message)| *q *= message);
        probability = math::normalise(belief).ok_or(Impossible { modality: number })?;
    }
    Ok(-math::ln(probability))
}
