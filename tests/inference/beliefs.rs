//! State inference: posteriors, surprise, the free energy of approximations, impossible
//! observations.

use super::{Room, assert_distributions, assert_marginals, close, for_seeds, marginals};
use host_sim::notebook::Sweeps;
use iibt_core::inference::{Beliefs, Evidence, Impossible, MAX_SWEEPS, Model, ObservationError, likelihood};
use tests::oracle::chance::Chance;
use tests::oracle::description::{Description, Hidden, Motion, Observed, Sense, Sensor};
use tests::oracle::{Marginals, Tables, generator};

/// The observed modalities with the weight of each outcome, in the order in which they are
/// explained: those of one factor first, then those that couple factors, component by component.
fn in_order(description: &Description, seen: &[Observed]) -> Vec<(usize, Vec<f64>)> {
    let observed: Vec<(usize, Vec<f64>)> = description
        .modalities
        .iter()
        .zip(seen)
        .enumerate()
        .filter_map(|(number, (sense, seen))| Some((number, seen.weights(sense.outcomes)?)))
        .collect();
    let factors = |number: usize| &description.modalities[number].factors;
    let (mut order, mut left): (Vec<_>, Vec<_>) =
        observed.into_iter().partition(|(number, _)| factors(*number).len() == 1);
    while !left.is_empty() {
        let mut reached = factors(left[0].0).clone();
        let joins = |reached: &[usize], number: usize| factors(number).iter().any(|of| reached.contains(of));
        for _ in 0..left.len() {
            for (number, _) in &left {
                if joins(&reached, *number) {
                    reached.extend(factors(*number));
                }
            }
        }
        let (together, others): (Vec<_>, Vec<_>) =
            left.into_iter().partition(|(number, _)| joins(&reached, *number));
        order.extend(together);
        left = others;
    }
    order
}

/// The first modality that cannot be explained together with those before it.
fn inexplicable(tables: &Tables, beliefs: &Marginals, evidence: &[(usize, Vec<f64>)]) -> Option<usize> {
    (1..=evidence.len())
        .find(|&count| tables.update(beliefs, &evidence[..count]).is_none())
        .map(|count| evidence[count - 1].0)
}

fn evidence(seen: &[Observed]) -> Vec<Evidence<'_>> {
    seen.iter().map(Observed::evidence).collect()
}

fn actions(chance: &mut Chance, model: &Model) -> Vec<Option<u8>> {
    let action = |control| match model.actions(control) {
        0 => None,
        actions => (!chance.once_in(4)).then(|| chance.below(actions.min(3)) as u8),
    };
    (0..model.controls()).map(action).collect()
}

/// What each factor's action is, given one for each control.
fn factor_actions(description: &Description, actions: &[Option<u8>]) -> Vec<Option<u8>> {
    let of = |control: Option<usize>| control.map_or(Some(0), |control| actions[control]);
    description.factors.iter().map(|factor| of(factor.control)).collect()
}

#[test]
fn exact_beliefs_and_surprise_equal_enumeration_step_after_step() {
    for_seeds(1, 40_000, |chance| {
        let description = generator::description(chance);
        let tables = description.tables();
        description.build(|model| {
            let mut beliefs = Room::prior(model);
            for _ in 0..3 {
                let (before, exact) = (beliefs, marginals(&beliefs, model));
                let seen = generator::observation(chance, &description);
                let explained = in_order(&description, &seen);
                match (beliefs.update(model, &evidence(&seen)), tables.update(&exact, &explained)) {
                    (Ok(update), Some((posterior, surprise))) => {
                        assert!(update.exact && update.converged && update.sweeps == 0);
                        assert!(close(update.free_energy, surprise, 2e-5), "{update:?} against {surprise}");
                        assert_marginals(&marginals(&beliefs, model), &posterior, 1e-5);
                    }
                    (Err(ObservationError::Impossible(Impossible { modality })), None) => {
                        assert_eq!(Some(modality), inexplicable(&tables, &exact, &explained));
                        assert_eq!(beliefs, before);
                    }
                    (ours, reference) => panic!("{ours:?} against {reference:?}"),
                }
                assert_distributions(&beliefs, model);

                let exact = marginals(&beliefs, model);
                let actions = actions(chance, model);
                beliefs.predict(model, &actions).expect("they are the model's");
                let predicted = tables.predict(&exact, &factor_actions(&description, &actions));
                assert_marginals(&marginals(&beliefs, model), &predicted, 1e-5);
            }
        });
    });
}

