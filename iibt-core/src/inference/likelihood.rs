//! A, the likelihood P(o | s), in the forms that sensors have.
//!
//! | form | what it is | numbers it stores |
//! |---|---|---|
//! | [`DenseLikelihood`] | any table | outcomes x states |
//! | [`IdentityNoise`] | the state itself, read with even errors | 4 |
//! | [`OutcomeTable`] | an outcome that labels of the states determine | its labels and columns |
//!
//! An [`OutcomeTable`] stores a byte per state, a byte per combination of labels, and a column per
//! kind of combination.
//!
//! Anything else is a type of the user's with one method, [`Likelihood::probability`].

mod dense;
mod identity_noise;
mod outcome_table;

pub use dense::DenseLikelihood;
pub use identity_noise::IdentityNoise;
pub use outcome_table::{MAX_KINDS, MAX_LABELS, OutcomeTable};

use super::shape::mass;
use super::{Evidence, Shape, Terms};
use crate::math::{self, Prediction};

/// The floor under a probability before its logarithm is taken in a mean-field update: 2^-52, as in
/// JAX pymdp.
pub const FLOOR: f32 = 2.220_446e-16;

/// P(o | s): the probability of each outcome of a modality in each combination of states of the
/// factors it depends on.
///
/// Only [`probability`](Self::probability) must be given. The other methods have defaults that work
/// for any form and cost a visit of the whole table; a form with structure replaces them. `shape`
/// is the modality's shape, and `beliefs` holds a distribution, or weights, for each condition in
/// it.
///
/// ```
/// use iibt_core::inference::{
///     Beliefs, Evidence, Factor, Likelihood, Modality, Model, NextState, Shape,
/// };
///
/// /// A button that reads pressed more surely the harder it is pressed.
/// struct Button;
///
/// impl Likelihood for Button {
///     fn probability(&self, outcome: usize, states: &[usize]) -> f32 {
///         let pressed = match states {
///             [0] => 0.0,
///             [1] => 0.5,
///             _ => 1.0,
///         };
///         if outcome == 1 { pressed } else { 1.0 - pressed }
///     }
/// }
///
/// let motion = NextState::new(&[0, 1, 2], 3);
/// let shape = Shape::new(2, &[3]).expect("two outcomes of three states");
/// let factors = [Factor::new(&motion, motion.shape(), &[0.5, 0.25, 0.25])];
/// let modalities = [Modality::new(&Button, shape, &[0], &[0.0, 0.0])];
/// let model = Model::new(&factors, &modalities);
/// let mut beliefs = Beliefs::<3, 1>::prior(&model);
/// beliefs.update(&model, &[Evidence::Outcome(1)])?;
/// assert!((beliefs.of(&model, 0)?[2] - 2.0 / 3.0).abs() < 1e-6);
/// # Ok::<(), iibt_core::inference::ObservationError>(())
/// ```
#[doc(alias = "observation model")]
#[doc(alias = "A matrix")]
pub trait Likelihood: Sync {
    /// P(o = `outcome` | `states`); zero outside the table.
    fn probability(&self, outcome: usize, states: &[usize]) -> f32;

    /// The expected terms of the outcomes under independent beliefs, where q(o) = Σ_s A(o, s) q(s):
    /// the utility, not yet normalised, Σ_o q(o) C(o), the information gain H[q(o)] - ambiguity,
    /// the ambiguity and the novelty.
    ///
    /// With weights in place of distributions it is linear in each, except for the entropy in the
    /// gain, which is that of the weights: -Σ w ln w.
    fn expect(&self, shape: &Shape, beliefs: &[&[f32]], preference: &[f32]) -> Terms {
        let mut prediction = Prediction::new();
        let mut ambiguity = 0.0;
        for (block, preferences) in preference.chunks(4).enumerate() {
            let mut probabilities = [0.0; 4];
            shape.for_each_column(|_, states| {
                let mass = mass(beliefs, states, None);
                for (lane, (sum, _)) in probabilities.iter_mut().zip(preferences).enumerate() {
                    let p = self.probability(4 * block + lane, states);
                    *sum += mass * p;
                    ambiguity -= mass * math::p_ln_p(p);
                }
            });
            prediction.add_some(probabilities.into_iter(), preferences);
        }
        Terms { novelty: self.novelty(shape, beliefs), ..Terms::of(&prediction, ambiguity) }
    }

