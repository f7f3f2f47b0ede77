//! Beliefs, free energies and joint decisions against references in double precision that do everything the
//! long way: every pair of states enumerated, every joint policy rolled out.

use iibt_core::inference::belief::update_pair;
use iibt_core::inference::free_energy::variational;
use iibt_core::inference::{
    Belief, Convention, IdentityNoise, Interaction, Likelihood, NextState, OutcomeTable, Padding, Policy,
    Preference, Scoring, Side, Workspace,
};
use proptest::prelude::*;
use tests::oracle::{self, Reference};

const S: usize = 49;

fn weights() -> impl Strategy<Value = [f32; S]> {
    // Some states are ruled out altogether.
    prop::array::uniform(prop_oneof![1 => Just(0.0_f32), 3 => 1e-6_f32..1.0])
}

/// Two robots whose result says whether they stand on different goals, the same, or none.
fn table(goals: [usize; 2]) -> OutcomeTable<S, 3, 3> {
    let mut labels = [0; S];
    labels[goals[0]] = 1;
    labels[goals[1]] = 2;
    OutcomeTable::new(labels, [[0, 2, 2], [2, 2, 1], [2, 1, 2]])
}

fn goals() -> impl Strategy<Value = [usize; 2]> {
    (0..S, 1..S).prop_map(|(first, ahead)| [first, (first + ahead) % S])
}

