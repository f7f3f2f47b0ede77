//! Inference over random models of several factors and modalities against references in double
//! precision that do everything the long way. Every test draws its own models from its own seed.

mod beliefs;
mod benchmarks;
mod decisions;
mod garbage;
mod mismatches;
mod readme;
mod symmetries;

use iibt_core::inference::{Beliefs, Evaluation, Model};
use tests::oracle::chance::Chance;
use tests::oracle::generator::{FACTORS, STATES};
use tests::oracle::{Marginals, normalised, wide};

/// Beliefs with room for every random model.
type Room = Beliefs<STATES, FACTORS>;

/// An evaluation with room for every random decision, five candidates of a group at a time.
type Trial = Evaluation<STATES, FACTORS, 5, 7>;

/// Runs `test` on this many seeds of its own; a failure names the seed.
fn for_seeds(name: u64, count: u64, test: impl Fn(&mut Chance)) {
    struct Named(u64);
    impl Drop for Named {
        fn drop(&mut self) {
            if std::thread::panicking() {
                eprintln!("failed with seed {}", self.0);
            }
        }
    }
    let only = std::env::var("SEED").ok().and_then(|seed| seed.parse().ok());
    for seed in only.map_or(name << 32..(name << 32) + count, |seed: u64| seed..seed + 1) {
        let named = Named(seed);
        test(&mut Chance::new(seed));
        core::mem::forget(named);
    }
}

/// The beliefs about each factor, in double precision and normalised there.
fn marginals<const S: usize, const G: usize>(beliefs: &Beliefs<S, G>, model: &Model) -> Marginals {
    (0..model.factors().len())
        .map(|factor| normalised(&wide(beliefs.of(model, factor).expect("the model has it"))))
        .collect()
}

/// Whether two numbers agree within a tolerance, relative where they are large.
fn close(ours: f32, reference: f64, tolerance: f64) -> bool {
    (f64::from(ours) - reference).abs() <= tolerance * reference.abs().max(1.0)
}

fn assert_marginals(ours: &Marginals, reference: &Marginals, tolerance: f64) {
    for (factor, (ours, reference)) in ours.iter().zip(reference).enumerate() {
        assert_eq!(ours.len(), reference.len());
        for (state, (q, p)) in ours.iter().zip(reference).enumerate() {
            assert!((q - p).abs() <= tolerance, "factor {factor}, state {state}: {q} against {p}");
        }
    }
}

/// Finite, not negative, summing to one.
fn assert_distributions<const S: usize, const G: usize>(beliefs: &Beliefs<S, G>, model: &Model) {
    for factor in 0..model.factors().len() {
        let q = beliefs.of(model, factor).expect("the model has it");
        assert!(q.iter().all(|q| q.is_finite() && *q >= 0.0), "factor {factor}: {q:?}");
        let sum: f32 = q.iter().sum();
        assert!((sum - 1.0).abs() < 1e-5, "factor {factor} sums to {sum}");
    }
}
