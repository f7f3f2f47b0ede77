//! Motion to one next state, certain or with slips.

use super::{Transition, stay};
use crate::actions::{Action, Actions};
use crate::inference::Shape;
use crate::inference::likelihood::TableError;

/// The next state of every state, per action, reached with probability 1 - slip; else the robot
/// stays where it is. The slip is the same for all actions, or one of each action's own.
///
/// Two bytes per action and state, and a prediction costs an addition per state.
///
/// ```
/// use iibt_core::inference::{NextState, Transition};
///
/// // Left and right in a corridor of three cells; the robot slips once in ten.
/// static MOVES: NextState = NextState::with_slip(&[0, 0, 1, 1, 2, 2], 3, 0.1);
/// assert_eq!((MOVES.successor(1, 0), MOVES.actions()), (1, 2));
/// let mut after = [0.0; 3];
/// MOVES.predict(&MOVES.shape(), 1, &[&[1.0, 0.0, 0.0]], &mut after);
/// assert_eq!(after, [0.1, 0.9, 0.0]);
///
/// // A slip of its own for each action.
/// static WORN: NextState = NextState::with_slips(&[0, 0, 1, 1, 2, 2], 3, &[0.0, 0.5]);
/// assert_eq!((WORN.slip(0), WORN.slip(1)), (0.0, 0.5));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NextState<'a> {
    table: &'a [u16],
    states: u16,
    /// The slip of actions without one of their own.
    slip: f32,
    slips: &'a [f32],
}

impl<'a> NextState<'a> {
    /// Motion without slips: a row of `states` next states per action.
    ///
    /// # Panics
    /// When there are no states or actions, the rows are ragged, or a next state is not below
    /// `states`; in a `const` this fails the build.
    #[must_use]
    pub const fn new(table: &'a [u16], states: usize) -> Self {
        Self::with_slip(table, states, 0.0)
    }

    /// Motion that fails with probability `slip`.
    ///
    /// # Panics
    /// As [`new`](Self::new), and when `slip` is no probability.
    #[must_use]
    pub const fn with_slip(table: &'a [u16], states: usize, slip: f32) -> Self {
        match Self::try_new(table, states, slip) {
            Ok(motion) => motion,
            Err(TableError::Range(_)) => panic!("B, the transition: a next state is out of range"),
            Err(TableError::Entry(_)) => panic!("B, the transition: the slip is no probability"),
            Err(_) => panic!("B, the transition, does not have a next state for each state and action"),
        }
    }

    /// Motion in which each action fails with a probability of its own: one for each, in the order
    /// of the rows.
    ///
    /// # Panics
    /// As [`new`](Self::new), and when there is not a probability for each action.
    #[must_use]
    pub const fn with_slips(table: &'a [u16], states: usize, slips: &'a [f32]) -> Self {
        match Self::new(table, states).try_slipping(slips) {
            Ok(motion) => motion,
            Err(TableError::Entry(_)) => panic!("B, the transition: a slip is no probability"),
            Err(_) => panic!("B, the transition, does not have a slip for each action"),
        }
    }

    /// Sets a slip for each action, such as learned ones.
    ///
    /// # Errors
    /// [`TableError::Length`] when there is not one for each action, and [`TableError::Entry`] with
    /// the place of one that is no probability.
    pub const fn try_slipping(self, slips: &'a [f32]) -> Result<Self, TableError> {
        if slips.len() * self.states as usize != self.table.len() {
            return Err(TableError::Length(slips.len()));
        }
        let mut at = 0;
        while at < slips.len() {
            if !(slips[at] >= 0.0 && slips[at] <= 1.0) {
                return Err(TableError::Entry(at));
            }
            at += 1;
        }
        Ok(Self { slips, ..self })
    }

    /// Builds it from numbers that are only known at run time.
    ///
    /// # Errors
    /// [`TableError::Length`] for ragged rows, none, or more than [`Actions::CODES`],
    /// [`TableError::Range`] with the place of a next state that does not exist, and
    /// [`TableError::Entry`] for a slip that is no probability.
    pub const fn try_new(table: &'a [u16], states: usize, slip: f32) -> Result<Self, TableError> {
        if states == 0 || states > u16::MAX as usize {
            return Err(TableError::Empty);
        }
        let actions = table.len() / states;
        if !table.len().is_multiple_of(states) || actions == 0 || actions > Actions::CODES as usize {
            return Err(TableError::Length(table.len()));
        }
        let mut at = 0;
        while at < table.len() {
            if table[at] as usize >= states {
                return Err(TableError::Range(at));
            }
            at += 1;
        }
        if !(slip >= 0.0 && slip <= 1.0) {
            return Err(TableError::Entry(0));
        }
        Ok(Self { table, states: states as u16, slip, slips: &[] })
    }

