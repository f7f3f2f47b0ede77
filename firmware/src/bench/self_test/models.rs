//! Beliefs and free energies of T1, T2 and random models.

use super::{Area, Bits, Vector};
use crate::bench::random_model::{BeliefRoom, RandomModel, Trial};
use crate::bench::{SEED, t1, t2};
use iibt_core::inference::{
    Beliefs, Candidates, Evaluation, Evidence, MAX_SWEEPS, Model, ObservationError, Problem, Scoring, Update,
};

/// The random models after T1 and T2.
const MODELS: u32 = 200;

/// The scoring where the joint gain is not enumerated.
const PER_MODALITY: &[Scoring] = &[Scoring::DEFAULT, Scoring::JAX_PYMDP];

const ALL: &[Scoring] = &[Scoring::DEFAULT, Scoring::JAX_PYMDP, Scoring::NUMPY_PYMDP];

pub(super) fn run(tell: &mut dyn FnMut(Vector)) {
    benchmark_1(tell);
    benchmark_2(tell);
    (0..MODELS).for_each(|model| random(model, tell));
}

#[inline(never)]
fn benchmark_1(tell: &mut dyn FnMut(Vector)) {
    let mut beliefs = Beliefs::<{ t1::S }, 2>::prior(&t1::MODEL);
    let mut hash = Hash::of(0, tell);
    hash.beliefs(&mut beliefs, &t1::MODEL, &t1::OBSERVED);
    let mut evaluation = Evaluation::<{ t1::S }, 2, 4, 4>::new();
    hash.decision(&mut evaluation, &t1::MODEL, &beliefs, t1::CANDIDATES, ALL);
}

#[inline(never)]
fn benchmark_2(tell: &mut dyn FnMut(Vector)) {
    let mut beliefs = Beliefs::<{ t2::S }, 2>::prior(&t2::MODEL);
    let mut hash = Hash::of(1, tell);
    hash.beliefs(&mut beliefs, &t2::MODEL, &t2::OBSERVED);
    let mut evaluation = Evaluation::<{ t2::S }, 2, 4, 4>::new();
    hash.decision(&mut evaluation, &t2::MODEL, &beliefs, t2::CANDIDATES, PER_MODALITY);
}

/// The joint gain of every fourth one is enumerated as well.
#[inline(never)]
fn random(model: u32, tell: &mut dyn FnMut(Vector)) {
    RandomModel::new(SEED + u64::from(model)).build(|built, candidates, observed| {
        let mut beliefs = BeliefRoom::prior(built);
        let mut hash = Hash::of(2 + model, tell);
        hash.beliefs(&mut beliefs, built, observed);
        let scorings = if model.is_multiple_of(4) { ALL } else { PER_MODALITY };
        hash.decision(&mut Trial::new(), built, &beliefs, candidates, scorings);
    });
}

/// The hashes of a model's beliefs and free energies.
struct Hash<'t> {
    number: u32,
    free_energies: Bits,
    tell: &'t mut dyn FnMut(Vector),
}

impl<'t> Hash<'t> {
    fn of(number: u32, tell: &'t mut dyn FnMut(Vector)) -> Self {
        Self { number, free_energies: Bits::NONE, tell }
    }

    /// Tells the beliefs after an observation, by coordinate ascent and exactly.
    fn beliefs<const S: usize, const G: usize>(
        &mut self,
        beliefs: &mut Beliefs<S, G>,
        model: &Model,
        observed: &[Evidence],
    ) {
        let mut ascended = *beliefs;
        self.update(ascended.update_by_ascent(model, observed, MAX_SWEEPS));
        self.update(beliefs.update(model, observed));
        let mut bits = Bits::NONE;
        bits.add_numbers(ascended.as_flat());
        bits.add_numbers(beliefs.as_flat());
        (self.tell)(bits.of(Area::Beliefs, self.number));
    }

    fn update(&mut self, update: Result<Update, ObservationError>) {
        match update {
            Ok(update) => {
                self.free_energies.add_numbers(&[update.free_energy]);
                self.free_energies.add(u32::from(update.sweeps));
            }
            Err(ObservationError::Impossible(impossible)) => {
                self.free_energies.add(impossible.modality as u32)
            }
            Err(ObservationError::OutOfRange(error)) => self.free_energies.add(error.value as u32),
        }
    }

    fn decision<const S: usize, const G: usize, const R: usize, const P: usize>(
        mut self,
        evaluation: &mut Evaluation<S, G, R, P>,
        model: &Model,
        beliefs: &Beliefs<S, G>,
        candidates: Candidates,
        scorings: &[Scoring],
    ) {
        let bits = &mut self.free_energies;
        for scoring in scorings {
            let begun = evaluation.evaluate(&Problem::new(model, beliefs, candidates, *scoring));
            bits.add(u32::from(begun.is_ok()));
            for terms in evaluation.terms() {
                bits.add_numbers(&[terms.utility, terms.information_gain, terms.ambiguity, terms.novelty]);
            }
            bits.add_numbers(evaluation.scores());
            bits.add_numbers(evaluation.posterior().as_flattened());
        }
        (self.tell)(bits.of(Area::FreeEnergies, self.number));
    }
}