#[test]
fn coordinate_ascent_never_raises_f_and_never_falls_below_the_surprise() {
    for_seeds(2, 20_000, |chance| {
        let description = generator::description(chance);
        let tables = description.tables();
        let seen = generator::observation(chance, &description);
        let explained = in_order(&description, &seen);
        description.build(|model| {
            let prior = Room::prior(model);
            let exact = marginals(&prior, model);
            let mut least = f32::INFINITY;
            for sweeps in 1..=MAX_SWEEPS {
                let mut beliefs = prior;
                let Ok(update) = beliefs.update_by_ascent(model, &evidence(&seen), sweeps) else {
                    assert_eq!(beliefs, prior);
                    assert!(tables.update(&exact, &explained).is_none());
                    return;
                };
                let ours = marginals(&beliefs, model);
                assert_distributions(&beliefs, model);
                let slack = 2e-5 * update.free_energy.abs().max(1.0);
                assert!(update.free_energy <= least + slack, "{update:?} after {least}");
                // Under a floor the bound is the surprise with that floor; without one the two are
                // the same.
                let surprise = floored_surprise(&tables, &exact, &explained, &description);
                assert!(
                    f64::from(update.free_energy) >= surprise - f64::from(slack),
                    "{update:?} {surprise}"
                );
                let free_energy = free_energy(&tables, &ours, &exact, &explained, &description);
                assert!(close(update.free_energy, free_energy, 2e-5), "{update:?} against {free_energy}");
                if update.exact {
                    assert!(close(update.free_energy, surprise, 2e-5));
                }
                least = update.free_energy;
                if update.converged {
                    break;
                }
            }
        });
    });
}

/// The floor of a modality: none where Bayes' rule takes it in exactly.
fn floor(description: &Description, modality: usize) -> f64 {
    if description.modalities[modality].factors.len() > 1 { f64::from(likelihood::FLOOR) } else { 0.0 }
}

/// -ln Σ_s p(s) Π_m max(P(e_m | s), floor).
fn floored_surprise(
    tables: &Tables,
    prior: &Marginals,
    explained: &[(usize, Vec<f64>)],
    description: &Description,
) -> f64 {
    let mut joint = tables.joint(prior);
    for (modality, weights) in explained {
        let of = tables.explains(*modality, weights, floor(description, *modality));
        joint.iter_mut().zip(of).for_each(|(mass, p)| *mass *= p);
    }
    -joint.iter().sum::<f64>().ln()
}

/// F of independent beliefs, coupled modalities with their floor.
fn free_energy(
    tables: &Tables,
    beliefs: &Marginals,
    prior: &Marginals,
    explained: &[(usize, Vec<f64>)],
    description: &Description,
) -> f64 {
    let (coupled, own): (Vec<_>, Vec<_>) =
        explained.iter().cloned().partition(|(modality, _)| floor(description, *modality) > 0.0);
    let together = tables.free_energy(beliefs, prior, &coupled, f64::from(likelihood::FLOOR));
    together + tables.free_energy(beliefs, beliefs, &own, 0.0)
}

#[test]
fn beliefs_stay_distributions_and_f_finite_after_every_call() {
    for_seeds(3, 10_000, |chance| {
        let description = generator::description(chance);
        description.build(|model| {
            let (mut beliefs, prior) = (Room::prior(model), Room::prior(model));
            for _ in 0..6 {
                let seen = generator::observation(chance, &description);
                let evidence = evidence(&seen);
                let free_energy = match chance.below(7) {
                    0 => Sweeps::NUMPY_PYMDP.update(&mut beliefs, model, &evidence).free_energy,
                    1 => Sweeps::JAX_PYMDP.update(&mut beliefs, model, &evidence).free_energy,
                    2 => beliefs.update(model, &evidence).map_or(0.0, |update| update.free_energy),
                    3 => beliefs
                        .update_by_ascent(model, &evidence, MAX_SWEEPS)
                        .map_or(0.0, |update| update.free_energy),
                    4 => {
                        beliefs.predict(model, &actions(chance, model)).expect("they are the model's");
                        0.0
                    }
                    5 => {
                        beliefs.mix(&prior, chance.pick(&[0.0, 0.2, 1.0, 7.0, -1.0, f32::NAN]));
                        0.0
                    }
                    _ => {
                        let factor = chance.below(description.factors.len());
                        let weights = [0.0, 3.0, 0.1, -1.0, f32::NAN, f32::INFINITY];
                        let weights: Vec<f32> = description.factors[factor]
                            .prior
                            .iter()
                            .map(|_| chance.pick(&weights[..chance.clone().pick(&[3, 3, 6])]))
                            .collect();
                        let _ = beliefs.set(model, factor, &weights);
                        0.0
                    }
                };
                assert!(free_energy.is_finite());
                assert_distributions(&beliefs, model);
            }
        });
    });
}

