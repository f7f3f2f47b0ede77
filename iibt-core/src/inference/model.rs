//! The generative model of one robot: A, B, C and D together.

use super::{Belief, Preference};
use crate::math;

/// P(o, s | π) = D(s_1) Π A(o_τ | s_τ) Π B_π(s_τ | s_τ-1), with the preferences C (the paper's equation 1).
///
/// `A` is a [`Likelihood`](super::Likelihood) over `S` states and `O` outcomes, `B` a
/// [`Transition`](super::Transition) over `S` states. A model never changes after it is built: put it in a
/// `static` and it stays in flash.
///
/// ```
/// use iibt_core::inference::{IdentityNoise, Model, NextState};
///
/// // A corridor of three cells, a sensor that is right nine times in ten, two moves, a goal on the right.
/// static CORRIDOR: Model<IdentityNoise<3>, NextState<3, 2>, 3, 3> = Model::new(
///     IdentityNoise::new(0.9),
///     NextState::new([[0, 0, 1], [1, 2, 2]]),
///     [0.0, 0.0, 1.0],
///     [0.8, 0.1, 0.1],
/// );
///
/// let mut belief = CORRIDOR.initial();
/// let free_energy = belief.update(&CORRIDOR.likelihood, 1)?;
/// assert!(free_energy > 0.0 && belief.most_likely().0 == 1);
/// # Ok::<(), iibt_core::inference::Impossible>(())
/// ```
///
/// A prior that is no distribution fails the build:
///
/// ```compile_fail,E0080
/// use iibt_core::inference::{IdentityNoise, Model, NextState};
///
/// static CORRIDOR: Model<IdentityNoise<3>, NextState<3, 2>, 3, 3> = Model::new(
///     IdentityNoise::new(0.9),
///     NextState::new([[0, 0, 1], [1, 2, 2]]),
///     [0.0, 0.0, 1.0],
///     [0.8, 0.1, 0.2],
/// );
/// # let _ = &CORRIDOR;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model<A, B, const S: usize, const O: usize> {
    /// A = P(o | s).
    pub likelihood: A,
    /// B = P(s' | s, u).
    pub transition: B,
    preference: Preference<O>,
    prior: Belief<S>,
}

impl<A, B, const S: usize, const O: usize> Model<A, B, S, O> {
    /// A model from its parts: C on a log scale, D a distribution.
    ///
    /// # Panics
    /// When a dimension is empty, a preference is not finite, or the prior is no distribution; in a `const`
    /// or `static` this fails the build.
    #[must_use]
    pub const fn new(likelihood: A, transition: B, preference: [f32; O], prior: [f32; S]) -> Self
    where
        A: Copy,
        B: Copy,
    {
        assert!(S > 0, "D, the prior, has no states");
        assert!(math::is_distribution(&prior), "D, the prior, is no distribution");
        let (preference, prior) = (Preference::new(preference), Belief::from_distribution(prior));
        Self { likelihood, transition, preference, prior }
    }

    /// A model from parts that are sound by their types, for numbers that are only known at run time.
    #[must_use]
    pub const fn from_parts(likelihood: A, transition: B, preference: Preference<O>, prior: Belief<S>) -> Self
    where
        A: Copy,
        B: Copy,
    {
        Self { likelihood, transition, preference, prior }
    }

    /// D, the belief before the first observation.
    #[must_use]
    pub const fn prior(&self) -> &[f32; S] {
        self.prior.probabilities()
    }

    /// The belief to begin with: D.
    #[must_use]
    pub const fn initial(&self) -> Belief<S> {
        self.prior
    }

    /// The preference to begin with: C.
    #[must_use]
    pub const fn preference(&self) -> Preference<O> {
        self.preference
    }
}
