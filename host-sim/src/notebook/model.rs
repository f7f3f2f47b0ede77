//! The model of a notebook: full tables, checked, each reduced to the factors it depends on.

use super::tensor::Tensor;

/// The most states of all factors together.
pub(super) const MAX_STATES: usize = 4096;

/// The most policies.
pub(super) const MAX_POLICIES: usize = 4096;

/// The most steps that one file has observations for.
pub(super) const MAX_STEPS: usize = 10_000;

/// A model from a notebook, ready to run.
///
/// ```
/// use host_sim::notebook::{Forms, InferenceRun, Notebook};
///
/// // A lamp that is seen right nine times in ten, and a switch for it.
/// let model = Notebook::read(
///     "lamp.json",
///     br#"{
///         "A": [[[0.9, 0.1], [0.1, 0.9]]],
///         "B": [[[[1, 1], [0, 0]], [[0, 0], [1, 1]]]],
///         "C": [[0, 2]], "D": [[0.5, 0.5]], "policies": [[[0]], [[1]]], "obs": [0]
///     }"#,
/// )?;
/// let report = model.infer(InferenceRun::default(), &mut |_| ())?;
/// assert!((report.result.steps()[0].qs[0][0] - 0.9).abs() < 1e-6);
/// assert!(model.to_rust(Forms::default()).is_ok());
///
/// let wrong = Notebook::read("wrong.json", br#"{"A": [[[0.9, 0.1], [0.2, 0.9]]]}"#).unwrap_err();
/// assert!(wrong.to_string().contains("wrong.json"), "{wrong}");
/// # Ok::<(), host_sim::FileError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Notebook {
    pub(super) file: String,
    pub(super) name: String,
    pub(super) likelihoods: Vec<LikelihoodTable>,
    pub(super) transitions: Vec<TransitionTable>,
    /// C by modality.
    pub(super) preferences: Vec<Vec<f32>>,
    /// D by factor.
    pub(super) priors: Vec<Vec<f32>>,
    /// ln E by policy; `None` where all are equal.
    pub(super) habits: Option<Vec<f32>>,
    pub(super) precision: f32,
    /// By policy and step an action for each factor.
    pub(super) policies: Vec<Vec<Vec<u8>>>,
    pub(super) horizon: usize,
    pub(super) observations: Observations,
}

/// A of one modality.
#[derive(Clone, Debug)]
pub(super) struct LikelihoodTable {
    /// Outcomes first, then the states of each factor.
    pub(super) table: Tensor,
    pub(super) factors: Vec<usize>,
}

/// B of one factor.
#[derive(Clone, Debug)]
pub(super) struct TransitionTable {
    /// Actions, next states, the factor's own states, then those of each factor it is coupled to.
    pub(super) table: Tensor,
    pub(super) coupled_to: Vec<usize>,
}

impl TransitionTable {
    pub(super) fn actions(&self) -> usize {
        self.table.shape()[0]
    }

    pub(super) fn states(&self) -> usize {
        self.table.shape()[1]
    }
}

/// The observations of a file.
#[derive(Clone, Debug)]
pub(super) enum Observations {
    /// The file says nothing of observations.
    None,
    /// `obs`: at one time.
    Once(Vec<Observation>),
    /// `steps`: at several times.
    Steps(Vec<Step>),
}

/// One time step of a record.
#[derive(Clone, Debug)]
pub(super) struct Step {
    /// The action before the observation, by factor, or `None` for a factor without one; without a
    /// list no time has passed.
    pub(super) action: Option<Vec<Option<u8>>>,
    pub(super) observation: Vec<Observation>,
}

/// The observation of one modality.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Observation {
    Missing,
    Outcome(usize),
    /// A weight for each outcome.
    Soft(Vec<f32>),
}

impl Notebook {
    /// The model's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether a factor moves by itself: it has one action.
    pub(super) fn is_uncontrolled(&self, factor: usize) -> bool {
        self.transitions[factor].actions() == 1
    }

    /// The bytes of all numbers in single precision, each likelihood a full table over all factors.
    pub(super) fn dense_bytes(&self) -> usize {
        let states = self.transitions.iter().map(TransitionTable::states).fold(1, usize::saturating_mul);
        let outcomes: usize = self.likelihoods.iter().map(|likelihood| likelihood.table.shape()[0]).sum();
        let transitions: usize =
            self.transitions.iter().map(|transition| transition.table.values().len()).sum();
        let vectors: usize = self.priors.iter().chain(&self.preferences).map(Vec::len).sum();
        outcomes.saturating_mul(states).saturating_add(transitions + vectors).saturating_mul(size_of::<f32>())
    }
}
