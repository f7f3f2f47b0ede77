//! The belief update behind the paper's own numbers, kept to reproduce them.

use super::{Belief, OutcomeTable};
use crate::math;

/// The floor under every likelihood before its logarithm is taken.
const FLOOR: f32 = 1e-16;

/// One simultaneous mean-field sweep from uniform beliefs: q(s1) ∝ exp(Σ_s2 ln P(o | s1, s2) / S), and likewise
/// for s2, with P(o | s1, s2) the product of each robot's own evidence and of the coupled outcome.
///
/// `evidence` holds A(o, ·) of each robot for what was observed. This is an approximation that the field's
/// older tools make and that can lose a robot's own position; use [`update_pair`](super::belief::update_pair)
/// for anything but reproduction. Costs `S * S` logarithms.
#[must_use]
pub fn parallel_sweep<const S: usize, const L: usize, const K: usize>(
    evidence: (&[f32; S], &[f32; S]),
    table: &OutcomeTable<S, L, K>,
    outcome: usize,
) -> (Belief<S>, Belief<S>) {
    let likelihood = |first: usize, second: usize| {
        let of = |values: &[f32; S], state: usize| values.get(state).copied().unwrap_or(0.0);
        let coupled = f32::from(u8::from(table.outcome(first, second) == outcome));
        math::ln(of(evidence.0, first) * of(evidence.1, second) * coupled + FLOOR)
    };
    let mean = |ln: &dyn Fn(usize) -> f32| (0..S).map(ln).sum::<f32>() / S as f32;
    let first = core::array::from_fn(|one| mean(&|other| likelihood(one, other)));
    let second = core::array::from_fn(|other| mean(&|one| likelihood(one, other)));
    (softmax(first), softmax(second))
}

fn softmax<const S: usize>(mut scores: [f32; S]) -> Belief<S> {
    math::softmax(&mut scores);
    Belief::from_distribution(scores)
}
