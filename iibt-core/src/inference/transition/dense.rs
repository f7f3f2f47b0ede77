//! Any transition, entry by entry.

use super::{Transition, stay};
use crate::actions::{Action, Actions};
use crate::inference::likelihood::TableError;
use crate::inference::{Shape, table};

/// A full table: per action a matrix with a row per next state and a column per combination of
/// states, the factor's own state running slowest.
///
/// ```
/// use iibt_core::inference::{Transition, transition};
///
/// // A door: action 0 waits, action 1 pushes it open. A row for each next state, a column for each
/// // state.
/// static DOOR: transition::DenseTransition =
///     transition::DenseTransition::new(&[0.9, 0.2, 0.1, 0.8, 1.0, 0.7, 0.0, 0.3], 2, &[2]);
/// assert_eq!(DOOR.probability(1, 0, &[1]), 0.7);
/// let mut after = [0.0; 2];
/// DOOR.predict(&DOOR.shape(), 1, &[&[0.0, 1.0]], &mut after);
/// assert_eq!(after, [0.7, 0.3]);
/// assert!(transition::DenseTransition::try_new(&[0.9, 0.2, 0.1], 1, &[2]).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DenseTransition<'a> {
    table: &'a [f32],
    shape: Shape,
}

impl<'a> DenseTransition<'a> {
    /// A table, checked: `actions` matrices over `states`, of which the first is the factor's own
    /// number of states and the others are those of the factors that it is coupled to.
    ///
    /// # Panics
    /// When the length does not fit or a column is no distribution; in a `const` this fails the
    /// build.
    #[must_use]
    pub const fn new(table: &'a [f32], actions: usize, states: &[usize]) -> Self {
        match Self::try_new(table, actions, states) {
            Ok(dense) => dense,
            Err(TableError::Column(..)) => panic!("a column of B, the transition, is no distribution"),
            Err(TableError::Entry(_)) => panic!("an entry of B, the transition, is negative or not finite"),
            Err(_) => panic!("B, the transition, does not have the entries that its shape asks for"),
        }
    }

    /// Builds it from numbers that are only known at run time.
    ///
    /// # Errors
    /// The first [`TableError`] found; columns are numbered action by action, row-major over the
    /// conditions.
    pub const fn try_new(table: &'a [f32], actions: usize, states: &[usize]) -> Result<Self, TableError> {
        if states.is_empty() || actions == 0 || actions > Actions::CODES as usize {
            return Err(TableError::Empty);
        }
        let Some(shape) = Shape::new(states[0], states) else { return Err(TableError::Empty) };
        if table.is_empty() || !table.len().is_multiple_of(actions) {
            return Err(TableError::Length(table.len()));
        }
        let Some(columns) = shape.columns() else { return Err(TableError::Length(table.len())) };
        let matrix = table.len() / actions;
        let (mut action, mut rest) = (0, table);
        while action < actions {
            let (first, others) = rest.split_at(matrix);
            match table::check(first, &shape) {
                Ok(()) => rest = others,
                Err(TableError::Column(column, sum)) => {
                    return Err(TableError::Column(action * columns + column, sum));
                }
                Err(TableError::Entry(at)) => return Err(TableError::Entry(action * matrix + at)),
                Err(_) => return Err(TableError::Length(table.len())),
            }
            action += 1;
        }
        Ok(Self { table, shape })
    }

    /// Its shape.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    fn matrix(&self, action: Action) -> Option<&'a [f32]> {
        let size = self.shape.columns()?.checked_mul(self.shape.values())?;
        self.table.chunks_exact(size).nth(usize::from(action))
    }
}

impl Transition for DenseTransition<'_> {
    fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32 {
        self.matrix(action).map_or(0.0, |matrix| table::entry(matrix, &self.shape, next, states))
    }

    fn predict(&self, shape: &Shape, action: Action, beliefs: &[&[f32]], to: &mut [f32]) {
        let Some(matrix) = self.matrix(action) else { return stay(beliefs, to) };
        let rows = matrix.chunks_exact(shape.columns().unwrap_or(1).max(1));
        to.iter_mut().zip(rows).for_each(|(next, row)| *next = table::contract(row, beliefs));
    }

    fn actions(&self) -> u8 {
        let matrix = self.shape.columns().map_or(0, |columns| columns * self.shape.values());
        self.table.len().checked_div(matrix).map_or(0, |actions| actions as u8)
    }
}
