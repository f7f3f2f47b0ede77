//! Nothing that a caller can hand over makes the engine panic, or a belief something else than a distribution.

use super::{Room, Trial, assert_distributions, for_seeds};
use iibt_core::actions::{Action, Actions, HORIZON};
use iibt_core::inference::{
    Beliefs, Blocks, Candidates, Combinations, Control, Encounter, Evaluation, Evidence, Factor, Habits,
    IdentityNoise, MAX_SWEEPS, Modality, Model, NextState, Policy, Problem, Scoring, Sweeps, Transition,
    policy,
};
use tests::oracle::chance::Chance;
use tests::oracle::generator;

const ODD: [f32; 9] = [0.0, 1.0, -1.0, -0.0, 1e-45, 1e8, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

fn odd_numbers(chance: &mut Chance, most: usize) -> Vec<f32> {
    (0..chance.within(0, most)).map(|_| chance.pick(&ODD)).collect()
}

#[test]
fn odd_observations_leave_distributions() {
    for_seeds(21, 6000, |chance| {
        let description = generator::description(chance);
        description.build(|model| {
            let mut beliefs = Room::prior(model);
            for _ in 0..4 {
                let count = chance.within(0, 6);
                let weights: Vec<Vec<f32>> = (0..count).map(|_| odd_numbers(chance, 8)).collect();
                let evidence: Vec<Evidence> = weights
                    .iter()
                    .map(|weights| match chance.below(4) {
                        0 => Evidence::Outcome(chance.pick(&[0, 1, 6, 70_000, usize::MAX])),
                        1 => Evidence::Missing,
                        _ => Evidence::Soft(weights),
                    })
                    .collect();
                let before = beliefs;
                let update = match chance.below(4) {
                    0 => Ok(beliefs.update_in_parallel(model, &evidence, Sweeps::NUMPY_PYMDP)),
                    1 => Ok(beliefs.update_in_parallel(model, &evidence, Sweeps::JAX_PYMDP)),
                    2 => beliefs.update(model, &evidence),
                    _ => beliefs.update_by_ascent(model, &evidence, chance.pick(&[0, 1, MAX_SWEEPS, 255])),
                };
                match update {
                    Ok(update) => assert!(update.free_energy.is_finite(), "{update:?} of {evidence:?}"),
                    Err(impossible) => {
                        assert!(impossible.modality < model.modalities().len());
                        assert_eq!(beliefs, before);
                    }
                }
                assert_distributions(&beliefs, model);
                let actions: Vec<Option<Action>> =
                    (0..chance.below(6)).map(|_| Some(chance.pick(&[0, 1, 3, 15, 16, 255]))).collect();
                beliefs.predict(model, &actions);
                let factor = chance.below(9);
                beliefs.set(model, factor, &odd_numbers(chance, 7));
                assert_distributions(&beliefs, model);
            }
        });
    });
}

/// An encounter of factors that need not exist, worth anything.
struct Odd([usize; 2], f32);

impl Encounter for Odd {
    fn factors(&self) -> [usize; 2] {
        self.0
    }

    fn departing(&self, _: [&[f32]; 2], _: [Option<Action>; 2]) -> f32 {
        self.1
    }

    fn arrived(&self, _: [&[f32]; 2]) -> f32 {
        -self.1
    }
}

#[test]
fn odd_decisions_give_a_posterior_or_nothing() {
    for_seeds(22, 4000, |chance| {
        let description = generator::description(chance);
        description.build(|model| {
            let beliefs = Room::prior(model);
            let mut policy = || {
                let steps = chance.pick(&[0, 1, 3, HORIZON]);
                let codes: Vec<Action> = (0..steps).map(|_| chance.below(16) as Action).collect();
                Policy::new(&codes).expect("codes that exist")
            };
            let lists: Vec<Vec<Policy>> =
                (0..6).map(|list| (0..list % 4).map(|_| policy()).collect()).collect();
            let sequences: Vec<&[Policy]> = lists[..chance.within(0, 6)].iter().map(Vec::as_slice).collect();
            let rows: Vec<u8> = (0..chance.below(40)).map(|_| chance.pick(&[0, 1, 2, 9, 255])).collect();
            let numbers: Vec<Vec<f32>> = (0..6).map(|_| odd_numbers(chance, 6)).collect();
            let slices: Vec<&[f32]> = numbers.iter().map(Vec::as_slice).collect();
            let odd = Odd([chance.below(6), chance.below(70)], chance.pick(&ODD));
            let candidates = Candidates {
                sequences: &sequences,
                combinations: if chance.once_in(2) { Combinations::All } else { Combinations::Listed(&rows) },
                habits: match chance.below(3) {
                    0 => Habits::Flat,
                    1 => Habits::Joint(slices[0]),
                    _ => Habits::PerSequence(&slices),
                },
            };
            let problem = Problem {
                horizon: chance.pick(&[0, 1, 3, 7]),
                preferences: &slices,
                aversions: &slices[1..],
                encounters: if chance.once_in(2) { &[&odd] } else { &[] },
                scope: chance.bits() as u16,
                ..Problem::new(
                    model,
                    &beliefs,
                    candidates,
                    Scoring {
                        precision: chance.pick(&[0.0, 1.0, -1.0, 1e30, f32::NAN, f32::INFINITY]),
                        window: chance.pick(&[0.0, 1.0, -1.0, f32::NAN, f32::INFINITY]),
                        ..generator::scoring(chance)
                    },
                )
            };
            let mut trial = Trial::new();
            trial.begin(&problem);
            while trial.advance(&problem, chance.within(1, 9)) {}
            assert!(trial.done() <= Trial::CAPACITY && trial.done() <= candidates.len());
            let posterior = trial.posterior();
            let (scored, beyond) = posterior.as_flattened().split_at(trial.done());
            let sum: f32 = scored.iter().sum();
            assert!(sum == 0.0 || (sum - 1.0).abs() < 1e-4, "{sum} from {:?}", trial.scores());
            assert!(beyond.iter().all(|&p| p == 0.0), "{:?}", trial.scores());
            assert!(trial.best().is_none_or(|best| best < trial.done()));
        });
    });
}

#[test]
fn a_model_with_more_groups_or_states_than_room_is_not_evaluated_and_does_no_harm() {
    for_seeds(23, 2000, |chance| {
        let description = generator::description(chance);
        let decision = generator::decision(chance, &description);
        let seen = generator::observation(chance, &description);
        let evidence: Vec<Evidence> = seen.iter().map(|seen| seen.evidence()).collect();
        description.build(|model| {
            let mut beliefs = Beliefs::<3, 2>::prior(model);
            let _ = beliefs.update(model, &evidence);
            let _ = beliefs.update_by_ascent(model, &evidence, MAX_SWEEPS);
            beliefs.update_in_parallel(model, &evidence, Sweeps::JAX_PYMDP);
            beliefs.predict(model, &[Some(0); 4]);
            let done = decision.pose(model, &beliefs, |problem| {
                let mut evaluation = Evaluation::<3, 2, 4, 4>::new();
                evaluation.evaluate(problem);
                evaluation.done()
            });
            assert!(model.groups() <= 2 || done == 0, "{} groups, {done} scored", model.groups());
        });
    });
}

/// Sixteen factors of two states that one action sequence each moves.
fn crowd(with: impl FnOnce(&Model)) {
    let motion = NextState::new(&[0, 1, 1, 0], 2);
    let sensor = IdentityNoise::new(0.9, 2);
    let factors: Vec<Factor> = (0..16)
        .map(|_| Factor::new(&motion, motion.shape(), &[0.5, 0.5]).controlled_by(Control::Own))
        .collect();
    let modality = [Modality::new(&sensor, sensor.shape(), &[0], &[0.0, 1.0])];
    with(&Model::new(&factors, &modality));
}

#[test]
fn more_joint_policies_than_can_be_counted_are_cut_off_at_the_room_for_them() {
    let list = vec![Policy::new(&[1]).expect("it is short"); 64];
    crowd(|model| {
        let sequences = vec![&list[..]; 16];
        let beliefs = Beliefs::<2, 16>::prior(model);
        let problem = Problem::new(model, &beliefs, Candidates::all(&sequences), Scoring::DEFAULT);
        let mut evaluation = Evaluation::<2, 16, 8, 4>::new();
        evaluation.evaluate(&problem);
        assert_eq!(evaluation.done(), 32);
    });
}

#[test]
fn a_group_with_more_joint_candidates_than_can_be_told_apart_is_not_mistaken_for_another() {
    // Five controls in one group with 256 sequences each: 2^40 combinations.
    let motion = NextState::new(&[0, 1, 1, 0], 2);
    let sensor = IdentityNoise::new(0.9, 2);
    let blocks: [(f32, &dyn Transition); 2] = [(1.0, &motion), (0.0, &motion)];
    let coupled = Blocks::new(&blocks, &[2, 2]);
    let others = [[1], [2], [3], [4], [0]];
    let factors =
        others.each_ref().map(|other| Factor::new(&coupled, coupled.shape(), &[0.5, 0.5]).coupled_to(other));
    let modality = [Modality::new(&sensor, sensor.shape(), &[0], &[0.0, 1.0])];
    let model = Model::new(&factors, &modality);
    assert_eq!(model.groups(), 1);
    let list = vec![Actions::EMPTY; 256];
    let sequences = vec![&list[..]; 5];
    let beliefs = Beliefs::<10, 1>::prior(&model);
    let rows = [255, 255, 255, 255, 255, 0, 0, 0, 0, 0];
    let problem = Problem::new(&model, &beliefs, Candidates::listed(&sequences, &rows), Scoring::DEFAULT);
    let mut evaluation = Evaluation::<10, 1, 4, 2>::new();
    evaluation.evaluate(&problem);
    assert_eq!(evaluation.done(), 0, "it is left out rather than wrong");
}

#[test]
fn odd_scores_get_nothing() {
    let mut scores = [f32::NAN, 1.0, f32::NEG_INFINITY, 1.0];
    policy::posterior(&mut scores, f32::INFINITY);
    assert_eq!(scores, [0.0, 0.5, 0.0, 0.5]);
    let mut scores = [f32::INFINITY, 1.0];
    policy::posterior(&mut scores, f32::INFINITY);
    assert_eq!(scores, [1.0, 0.0]);
    let mut scores = [f32::NAN, f32::NEG_INFINITY];
    policy::posterior(&mut scores, 1.0);
    assert_eq!(scores, [0.0, 0.0]);
    let mut scores = [1.0, 2.0];
    policy::posterior(&mut scores, -1.0);
    assert_eq!(scores, [0.0, 1.0]);
}
