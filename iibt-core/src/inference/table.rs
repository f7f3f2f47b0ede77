//! Dense tables of conditional probabilities: a row per value, a column per combination of states.

use super::Shape;
use super::likelihood::TableError;
use crate::math;

/// Whether every column is a distribution.
pub(super) const fn check(table: &[f32], shape: &Shape) -> Result<(), TableError> {
    let Some(columns) = shape.columns() else { return Err(TableError::Length(table.len())) };
    match shape.values().checked_mul(columns) {
        Some(length) if length == table.len() => {}
        _ => return Err(TableError::Length(table.len())),
    }
    let mut column = 0;
    while column < columns {
        let mut sum = 0.0;
        let mut at = column;
        while at < table.len() {
            if !(table[at] >= 0.0 && table[at].is_finite()) {
                return Err(TableError::Entry(at));
            }
            sum += table[at];
            at += columns;
        }
        if !math::is_one(sum) {
            return Err(TableError::Column(column, sum));
        }
        column += 1;
    }
    Ok(())
}

/// One entry; zero outside the table.
pub(super) fn entry(table: &[f32], shape: &Shape, value: usize, states: &[usize]) -> f32 {
    if value >= shape.values() {
        return 0.0;
    }
    shape.place(value, states).and_then(|at| table.get(at)).copied().unwrap_or(0.0)
}

/// Σ row(s1, ..., sn) q1(s1) ... qn(sn).
#[inline]
pub(super) fn contract(row: &[f32], beliefs: &[&[f32]]) -> f32 {
    contract_with(row, beliefs, &|p| p)
}

/// Contracts a function of the entries.
pub(super) fn contract_with(row: &[f32], beliefs: &[&[f32]], of: &impl Fn(f32) -> f32) -> f32 {
    match beliefs {
        [] => 0.0,
        [belief] => row.iter().zip(*belief).map(|(&p, q)| of(p) * q).sum(),
        [belief, others @ ..] => {
            let width = (row.len() / belief.len().max(1)).max(1);
            let parts = row.chunks_exact(width).zip(*belief);
            parts.map(|(part, q)| if *q == 0.0 { 0.0 } else { q * contract_with(part, others, of) }).sum()
        }
    }
}
