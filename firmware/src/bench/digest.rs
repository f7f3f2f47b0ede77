//! One number for every bit of many results, to compare the host with the target.

use super::random_model::{BeliefRoom, RandomModel, Trial};
use super::{t1, t2};
use iibt_core::inference::{
    Beliefs, Candidates, Evaluation, Evidence, MAX_SWEEPS, Model, ObservationError, Problem, Scoring, Update,
};
use iibt_core::team::Fnv1a;

/// The number of random models in a digest.
pub const MODELS: u64 = 200;

/// The FNV-1a hash of the bits of all beliefs, free energies, terms and posteriors of T1, T2 and
/// [`MODELS`] random models.
///
/// Exact updates and coordinate ascent; per-modality gain, and joint gain of T1 and of every fourth
/// random model.
#[must_use]
pub fn digest(seed: u64) -> u64 {
    let mut digest = Digest(Fnv1a::EMPTY);
    digest.add_t1();
    digest.add_t2();
    for model in 0..MODELS {
        digest.add_random(seed.wrapping_add(model));
    }
    digest.0.finish()
}

/// The scoring where the joint gain is not enumerated.
const PER_MODALITY: [Scoring; 2] = [Scoring::DEFAULT, Scoring::JAX_PYMDP];

const ALL: [Scoring; 3] = [Scoring::DEFAULT, Scoring::JAX_PYMDP, Scoring::NUMPY_PYMDP];

struct Digest(Fnv1a);

impl Digest {
    fn add_bits(&mut self, bits: u32) {
        self.0 = self.0.write(&bits.to_le_bytes());
    }

    fn add_numbers(&mut self, numbers: &[f32]) {
        numbers.iter().for_each(|number| self.add_bits(number.to_bits()));
    }

    fn add_update(&mut self, update: &Update) {
        self.add_numbers(&[update.free_energy]);
        self.add_bits(u32::from(update.sweeps));
    }

    #[inline(never)]
    fn add_t1(&mut self) {
        let mut beliefs = Beliefs::<{ t1::S }, 2>::prior(&t1::MODEL);
        self.add_beliefs(&mut beliefs, &t1::MODEL, &t1::OBSERVED);
        let mut evaluation = Evaluation::<{ t1::S }, 2, 4, 4>::new();
        self.add_decision(&mut evaluation, &t1::MODEL, &beliefs, t1::CANDIDATES, &ALL);
    }

    #[inline(never)]
    fn add_t2(&mut self) {
        let mut beliefs = Beliefs::<{ t2::S }, 2>::prior(&t2::MODEL);
        self.add_beliefs(&mut beliefs, &t2::MODEL, &t2::OBSERVED);
        let mut evaluation = Evaluation::<{ t2::S }, 2, 4, 4>::new();
        self.add_decision(&mut evaluation, &t2::MODEL, &beliefs, t2::CANDIDATES, &PER_MODALITY);
    }

    #[inline(never)]
    fn add_random(&mut self, seed: u64) {
        let built = RandomModel::new(seed).build(|model, candidates, observed| {
            let mut beliefs = BeliefRoom::prior(model);
            self.add_beliefs(&mut beliefs, model, observed);
            let scorings = if seed.is_multiple_of(4) { &ALL[..] } else { &PER_MODALITY[..] };
            self.add_decision(&mut Trial::new(), model, &beliefs, candidates, scorings);
        });
        self.add_bits(u32::from(built.is_some()));
    }

    /// Adds the beliefs after an observation, by coordinate ascent and exactly.
    fn add_beliefs<const S: usize, const G: usize>(
        &mut self,
        beliefs: &mut Beliefs<S, G>,
        model: &Model,
        observed: &[Evidence],
    ) {
        let mut ascended = *beliefs;
        let updates =
            [ascended.update_by_ascent(model, observed, MAX_SWEEPS), beliefs.update(model, observed)];
        for update in updates {
            match update {
                Ok(update) => self.add_update(&update),
                Err(ObservationError::Impossible(impossible)) => self.add_bits(impossible.modality as u32),
                Err(ObservationError::OutOfRange(error)) => self.add_bits(error.value as u32),
            }
        }
        self.add_numbers(ascended.as_flat());
        self.add_numbers(beliefs.as_flat());
    }

    fn add_decision<const S: usize, const G: usize, const R: usize, const P: usize>(
        &mut self,
        evaluation: &mut Evaluation<S, G, R, P>,
        model: &Model,
        beliefs: &Beliefs<S, G>,
        candidates: Candidates,
        scorings: &[Scoring],
    ) {
        for scoring in scorings {
            let begun = evaluation.evaluate(&Problem::new(model, beliefs, candidates, *scoring));
            self.add_bits(u32::from(begun.is_ok()));
            for terms in evaluation.terms() {
                self.add_numbers(&[terms.utility, terms.information_gain, terms.ambiguity, terms.novelty]);
            }
            self.add_numbers(evaluation.scores());
            self.add_numbers(evaluation.posterior().as_flattened());
        }
    }
}
