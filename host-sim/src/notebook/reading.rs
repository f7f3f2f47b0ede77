//! Reading a model from JSON: the keys, their values, and whether they fit together.

use super::entries::{Entries, list};
use super::fault::{NotebookFault, refuse};
use super::json::JsonValue;
use super::model::{LikelihoodTable, MAX_STATES, Notebook, Observations, TransitionTable};
use super::observations;
use super::policies;
use super::tensor::{Tensor, finite, place};
use iibt_core::actions::Actions;
use iibt_core::inference::{MAX_CONDITIONS, MAX_FACTORS, MAX_MODALITIES};

/// The keys that a model has; others are refused, but for those that are ignored.
const KEYS: [&str; 15] = [
    "name",
    "A",
    "A_red",
    "A_dep",
    "B",
    "B_dep",
    "C",
    "D",
    "E",
    "gamma",
    "policies",
    "policy_len",
    "horizon",
    "obs",
    "steps",
];

/// Keys for human readers, as is every key that begins with `_`.
const IGNORED: [&str; 2] = ["conventions", "model"];

/// The precision of a file without one.
const PRECISION: f64 = 16.0;

/// A model from a JSON value.
pub(super) fn model(file: &str, value: &JsonValue) -> Result<Notebook, NotebookFault> {
    let JsonValue::Object(entries) = value else { refuse!("a model is an object, not {}", value.kind()) };
    for (key, _) in entries {
        if !KEYS.contains(&key.as_str()) && !IGNORED.contains(&key.as_str()) && !key.starts_with('_') {
            refuse!("\"{key}\" is no key of a model; the keys are {}", KEYS.join(", "));
        }
    }
    let entries = Entries::new(entries);
    let transitions = transitions(&entries)?;
    let states: Vec<_> = transitions.iter().map(TransitionTable::states).collect();
    let likelihoods = likelihoods(&entries, &states)?;
    let outcomes: Vec<_> = likelihoods.iter().map(|likelihood| likelihood.table.shape()[0]).collect();
    let policies = policies::read(&entries, &transitions)?;
    let mut model = Notebook {
        file: file.to_owned(),
        name: name(file, entries.get("name"))?,
        preferences: preferences(&entries, &outcomes)?,
        priors: priors(&entries, &states)?,
        habits: policies::habits(&entries, policies.len())?,
        precision: match entries.get("gamma") {
            Some(gamma) => precision(finite(gamma, || "gamma".to_owned())?)?,
            None => PRECISION as f32,
        },
        horizon: policies::horizon(&entries, &policies)?,
        policies,
        likelihoods,
        transitions,
        observations: Observations::None,
    };
    model.observations = observations::read(&entries, &model)?;
    Ok(model)
}

/// γ, checked.
pub(super) fn precision(gamma: f64) -> Result<f32, NotebookFault> {
    if !(0.0..=1e6).contains(&gamma) {
        refuse!("gamma is {gamma}: a precision is from 0 to 1000000");
    }
    Ok(gamma as f32)
}

fn name(file: &str, value: Option<&JsonValue>) -> Result<String, NotebookFault> {
    match value {
        Some(JsonValue::Text(name)) => Ok(name.clone()),
        Some(other) => refuse!("name is {}, not a text", other.shown()),
        None => {
            let stem = std::path::Path::new(file).file_stem();
            Ok(stem.map_or_else(|| "model".to_owned(), |stem| stem.to_string_lossy().into_owned()))
        }
    }
}

fn transitions(entries: &Entries) -> Result<Vec<TransitionTable>, NotebookFault> {
    let tables = entries.required("B", "B[f][s'][s][u], the transitions")?;
    if tables.is_empty() || tables.len() > MAX_FACTORS {
        refuse!("B has {} factors: a model has 1 to {MAX_FACTORS}", tables.len());
    }
    let mut tensors = Vec::new();
    for (factor, table) in tables.iter().enumerate() {
        tensors.push(Tensor::read(table, &place("B", &[factor]))?);
    }
    let states: Vec<_> = tensors.iter().map(|tensor| tensor.shape().first().copied().unwrap_or(0)).collect();
    let total: usize = states.iter().sum();
    if total > MAX_STATES {
        refuse!("B has {total} states over all factors: this program takes {MAX_STATES}");
    }
    let dependencies = match entries.get("B_dep") {
        Some(value) => dependencies(value, "B_dep", (tensors.len(), "B"), states.len())?,
        None => (0..tensors.len()).map(|factor| vec![factor]).collect(),
    };
    let parts = tensors.into_iter().zip(dependencies).enumerate();
    parts.map(|(factor, (tensor, on))| transition(factor, tensor, &on, &states)).collect()
}

