//! Learning: the model's tables as Dirichlet counts of experience, in fixed memory.
//!
//! | counts | of | learned from | used as |
//! |---|---|---|---|
//! | [`LikelihoodCounts`] | A | an observation and the beliefs at that time | a [`Likelihood`] |
//! | [`TransitionCounts`] | B | an action and the beliefs before and after it | a [`Transition`] |
//! | [`SlipCounts`] | B of moves that may fail | if a move was made | slips of a [`NextState`] |
//! | [`PreferenceCounts`] | C | outcomes and how good each was | a list for a [`Modality`] |
//! | [`DistributionCounts`] | D | beliefs about where things began | the prior of a [`Factor`] |
//! | the same | E | what was chosen | [`Habits::Joint`] |
//!
//! [`Likelihood`]: super::Likelihood
//! [`Transition`]: super::Transition
//! [`NextState`]: super::NextState
//! [`Modality`]: super::Modality
//! [`Factor`]: super::Factor
//! [`Habits::Joint`]: super::Habits::Joint
//!
//! Every experience changes the counts `a` with prior counts `a0` by
//!
//! a := a0 + (1 - φ) (a - a0) + η x,
//!
//! where `x` is what was experienced, η the learning rate and φ the forgetting of [`Rates`]. The
//! usual form is a := ω a + η x (Smith, Friston and Whyte 2022, "A step-by-step tutorial on active
//! inference", with ω = 1 - φ), which without experience ends at nothing; here it ends at the
//! prior, so that a column stays a distribution. The expectation of a table is its counts divided
//! by the sum of their column.
//!
//! The feature `learning`, on by default, has the counts of A and B; the others are always there.
//! `examples/learning.rs` has a robot whose drive wears out.
//!
//! Nothing here panics and every number stays finite, whatever is learned: experience that makes no
//! sense changes nothing, and the method that was given it returns `false`.

#[cfg(feature = "learning")]
mod columns;
mod dirichlet;
mod distribution;
#[cfg(feature = "learning")]
mod likelihood;
#[cfg(feature = "learning")]
mod origin;
mod preference;
#[cfg(test)]
mod sampling;
mod slip;
#[cfg(feature = "learning")]
mod transition;

pub use dirichlet::{Dirichlet, LEAST, MOST};
pub use distribution::DistributionCounts;
#[cfg(feature = "learning")]
pub use likelihood::LikelihoodCounts;
pub use preference::PreferenceCounts;
pub use slip::SlipCounts;
#[cfg(feature = "learning")]
pub use transition::TransitionCounts;

use super::Evidence;
#[cfg(feature = "learning")]
use super::Shape;
use crate::math;

/// The rates of learning and forgetting.
///
/// ```
/// use iibt_core::inference::learning::Rates;
///
/// let rates = Rates::new(0.5, 0.01); // about the last hundred experiences count, half each
/// assert_eq!((rates.learning(), rates.forgetting()), (0.5, 0.01));
/// assert_eq!(Rates::new(f32::NAN, 7.0), Rates::new(0.0, 1.0)); // held to their ranges
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rates {
    learning: f32,
    forgetting: f32,
}

impl Rates {
    /// Every experience counts as one, and none is forgotten: Bayes' rule in a world that does not
    /// change.
    pub const DEFAULT: Self = Self { learning: 1.0, forgetting: 0.0 };

    /// `learning`, η, is what one experience adds, held to 0..=[`MOST`]; `forgetting`, φ, is the
    /// share of what was learned that every experience takes away, held to 0..=1. NaN counts as
    /// zero. About the last 1/φ experiences are remembered.
    #[must_use]
    pub const fn new(learning: f32, forgetting: f32) -> Self {
        Self { learning: held(learning, MOST), forgetting: held(forgetting, 1.0) }
    }

    /// η.
    #[must_use]
    pub const fn learning(&self) -> f32 {
        self.learning
    }

    /// φ.
    #[must_use]
    pub const fn forgetting(&self) -> f32 {
        self.forgetting
    }
}

impl Default for Rates {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A number held to 0..=`most`; NaN counts as zero.
const fn held(x: f32, most: f32) -> f32 {
    x.max(0.0).min(most)
}

/// A distribution over the outcomes that an observation supports; `None` for one that is missing or
/// makes no sense.
fn observed<const O: usize>(evidence: Evidence) -> Option<[f32; O]> {
    let mut weights = [0.0; O];
    match evidence {
        Evidence::Missing => return None,
        Evidence::Outcome(outcome) => *weights.get_mut(outcome)? = 1.0,
        Evidence::Soft(soft) if evidence.check(0, O).is_ok() => math::assign(&mut weights, soft),
        Evidence::Soft(_) => return None,
    }
    math::normalise(&mut weights).map(|_| weights)
}

/// Whether `beliefs` are distributions over the conditions of `shape`.
#[cfg(feature = "learning")]
fn fit(shape: &Shape, beliefs: &[&[f32]]) -> bool {
    let sizes = beliefs.iter().enumerate();
    beliefs.len() == shape.conditions()
        && sizes.clone().all(|(condition, belief)| belief.len() == shape.states(condition))
        && beliefs.iter().all(|belief| math::is_distribution(belief))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_held_to_their_ranges() {
        assert_eq!(Rates::new(f32::NAN, f32::NAN), Rates::new(0.0, 0.0));
        assert_eq!(Rates::new(-1.0, 2.0), Rates::new(0.0, 1.0));
        assert_eq!(Rates::new(f32::INFINITY, 0.5).learning(), MOST);
        assert_eq!(Rates::default(), Rates::DEFAULT);
    }

    #[test]
    fn observations_that_make_no_sense_speak_for_nothing() {
        assert_eq!(observed::<2>(Evidence::Missing), None);
        assert_eq!(observed::<2>(Evidence::Outcome(2)), None);
        for wrong in [[f32::NAN, 1.0], [-1.0, 2.0], [0.0, 0.0], [f32::INFINITY, 0.0], [f32::MAX, f32::MAX]] {
            assert_eq!(observed::<2>(Evidence::Soft(&wrong)), None, "{wrong:?}");
        }
        assert_eq!(observed(Evidence::Soft(&[1.0, 3.0])), Some([0.25, 0.75]));
        assert_eq!(observed(Evidence::Outcome(1)), Some([0.0, 1.0]));
    }
}
