//! The structure of full tables: the smallest of the core's forms for each.

use super::model::TransitionTable;
use super::tensor::{Tensor, alike};
use iibt_core::inference::likelihood::{MAX_KINDS, MAX_LABELS};
use iibt_core::inference::{
    DenseLikelihood, DenseTransition, IdentityNoise, Likelihood, NextState, OutcomeTable, TableError,
    Transition,
};

/// Whether structure is looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Forms {
    /// The smallest form that has the same numbers.
    #[default]
    Structured,
    /// Full tables, as they were given.
    Dense,
}

/// A likelihood in one of the core's forms, with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum LikelihoodForm {
    IdentityNoise { correct: f32, states: usize },
    OutcomeTable { labels: Vec<Vec<u8>>, kinds: Vec<u8>, columns: Vec<f32>, outcomes: usize },
    Dense { table: Vec<f32>, outcomes: usize, states: Vec<usize> },
}

/// A transition in one of the core's forms, with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TransitionForm {
    NextState { table: Vec<u16>, states: usize, slip: f32 },
    Dense { table: Vec<f32>, actions: usize, states: Vec<usize> },
}

/// The smallest form of a likelihood.
pub(super) fn likelihood(table: &Tensor, forms: Forms) -> LikelihoodForm {
    let (outcomes, states) = table.shape().split_at(1);
    let dense =
        LikelihoodForm::Dense { table: table.to_f32(), outcomes: outcomes[0], states: states.to_vec() };
    if forms == Forms::Dense {
        return dense;
    }
    let found = [identity_noise(table), outcome_table(table)].into_iter().flatten();
    found.chain([dense]).min_by_key(LikelihoodForm::bytes).expect("the full table is one of them")
}

/// The smallest form of a transition, whose axes are actions, next states, and the conditions.
pub(super) fn transition(of: &TransitionTable, forms: Forms) -> TransitionForm {
    let structured = if forms == Forms::Dense { None } else { next_state(&of.table) };
    structured.unwrap_or_else(|| TransitionForm::Dense {
        table: of.table.to_f32(),
        actions: of.actions(),
        states: of.table.shape()[2..].to_vec(),
    })
}

impl LikelihoodForm {
    /// The bytes of its numbers.
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::IdentityNoise { .. } => size_of::<IdentityNoise>(),
            Self::OutcomeTable { labels, kinds, columns, .. } => {
                labels.iter().map(Vec::len).sum::<usize>() + kinds.len() + size_of_val(&columns[..])
            }
            Self::Dense { table, .. } => size_of_val(&table[..]),
        }
    }

    /// The core's likelihood; `labels` are those of an outcome table.
    pub(super) fn build<'a>(
        &'a self,
        labels: &'a [&'a [u8]],
    ) -> Result<Box<dyn Likelihood + 'a>, TableError> {
        Ok(match self {
            Self::IdentityNoise { correct, states } => Box::new(IdentityNoise::among(*correct, *states)),
            Self::OutcomeTable { kinds, columns, outcomes, .. } => {
                Box::new(OutcomeTable::try_new(labels, kinds, columns, *outcomes)?)
            }
            Self::Dense { table, outcomes, states } => {
                Box::new(DenseLikelihood::try_new(table, *outcomes, states)?)
            }
        })
    }

    /// Its name.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::IdentityNoise { .. } => "identity with noise",
            Self::OutcomeTable { .. } => "outcome table",
            Self::Dense { .. } => "dense",
        }
    }
}

impl TransitionForm {
    /// The bytes of its numbers.
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::NextState { table, .. } => size_of_val(&table[..]) + size_of::<f32>(),
            Self::Dense { table, .. } => size_of_val(&table[..]),
        }
    }

    /// The core's transition.
    pub(super) fn build(&self) -> Result<Box<dyn Transition + '_>, TableError> {
        Ok(match self {
            Self::NextState { table, states, slip } => Box::new(NextState::try_new(table, *states, *slip)?),
            Self::Dense { table, actions, states } => {
                Box::new(DenseTransition::try_new(table, *actions, states)?)
            }
        })
    }

    /// Its name.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::NextState { slip: 0.0, .. } => "next state",
            Self::NextState { .. } => "next state with slip",
            Self::Dense { .. } => "dense",
        }
    }
}

/// A likelihood whose every column has one probability at its own state and another everywhere
/// else.
fn identity_noise(table: &Tensor) -> Option<LikelihoodForm> {
    let &[outcomes, states] = table.shape() else { return None };
    if outcomes != states || states < 2 {
        return None;
    }
    let correct = table.values()[0] as f32;
    let form = IdentityNoise::among(correct, states);
    let same = |at: usize, p: f64| is_close(form.probability(at / states, &[at % states]), p);
    let found = table.values().iter().enumerate().all(|(at, &p)| same(at, p));
    found.then_some(LikelihoodForm::IdentityNoise { correct, states })
}

/// A likelihood with few different columns, which labels of the states determine.
fn outcome_table(table: &Tensor) -> Option<LikelihoodForm> {
    let (outcomes, states) = table.shape().split_at(1);
    let (kinds, columns) = column_kinds(table)?;
    let mut labels = Vec::new();
    let mut kinds = Kinds { shape: states.to_vec(), of: kinds };
    for condition in 0..states.len() {
        labels.push(kinds.merge(condition)?);
    }
    let columns = columns.concat().iter().map(|&p| p as f32).collect();
    Some(LikelihoodForm::OutcomeTable { labels, kinds: kinds.of, columns, outcomes: outcomes[0] })
}

