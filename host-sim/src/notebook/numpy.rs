//! The effect of numpy pymdp 0.0.7's floors on the joint information gain.
//!
//! Its gain is H[q(o)] + Σ_s q(s) Σ_o p ln(p + e^-16) with p = Π_m A_m(o_m | s), over the
//! combinations of states with q(s) above e^-16; without both it is the mutual information that the
//! core works out.

use super::fault::{NotebookFault, refuse};
use super::model::Notebook;
use super::tensor::Tensor;

/// e^-16, under logarithms and as the least mass of a combination of states.
const FLOOR: f64 = 1.125_351_747_192_591_2e-7;

/// The most combinations of states, and of outcomes.
const MAX_COMBINATIONS: usize = 1 << 20;

/// The most steps of one evaluation.
const MAX_WORK: usize = 1 << 30;

/// The likelihood of a notebook, arranged for sums over all states and outcomes.
pub(super) struct Floors<'n> {
    states: Vec<usize>,
    /// By factor, the modalities of which it is the last.
    modalities: Vec<Vec<Joined<'n>>>,
    /// The outcomes of the modalities of each factor and those after it.
    widths: Vec<usize>,
    /// By combination of states, Σ_o p ln p with and without the floor.
    floored: Vec<f64>,
    exact: Vec<f64>,
}

/// A likelihood and where its states are.
struct Joined<'n> {
    table: &'n Tensor,
    factors: &'n [usize],
}

impl Joined<'_> {
    /// The number of the column for the states of all factors.
    fn column(&self, states: &[usize]) -> usize {
        let conditions = self.factors.iter().zip(&self.table.shape()[1..]);
        conditions.fold(0, |column, (&factor, &length)| column * length + states[factor])
    }
}

impl<'n> Floors<'n> {
    /// The floors for a notebook's model; refused when there are too many combinations.
    pub(super) fn new(notebook: &'n Notebook) -> Result<Self, NotebookFault> {
        let states: Vec<_> = notebook.transitions.iter().map(|of| of.table.shape()[1]).collect();
        let outcomes =
            notebook.likelihoods.iter().map(|of| of.table.shape()[0]).fold(1, usize::saturating_mul);
        let combinations = states.iter().copied().fold(1, usize::saturating_mul);
        if combinations > MAX_COMBINATIONS || outcomes > MAX_COMBINATIONS {
            refuse!(
                "the joint information gain takes {combinations} combinations of states and {outcomes} of outcomes, \
                 at most {MAX_COMBINATIONS} of each: choose the convention per-modality"
            );
        }
        let mut modalities: Vec<Vec<Joined>> = states.iter().map(|_| Vec::new()).collect();
        for likelihood in &notebook.likelihoods {
            let last = likelihood.factors.iter().copied().max().unwrap_or(0);
            modalities[last].push(Joined { table: &likelihood.table, factors: &likelihood.factors });
        }
        let mut widths = vec![1; states.len() + 1];
        for factor in (0..states.len()).rev() {
            let own = modalities[factor].iter().map(|of| of.table.shape()[0]).product::<usize>();
            widths[factor] = widths[factor + 1] * own;
        }
        let mut floors = Self { states, modalities, widths, floored: Vec::new(), exact: Vec::new() };
        if floors.work() > MAX_WORK {
            refuse!(
                "the joint information gain of this model takes more than {MAX_WORK} steps: choose the convention \
                     per-modality"
            );
        }
        floors.sum_columns();
        Ok(floors)
    }

    /// The steps of one evaluation.
    fn work(&self) -> usize {
        let mut combinations = 1_usize;
        let parts = self.states.iter().zip(&self.widths);
        let steps = parts.map(|(&states, &width)| {
            combinations = combinations.saturating_mul(states);
            combinations.saturating_mul(width)
        });
        steps.fold(0, usize::saturating_add)
    }

    /// Fills in Σ_o p ln p for every combination of states, equal numbers of a column taken
    /// together.
    fn sum_columns(&mut self) {
        let all: Vec<&Joined> = self.modalities.iter().flatten().collect();
        let values = |of: &&Joined| (0..of.table.columns()).map(|column| counted(of.table, column)).collect();
        let counted: Vec<Vec<Vec<(f64, f64)>>> = all.iter().map(values).collect();
        let combinations = self.states.iter().product();
        let mut now = vec![0; self.states.len()];
        let (mut floored, mut exact) = (Vec::new(), Vec::new());
        for _ in 0..combinations {
            let columns: Vec<_> =
                all.iter().zip(&counted).map(|(of, columns)| &columns[of.column(&now)][..]).collect();
            let mut sums = (0.0, 0.0);
            add_products(&columns, (1.0, 1.0), &mut sums);
            floored.push(sums.0);
            exact.push(sums.1);
            for (state, &states) in now.iter_mut().zip(&self.states).rev() {
                *state += 1;
                if *state < states {
                    break;
                }
                *state = 0;
            }
        }
        (self.floored, self.exact) = (floored, exact);
    }