fn transition(
    factor: usize,
    mut table: Tensor,
    on: &[usize],
    states: &[usize],
) -> Result<TransitionTable, NotebookFault> {
    let name = place("B", &[factor]);
    if table.shape().len() != on.len() + 2 {
        let (axes, wanted) = (table.shape().len(), on.len() + 2);
        refuse!("{name} has {axes} axes, not {wanted}: next state, state{}, action", and(on.len() - 1));
    }
    let Some(own) = on.iter().position(|&other| other == factor) else {
        refuse!("B_dep[{factor}] does not have factor {factor} itself");
    };
    check_axes(&table, &name, on, states)?;
    let actions = table.shape()[on.len() + 1];
    if actions > usize::from(Actions::CODES) {
        refuse!("{name} has {actions} actions: a factor has at most {}", Actions::CODES);
    }
    table.normalise_columns(&name)?;
    let others = || (0..on.len()).filter(|&axis| axis != own);
    let order: Vec<_> = [on.len() + 1, 0, own + 1].into_iter().chain(others().map(|axis| axis + 1)).collect();
    let mut coupled_to: Vec<_> = others().map(|axis| on[axis]).collect();
    let mut table = table.transposed(&order);
    for at in (0..coupled_to.len()).rev() {
        if table.is_constant_along(at + 3) {
            table = table.without(at + 3);
            coupled_to.remove(at);
        }
    }
    if coupled_to.len() >= MAX_CONDITIONS {
        refuse!("{name} depends on {} factors: a table depends on at most {MAX_CONDITIONS}", on.len());
    }
    Ok(TransitionTable { table, coupled_to })
}

fn and(others: usize) -> String {
    if others == 0 { String::new() } else { format!(", {others} more for B_dep") }
}

/// Whether axis `1 + i` has the states of factor `on[i]`.
fn check_axes(table: &Tensor, name: &str, on: &[usize], states: &[usize]) -> Result<(), NotebookFault> {
    for (axis, &factor) in on.iter().enumerate() {
        let found = table.shape()[axis + 1];
        if found != states[factor] {
            refuse!(
                "{name} has {found} states of factor {factor} (axis {}), but B[{factor}] has {}",
                axis + 1,
                states[factor]
            );
        }
    }
    Ok(())
}

fn likelihoods(entries: &Entries, states: &[usize]) -> Result<Vec<LikelihoodTable>, NotebookFault> {
    let reduced = entries.get("A_red").is_some();
    if reduced && entries.get("A").is_some() {
        refuse!("A and A_red are both there: one of them is the likelihood");
    }
    let tables = if reduced {
        entries.required("A_red", "")?
    } else {
        entries.required("A", "A[m][o][s_0][s_1]..., or A_red with A_dep, the likelihoods")?
    };
    if tables.is_empty() || tables.len() > MAX_MODALITIES {
        refuse!("A has {} modalities: a model has 1 to {MAX_MODALITIES}", tables.len());
    }
    let on = match (reduced, entries.get("A_dep")) {
        (true, Some(value)) => dependencies(value, "A_dep", (tables.len(), "A_red"), states.len())?,
        (true, None) => refuse!("A_dep is missing: A_dep[m], the factors that A_red[m] depends on"),
        (false, _) => vec![(0..states.len()).collect(); tables.len()],
    };
    let mut likelihoods = Vec::new();
    for (number, (value, on)) in tables.iter().zip(on).enumerate() {
        let name = place("A", &[number]);
        let table = Tensor::read(value, &name)?;
        likelihoods.push(likelihood(&name, table, on, states)?);
    }
    Ok(likelihoods)
}