#[test]
fn the_product_of_many_states_is_left_to_coordinate_ascent() {
    for_seeds(4, 10, |chance| {
        const N: usize = 17;
        let description = big(chance, N);
        let tables = description.tables();
        description.build(|model| {
            let mut beliefs = Beliefs::<N, 3>::prior(model);
            let prior = marginals(&beliefs, model);
            let seen = [Observed::Outcome(0)];
            let explained = in_order(&description, &seen);
            let update = beliefs.update(model, &evidence(&seen)).expect("every outcome is possible");
            assert!(!update.exact && update.converged, "{update:?}");
            let (_, surprise) = tables.update(&prior, &explained).expect("every outcome is possible");
            assert!(f64::from(update.free_energy) > surprise - 1e-4);
            let ours = marginals(&beliefs, model);
            assert_distributions(&beliefs, model);
            assert!(close(
                update.free_energy,
                free_energy(&tables, &ours, &prior, &explained, &description),
                2e-5
            ));
        });
    });
}

/// Three factors that one modality couples, of `states` states each.
fn big(chance: &mut Chance, states: usize) -> Description {
    let hidden = |chance: &mut Chance| Hidden {
        prior: chance.distribution(states),
        coupled_to: vec![],
        control: None,
        actions: 1,
        motion: Motion::NextState((0..states as u16).collect(), 0.0),
    };
    let columns = states.pow(3);
    let high: Vec<f32> = (0..columns).map(|_| chance.between(0.01, 0.99)).collect();
    let low = high.iter().map(|p| 1.0 - p);
    Description {
        factors: (0..3).map(|_| hidden(chance)).collect(),
        modalities: vec![Sense {
            outcomes: 2,
            factors: vec![0, 1, 2],
            sensor: Sensor::Dense(high.iter().copied().chain(low).collect()),
            preference: vec![0.0, 0.0],
        }],
    }
}

/// Two robots on a grid of 49 cells, each with its own noisy reading, and a result that says
/// whether they stand on different goals, the same, or none.
fn two_robots(chance: &mut Chance) -> Description {
    const CELLS: usize = 49;
    let goals = chance.order(CELLS);
    let mut labels = vec![0; CELLS];
    (labels[goals[0]], labels[goals[1]]) = (1, 2);
    let robot = |chance: &mut Chance| Hidden {
        prior: chance.distribution(CELLS),
        coupled_to: vec![],
        control: None,
        actions: 1,
        motion: Motion::NextState((0..CELLS as u16).collect(), 0.0),
    };
    let reading = |chance: &mut Chance, robot| Sense {
        outcomes: CELLS,
        factors: vec![robot],
        sensor: Sensor::IdentityNoise(chance.between(0.3, 0.9999)),
        preference: vec![0.0; CELLS],
    };
    let certain = vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    Description {
        factors: vec![robot(chance), robot(chance)],
        modalities: vec![
            reading(chance, 0),
            reading(chance, 1),
            Sense {
                outcomes: 3,
                factors: vec![0, 1],
                sensor: Sensor::OutcomeTable(
                    vec![labels.clone(), labels],
                    vec![0, 2, 2, 2, 2, 1, 2, 1, 2],
                    certain,
                ),
                preference: vec![0.0; 3],
            },
        ],
    }
}

#[test]
fn the_exact_belief_of_two_robots_on_a_grid_equals_enumeration() {
    for_seeds(5, 100, |chance| {
        let description = two_robots(chance);
        let tables = description.tables();
        description.build(|model| {
            for _ in 0..10 {
                let mut beliefs = Beliefs::<49, 2>::prior(model);
                let (before, exact) = (beliefs, marginals(&beliefs, model));
                let seen = [49, 49, 3].map(|outcomes| Observed::Outcome(chance.below(outcomes)));
                let explained = in_order(&description, &seen);
                match (beliefs.update(model, &evidence(&seen)), tables.update(&exact, &explained)) {
                    (Ok(update), Some((posterior, surprise))) => {
                        assert!(close(update.free_energy, surprise, 1e-4), "{update:?}, {surprise}");
                        assert_marginals(&marginals(&beliefs, model), &posterior, 1e-5);
                    }
                    (Err(_), None) => assert_eq!(beliefs, before),
                    (ours, reference) => panic!("{ours:?} against {reference:?}"),
                }
            }
        });
    });
}
