//! The columns of a table of conditional probabilities, each a Dirichlet distribution of its own.

use super::{Dirichlet, Rates};
use crate::inference::Shape;
use crate::math;

/// `C` columns over `K` values, one for each combination of states, with what a prediction needs of
/// each worked out when it is learned and not when it is used.
#[derive(Clone)]
pub(super) struct Columns<const K: usize, const C: usize>([Column<K>; C]);

#[derive(Clone, Copy)]
struct Column<const K: usize> {
    counts: Dirichlet<K>,
    /// H of the expected column.
    entropy: f32,
    novelty: f32,
}

impl<const K: usize> Column<K> {
    fn new(counts: Dirichlet<K>) -> Self {
        Self { counts, entropy: math::entropy(&counts.expected()).max(0.0), novelty: counts.novelty() }
    }
}

impl<const K: usize, const C: usize> Columns<K, C> {
    /// The columns of `shape`, each from its place and states.
    pub(super) fn new(shape: &Shape, prior: impl Fn(usize, &[usize]) -> Dirichlet<K>) -> Self {
        let mut new = Self([Column::new(Dirichlet::new([1.0; K])); C]);
        new.for_each(shape, |at, states, column| *column = Column::new(prior(at, states)));
        new
    }

    /// The counts of one column.
    pub(super) fn get(&self, at: usize) -> Option<&Dirichlet<K>> {
        self.0.get(at).map(|column| &column.counts)
    }

    /// The probability of each combination of states under independent beliefs.
    pub(super) fn masses(beliefs: &[&[f32]]) -> [f32; C] {
        let mut masses = [0.0; C];
        multiply(1.0, beliefs, &mut masses);
        masses
    }

    /// Σ_c m_c E θ_c, the expected distribution of values.
    pub(super) fn predict(&self, masses: &[f32; C]) -> [f32; K] {
        let mut predicted = [0.0; K];
        for (column, mass) in self.0.iter().zip(masses).filter(|(_, mass)| **mass != 0.0) {
            let share = mass / column.counts.total();
            for (sum, count) in predicted.iter_mut().zip(column.counts.counts()) {
                *sum += share * count;
            }
        }
        predicted
    }

    /// Σ_c m_c H[E θ_c].
    pub(super) fn ambiguity(&self, masses: &[f32; C]) -> f32 {
        self.0.iter().zip(masses).map(|(column, mass)| mass * column.entropy).sum()
    }

    /// Σ_c m_c I(value; θ_c).
    pub(super) fn novelty(&self, masses: &[f32; C]) -> f32 {
        self.0.iter().zip(masses).map(|(column, mass)| mass * column.novelty).sum()
    }

    /// Applies forgetting to every column, and adds to each its mass times its experience. Where
    /// nothing is forgotten, columns without mass cost nothing.
    pub(super) fn learn(
        &mut self,
        shape: &Shape,
        rates: Rates,
        masses: &[f32; C],
        prior: impl Fn(usize, &[usize]) -> Dirichlet<K>,
        experience: impl Fn(&Dirichlet<K>) -> [f32; K],
    ) {
        self.for_each(shape, |at, states, column| {
            let mut counts = column.counts;
            let mass = masses.get(at).copied().unwrap_or(0.0);
            if rates.forgetting() > 0.0 {
                counts.forget(rates.forgetting(), &prior(at, states));
            }
            if mass > 0.0 {
                counts.add(rates.learning() * mass, &experience(&column.counts));
            }
            if counts != column.counts {
                *column = Column::new(counts);
            }
        });
    }

    fn for_each(&mut self, shape: &Shape, mut visit: impl FnMut(usize, &[usize], &mut Column<K>)) {
        shape.for_each_column(|at, states| {
            if let Some(column) = self.0.get_mut(at) {
                visit(at, states, column);
            }
        });
    }
}

/// Writes `mass` times the product of the beliefs to `to`, the last belief's states running
/// fastest.
fn multiply(mass: f32, beliefs: &[&[f32]], to: &mut [f32]) {
    match beliefs {
        [] => {}
        [belief] => to.iter_mut().zip(*belief).for_each(|(to, q)| *to = mass * q),
        [belief, others @ ..] => {
            let width = (to.len() / belief.len().max(1)).max(1);
            for (part, q) in to.chunks_exact_mut(width).zip(*belief) {
                multiply(mass * q, others, part);
            }
        }
    }
}