    /// The correction to the exact joint information gain under these beliefs.
    pub(super) fn correction(&self, beliefs: &[&[f32]]) -> f64 {
        self.gain(beliefs, FLOOR, &self.floored) - self.gain(beliefs, 0.0, &self.exact)
    }

    /// H[q(o)] + Σ_s q(s) `sums`(s), over the combinations of states with more than `least`.
    fn gain(&self, beliefs: &[&[f32]], least: f64, sums: &[f64]) -> f64 {
        let mut predicted: Vec<Vec<f64>> = self.widths.iter().map(|&width| vec![0.0; width]).collect();
        let mut walk = Walk { floors: self, beliefs, least, sums, states: Vec::new(), ambiguity: 0.0 };
        walk.predict(1.0, 0, &mut predicted);
        let entropy = predicted[0].iter().filter(|p| **p > 0.0).map(|p| -p * p.ln()).sum::<f64>();
        entropy + walk.ambiguity
    }
}

/// The different numbers of a column above zero, and how often each is there.
fn counted(table: &Tensor, column: usize) -> Vec<(f64, f64)> {
    let mut values: Vec<f64> = table.column(column).filter(|p| *p > 0.0).collect();
    values.sort_by(f64::total_cmp);
    values.chunk_by(|a, b| a == b).map(|equal| (equal[0], equal.len() as f64)).collect()
}

/// Adds Σ p ln(p + floor) and Σ p ln p over the products of one number of each column.
fn add_products(columns: &[&[(f64, f64)]], (p, count): (f64, f64), sums: &mut (f64, f64)) {
    match columns {
        [] => {
            sums.0 += count * p * (p + FLOOR).ln();
            sums.1 += count * p * p.ln();
        }
        [first, others @ ..] => {
            for (value, times) in *first {
                add_products(others, (p * value, count * times), sums);
            }
        }
    }
}

/// A visit of all combinations of states, the last factor's running fastest.
struct Walk<'a> {
    floors: &'a Floors<'a>,
    beliefs: &'a [&'a [f32]],
    least: f64,
    sums: &'a [f64],
    states: Vec<usize>,
    ambiguity: f64,
}

impl Walk<'_> {
    /// Writes to `predicted[0]` the mass of every combination of outcomes of the modalities from
    /// `factor` on, for states that are fixed up to there and have this mass and number.
    fn predict(&mut self, mass: f64, number: usize, predicted: &mut [Vec<f64>]) {
        let (now, later) = predicted.split_first_mut().expect("a list of outcomes for each factor");
        now.fill(0.0);
        let factor = self.states.len();
        let Some(&states) = self.floors.states.get(factor) else {
            if mass > self.least {
                now[0] = mass;
                self.ambiguity += mass * self.sums[number];
            }
            return;
        };
        for state in 0..states {
            let mass = mass * f64::from(self.beliefs[factor][state]);
            if mass > self.least {
                self.states.push(state);
                self.predict(mass, number * states + state, later);
                let columns: Vec<Vec<f64>> = self.columns(factor);
                let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
                add_outer(now, &columns, &later[0], 1.0);
                self.states.pop();
            }
        }
    }

    fn columns(&self, factor: usize) -> Vec<Vec<f64>> {
        let of = |joined: &Joined| joined.table.column(joined.column(&self.states)).collect();
        self.floors.modalities[factor].iter().map(of).collect()
    }
}

/// Adds the outer product of the columns and the rest.
fn add_outer(to: &mut [f64], columns: &[&[f64]], rest: &[f64], scale: f64) {
    match columns {
        [] => to.iter_mut().zip(rest).for_each(|(to, value)| *to += scale * value),
        [first, others @ ..] => {
            let width = to.len() / first.len();
            for (to, &p) in to.chunks_mut(width).zip(*first).filter(|(_, p)| **p > 0.0) {
                add_outer(to, others, rest, scale * p);
            }
        }
    }
}