/// The kind of every column, and one column of each kind; nothing when there are too many.
fn column_kinds(table: &Tensor) -> Option<(Vec<u8>, Vec<Vec<f64>>)> {
    let mut kinds = Vec::new();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for number in 0..table.columns() {
        let same = |known: &Vec<f64>| known.iter().zip(table.column(number)).all(|(&a, b)| alike(a, b));
        let kind = columns.iter().position(same).unwrap_or_else(|| {
            columns.push(table.column(number).collect());
            columns.len() - 1
        });
        if columns.len() > MAX_KINDS {
            return None;
        }
        kinds.push(kind as u8);
    }
    Some((kinds, columns))
}

/// The kind of every combination of states, of which more and more are known by their labels.
struct Kinds {
    shape: Vec<usize>,
    of: Vec<u8>,
}

impl Kinds {
    /// Assigns one label to states of one condition that are never distinguished; returns the label
    /// of each state.
    fn merge(&mut self, condition: usize) -> Option<Vec<u8>> {
        let states = self.shape[condition];
        let inner: usize = self.shape[condition + 1..].iter().product();
        let slice = |state: usize| -> Vec<u8> {
            self.of
                .chunks(inner * states)
                .flat_map(|block| &block[state * inner..][..inner])
                .copied()
                .collect()
        };
        let mut slices: Vec<Vec<u8>> = Vec::new();
        let mut labels = Vec::new();
        for state in 0..states {
            let now = slice(state);
            let label = slices.iter().position(|known| *known == now).unwrap_or_else(|| {
                slices.push(now);
                slices.len() - 1
            });
            if slices.len() > MAX_LABELS {
                return None;
            }
            labels.push(label as u8);
        }
        let blocks = self.of.len() / (inner * states);
        let joined = |block: usize| slices.iter().flat_map(move |slice| &slice[block * inner..][..inner]);
        let of = (0..blocks).flat_map(joined).copied().collect();
        self.shape[condition] = slices.len();
        self.of = of;
        Some(labels)
    }
}

/// A transition whose every column has one next state, or one and its own state with the same slip
/// throughout.
fn next_state(table: &Tensor) -> Option<TransitionForm> {
    let &[actions, states, own] = table.shape() else { return None };
    if states != own {
        return None;
    }
    let p =
        |action: usize, next: usize, state: usize| table.values()[(action * states + next) * states + state];
    let columns = || (0..actions).flat_map(|action| (0..states).map(move |state| (action, state)));
    let mut successors = Vec::new();
    let mut slip = 0.0;
    for (action, state) in columns() {
        let mut others = (0..states).filter(|&next| next != state && p(action, next, state) > 0.0);
        let successor = others.next();
        if others.next().is_some() {
            return None;
        }
        if successor.is_some() && slip == 0.0 {
            slip = p(action, state, state);
        }
        successors.push(successor.unwrap_or(state) as u16);
    }
    let slip = slip as f32;
    let form = NextState::try_new(&successors, states, slip).ok()?;
    let same = |(action, state): (usize, usize)| {
        let probability = |next| form.probability(action as u8, next, &[state]);
        (0..states).all(|next| is_close(probability(next), p(action, next, state)))
    };
    let found = columns().all(same);
    found.then_some(TransitionForm::NextState { table: successors, states, slip })
}

/// Whether a form has the number of the full table, within single precision; zero is only itself.
fn is_close(form: f32, table: f64) -> bool {
    let form = f64::from(form);
    let error = (form - table).abs();
    form == table || (form > 0.0 && table > 0.0 && error <= 5e-5 * table && error <= 1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::notebook::json;

    fn likelihood_of(text: &str) -> LikelihoodForm {
        likelihood(&tensor(text), Forms::Structured)
    }

    fn tensor(text: &str) -> Tensor {
        Tensor::read(&json::read(text.as_bytes()).expect("JSON"), "table").expect("a table")
    }

    #[test]
    fn an_even_sensor_is_two_numbers() {
        let sensor = likelihood_of("[[0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]]");
        assert_eq!(sensor, LikelihoodForm::IdentityNoise { correct: 0.8, states: 3 });
        let uneven = likelihood_of("[[0.8, 0.1, 0.1], [0.1, 0.7, 0.1], [0.1, 0.2, 0.8]]");
        assert_eq!(uneven.name(), "dense");
    }

    #[test]
    fn states_that_nothing_tells_apart_share_a_label() {
        let rows = ["[1, 1, 1, 1]", "[1, 0, 0, 1]", "[1, 1, 1, 1]"];
        let nots = ["[0, 0, 0, 0]", "[0, 1, 1, 0]", "[0, 0, 0, 0]"];
        let found = likelihood_of(&format!("[[{}], [{}]]", rows.join(","), nots.join(",")));
        let labels = vec![vec![0, 1, 0], vec![0, 1, 1, 0]];
        let expected = LikelihoodForm::OutcomeTable {
            labels,
            kinds: vec![0, 0, 0, 1],
            columns: vec![1.0, 0.0, 0.0, 1.0],
            outcomes: 2,
        };
        assert_eq!(found, expected);
    }

    #[test]
    fn a_move_that_slips_evenly_is_a_next_state() {
        let of = |text: &str| next_state(&tensor(text));
        let slips = "[[[0.2, 0, 0], [0.8, 0.2, 0], [0, 0.8, 1]], [[1, 0, 0], [0, 1, 0], [0, 0, 1]]]";
        let table = vec![1, 2, 2, 0, 1, 2];
        assert_eq!(of(slips), Some(TransitionForm::NextState { table, states: 3, slip: 0.2 }));
        assert_eq!(of("[[[0.2, 0], [0.8, 1]], [[1, 0.9], [0, 0.1]]]"), None);
        assert_eq!(of("[[[0, 0.5, 0], [1, 0, 0], [0, 0.5, 1]]]"), None);
        assert_eq!(of("[[[0, 1], [1, 0]]]").map(|form| form.name()), Some("next state"));
    }
}
