//! The report of running a model, as it is printed.

use super::convention::Convention;
use super::tally::Tally;
use iibt_core::inference::Terms;
use serde::Serialize;

/// The report of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InferenceReport {
    /// The model's name.
    pub name: String,
    /// The conventions it was run with.
    pub convention: &'static str,
    /// γ.
    pub gamma: f32,
    /// The forms of the tables.
    pub structure: StructureReport,
    /// The result.
    #[serde(flatten)]
    pub result: InferenceOutcome,
}

/// The result of one observation, or of a record of several.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum InferenceOutcome {
    /// Of the observation `obs`; its entries stand at the top.
    Once(Box<StepReport>),
    /// Of the record `steps`.
    Record {
        /// One after the other.
        steps: Vec<StepReport>,
    },
}

impl InferenceOutcome {
    /// All steps.
    #[must_use]
    pub fn steps(&self) -> &[StepReport] {
        match self {
            Self::Once(step) => std::slice::from_ref(step),
            Self::Record { steps } => steps,
        }
    }
}

/// The forms of the tables in the core.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(non_snake_case, reason = "the names of the tables in the field")]
pub struct StructureReport {
    /// By modality.
    pub A: Vec<&'static str>,
    /// By factor.
    pub B: Vec<&'static str>,
    /// The bytes of all numbers in these forms.
    pub bytes: usize,
    /// The bytes of all numbers with each likelihood a full table over all factors.
    pub dense_bytes: usize,
}

/// One observation and the decision after it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(non_snake_case, reason = "the symbols of the field")]
pub struct StepReport {
    /// The method of the update.
    pub beliefs: &'static str,
    /// The reason, if not by the convention's method.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// q(s) by factor.
    pub qs: Vec<Vec<f32>>,
    /// The variational free energy; nothing for an impossible observation.
    pub F: Option<f32>,
    /// -ln P(o), where it was worked out exactly.
    pub surprise: Option<f32>,
    /// Whether the update came to rest.
    pub converged: bool,
    /// The sweeps it took; none for an exact one.
    pub sweeps: u8,
    /// The observation has probability zero; exact beliefs were left as they were.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub impossible: Option<String>,
    /// The negative expected free energy by policy: larger is better, as in pymdp.
    pub G: Vec<f32>,
    /// The expected free energy by policy: smaller is better.
    pub expected_free_energy: Vec<f32>,
    /// By policy.
    pub terms: Vec<PolicyReport>,
    /// The posterior over policies.
    pub q_pi: Vec<f32>,
    /// The most probable policy, the first of equals.
    pub policy: usize,
    /// Its actions, step by step, one for each factor.
    pub actions: Vec<Vec<u8>>,
    /// The reasons against the second best policy; `None` for a single policy.
    pub why: Option<Why>,
}

/// The terms of the expected free energy, in nats.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TermsReport {
    /// E ln P(o).
    pub utility: f32,
    /// KL[q(o) || P(o)].
    pub risk: f32,
    /// Σ q(s) H[P(o | s)].
    pub ambiguity: f32,
    /// I(o; s).
    pub information_gain: f32,
    /// I(o; A) and I(s'; B) where they are learned.
    pub novelty: f32,
}

impl From<Terms> for TermsReport {
    fn from(terms: Terms) -> Self {
        Self {
            utility: terms.utility,
            risk: terms.risk(),
            ambiguity: terms.ambiguity,
            information_gain: terms.information_gain,
            novelty: terms.novelty,
        }
    }
}

/// The terms of one policy, and their parts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PolicyReport {
    /// Over all modalities and steps.
    #[serde(flatten)]
    pub total: TermsReport,
    /// The effect of numpy pymdp's floors on the information gain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub numpy_floors: Option<f64>,
    /// Of each modality over all steps, its information gain its own.
    pub by_modality: Vec<TermsReport>,
    /// Of each step over all modalities, the information gain the sum of their own.
    pub by_step: Vec<TermsReport>,
}

impl PolicyReport {
    pub(super) fn new(total: Terms, tally: &Tally, numpy_floors: Option<f64>) -> Self {
        let report = |parts: &[Terms]| parts.iter().copied().map(TermsReport::from).collect();
        Self {
            total: total.into(),
            numpy_floors,
            by_modality: report(&tally.by_modality),
            by_step: report(&tally.by_step),
        }
    }
}

/// The reasons for the chosen policy against the second best.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Why {
    /// The second best policy.
    pub runner_up: usize,
    /// The lead of the chosen policy in log posterior, in nats.
    pub lead: f32,
    /// The modality that contributed most to the choice; `None` when none did.
    pub modality: Option<usize>,
    /// The lead of each modality's part of G, in nats.
    pub by_modality: Vec<f32>,
    /// The rest of the lead in G: joint information gain, floors, novelty.
    pub beyond: f32,
    /// The lead in ln E.
    pub habit: f32,
    /// The reasons in words.
    pub text: String,
}

/// The best policies' numbers, scores and parts, to say why one is best.
pub(super) struct Ranking<'a> {
    pub(super) scores: &'a [f32],
    pub(super) values: &'a [f32],
    pub(super) habits: Option<&'a [f32]>,
    pub(super) tallies: &'a [Tally],
    pub(super) convention: Convention,
}

impl Ranking<'_> {
    /// The reasons why `chosen` is better than the best of the others.
    pub(super) fn why(&self, chosen: usize) -> Option<Why> {
        let others = self.scores.iter().enumerate().filter(|(policy, _)| *policy != chosen);
        let (runner_up, second) =
            others.fold(None, |best: Option<(usize, f32)>, (policy, &score)| match best {
                Some((_, known)) if known >= score => best,
                _ => Some((policy, score)),
            })?;
        let value = |terms: &Terms| -self.convention.expected_free_energy(terms);
        let parts = self.tallies[chosen].by_modality.iter().zip(&self.tallies[runner_up].by_modality);
        let by_modality: Vec<f32> = parts.map(|(best, other)| value(best) - value(other)).collect();
        let habit = self.habits.map_or(0.0, |habits| habits[chosen] - habits[runner_up]);
        let beyond = self.values[chosen] - self.values[runner_up] - by_modality.iter().sum::<f32>();
        let most =
            (0..by_modality.len()).max_by(|&a, &b| by_modality[a].total_cmp(&by_modality[b]).then(b.cmp(&a)));
        let modality = most.filter(|&modality| by_modality[modality] > 0.0);
        let lead = self.scores[chosen] - second;
        let text = match modality {
            _ if lead == 0.0 => format!("policy {chosen} is the first of equals; {runner_up} is as good"),
            Some(modality) => format!(
                "policy {chosen} leads {runner_up} by {lead:.3} nats of log posterior; modality {modality} speaks most \
                 for it, {:.3} nats of G",
                by_modality[modality]
            ),
            None => format!(
                "policy {chosen} leads {runner_up} by {lead:.3} nats of log posterior; no modality speaks for it"
            ),
        };
        Some(Why { runner_up, lead, modality, by_modality, beyond, habit, text })
    }
}
