//! Changes that must not affect the result: the form of a table, the order of states, outcomes and
//! policies, and how many policies are scored per call.

use super::decisions::too_long;
use super::{Room, Trial, for_seeds};
use iibt_core::inference::{Beliefs, Evaluation, ObservationError, Terms};
use tests::oracle::chance::Chance;
use tests::oracle::decision::Decision;
use tests::oracle::description::{Description, Motion, Observed, Sensor};
use tests::oracle::generator;

/// Beliefs, F and the terms of every joint policy.
struct Result {
    update: core::result::Result<f32, ObservationError>,
    beliefs: Vec<Vec<f32>>,
    terms: Vec<Terms>,
    scores: Vec<f32>,
}

fn results(description: &Description, seen: &[Observed], decision: &Decision) -> Result {
    let evidence: Vec<_> = seen.iter().map(Observed::evidence).collect();
    description.build(|model| {
        let mut beliefs = Room::prior(model);
        let update = beliefs.update(model, &evidence).map(|update| update.free_energy);
        decision.pose(model, &beliefs, |problem| {
            let mut trial = Trial::new();
            trial.evaluate(problem).expect("it fits");
            Result {
                update,
                beliefs: (0..model.factors().len())
                    .map(|factor| beliefs.of(model, factor).expect("the model has it").to_vec())
                    .collect(),
                terms: trial.terms().to_vec(),
                scores: trial.scores().to_vec(),
            }
        })
    })
}

fn same(one: f32, other: f32, tolerance: f32) -> bool {
    (one - other).abs() <= tolerance * other.abs().max(1.0)
}

fn assert_same_update(one: &Result, other: &Result) {
    match (one.update, other.update) {
        (Ok(one), Ok(other)) => assert!(same(one, other, 2e-5), "F is {one} and {other}"),
        (one, other) => assert_eq!(one, other),
    }
}

fn assert_same_terms(one: &Terms, other: &Terms) {
    let pairs = [
        (one.utility, other.utility),
        (one.information_gain, other.information_gain),
        (one.ambiguity, other.ambiguity),
        (one.novelty, other.novelty),
    ];
    assert!(pairs.iter().all(|&(one, other)| same(one, other, 2e-4)), "{one:?} and {other:?}");
}

fn assert_same(one: &Result, other: &Result) {
    assert_same_update(one, other);
    for (one, other) in one.beliefs.iter().flatten().zip(other.beliefs.iter().flatten()) {
        assert!(same(*one, *other, 2e-5), "{one} and {other}");
    }
    assert_eq!(one.terms.len(), other.terms.len());
    one.terms.iter().zip(&other.terms).for_each(|(one, other)| assert_same_terms(one, other));
}

/// A random model, observation and decision that take no long time.
fn task(chance: &mut Chance) -> (Description, Vec<Observed>, Decision) {
    loop {
        let description = generator::description(chance);
        let seen = generator::observation(chance, &description);
        let decision = generator::decision(chance, &description);
        if !too_long(&description, &decision) {
            return (description, seen, decision);
        }
    }
}

#[test]
fn structured_forms_equal_dense_tables() {
    for_seeds(31, 10_000, |chance| {
        let (description, seen, decision) = task(chance);
        assert_same(
            &results(&description, &seen, &decision),
            &results(&description.dense(), &seen, &decision),
        );
    });
}

/// Moves every entry of a table, row-major with the row first, to where `orders` put its row and
/// columns.
fn moved(table: &[f32], counts: &[usize], orders: &[&[usize]]) -> Vec<f32> {
    let mut new = vec![0.0; table.len()];
    for (at, &p) in table.iter().enumerate() {
        let (mut rest, mut place, mut stride) = (at, 0, 1);
        for (count, order) in counts.iter().zip(orders).rev() {
            place += order[rest % count] * stride;
            (rest, stride) = (rest / count, stride * count);
        }
        new[place + rest * stride] = p;
    }
    new
}

fn moved_list(list: &[f32], order: &[usize]) -> Vec<f32> {
    moved(list, &[list.len()], &[order])
}

/// The dense model with the states of every factor in another order.
fn with_states_in(description: &Description, orders: &[Vec<usize>]) -> Description {
    let counts = description.states();
    let mut new = description.dense();
    for (number, factor) in new.factors.iter_mut().enumerate() {
        factor.prior = moved_list(&factor.prior, &orders[number]);
        let of: Vec<usize> = [number, number].iter().chain(&factor.coupled_to).copied().collect();
        let sizes: Vec<usize> = of.iter().map(|&factor| counts[factor]).collect();
        let by: Vec<&[usize]> = of.iter().map(|&factor| orders[factor].as_slice()).collect();
        let Motion::Dense(table) = &factor.motion else { unreachable!("it is dense") };
        factor.motion = Motion::Dense(moved(table, &sizes, &by));
    }
    for sense in &mut new.modalities {
        let still: Vec<usize> = (0..sense.outcomes).collect();
        let sizes: Vec<usize> =
            [sense.outcomes].into_iter().chain(sense.factors.iter().map(|&factor| counts[factor])).collect();
        let by: Vec<&[usize]> = [still.as_slice()]
            .into_iter()
            .chain(sense.factors.iter().map(|&factor| orders[factor].as_slice()))
            .collect();
        let Sensor::Dense(table) = &sense.sensor else { unreachable!("it is dense") };
        sense.sensor = Sensor::Dense(moved(table, &sizes, &by));
    }
    new
}

