//! One observation: the choice of an update, and its result.

use super::convention;
use super::sweeps::Sweeps;
use iibt_core::inference::{Beliefs, Evidence, MAX_SWEEPS, Model, ObservationError, Update};

/// The most combinations of states for which parallel sweeps are tried.
const MAX_COMBINATIONS: usize = 1 << 20;

/// The result of an update.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Observed {
    /// The method that was used.
    pub(super) method: &'static str,
    /// `None` for an observation that is impossible.
    pub(super) update: Option<Update>,
    /// -ln P(o), where it was worked out exactly.
    pub(super) surprise: Option<f32>,
    pub(super) impossible: Option<ObservationError>,
    /// The reason why the method is not the one asked for.
    pub(super) note: Option<String>,
}

/// Updates `beliefs` by an observation.
pub(super) fn observe<const S: usize, const G: usize>(
    beliefs: &mut Beliefs<S, G>,
    model: &Model,
    evidence: &[Evidence],
    method: convention::BeliefMethod,
    sweeps: Sweeps,
) -> Observed {
    let mut exact = *beliefs;
    let result = exact.update(model, evidence);
    let observed = match method {
        convention::BeliefMethod::Exact => {
            *beliefs = exact;
            Observed::new(result, None)
        }
        convention::BeliefMethod::Ascent => {
            Observed::new(beliefs.update_by_ascent(model, evidence, MAX_SWEEPS), None)
        }
        convention::BeliefMethod::Sweeps => match sweep(beliefs, model, evidence, sweeps) {
            Ok(update) => Observed { impossible: result.err(), ..swept(update, None) },
            Err(Unswept { after: Some(after), update: Some(update), reason }) if result.is_err() => {
                *beliefs = after;
                Observed { impossible: result.err(), ..swept(update, Some(reason)) }
            }
            Err(unswept) => {
                *beliefs = exact;
                Observed::new(result, Some(unswept.reason))
            }
        },
    };
    let surprise = result.ok().filter(|update| update.exact).map(|update| update.free_energy);
    Observed { surprise, ..observed }
}

impl Observed {
    /// The result of an exact update or of coordinate ascent.
    fn new(result: Result<Update, ObservationError>, note: Option<String>) -> Self {
        let exact = result.is_ok_and(|update| update.exact) || result.is_err();
        Self {
            method: if exact { "exact" } else { "coordinate ascent" },
            update: result.ok(),
            surprise: None,
            impossible: result.err(),
            note,
        }
    }
}

fn swept(update: Update, note: Option<String>) -> Observed {
    Observed { method: "parallel sweeps", update: Some(update), surprise: None, impossible: None, note }
}

/// Sweeps whose result is not to be used.
struct Unswept<const S: usize, const G: usize> {
    after: Option<Beliefs<S, G>>,
    update: Option<Update>,
    reason: String,
}

fn sweep<const S: usize, const G: usize>(
    beliefs: &mut Beliefs<S, G>,
    model: &Model,
    evidence: &[Evidence],
    sweeps: Sweeps,
) -> Result<Update, Unswept<S, G>> {
    let combinations = model.factors().iter().map(|factor| factor.states()).fold(1, usize::saturating_mul);
    if combinations > MAX_COMBINATIONS {
        let reason =
            format!("parallel sweeps visit every combination of states, more than {MAX_COMBINATIONS}");
        return Err(Unswept { after: None, update: None, reason });
    }
    let mut after = *beliefs;
    let update = sweeps.update(&mut after, model, evidence);
    if update.converged {
        *beliefs = after;
        return Ok(update);
    }
    let reason = format!("the parallel sweeps did not come to rest in {}", update.sweeps);
    Err(Unswept { after: Some(after), update: Some(update), reason })
}
