//! Counts of a single distribution, with the prior that they fall back to.

use super::{Dirichlet, Rates};

/// What C, D and E are learned with.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tally<const K: usize> {
    prior: Dirichlet<K>,
    now: Dirichlet<K>,
    rates: Rates,
}

impl<const K: usize> Tally<K> {
    pub(super) fn new(prior: [f32; K], rates: Rates) -> Self {
        let prior = Dirichlet::new(prior);
        Self { prior, now: prior, rates }
    }

    pub(super) const fn now(&self) -> &Dirichlet<K> {
        &self.now
    }

    /// Forgets a little, and adds `weight` times what was experienced.
    pub(super) fn learn(&mut self, weight: f32, experience: &[f32; K]) {
        self.now.forget(self.rates.forgetting(), &self.prior);
        self.now.add(weight * self.rates.learning(), experience);
    }

    /// Forgets everything.
    pub(super) const fn reset(&mut self) {
        self.now = self.prior;
    }
}
