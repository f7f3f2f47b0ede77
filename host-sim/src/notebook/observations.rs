//! Observations and actions, as a notebook writes them.

use super::entries::{Entries, list};
use super::fault::{NotebookFault, refuse};
use super::json::JsonValue;
use super::model::{MAX_STEPS, Notebook, Observation, Observations, Step};
use super::policies;
use super::tensor::{finite, place};
use iibt_core::inference::Evidence;

/// `obs` or `steps` of a model whose tables are read.
pub(super) fn read(entries: &Entries, model: &Notebook) -> Result<Observations, NotebookFault> {
    match (entries.get("obs"), entries.get("steps")) {
        (Some(_), Some(_)) => refuse!("obs and steps are both there: one of them says what was observed"),
        (Some(value), None) => observation(value, "obs", model).map(Observations::Once),
        (None, Some(value)) => {
            let items = list(value, || "steps".to_owned())?;
            if items.is_empty() || items.len() > MAX_STEPS {
                refuse!("steps has {} entries: this program takes 1 to {MAX_STEPS}", items.len());
            }
            let steps = items.iter().enumerate().map(|(number, item)| step(item, number, model));
            steps.collect::<Result<_, _>>().map(Observations::Steps)
        }
        (None, None) => Ok(Observations::None),
    }
}

fn step(value: &JsonValue, number: usize, model: &Notebook) -> Result<Step, NotebookFault> {
    let name = place("steps", &[number]);
    let JsonValue::Object(entries) = value else { refuse!("{name} is {}, not an object", value.kind()) };
    let mut step = Step { action: None, observation: Vec::new() };
    let mut observed = false;
    for (key, value) in entries {
        let at = format!("{name}.{key}");
        match key.as_str() {
            "obs" => {
                step.observation = observation(value, &at, model)?;
                observed = true;
            }
            "action" => step.action = Some(action(value, &at, model)?),
            _ if key.starts_with('_') => {}
            _ => refuse!("{at} is no key of a step; the keys are obs, action"),
        }
    }
    if !observed {
        refuse!("{name}.obs is missing: what was observed, null where nothing was");
    }
    Ok(step)
}

fn action(value: &JsonValue, name: &str, model: &Notebook) -> Result<Vec<Option<u8>>, NotebookFault> {
    let items = list(value, || name.to_owned())?;
    if items.len() != model.transitions.len() {
        refuse!("{name} has {} entries, B has {} factors", items.len(), model.transitions.len());
    }
    let mut actions = Vec::new();
    for (factor, (item, transition)) in items.iter().zip(&model.transitions).enumerate() {
        let action = policies::action(item, transition);
        if action.is_none() && *item != JsonValue::Null {
            let (at, count) = (place(name, &[factor]), transition.actions());
            refuse!("{at} is {}, but B[{factor}] has {count} actions, from 0", item.shown());
        }
        actions.push(action);
    }
    Ok(actions)
}

/// One entry for each modality.
pub(super) fn observation(
    value: &JsonValue,
    name: &str,
    model: &Notebook,
) -> Result<Vec<Observation>, NotebookFault> {
    let items = list(value, || name.to_owned())?;
    if items.len() != model.likelihoods.len() {
        refuse!("{name} has {} entries, A has {} modalities", items.len(), model.likelihoods.len());
    }
    let numbered = items.iter().zip(&model.likelihoods).enumerate();
    numbered
        .map(|(modality, (item, likelihood))| {
            outcome(item, &place(name, &[modality]), modality, likelihood.table.shape()[0])
        })
        .collect()
}

fn outcome(
    value: &JsonValue,
    name: &str,
    modality: usize,
    outcomes: usize,
) -> Result<Observation, NotebookFault> {
    match (value, value.as_count()) {
        (JsonValue::Null, _) => Ok(Observation::Missing),
        (JsonValue::List(items), _) => soft(items, name, modality, outcomes),
        (_, Some(outcome)) if outcome < outcomes => Ok(Observation::Outcome(outcome)),
        _ => refuse!("{name} is {}, but A[{modality}] has {outcomes} outcomes, from 0", value.shown()),
    }
}

fn soft(
    items: &[JsonValue],
    name: &str,
    modality: usize,
    outcomes: usize,
) -> Result<Observation, NotebookFault> {
    if items.len() != outcomes {
        refuse!("{name} has {} weights, A[{modality}] has {outcomes} outcomes", items.len());
    }
    let mut weights = Vec::new();
    for (at, item) in items.iter().enumerate() {
        let weight = finite(item, || place(name, &[at]))?;
        if weight < 0.0 {
            refuse!("{} is {weight}: a weight is not negative", place(name, &[at]));
        }
        weights.push(weight as f32);
    }
    let sum: f32 = weights.iter().sum();
    if !(sum > 0.0 && sum.is_finite()) {
        refuse!("{name} has no weight, or more than single precision holds");
    }
    Ok(Observation::Soft(weights))
}

impl Observation {
    /// The observation as the core's evidence.
    pub(super) fn evidence(&self) -> Evidence<'_> {
        match self {
            Self::Missing => Evidence::Missing,
            Self::Outcome(outcome) => Evidence::Outcome(*outcome),
            Self::Soft(weights) => Evidence::Soft(weights),
        }
    }
}
