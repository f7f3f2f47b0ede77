//! The prior counts of a table: where learning begins, and where forgetting ends.

use super::{Dirichlet, LEAST, MOST};
use crate::inference::Shape;
use crate::inference::likelihood::TableError;

/// Prior counts, which stay where they are, in flash for a `static`.
pub(super) enum Origin<'a, T: ?Sized> {
    /// A table, every column of which counts as this many experiences.
    Table(&'a T, f32),
    /// One count for each entry: matrix after matrix, a row per value, a column per combination of
    /// states.
    Counts(&'a [f32]),
}

impl<T: ?Sized> Clone for Origin<'_, T> {
    fn clone(&self) -> Self {
        match *self {
            Self::Table(table, concentration) => Self::Table(table, concentration),
            Self::Counts(counts) => Self::Counts(counts),
        }
    }
}

impl<'a, T: ?Sized> Origin<'a, T> {
    pub(super) const fn table(table: &'a T, concentration: f32) -> Self {
        let concentration = if concentration.is_nan() { 1.0 } else { concentration.clamp(LEAST, MOST) };
        Self::Table(table, concentration)
    }

    /// Checks `matrices` matrices of counts.
    pub(super) fn counts(counts: &'a [f32], shape: &Shape, matrices: usize) -> Result<Self, TableError> {
        let columns = shape.columns().unwrap_or(usize::MAX).max(1);
        let size = columns.saturating_mul(shape.values()).max(1);
        if size.checked_mul(matrices) != Some(counts.len()) {
            return Err(TableError::Length(counts.len()));
        }
        if let Some(at) = counts.iter().position(|count| !(0.0..=MOST).contains(count)) {
            return Err(TableError::Entry(at));
        }
        for (matrix, counts) in counts.chunks_exact(size).enumerate() {
            for column in 0..columns {
                let sum: f32 = counts.iter().skip(column).step_by(columns).sum();
                if sum < LEAST {
                    return Err(TableError::Column(matrix * columns + column, sum));
                }
            }
        }
        Ok(Self::Counts(counts))
    }

    /// The prior counts of column `at` of `C` in a matrix, from the table's own probability of each
    /// value in it.
    pub(super) fn column<const K: usize, const C: usize>(
        &self,
        matrix: usize,
        at: usize,
        probability: impl Fn(&T, usize) -> f32,
    ) -> Dirichlet<K> {
        Dirichlet::new(core::array::from_fn(|value| match self {
            Self::Table(table, concentration) => concentration * probability(table, value),
            Self::Counts(counts) => counts.get((matrix * K + value) * C + at).copied().unwrap_or(0.0),
        }))
    }
}
