//! T1 and T2: what other engines make of them, and what they get wrong.

use super::close;
use firmware::bench::{t1, t2};
use host_sim::notebook::Sweeps;
use iibt_core::inference::{
    Beliefs, Candidates, Evaluation, Evidence, MAX_SWEEPS, Model, Problem, Scoring, Update,
};
use tests::peers::{self, Peer};

/// A benchmark model with an observation and candidates.
type Benchmark = (&'static Model<'static>, [Evidence<'static>; 3], Candidates<'static>);

fn t1() -> Benchmark {
    (&t1::MODEL, t1::OBSERVED, t1::CANDIDATES)
}

fn t2() -> Benchmark {
    (&t2::MODEL, t2::OBSERVED, t2::CANDIDATES)
}

fn assert_numbers(what: &str, ours: impl IntoIterator<Item = f32>, peer: &[f64], tolerance: f64) {
    let mut count = 0;
    for (at, (ours, &peer)) in ours.into_iter().zip(peer).enumerate() {
        assert!((f64::from(ours) - peer).abs() <= tolerance, "{what} {at}: {ours} against {peer}");
        count += 1;
    }
    assert_eq!(count, peer.len());
}

fn assert_beliefs<const S: usize>(
    (model, observed, _): Benchmark,
    sweeps: Sweeps,
    peer: &Peer,
) -> Beliefs<S, 2> {
    let mut beliefs = Beliefs::<S, 2>::prior(model);
    let update = sweeps.update(&mut beliefs, model, &observed);
    assert!(close(update.free_energy, peer.free_energy, 1e-5), "{update:?}");
    for (factor, peer) in peer.beliefs.iter().enumerate() {
        assert_numbers(
            "state",
            beliefs.of(model, factor).expect("the model has it").iter().copied(),
            peer,
            1e-5,
        );
    }
    beliefs
}

/// -G within 1e-4, the posterior within 1e-4 at a precision of 1 and 1e-3 at 16.
fn assert_policies<const S: usize>(
    (model, _, candidates): Benchmark,
    beliefs: &Beliefs<S, 2>,
    scoring: Scoring,
    peer: &Peer,
) {
    for (precision, posterior, tolerance) in
        [(1.0, &peer.posterior_1, 1e-4), (16.0, &peer.posterior_16, 1e-3)]
    {
        let problem = Problem::new(model, beliefs, candidates, Scoring { precision, ..scoring });
        let mut evaluation = Evaluation::<S, 2, 4, 4>::new();
        evaluation.evaluate(&problem).expect("there is room");
        let values = evaluation.terms().iter().map(|terms| -terms.expected_free_energy());
        assert_numbers("-G", values, &peer.value, 1e-4);
        assert_numbers(
            "posterior",
            evaluation.posterior().as_flattened().iter().copied(),
            posterior,
            tolerance,
        );
    }
}

#[test]
fn t1_agrees_with_jax_pymdp_by_its_conventions() {
    let peer = peers::jax_t1();
    let beliefs = assert_beliefs::<{ t1::S }>(t1(), Sweeps::JAX_PYMDP, &peer);
    assert_policies(t1(), &beliefs, Scoring::JAX_PYMDP, &peer);
}

#[test]
fn t1_agrees_with_numpy_pymdp_by_its_conventions() {
    let peer = peers::numpy_t1();
    let beliefs = assert_beliefs::<{ t1::S }>(t1(), Sweeps::NUMPY_PYMDP, &peer);
    assert_policies(t1(), &beliefs, Scoring::NUMPY_PYMDP, &peer);
}

#[test]
fn t2_agrees_with_jax_pymdp_by_its_conventions() {
    let peer = peers::jax_t2();
    let beliefs = assert_beliefs::<{ t2::S }>(t2(), Sweeps::JAX_PYMDP, &peer);
    assert_policies(t2(), &beliefs, Scoring::JAX_PYMDP, &peer);
}

/// Its policies are left out: numpy pymdp's joint gain of T2 has a floor of exp(-16) under every
/// outcome in it, which the core does not imitate.
#[test]
fn t2_has_the_beliefs_of_numpy_pymdp_by_its_conventions() {
    assert_beliefs::<{ t2::S }>(t2(), Sweeps::NUMPY_PYMDP, &peers::numpy_t2());
}

/// A result that T2's robots observe.
const NOTHING: usize = 0;
const SUCCESS: usize = 1;
const FAILURE: usize = 2;

type Grid = Beliefs<{ t2::S }, 2>;

/// The most likely cells and how the update went.
fn after(
    observed: [usize; 3],
    update: impl FnOnce(&mut Grid, &[Evidence]) -> Update,
) -> ([usize; 2], Update) {
    let mut beliefs = Grid::prior(&t2::MODEL);
    let update = update(&mut beliefs, &observed.map(Evidence::Outcome));
    ([0, 1].map(|robot| beliefs.most_likely(&t2::MODEL, robot).expect("there are two").0), update)
}

fn exactly(observed: [usize; 3]) -> ([usize; 2], Update) {
    after(observed, |beliefs, evidence| beliefs.update(&t2::MODEL, evidence).expect("it is possible"))
}

fn by_ascent(observed: [usize; 3]) -> ([usize; 2], Update) {
    after(observed, |beliefs, evidence| {
        beliefs.update_by_ascent(&t2::MODEL, evidence, MAX_SWEEPS).expect("it is possible")
    })
}

fn in_parallel(observed: [usize; 3], sweeps: Sweeps) -> ([usize; 2], Update) {
    after(observed, |beliefs, evidence| sweeps.update(beliefs, &t2::MODEL, evidence))
}

/// Whether a free energy is what a table of two decimals, some of them cut off, says.
fn reads(update: Update, free_energy: f64) -> bool {
    (f64::from(update.free_energy) - free_energy).abs() < 0.007
}

#[test]
fn observations_on_which_parallel_updates_oscillate_are_inferred_right() {
    // Observed; exact F; F of numpy and JAX pymdp and where they put the robots.
    let rows = [
        ([24, 25, FAILURE], 7.79, (40.06, 49.12), [0, 25]),
        ([25, 26, FAILURE], 7.88, (40.72, 46.19), [25, 0]),
    ];
    for (observed, free_energy, (numpy, jax), wrong) in rows {
        let right = [observed[0], observed[1]];
        let (cells, update) = exactly(observed);
        assert!(cells == right && update.exact && reads(update, free_energy), "{cells:?}, {update:?}");
        let (cells, update) = by_ascent(observed);
        assert!(cells == right && update.converged && reads(update, free_energy), "{cells:?}, {update:?}");
        for (sweeps, free_energy) in [(Sweeps::NUMPY_PYMDP, numpy), (Sweeps::JAX_PYMDP, jax)] {
            let (cells, update) = in_parallel(observed, sweeps);
            assert!(
                cells == wrong && !update.converged && reads(update, free_energy),
                "{cells:?}, {update:?}"
            );
        }
    }
}

#[test]
fn ordinary_observations_are_inferred_right_by_every_method() {
    for observed in [[24, 26, SUCCESS], [24, 24, FAILURE], [8, 36, NOTHING], [23, 26, NOTHING]] {
        let (cells, exact) = exactly(observed);
        for (others, update) in [
            by_ascent(observed),
            in_parallel(observed, Sweeps::NUMPY_PYMDP),
            in_parallel(observed, Sweeps::JAX_PYMDP),
        ] {
            assert_eq!(others, cells, "{observed:?}");
            assert!((update.free_energy - exact.free_energy).abs() < 0.005, "{update:?} and {exact:?}");
            assert!(update.converged);
        }
    }
}

#[test]
fn a_surprising_observation_is_bimodal_and_ascent_finds_one_mode() {
    let observed = [23, 25, FAILURE];
    let (cells, update) = exactly(observed);
    assert!(cells == [23, 24] && reads(update, 13.26), "{cells:?}, {update:?}");
    let (cells, update) = by_ascent(observed);
    assert!(cells == [24, 25] && update.converged && reads(update, 16.30), "{cells:?}, {update:?}");
    for (sweeps, free_energy) in [(Sweeps::NUMPY_PYMDP, 43.92), (Sweeps::JAX_PYMDP, 43.83)] {
        let (cells, update) = in_parallel(observed, sweeps);
        assert!(cells == [23, 25] && reads(update, free_energy), "{cells:?}, {update:?}");
    }
}
