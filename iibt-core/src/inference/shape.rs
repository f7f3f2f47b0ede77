//! The shape of a table of conditional probabilities, and the walk over its conditions.

/// The most hidden factors that one table is conditioned on.
pub const MAX_CONDITIONS: usize = 8;

/// The shape of a table: the number of its values, and of the states of each of its conditions.
///
/// For a likelihood the values are outcomes and the conditions are hidden factors; for a transition
/// the values are next states, and the first condition is the factor's own state.
///
/// ```
/// use iibt_core::inference::Shape;
///
/// // Three outcomes, given two factors of four and two states.
/// let shape = Shape::new(3, &[4, 2]).expect("it has no empty dimension");
/// assert_eq!((shape.values(), shape.conditions(), shape.columns()), (3, 2, Some(8)));
/// assert_eq!(shape.column(&[1, 0]), Some(2)); // the last condition runs fastest
/// assert_eq!(shape.column(&[4, 0]), None);
/// assert!(Shape::new(3, &[4, 0]).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Shape {
    values: u16,
    conditions: u8,
    states: [u16; MAX_CONDITIONS],
}

impl Shape {
    /// A shape; `None` when it has no values, no conditions or more than [`MAX_CONDITIONS`], or a
    /// size is zero or above 65,535.
    #[must_use]
    pub const fn new(values: usize, states: &[usize]) -> Option<Self> {
        let most = u16::MAX as usize;
        let conditions = states.len();
        if values == 0 || values > most || conditions == 0 || conditions > MAX_CONDITIONS {
            return None;
        }
        let mut shape =
            Self { values: values as u16, conditions: conditions as u8, states: [1; MAX_CONDITIONS] };
        let mut index = 0;
        while index < conditions {
            if states[index] == 0 || states[index] > most {
                return None;
            }
            shape.states[index] = states[index] as u16;
            index += 1;
        }
        Some(shape)
    }

    /// The number of values.
    #[must_use]
    pub const fn values(&self) -> usize {
        self.values as usize
    }

    /// The number of conditions.
    #[must_use]
    pub const fn conditions(&self) -> usize {
        self.conditions as usize
    }

    /// The states of one condition; one where there is no such condition.
    #[must_use]
    pub const fn states(&self, condition: usize) -> usize {
        let known = condition < self.conditions() && condition < MAX_CONDITIONS;
        if known { self.states[condition] as usize } else { 1 }
    }

    /// The number of columns: the product of the conditions' states, or `None` where that is no
    /// `usize`.
    #[must_use]
    pub const fn columns(&self) -> Option<usize> {
        let mut product: usize = 1;
        let mut index = 0;
        while index < self.conditions() {
            match product.checked_mul(self.states(index)) {
                Some(more) => product = more,
                None => return None,
            }
            index += 1;
        }
        Some(product)
    }

    /// The place of a combination of states among the columns, row-major; `None` outside the table.
    #[must_use]
    pub fn column(&self, states: &[usize]) -> Option<usize> {
        self.place(0, states)
    }

    /// The place of a value and a combination of states in a table with a row per value; `None` for
    /// states outside it.
    #[inline]
    pub(super) fn place(&self, value: usize, states: &[usize]) -> Option<usize> {
        if states.len() != self.conditions() {
            return None;
        }
        states.iter().enumerate().try_fold(value, |at, (condition, &state)| {
            (state < self.states(condition)).then_some(at * self.states(condition) + state)
        })
    }

    /// Calls `visit` with every combination of states, the last condition running fastest, and with
    /// its place.
    #[inline]
    pub fn for_each_column(&self, mut visit: impl FnMut(usize, &[usize])) {
        let mut now = [0; MAX_CONDITIONS];
        let mut column = 0;
        loop {
            let Some(states) = now.get(..self.conditions()) else { return };
            visit(column, states);
            column += 1;
            let mut condition = self.conditions();
            loop {
                let Some(before) = condition.checked_sub(1) else { return };
                condition = before;
                let Some(state) = now.get_mut(condition) else { return };
                *state += 1;
                if *state < self.states(condition) {
                    break;
                }
                *state = 0;
            }
        }
    }
}

/// The probability of a combination of states under independent beliefs, one condition left out.
#[inline]
#[must_use]
pub(super) fn mass(beliefs: &[&[f32]], states: &[usize], except: Option<usize>) -> f32 {
    let mut product = 1.0;
    for (condition, (belief, &state)) in beliefs.iter().zip(states).enumerate() {
        if except != Some(condition) {
            product *= belief.get(state).copied().unwrap_or(0.0);
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn every_combination_is_visited_once_in_row_major_order() {
        let shape = Shape::new(2, &[2, 3]).unwrap();
        let mut seen = Vec::new();
        shape.for_each_column(|column, states| seen.push((column, states.to_vec())));
        let expected: Vec<_> = (0..6).map(|column| (column, [column / 3, column % 3].to_vec())).collect();
        assert!(seen.iter().all(|(column, states)| shape.column(states) == Some(*column)));
        assert_eq!(seen, expected);
        assert_eq!((shape.column(&[2, 0]), shape.column(&[0]), shape.column(&[0, 0, 0])), (None, None, None));
    }

    #[test]
    fn shapes_without_room_are_none() {
        assert_eq!(Shape::new(0, &[2]), None);
        assert_eq!(Shape::new(2, &[]), None);
        assert_eq!(Shape::new(2, &[3, 0]), None);
        assert_eq!(Shape::new(2, &[1; MAX_CONDITIONS + 1]), None);
        assert_eq!(Shape::new(70_000, &[2]), None);
        assert_eq!(Shape::new(2, &[65_535; MAX_CONDITIONS]).unwrap().columns(), None);
    }
}
