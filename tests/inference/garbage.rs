//! No argument of a caller makes the engine panic, or turns a belief into anything but a
//! distribution.

use super::{Room, Trial, assert_distributions, for_seeds};
use iibt_core::actions::{Action, Actions, HORIZON};
use iibt_core::inference::{
    Argument, Beliefs, Blocks, Candidates, Combinations, Control, Evaluation, Evidence, Factor, Habits,
    IdentityNoise, MAX_SWEEPS, Modality, Model, NextState, ObservationError, OutOfRange, PairPreference,
    Policy, Problem, Scoring, Transition, policy,
};
use tests::oracle::chance::Chance;
use tests::oracle::generator;

const ODD: [f32; 9] = [0.0, 1.0, -1.0, -0.0, 1e-45, 1e8, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

fn odd_numbers(chance: &mut Chance, most: usize) -> Vec<f32> {
    (0..chance.within(0, most)).map(|_| chance.pick(&ODD)).collect()
}

/// Whether this could be observed of a model at all.
fn fits(model: &Model, evidence: &[Evidence]) -> bool {
    let sound = |(evidence, outcomes): (&Evidence, usize)| match evidence {
        Evidence::Missing => true,
        Evidence::Outcome(outcome) => *outcome < outcomes,
        Evidence::Soft(weights) => {
            weights.len() == outcomes
                && weights.iter().all(|weight| *weight >= 0.0 && *weight < f32::INFINITY)
        }
    };
    let outcomes = model.modalities().iter().map(|modality| modality.shape().values());
    evidence.len() <= model.modalities().len() && evidence.iter().zip(outcomes).all(sound)
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
                let update = match chance.below(2) {
                    0 => beliefs.update(model, &evidence),
                    _ => beliefs.update_by_ascent(model, &evidence, chance.pick(&[0, 1, MAX_SWEEPS, 255])),
                };
                match update {
                    Ok(update) => assert!(update.free_energy.is_finite(), "{update:?} of {evidence:?}"),
                    Err(ObservationError::Impossible(impossible)) => {
                        assert!(impossible.modality < model.modalities().len() && fits(model, &evidence));
                        assert_eq!(beliefs, before);
                    }
                    Err(ObservationError::OutOfRange(_)) => {
                        assert!(!fits(model, &evidence) && beliefs == before, "{evidence:?}");
                    }
                }
                assert_distributions(&beliefs, model);
                let actions: Vec<Option<Action>> =
                    (0..chance.below(6)).map(|_| Some(chance.pick(&[0, 1, 3, 15, 16, 255]))).collect();
                let known = |(control, action): (usize, &Option<Action>)| {
                    *action == Some(0) || usize::from(action.unwrap_or(0)) < model.actions(control)
                };
                let fits = actions.len() <= model.controls() && actions.iter().enumerate().all(known);
                assert_eq!(beliefs.predict(model, &actions).is_ok(), fits, "{actions:?}");
                let factor = chance.below(9);
                let before = beliefs;
                assert!(beliefs.set(model, factor, &odd_numbers(chance, 7)).is_ok() || beliefs == before);
                assert_distributions(&beliefs, model);
            }
        });
    });
}

/// A pair of factors that may not exist, with any preference.
struct Odd([usize; 2], f32);

impl PairPreference for Odd {
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
            let rows: Vec<u16> = (0..chance.below(40)).map(|_| chance.pick(&[0, 1, 2, 9, 65_535])).collect();
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
                announced: if chance.once_in(4) { &[None, Some(7)] } else { &[] },
            };
            let problem = Problem {
                horizon: chance.pick(&[0, 1, 3, 7]),
                preferences: &slices,
                negative_preferences: &slices[1..],
                pair_preferences: if chance.once_in(2) { &[&odd] } else { &[] },
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
            let begun = trial.begin(&problem);
            assert!(begun.is_ok() || !trial.advance(&problem, 9));
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
fn a_model_with_more_groups_or_states_than_room_is_refused() {
    for_seeds(23, 2000, |chance| {
        let description = generator::description(chance);
        let decision = generator::decision(chance, &description);
        let seen = generator::observation(chance, &description);
        let evidence: Vec<Evidence> = seen.iter().map(|seen| seen.evidence()).collect();
        description.build(|model| {
            let small = model.states() <= 6;
            let error = OutOfRange { what: Argument::States, index: 0, value: model.states(), limit: 6 };
            assert_eq!(Beliefs::<3, 2>::try_prior(model).err(), (!small).then_some(error));
            // Beliefs of another, smaller model.
            let mut beliefs = one_factor(Beliefs::<3, 2>::prior);
            let update = beliefs.update(model, &evidence);
            assert!(small || update == Err(error.into()));
            assert!(small || beliefs.update_by_ascent(model, &evidence, MAX_SWEEPS) == Err(error.into()));
            assert!(small || beliefs.predict(model, &[]) == Err(error));
            decision.pose(model, &beliefs, |problem| {
                let mut evaluation = Evaluation::<3, 2, 16, 16>::new();
                let result = evaluation.evaluate(problem);
                assert_eq!(result.is_ok(), small && model.groups() <= 2, "{result:?}");
                assert!(result.is_ok() || evaluation.done() == 0);
            });
        });
    });
}

fn one_factor<T>(with: impl FnOnce(&Model) -> T) -> T {
    let motion = NextState::new(&[0, 1, 1, 0], 2);
    let sensor = IdentityNoise::new(0.9, 2);
    let factors = [Factor::new(&motion, motion.shape(), &[0.5, 0.5])];
    with(&Model::new(&factors, &[Modality::new(&sensor, sensor.shape(), &[0], &[0.0, 1.0])]))
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
fn more_joint_policies_than_can_be_counted_are_refused() {
    let list = vec![Policy::new(&[1]).expect("it is short"); 64];
    crowd(|model| {
        let sequences = vec![&list[..]; 16];
        let beliefs = Beliefs::<2, 16>::prior(model);
        let problem = Problem::new(model, &beliefs, Candidates::all(&sequences), Scoring::DEFAULT);
        let mut evaluation = Evaluation::<2, 16, 8, 4>::new();
        let error = OutOfRange { what: Argument::Policies, index: 0, value: usize::MAX, limit: 32 };
        assert_eq!((evaluation.evaluate(&problem), evaluation.done()), (Err(error), 0));
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
    let error = evaluation.evaluate(&problem).expect_err("more than 32 bits count").to_string();
    assert_eq!(error, "group 0 is moved by 1099511627776 combinations, but there can be 4294967294");
    assert_eq!(evaluation.done(), 0);
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
