//! The policies of a notebook: read, or generated.

use super::entries::{Entries, list};
use super::fault::{NotebookFault, refuse};
use super::json::JsonValue;
use super::model::{MAX_POLICIES, TransitionTable};
use super::tensor::{Tensor, place};
use iibt_core::actions::HORIZON;
use iibt_core::math;

/// By policy and step an action for each factor: those of the file, or all sequences of
/// `policy_len` steps.
pub(super) fn read(
    entries: &Entries,
    transitions: &[TransitionTable],
) -> Result<Vec<Vec<Vec<u8>>>, NotebookFault> {
    match (entries.get("policies"), entries.get("policy_len")) {
        (Some(_), Some(_)) => {
            refuse!("policies and policy_len are both there: one of them says what to choose from")
        }
        (Some(value), None) => listed(value, transitions),
        (None, length) => all(steps(length, "policy_len", 1)?, transitions),
    }
}

/// The horizon in steps.
pub(super) fn horizon(entries: &Entries, policies: &[Vec<Vec<u8>>]) -> Result<usize, NotebookFault> {
    steps(entries.get("horizon"), "horizon", policies.first().map_or(1, Vec::len))
}

fn steps(value: Option<&JsonValue>, key: &str, default: usize) -> Result<usize, NotebookFault> {
    match value.map(|value| (value, value.as_count())) {
        None => Ok(default),
        Some((_, Some(steps))) if (1..=HORIZON).contains(&steps) => Ok(steps),
        Some((value, _)) => refuse!("{key} is {}: a policy has 1 to {HORIZON} steps", value.shown()),
    }
}

fn listed(value: &JsonValue, transitions: &[TransitionTable]) -> Result<Vec<Vec<Vec<u8>>>, NotebookFault> {
    let items = list(value, || "policies".to_owned())?;
    if items.is_empty() || items.len() > MAX_POLICIES {
        refuse!("policies has {} entries: this program takes 1 to {MAX_POLICIES}", items.len());
    }
    let mut policies: Vec<Vec<Vec<u8>>> = Vec::new();
    for (number, item) in items.iter().enumerate() {
        let rows = list(item, || place("policies", &[number]))?;
        if rows.is_empty() || rows.len() > HORIZON {
            refuse!("policies[{number}] has {} steps: a policy has 1 to {HORIZON}", rows.len());
        }
        if let Some(first) = policies.first().filter(|first| first.len() != rows.len()) {
            let steps = rows.len();
            refuse!(
                "policies is ragged: policies[{number}] has {steps} steps, policies[0] has {}",
                first.len()
            );
        }
        let numbered = rows.iter().enumerate();
        let steps = numbered.map(|(step, row)| actions(row, (number, step), transitions));
        policies.push(steps.collect::<Result<_, _>>()?);
    }
    Ok(policies)
}

fn actions(
    row: &JsonValue,
    (policy, step): (usize, usize),
    transitions: &[TransitionTable],
) -> Result<Vec<u8>, NotebookFault> {
    let at = || place("policies", &[policy, step]);
    let items = list(row, at)?;
    if items.len() != transitions.len() {
        refuse!("{} has {} actions, B has {} factors", at(), items.len(), transitions.len());
    }
    let numbered = items.iter().zip(transitions).enumerate();
    numbered
        .map(|(factor, (item, transition))| {
            action(item, transition).ok_or_else(|| {
                let (shown, actions) = (item.shown(), transition.actions());
                NotebookFault::new(format!(
                    "policy {policy} step {step} factor {factor} has action {shown}, but B[{factor}] has {actions} \
                     actions, from 0"
                ))
            })
        })
        .collect()
}

/// The number of an action that a factor has.
pub(super) fn action(value: &JsonValue, transition: &TransitionTable) -> Option<u8> {
    value
        .as_count()
        .filter(|&action| action < transition.actions())
        .and_then(|action| u8::try_from(action).ok())
}

/// All sequences of joint actions, the last factor of the last step running fastest.
fn all(steps: usize, transitions: &[TransitionTable]) -> Result<Vec<Vec<Vec<u8>>>, NotebookFault> {
    let actions: Vec<_> = transitions.iter().map(TransitionTable::actions).collect();
    let joint = actions.iter().try_fold(1_usize, |count, &actions| count.checked_mul(actions));
    let count =
        joint.and_then(|joint| joint.checked_pow(steps as u32)).filter(|&count| count <= MAX_POLICIES);
    let Some(count) = count else {
        refuse!(
            "all sequences of {steps} joint actions are more than the {MAX_POLICIES} policies that this program \
                 takes: list some in policies"
        );
    };
    let policy = |mut number: usize| -> Vec<Vec<u8>> {
        let mut policy = vec![vec![0; actions.len()]; steps];
        for row in policy.iter_mut().rev() {
            for (action, &choices) in row.iter_mut().zip(&actions).rev() {
                *action = (number % choices) as u8;
                number /= choices;
            }
        }
        policy
    };
    Ok((0..count).map(policy).collect())
}

/// ln E, from a probability for each policy.
pub(super) fn habits(entries: &Entries, policies: usize) -> Result<Option<Vec<f32>>, NotebookFault> {
    let Some(value) = entries.get("E") else { return Ok(None) };
    let mut habits = Tensor::read(value, "E")?;
    if habits.shape() != [policies] {
        let found = list(value, || "E".to_owned())?.len();
        refuse!("E has {found} entries, there are {policies} policies: E is a probability for each");
    }
    habits.normalise_columns("E")?;
    Ok(Some(habits.to_f32().into_iter().map(math::ln).collect()))
}
