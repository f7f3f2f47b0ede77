//! Motion as a weighted sum of blocks.

use super::{Transition, stay, stay_without_mass};
use crate::actions::Action;
use crate::inference::Shape;
use crate::inference::likelihood::TableError;
use crate::math;

/// q(s_i') = Σ_j w_j B^ij q(s_j): the row of blocks of one factor in the block matrix of the
/// paper's section 4.
///
/// The first block is the factor's own motion, the others are what the factors coupled to it do to
/// it; the weights are probabilities that sum to one. Memory and time grow with the number of
/// blocks, not with the product of the factors' states. Each block has as many values as the
/// factor, the states of its own condition, and the same actions as the others.
///
/// ```
/// use iibt_core::inference::{Blocks, NextState, Transition};
///
/// // A follower keeps its own cell three times in four, else it is drawn to where the leader is.
/// static STAY: NextState = NextState::new(&[0, 1], 2);
/// static FOLLOWER: Blocks = Blocks::new(&[(0.75, &STAY), (0.25, &STAY)], &[2, 2]);
/// let mut after = [0.0; 2];
/// FOLLOWER.predict(&FOLLOWER.shape(), 0, &[&[1.0, 0.0], &[0.0, 1.0]], &mut after);
/// assert_eq!(after, [0.75, 0.25]);
/// ```
#[derive(Clone, Copy)]
pub struct Blocks<'a> {
    blocks: &'a [(f32, &'a dyn Transition)],
    shape: Shape,
}

impl<'a> Blocks<'a> {
    /// A row of blocks with their weights; `states` are those of the factor itself and of each
    /// factor it is coupled to.
    ///
    /// # Panics
    /// When the weights are no distribution or there are not as many blocks as `states`; in a
    /// `const` this fails the build.
    #[must_use]
    pub const fn new(blocks: &'a [(f32, &'a dyn Transition)], states: &[usize]) -> Self {
        match Self::try_new(blocks, states) {
            Ok(blocks) => blocks,
            Err(_) => {
                panic!("B, the transition: the weights of its blocks are no distribution over its conditions")
            }
        }
    }

    /// Builds it from numbers that are only known at run time.
    ///
    /// # Errors
    /// [`TableError::Length`] with the number of blocks, [`TableError::Entry`] with the place of a
    /// negative weight, and [`TableError::Column`] with the sum of the weights.
    pub const fn try_new(
        blocks: &'a [(f32, &'a dyn Transition)],
        states: &[usize],
    ) -> Result<Self, TableError> {
        if states.is_empty() || blocks.len() != states.len() {
            return Err(TableError::Length(blocks.len()));
        }
        let Some(shape) = Shape::new(states[0], states) else { return Err(TableError::Empty) };
        let (mut sum, mut at) = (0.0, 0);
        while at < blocks.len() {
            if blocks[at].0 < 0.0 || blocks[at].0.is_nan() {
                return Err(TableError::Entry(at));
            }
            sum += blocks[at].0;
            at += 1;
        }
        if !math::is_one(sum) {
            return Err(TableError::Column(0, sum));
        }
        Ok(Self { blocks, shape })
    }

    /// Its shape.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// The shape of one block.
    fn block(&self, condition: usize) -> Option<Shape> {
        Shape::new(self.shape.values(), &[self.shape.states(condition)])
    }
}

impl core::fmt::Debug for Blocks<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Blocks").field("blocks", &self.blocks.len()).field("shape", &self.shape).finish()
    }
}

impl Transition for Blocks<'_> {
    fn probability(&self, action: Action, next: usize, states: &[usize]) -> f32 {
        let parts = self.blocks.iter().zip(states);
        parts.map(|((weight, block), &state)| weight * block.probability(action, next, &[state])).sum()
    }

    fn predict(&self, _shape: &Shape, action: Action, beliefs: &[&[f32]], to: &mut [f32]) {
        if self.blocks.len() != beliefs.len() {
            return stay(beliefs, to);
        }
        to.fill(0.0);
        for (condition, ((weight, block), belief)) in self.blocks.iter().zip(beliefs).enumerate() {
            let Some(shape) = self.block(condition) else { continue };
            shape.for_each_column(|_, states| {
                let mass = states.first().and_then(|&state| belief.get(state)).map_or(0.0, |q| weight * q);
                if mass > 0.0 {
                    for (next, sum) in to.iter_mut().enumerate() {
                        *sum += mass * block.probability(action, next, states);
                    }
                }
            });
        }
        stay_without_mass(beliefs, to);
    }

    fn actions(&self) -> u8 {
        self.blocks.iter().map(|(_, block)| block.actions()).min().unwrap_or(0)
    }
}