fn likelihood(
    name: &str,
    mut table: Tensor,
    mut factors: Vec<usize>,
    states: &[usize],
) -> Result<LikelihoodTable, NotebookFault> {
    if table.shape().len() != factors.len() + 1 {
        let axes = table.shape().len();
        refuse!("{name} has {axes} axes, not {}: the outcome and a state of each factor", factors.len() + 1);
    }
    check_axes(&table, name, &factors, states)?;
    if table.shape()[0] > usize::from(u16::MAX) {
        refuse!("{name} has {} outcomes: a modality has at most {}", table.shape()[0], u16::MAX);
    }
    table.normalise_columns(name)?;
    for at in (0..factors.len()).rev() {
        if factors.len() > 1 && table.is_constant_along(at + 1) {
            table = table.without(at + 1);
            factors.remove(at);
        }
    }
    if factors.len() > MAX_CONDITIONS {
        refuse!("{name} depends on {} factors: a table depends on at most {MAX_CONDITIONS}", factors.len());
    }
    Ok(LikelihoodTable { table, factors })
}

/// For each of `tables` the factors that it depends on, each once.
fn dependencies(
    value: &JsonValue,
    key: &str,
    (tables, of): (usize, &str),
    factors: usize,
) -> Result<Vec<Vec<usize>>, NotebookFault> {
    let items = list(value, || key.to_owned())?;
    if items.len() != tables {
        refuse!("{key} has {} entries, {of} has {tables}", items.len());
    }
    let mut all = Vec::new();
    for (number, item) in items.iter().enumerate() {
        let mut on = Vec::new();
        for (at, item) in list(item, || place(key, &[number]))?.iter().enumerate() {
            let here = place(key, &[number, at]);
            match item.as_count() {
                Some(factor) if factor < factors && !on.contains(&factor) => on.push(factor),
                Some(factor) if factor < factors => refuse!("{here} is {factor}, which is there twice"),
                _ => refuse!("{here} is {}: B has factors 0 to {}", item.shown(), factors - 1),
            }
        }
        if on.is_empty() {
            refuse!("{} is empty: a table depends on a factor at least", place(key, &[number]));
        }
        all.push(on);
    }
    Ok(all)
}

/// One list of numbers for each of `lengths`, of that length.
fn vectors(
    entries: &Entries,
    (key, what): (&str, &str),
    (of, each): (&str, &str),
    lengths: &[usize],
) -> Result<Vec<Tensor>, NotebookFault> {
    let items = entries.required(key, what)?;
    if items.len() != lengths.len() {
        refuse!("{key} has {} entries, {of} has {}", items.len(), lengths.len());
    }
    let mut vectors = Vec::new();
    for (number, (item, &length)) in items.iter().zip(lengths).enumerate() {
        let name = place(key, &[number]);
        let vector = Tensor::read(item, &name)?;
        if vector.shape().len() != 1 {
            refuse!("{name} is not a list of numbers: {what}");
        }
        if vector.shape()[0] != length {
            refuse!("{name} has {} entries, {of}[{number}] has {length} {each}", vector.shape()[0]);
        }
        vectors.push(vector);
    }
    Ok(vectors)
}

fn preferences(entries: &Entries, outcomes: &[usize]) -> Result<Vec<Vec<f32>>, NotebookFault> {
    let vectors = vectors(entries, ("C", "C[m][o], the preferences"), ("A", "outcomes"), outcomes)?;
    let mut preferences = Vec::new();
    for (number, vector) in vectors.iter().enumerate() {
        let values = vector.to_f32();
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            refuse!("{} is {}, beyond single precision", place("C", &[number, at]), vector.values()[at]);
        }
        preferences.push(values);
    }
    Ok(preferences)
}

fn priors(entries: &Entries, states: &[usize]) -> Result<Vec<Vec<f32>>, NotebookFault> {
    let mut vectors = vectors(entries, ("D", "D[f][s], the priors"), ("B", "states"), states)?;
    for (number, vector) in vectors.iter_mut().enumerate() {
        vector.normalise_columns(&place("D", &[number]))?;
    }
    Ok(vectors.iter().map(Tensor::to_f32).collect())
}