    /// Computes the same for every pair of a belief in `firsts` and one in `seconds`, of a
    /// likelihood with two conditions, into `pairs`, row by row: what a form with structure can do
    /// with less than that many calls.
    fn expect_pairs(
        &self,
        shape: &Shape,
        firsts: &[&[f32]],
        seconds: &[&[f32]],
        preference: &[f32],
        pairs: &mut [Terms],
    ) {
        let beliefs = firsts.iter().flat_map(|first| seconds.iter().map(move |second| [*first, *second]));
        for (terms, beliefs) in pairs.iter_mut().zip(beliefs) {
            *terms = self.expect(shape, &beliefs, preference);
        }
    }

    /// Adds to `message`, one number per state of condition `to`, the evidence under the beliefs
    /// about the other conditions: Σ P(e | s, s') Π q(s'). With a single condition that is P(e |
    /// s).
    fn message(&self, shape: &Shape, evidence: Evidence, beliefs: &[&[f32]], to: usize, message: &mut [f32]) {
        walk_message(self, shape, evidence, beliefs, to, message);
    }

    /// Adds to `scores`, one per state of condition `to`, the expected log evidence under the
    /// beliefs about the other conditions, E ln max(P(e | s, s'), [`FLOOR`]): the mean-field
    /// message.
    fn log_message(
        &self,
        shape: &Shape,
        evidence: Evidence,
        beliefs: &[&[f32]],
        to: usize,
        scores: &mut [f32],
    ) {
        shape.for_each_column(|_, states| {
            let p = evidence.probability(shape.values(), |outcome| self.probability(outcome, states));
            add(scores, states.get(to), mass(beliefs, states, Some(to)) * math::ln(p.max(FLOOR)));
        });
    }

    /// The number of steps of one [`message`](Self::message), which decides whether exact inference
    /// is used.
    fn effort(&self, shape: &Shape) -> usize {
        shape.columns().unwrap_or(usize::MAX)
    }

    /// I(o; A | s), how much the outcome will tell about the likelihood itself, in nats; zero for a
    /// table that is not being learned.
    fn novelty(&self, _shape: &Shape, _beliefs: &[&[f32]]) -> f32 {
        0.0
    }
}

/// [`Likelihood::message`] by a visit of every combination of states.
fn walk_message<L: Likelihood + ?Sized>(
    likelihood: &L,
    shape: &Shape,
    evidence: Evidence,
    beliefs: &[&[f32]],
    to: usize,
    message: &mut [f32],
) {
    shape.for_each_column(|_, states| {
        let p = evidence.probability(shape.values(), |outcome| likelihood.probability(outcome, states));
        add(message, states.get(to), mass(beliefs, states, Some(to)) * p);
    });
}

fn add(sums: &mut [f32], at: Option<&usize>, term: f32) {
    if let Some(sum) = at.and_then(|&at| sums.get_mut(at)) {
        *sum += term;
    }
}

/// The reason why a table is refused.
///
/// ```
/// use iibt_core::inference::{TableError, likelihood, NextState};
///
/// let error = likelihood::DenseLikelihood::try_new(&[0.5, -0.5, 0.5, 1.5], 2, &[2]).unwrap_err();
/// assert_eq!(error.to_string(), "entry 1 is negative or not finite");
/// let error = NextState::try_new(&[0, 2], 2, 0.0).unwrap_err();
/// assert_eq!(error, TableError::Range(1));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TableError {
    /// No values, no conditions, too many conditions, or a dimension without entries.
    #[error("a dimension is empty, or there are too many")]
    Empty,
    /// A number of entries, given here, that does not fit the shape.
    #[error("the table has {0} entries, which its shape does not ask for")]
    Length(usize),
    /// An entry is negative or not finite, at this place of the table.
    #[error("entry {0} is negative or not finite")]
    Entry(usize),
    /// The column of this combination of conditions sums to this, and not to one.
    #[error("column {0} sums to {1}, not to one")]
    Column(usize, f32),
    /// A label, kind or next state at this place is out of range.
    #[error("entry {0} is out of range")]
    Range(usize),
}