#[test]
fn permuting_states_permutes_beliefs_and_leaves_the_terms_alone() {
    for_seeds(32, 6000, |chance| {
        let (description, seen, mut decision) = task(chance);
        decision.meetings.clear();
        let orders: Vec<Vec<usize>> =
            description.states().iter().map(|&states| chance.order(states)).collect();
        let mut plain = results(&description, &seen, &decision);
        let permuted = results(&with_states_in(&description, &orders), &seen, &decision);
        for (beliefs, order) in plain.beliefs.iter_mut().zip(&orders) {
            *beliefs = moved_list(beliefs, order);
        }
        assert_same(&plain, &permuted);
    });
}

#[test]
fn permuting_outcomes_changes_nothing() {
    for_seeds(33, 6000, |chance| {
        let (description, mut seen, mut decision) = task(chance);
        let orders: Vec<Vec<usize>> =
            description.modalities.iter().map(|sense| chance.order(sense.outcomes)).collect();
        let plain = results(&description, &seen, &decision);
        let mut permuted = description.dense();
        for (sense, order) in permuted.modalities.iter_mut().zip(&orders) {
            let Sensor::Dense(table) = &sense.sensor else { unreachable!("it is dense") };
            let columns = table.len() / sense.outcomes;
            let still: Vec<usize> = (0..columns).collect();
            sense.sensor = Sensor::Dense(moved(table, &[sense.outcomes, columns], &[order, &still]));
            sense.preference = moved_list(&sense.preference, order);
        }
        for list in [&mut decision.preferences, &mut decision.negative_preferences] {
            list.iter_mut().zip(&orders).for_each(|(list, order)| *list = moved_list(list, order));
        }
        for (seen, order) in seen.iter_mut().zip(&orders) {
            match seen {
                Observed::Outcome(outcome) => *outcome = order.get(*outcome).copied().unwrap_or(*outcome),
                Observed::Soft(weights) => {
                    weights.resize(order.len(), 0.0);
                    *weights = moved_list(weights, order);
                }
                Observed::Missing => {}
            }
        }
        assert_same(&plain, &results(&permuted, &seen, &decision));
    });
}

#[test]
fn permuting_policies_permutes_terms_and_scores() {
    for_seeds(34, 6000, |chance| {
        let (description, seen, mut decision) = task(chance);
        if description.controls() == 0 {
            return;
        }
        decision.listed = Some(decision.policies());
        decision.habits = tests::oracle::decision::Habit::Flat;
        let plain = results(&description, &seen, &decision);
        let order = chance.order(plain.terms.len());
        let rows = decision.policies();
        decision.listed = Some(order.iter().map(|&policy| rows[policy].clone()).collect());
        let permuted = results(&description, &seen, &decision);
        for (place, &policy) in order.iter().enumerate() {
            assert_same_terms(&permuted.terms[place], &plain.terms[policy]);
            assert!(same(permuted.scores[place], plain.scores[policy], 2e-4));
        }
    });
}

#[test]
fn scoring_a_few_policies_per_call_gives_the_same_bits_and_the_best_so_far() {
    for_seeds(35, 6000, |chance| {
        let (description, seen, decision) = task(chance);
        let whole = results(&description, &seen, &decision);
        let bits = |scores: &[f32]| scores.iter().map(|score| score.to_bits()).collect::<Vec<_>>();
        let evidence: Vec<_> = seen.iter().map(Observed::evidence).collect();
        description.build(|model| {
            let mut beliefs = Room::prior(model);
            let _ = beliefs.update(model, &evidence);
            decision.pose(model, &beliefs, |problem| {
                let mut trial = Trial::new();
                trial.begin(problem).expect("it fits");
                assert_eq!((trial.best(), trial.done()), (None, 0));
                let mut more = true;
                while more {
                    let (before, count) = (trial.done(), chance.within(0, 5));
                    more = trial.advance(problem, count);
                    assert_eq!(trial.done(), (before + count).min(whole.scores.len()));
                    assert_eq!(more, trial.done() < whole.scores.len());
                    assert_eq!(bits(trial.scores()), bits(&whole.scores[..trial.done()]));
                    assert_eq!(trial.terms(), &whole.terms[..trial.done()]);
                    let best = whole.scores[..trial.done()].iter().copied().fold(f32::NEG_INFINITY, f32::max);
                    let first = whole.scores[..trial.done()].iter().position(|&score| score == best);
                    assert_eq!(trial.best(), first.filter(|_| best > f32::NEG_INFINITY));
                }
                // However many candidates there is room for side by side.
                let mut narrow = Evaluation::<{ generator::STATES }, { generator::FACTORS }, 1, 35>::new();
                narrow.evaluate(problem).expect("it fits");
                assert_eq!(bits(narrow.scores()), bits(&whole.scores));
                // What does not fit is refused, and nothing is scored.
                let mut small = Evaluation::<{ generator::STATES }, { generator::FACTORS }, 2, 2>::new();
                assert_eq!(small.evaluate(problem).is_ok(), whole.scores.len() <= 4);
                assert!(whole.scores.len() <= 4 || (small.best(), small.done()) == (None, 0));
            });
        });
    });
}

#[test]
fn room_to_spare_changes_no_bit() {
    for_seeds(36, 2000, |chance| {
        let (description, seen, decision) = task(chance);
        let whole = results(&description, &seen, &decision);
        let evidence: Vec<_> = seen.iter().map(Observed::evidence).collect();
        description.build(|model| {
            let mut beliefs = Beliefs::<17, 5>::prior(model);
            assert_eq!(beliefs.update(model, &evidence).map(|update| update.free_energy), whole.update);
            for (factor, q) in whole.beliefs.iter().enumerate() {
                assert_eq!(beliefs.of(model, factor).expect("the model has it"), q);
            }
            decision.pose(model, &beliefs, |problem| {
                let mut evaluation = Evaluation::<17, 5, 8, 8>::new();
                evaluation.evaluate(problem).expect("it fits");
                assert_eq!(evaluation.scores(), whole.scores);
            });
        });
    });
}
