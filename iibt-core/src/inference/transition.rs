//! B, the transition P(s' | s, u), in the forms that motion has.

use crate::actions::Action;
use crate::math;

/// How each action moves a belief over `S` states.
pub trait Transition<const S: usize> {
    /// The predicted belief q(s') = Σ_s B_u(s', s) q(s) after `action`, written to `to`.
    ///
    /// An action that the model does not have leaves the belief as it is.
    fn predict(&self, action: Action, from: &[f32; S], to: &mut [f32; S]);

    /// The state most likely to follow `state` under `action`.
    fn successor(&self, action: Action, state: usize) -> usize;
}

/// A full table per action: `U` matrices with a row per next state and a column per state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dense<const S: usize, const U: usize>([[[f32; S]; S]; U]);

impl<const S: usize, const U: usize> Dense<S, U> {
    /// A table, checked: `table[u][s'][s]`.
    ///
    /// # Panics
    /// When there are no states or actions, or a column is no distribution; in a `const` this fails the build.
    #[must_use]
    pub const fn new(table: [[[f32; S]; S]; U]) -> Self {
        assert!(S > 0, "B, the transition, has no states");
        assert!(U > 0, "B, the transition, has no actions");
        let mut column = 0;
        while column < S * U {
            let mut next = [0.0; S];
            let mut state = 0;
            while state < S {
                next[state] = table[column / S][state][column % S];
                state += 1;
            }
            assert!(math::is_distribution(&next), "a column of B, the transition, is no distribution");
            column += 1;
        }
        Self(table)
    }
}

impl<const S: usize, const U: usize> Transition<S> for Dense<S, U> {
    fn predict(&self, action: Action, from: &[f32; S], to: &mut [f32; S]) {
        let Some(matrix) = self.0.get(usize::from(action)) else {
            *to = *from;
            return;
        };
        for (next, row) in to.iter_mut().zip(matrix) {
            *next = math::expectation(from, row);
        }
    }

    fn successor(&self, action: Action, state: usize) -> usize {
        let Some(matrix) = self.0.get(usize::from(action)) else { return state };
        let column: [f32; S] = core::array::from_fn(|next| {
            matrix.get(next).and_then(|row| row.get(state)).copied().unwrap_or(0.0)
        });
        math::argmax(&column)
    }
}

/// Deterministic motion: the next state of every state, per action. Two bytes per state and action, and a
/// prediction costs `S` additions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NextState<const S: usize, const U: usize>([[u16; S]; U]);

impl<const S: usize, const U: usize> NextState<S, U> {
    /// A table, checked: `table[u][s]` is the state after action `u` in state `s`.
    ///
    /// # Panics
    /// When there are no states or actions, or a next state is not below `S`; in a `const` this fails the
    /// build.
    #[must_use]
    pub const fn new(table: [[u16; S]; U]) -> Self {
        assert!(S > 0, "B, the transition, has no states");
        assert!(U > 0, "B, the transition, has no actions");
        let mut entry = 0;
        while entry < S * U {
            assert!(
                (table[entry / S][entry % S] as usize) < S,
                "B, the transition: a next state is out of range"
            );
            entry += 1;
        }
        Self(table)
    }
}

impl<const S: usize, const U: usize> NextState<S, U> {
    /// A table worked out per action and state; where that leads to no state, the action changes nothing.
    #[must_use]
    pub fn from_fn(mut next: impl FnMut(Action, usize) -> usize) -> Self {
        Self(core::array::from_fn(|action| {
            core::array::from_fn(|state| {
                let next = next(action as Action, state);
                (if next < S { next } else { state }) as u16
            })
        }))
    }
}

impl<const S: usize, const U: usize> Transition<S> for NextState<S, U> {
    fn predict(&self, action: Action, from: &[f32; S], to: &mut [f32; S]) {
        let Some(row) = self.0.get(usize::from(action)) else {
            *to = *from;
            return;
        };
        to.fill(0.0);
        for (&next, q) in row.iter().zip(from) {
            if let Some(mass) = to.get_mut(usize::from(next)) {
                *mass += q;
            }
        }
    }

    fn successor(&self, action: Action, state: usize) -> usize {
        self.0
            .get(usize::from(action))
            .and_then(|row| row.get(state))
            .map_or(state, |&next| usize::from(next))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEFT: [[f32; 3]; 3] = [[1.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]];
    const RIGHT: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]];
    const TABLE: Dense<3, 2> = Dense::new([LEFT, RIGHT]);
    const NEXT: NextState<3, 2> = NextState::new([[0, 0, 1], [1, 2, 2]]);

    #[test]
    fn next_states_equal_their_matrix() {
        let from = [0.5, 0.3, 0.2];
        for action in 0..3 {
            let (mut dense, mut table) = ([0.0; 3], [0.0; 3]);
            TABLE.predict(action, &from, &mut dense);
            NEXT.predict(action, &from, &mut table);
            assert_eq!(dense, table, "action {action}");
            for state in 0..3 {
                assert_eq!(TABLE.successor(action, state), NEXT.successor(action, state));
            }
        }
    }

    #[test]
    fn a_table_can_be_worked_out() {
        let worked_out =
            NextState::<3, 2>::from_fn(
                |action, state| if action == 0 { state.wrapping_sub(1) } else { state + 1 },
            );
        assert_eq!(worked_out, NEXT);
    }

    #[test]
    fn an_unknown_action_changes_nothing() {
        let (from, mut to) = ([0.5, 0.3, 0.2], [0.0; 3]);
        NEXT.predict(7, &from, &mut to);
        assert_eq!(to, from);
    }
}