    /// Its shape: the factor's own state is all that it depends on.
    ///
    /// # Panics
    /// Never: it has states.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        let states = self.states as usize;
        match Shape::new(states, &[states]) {
            Some(shape) => shape,
            None => panic!("B, the transition, has no states"),
        }
    }

    /// The probability that an action fails.
    #[must_use]
    pub fn slip(&self, action: Action) -> f32 {
        self.slips.get(usize::from(action)).copied().unwrap_or(self.slip)
    }

    /// The state after `action` in `state` without a slip; `state` itself where there is no such
    /// state or action.
    #[must_use]
    pub fn successor(&self, action: Action, state: usize) -> usize {
        let row = self.row(action).unwrap_or(&[]);
        row.get(state).map_or(state, |&next| usize::from(next))
    }

    fn row(&self, action: Action) -> Option<&'a [u16]> {
        let states = usize::from(self.states);
        let from = usize::from(action) * states;
        self.table.get(from..from + states)
    }
}

impl Transition for NextState<'_> {
    fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32 {
        let Some(&state) = states.first() else { return 0.0 };
        let Some(&successor) = self.row(action).and_then(|row| row.get(state)) else { return 0.0 };
        let slip = self.slip(action);
        let arrives = if usize::from(successor) == next { 1.0 - slip } else { 0.0 };
        let stays = if state == next { slip } else { 0.0 };
        arrives + stays
    }

    fn predict(&self, _shape: &Shape, action: Action, beliefs: &[&[f32]], to: &mut [f32]) {
        let (Some(row), Some(from)) = (self.row(action), beliefs.first()) else { return stay(beliefs, to) };
        let slip = self.slip(action);
        to.iter_mut().zip(*from).for_each(|(mass, q)| *mass = slip * q);
        let moved = 1.0 - slip;
        for (&next, q) in row.iter().zip(*from) {
            if let Some(mass) = to.get_mut(usize::from(next)) {
                *mass += moved * q;
            }
        }
    }

    fn actions(&self) -> u8 {
        self.table.len().checked_div(usize::from(self.states)).map_or(0, |rows| rows as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of three: on, and back.
    const RING: [u16; 6] = [1, 2, 0, 2, 0, 1];

    #[test]
    fn each_action_slips_as_often_as_it_is_said_to_and_a_robot_that_slips_stays() {
        static B: NextState = NextState::with_slips(&RING, 3, &[0.25, 0.0]);
        let predicted = |action| {
            let mut to = [0.0; 3];
            B.predict(&B.shape(), action, &[&[0.5, 0.5, 0.0]], &mut to);
            to
        };
        assert_eq!(predicted(0), [0.125, 0.5, 0.375]);
        assert_eq!(predicted(1), [0.5, 0.0, 0.5]);
        for action in [0, 1] {
            for state in 0..3 {
                let column = [0, 1, 2].map(|next| B.probability(action, next, &[state]));
                let mut to = [0.0; 3];
                let certain: [f32; 3] = core::array::from_fn(|at| if at == state { 1.0 } else { 0.0 });
                B.predict(&B.shape(), action, &[&certain], &mut to);
                assert_eq!(to, column, "{action}, {state}");
            }
        }
        // An action that it does not have is in no column, and leaves a belief alone.
        assert_eq!((predicted(2), B.probability(2, 0, &[0])), ([0.5, 0.5, 0.0], 0.0));
        assert_eq!((B.slip(0), B.slip(1), NextState::with_slip(&RING, 3, 0.5).slip(1)), (0.25, 0.0, 0.5));
    }

    #[test]
    fn slips_that_do_not_fit_are_refused_by_name() {
        let motion = NextState::new(&RING, 3);
        assert_eq!(motion.try_slipping(&[0.5]), Err(TableError::Length(1)));
        assert_eq!(motion.try_slipping(&[0.5, 1.5]), Err(TableError::Entry(1)));
        assert_eq!(motion.try_slipping(&[f32::NAN, 0.0]), Err(TableError::Entry(0)));
    }
}
