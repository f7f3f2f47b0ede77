//! Any likelihood, entry by entry.

use super::{Likelihood, TableError};
use crate::inference::table;
use crate::inference::{Evidence, Shape, Terms};
use crate::math::{self, Prediction};

/// A full table: a row per outcome, in each row a column per combination of states, the last
/// condition's states running fastest.
///
/// The numbers stay where they are, in flash for a `static`.
///
/// ```
/// use iibt_core::inference::{Likelihood, TableError, likelihood};
///
/// // A row for each outcome, a column for each state.
/// static A: likelihood::DenseLikelihood =
///     likelihood::DenseLikelihood::new(&[0.8, 0.3, 0.2, 0.7], 2, &[2]);
/// assert_eq!(A.probability(1, &[0]), 0.2);
/// assert_eq!(A.shape().columns(), Some(2));
///
/// // A column that sums to 0.9.
/// let error = likelihood::DenseLikelihood::try_new(&[0.8, 0.3, 0.1, 0.7], 2, &[2]).unwrap_err();
/// assert!(matches!(error, TableError::Column(0, _)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DenseLikelihood<'a> {
    table: &'a [f32],
    shape: Shape,
}

impl<'a> DenseLikelihood<'a> {
    /// A table, checked: `outcomes` rows over the product of `states`.
    ///
    /// # Panics
    /// When the length does not fit or a column is no distribution. In a `const` or `static` this
    /// fails the build:
    ///
    /// ```compile_fail,E0080
    /// use iibt_core::inference::likelihood::DenseLikelihood;
    /// const A: DenseLikelihood = DenseLikelihood::new(&[0.97, 0.2, 0.0, 0.8], 2, &[2]);
    /// # let _ = A;
    /// ```
    #[must_use]
    pub const fn new(table: &'a [f32], outcomes: usize, states: &[usize]) -> Self {
        match Self::try_new(table, outcomes, states) {
            Ok(dense) => dense,
            Err(TableError::Column(..)) => panic!("a column of A, the likelihood, is no distribution"),
            Err(TableError::Entry(_)) => panic!("an entry of A, the likelihood, is negative or not finite"),
            Err(_) => panic!("A, the likelihood, does not have the entries that its shape asks for"),
        }
    }

    /// Builds it from numbers that are only known at run time.
    ///
    /// # Errors
    /// The first [`TableError`] found; columns are numbered row-major over the conditions.
    pub const fn try_new(table: &'a [f32], outcomes: usize, states: &[usize]) -> Result<Self, TableError> {
        let Some(shape) = Shape::new(outcomes, states) else { return Err(TableError::Empty) };
        match table::check(table, &shape) {
            Ok(()) => Ok(Self { table, shape }),
            Err(error) => Err(error),
        }
    }

    /// Its shape.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// The rows, one per outcome.
    fn rows(&self) -> impl Iterator<Item = &'a [f32]> {
        self.table.chunks_exact(self.shape.columns().unwrap_or(1).max(1))
    }
}

impl Likelihood for DenseLikelihood<'_> {
    fn probability(&self, outcome: usize, states: &[usize]) -> f32 {
        table::entry(self.table, &self.shape, outcome, states)
    }

    fn expect(&self, _shape: &Shape, beliefs: &[&[f32]], preference: &[f32]) -> Terms {
        let mut prediction = Prediction::new();
        let mut ambiguity = 0.0;
        let mut rows = self.rows();
        for preferences in preference.chunks(4) {
            let mut outcomes = [0.0; 4];
            for ((sum, _), row) in outcomes.iter_mut().zip(preferences).zip(&mut rows) {
                *sum = table::contract(row, beliefs);
                ambiguity -= table::contract_with(row, beliefs, &math::p_ln_p);
            }
            prediction.add_some(outcomes.into_iter(), preferences);
        }
        Terms::of(&prediction, ambiguity)
    }

    fn message(&self, shape: &Shape, evidence: Evidence, beliefs: &[&[f32]], to: usize, message: &mut [f32]) {
        match (evidence, shape.conditions()) {
            // One row, read off.
            (Evidence::Outcome(outcome), 1) => {
                for (sum, p) in message.iter_mut().zip(self.rows().nth(outcome).unwrap_or(&[])) {
                    *sum += p;
                }
            }
            _ => super::walk_message(self, shape, evidence, beliefs, to, message),
        }
    }
}
