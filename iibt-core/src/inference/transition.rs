//! B, the transition P(s' | s, u), in the forms that motion has.
//!
//! | form | what it is | numbers it stores |
//! |---|---|---|
//! | [`DenseTransition`] | any table, coupled to other factors or not | actions x states x states |
//! | [`NextState`] | a next state per action and state, with or without slips | two bytes each |
//! | [`Blocks`] | a weighted sum of blocks, one per factor: the paper's section 4 | its blocks |

mod blocks;
mod dense;
mod next_state;

pub use blocks::Blocks;
pub use dense::DenseTransition;
pub use next_state::NextState;

use super::shape::{Shape, mass};
use crate::actions::{Action, Actions};
use crate::math;

/// P(s' | s, u): the change of a hidden factor by each action, given its own state and, where
/// motion is coupled, the states of other factors.
///
/// Only [`probability`](Self::probability) must be given. `shape` is the factor's shape: as many
/// values as states, and the factor's own state as the first condition.
///
/// ```
/// use iibt_core::inference::{Shape, Transition};
///
/// /// A counter that an action sets to its own number.
/// struct Counter;
///
/// impl Transition for Counter {
///     fn probability(&self, action: u8, next: usize, _: &[usize]) -> f32 {
///         if usize::from(action) == next { 1.0 } else { 0.0 }
///     }
///
///     fn actions(&self) -> u8 {
///         3
///     }
/// }
///
/// let shape = Shape::new(3, &[3]).expect("three states");
/// let mut after = [0.0; 3];
/// Counter.predict(&shape, 2, &[&[0.5, 0.5, 0.0]], &mut after);
/// assert_eq!(after, [0.0, 0.0, 1.0]);
/// ```
#[doc(alias = "B matrix")]
#[doc(alias = "dynamics")]
pub trait Transition: Sync {
    /// P(s' = `next` | `states`, u = `action`); zero outside the table.
    fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32;

    /// The predicted belief q(s') = Σ_s B_u(s', s) q(s) after `action`, written to `to`.
    ///
    /// An action that the model does not have leaves the belief as it is.
    fn predict(&self, shape: &Shape, action: Action, beliefs: &[&[f32]], to: &mut [f32]) {
        to.fill(0.0);
        shape.for_each_column(|_, states| {
            let mass = mass(beliefs, states, None);
            if mass > 0.0 {
                for (next, sum) in to.iter_mut().enumerate() {
                    *sum += mass * self.probability(action, next, states);
                }
            }
        });
        stay_without_mass(beliefs, to);
    }

    /// The number of actions, whose codes run from zero. A policy with another one is an error. All
    /// codes are known to a form that does not say.
    fn actions(&self) -> u8 {
        Actions::CODES
    }

    /// I(s'; B | s, u), how much the next state will tell about the transition itself, in nats;
    /// zero for a table that is not being learned.
    fn novelty(&self, _shape: &Shape, _action: Action, _beliefs: &[&[f32]]) -> f32 {
        0.0
    }
}

/// Lets a factor stay where an action that the model does not have leaves no mass.
fn stay_without_mass(beliefs: &[&[f32]], to: &mut [f32]) {
    if to.iter().all(|mass| *mass == 0.0) {
        stay(beliefs, to);
    }
}

/// Copies the belief about the factor itself.
pub(super) fn stay(beliefs: &[&[f32]], to: &mut [f32]) {
    math::assign(to, beliefs.first().copied().unwrap_or(&[]));
}