fn assert_close(ours: &[f32], reference: &[f64], tolerance: f64) {
    for (state, (&q, &p)) in ours.iter().zip(reference).enumerate() {
        assert!((f64::from(q) - p).abs() <= tolerance, "state {state}: {q} against {p}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_exact_belief_of_two_robots_equals_enumeration(
        first in weights(), second in weights(), goals in goals(),
        readings in (0..S, 0..S), outcome in 0_usize..3, sensors in (0.3_f32..0.9999, 0.3_f32..0.9999),
    ) {
        let (Some(mut p), Some(mut q)) = (Belief::from_weights(first), Belief::from_weights(second)) else { return Ok(()) };
        let (a, b) = (IdentityNoise::<S>::new(sensors.0), IdentityNoise::<S>::new(sensors.1));
        let reference = oracle::joint_belief(
            (p.probabilities(), q.probabilities()),
            |s| f64::from(a.probability(readings.0, s)),
            |s| f64::from(b.probability(readings.1, s)),
            |s, t| table(goals).outcome(s, t) == outcome,
        );
        let surprise = p.update(&a, readings.0).and_then(|f| Ok(f + q.update(&b, readings.1)?));
        let before = (p, q);
        let ours = surprise.and_then(|f| Ok(f + update_pair(&mut p, &mut q, &table(goals), outcome)?));
        match (ours, reference) {
            (Ok(f), Some(reference)) => {
                assert_close(p.probabilities(), &reference.first, 1e-5);
                assert_close(q.probabilities(), &reference.second, 1e-5);
                prop_assert!((f64::from(f) - reference.surprise).abs() < 1e-4 * reference.surprise.abs().max(1.0));
            }
            (Err(_), None) => prop_assert_eq!((p, q), before),
            (ours, reference) => prop_assert!(false, "{:?} against {}", ours, reference.is_some()),
        }
    }

    #[test]
    fn beliefs_stay_distributions(first in weights(), readings in prop::collection::vec(0..S, 1..30), correct in 0.0_f32..=1.0) {
        let Some(mut belief) = Belief::from_weights(first) else { return Ok(()) };
        let sensor = IdentityNoise::<S>::new(correct);
        for reading in readings {
            let before = belief;
            match belief.update(&sensor, reading) {
                Ok(surprise) => prop_assert!(surprise >= -1e-5 && surprise.is_finite()),
                Err(_) => prop_assert_eq!(belief, before),
            }
            let sum: f32 = belief.probabilities().iter().sum();
            prop_assert!((sum - 1.0).abs() < 1e-5 && belief.probabilities().iter().all(|&q| q >= 0.0));
        }
    }

    #[test]
    fn free_energy_is_never_below_the_surprise(first in weights(), other in weights(), reading in 0..S) {
        let (Some(prior), Some(other)) = (Belief::from_weights(first), Belief::from_weights(other)) else { return Ok(()) };
        let sensor = IdentityNoise::<S>::new(0.9);
        let mut posterior = prior;
        let Ok(surprise) = posterior.update(&sensor, reading) else { return Ok(()) };
        let at = |belief: &Belief<S>| variational(belief.probabilities(), prior.probabilities(), &sensor, reading);
        prop_assert!((at(&posterior) - surprise).abs() < 1e-3);
        let elsewhere = at(&other);
        prop_assert!(elsewhere.is_nan() || elsewhere > surprise - 1e-3);
    }
}

/// A small world in which everything can be enumerated: `N` states on a ring with shortcuts.
const N: usize = 6;

#[derive(Clone, Debug)]
struct World {
    next: [[u16; N]; 3],
    labels: [u8; N],
    beliefs: [[f32; N]; 2],
    preferences: [[f32; N]; 2],
    team: [f32; 3],
    collision: f32,
    policies: [Vec<Vec<u8>>; 2],
    sensors: [f32; 2],
    scoring: Scoring,
}

fn world() -> impl Strategy<Value = World> {
    let beliefs = prop::array::uniform2(prop::array::uniform6(0.01_f32..1.0));
    let preferences = prop::array::uniform2(prop::array::uniform6(-2.0_f32..2.0));
    let policies = prop::array::uniform2(prop::collection::vec(prop::collection::vec(0_u8..3, 0..5), 1..5));
    let scoring =
        (any::<bool>(), any::<bool>(), any::<bool>()).prop_map(|(printed, joint, published)| Scoring {
            precision: 1.0,
            convention: if printed { Convention::AsPrinted } else { Convention::Standard },
            gain: if joint {
                iibt_core::inference::Gain::Joint
            } else {
                iibt_core::inference::Gain::PerModality
            },
            credit: if published {
                iibt_core::inference::Credit::EveryStep
            } else {
                iibt_core::inference::Credit::OnArrival
            },
            padding: if published { Padding::Repeat(1) } else { Padding::Stay },
        });
    let tables =
        (prop::array::uniform3(prop::array::uniform6(0_u16..N as u16)), prop::array::uniform6(0_u8..3));
    let numbers = (prop::array::uniform3(-1.0_f32..1.0), prop_oneof![Just(0.0_f32), -4.0_f32..0.0]);
    (tables, beliefs, preferences, numbers, policies, prop::array::uniform2(0.2_f32..0.99), scoring).prop_map(
        |((next, labels), beliefs, preferences, (team, collision), policies, sensors, scoring)| World {
            next,
            labels,
            beliefs,
            preferences,
            team,
            collision,
            policies,
            sensors,
            scoring,
        },
    )
}

const MEET: [[u8; 3]; 3] = [[0, 2, 2], [2, 2, 1], [2, 1, 2]];

/// -G of every joint policy, factored, as the core has it.
fn factored(world: &World, horizon: usize) -> Vec<f32> {
    let transition = NextState::<N, 3>::new(world.next);
    let outcomes = OutcomeTable::<N, 3, 3>::new(world.labels, MEET);
    let team = Preference::new(world.team);
    let belief = world.beliefs.map(|weights| Belief::from_weights(weights).unwrap());
    let preference = world.preferences.map(Preference::new);
    let sensor = world.sensors.map(IdentityNoise::<N>::new);
    let policies = [0, 1].map(|robot| {
        world.policies[robot].iter().map(|actions| Policy::new(actions).unwrap()).collect::<Vec<_>>()
    });
    let side = |robot: usize| Side {
        likelihood: &sensor[robot],
        transition: &transition,
        belief: &belief[robot],
        preference: &preference[robot],
        policies: &policies[robot],
    };
    let interaction = Interaction { outcomes: &outcomes, preference: &team, collision: world.collision };
    let mut workspace = Workspace::<N, 4>::new();
    workspace.evaluate(&side(0), &side(1), &interaction, &world.scoring, horizon);
    let value = |terms: &iibt_core::inference::Terms| -terms.expected_free_energy(world.scoring.convention);
    let mut values = vec![];
    for first in 0..policies[0].len() {
        for second in 0..policies[1].len() {
            let own = value(&workspace.first_terms()[first]) + value(&workspace.second_terms()[second]);
            values.push(own + workspace.pairs()[first][second]);
        }
    }
    values
}

fn brute_force(world: &World, horizon: usize) -> Vec<f64> {
    let reference = Reference {
        next: world.next.map(|row| row.map(usize::from).to_vec()).to_vec(),
        labels: world.labels.map(usize::from).to_vec(),
        outcomes: MEET.map(|row| row.map(usize::from).to_vec()).to_vec(),
        beliefs: world.beliefs.map(|weights| oracle::normalised(&weights)),
        preferences: world.preferences.map(|values| values.map(f64::from).to_vec()),
        team: world.team.map(f64::from).to_vec(),
        collision: world.collision.into(),
        sensors: world.sensors.map(f64::from),
        scoring: world.scoring,
    };
    let mut values = vec![];
    for first in &world.policies[0] {
        for second in &world.policies[1] {
            values.push(reference.value(first, second, horizon));
        }
    }
    values
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn the_factored_value_of_every_joint_policy_equals_brute_force(world in world(), slack in 0_usize..3) {
        let longest = world.policies.iter().flatten().map(Vec::len).max().unwrap_or(0);
        let horizon = longest + slack;
        let (ours, reference) = (factored(&world, horizon), brute_force(&world, horizon));
        for (pair, (ours, reference)) in ours.iter().zip(&reference).enumerate() {
            prop_assert!((f64::from(*ours) - reference).abs() < 1e-4 * reference.abs().max(1.0), "pair {}: {} against {}", pair, ours, reference);
        }
    }
}
