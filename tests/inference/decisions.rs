//! Expected free energies and the choice of a joint policy.

use crate::{Room, Trial, close, for_seeds, marginals};
use iibt_core::inference::{Gain, Terms};
use tests::oracle::decision::Decision;
use tests::oracle::evaluation::Reference;
use tests::oracle::{generator, softmax};

/// What the core makes of a decision.
struct Judged {
    terms: Vec<Terms>,
    scores: Vec<f32>,
    posterior: Vec<f32>,
    best: Option<usize>,
}

fn judge(problem: &iibt_core::inference::Problem<'_, 6, 4>) -> Judged {
    let mut trial = Trial::new();
    trial.evaluate(problem);
    let count = trial.done();
    Judged {
        terms: trial.terms().to_vec(),
        scores: trial.scores().to_vec(),
        posterior: trial.posterior().as_flattened()[..count].to_vec(),
        best: trial.best(),
    }
}

/// The posterior over policies: the softmax of their scores, without those too far below the best.
fn posterior(scores: &[f64], window: f64) -> Vec<f64> {
    let best = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let kept: Vec<f64> =
        scores.iter().map(|&score| if score < best - window { f64::NEG_INFINITY } else { score }).collect();
    softmax(&kept)
}

fn assert_posterior(ours: &[f32], scores: &[f32], decision: &Decision) {
    let scores: Vec<f64> = scores.iter().copied().map(f64::from).collect();
    let reference = posterior(&scores, decision.scoring.window.into());
    for (policy, (ours, reference)) in ours.iter().zip(&reference).enumerate() {
        assert!((f64::from(*ours) - reference).abs() < 1e-5, "policy {policy}: {ours} against {reference}");
    }
}

#[test]
fn the_factored_terms_of_every_joint_policy_equal_brute_force() {
    for_seeds(11, 12_000, |chance| {
        let description = generator::description(chance);
        let decision = generator::decision(chance, &description);
        if too_long(&description, &decision) {
            return;
        }
        description.build(|model| {
            let beliefs = Room::prior(model);
            let reference = Reference::new(&description, &decision);
            let exact = marginals(&beliefs, model);
            let judged = decision.pose(model, &beliefs, judge);
            let policies = decision.policies();
            assert_eq!(judged.terms.len(), policies.len());
            for (number, (policy, terms)) in policies.iter().zip(&judged.terms).enumerate() {
                let sums = reference.terms(&exact, &decision.actions(policy));
                let same = |ours: f32, reference: f64| close(ours, reference, 1e-4);
                assert!(same(terms.utility, sums.utility), "{number} of {decision:?}: {terms:?}, {sums:?}");
                assert!(
                    same(terms.information_gain, sums.information_gain),
                    "{number} of {decision:?}: {terms:?}, {sums:?}"
                );
                assert!(same(terms.ambiguity, sums.ambiguity), "{number}: {terms:?}, {sums:?}");
                assert!(same(terms.risk(), sums.risk), "{number}: {terms:?}, {sums:?}");
                let value = sums.value(decision.scoring.convention);
                assert!(same(-terms.expected_free_energy(decision.scoring.convention), value));
                let gamma = f64::from(decision.scoring.precision);
                let score = decision.ln_prior(number, policy) + gamma * value;
                let slack = 1e-4 * (gamma * value.abs().max(1.0) + 1.0);
                assert!((f64::from(judged.scores[number]) - score).abs() < slack);
            }
            assert_posterior(&judged.posterior, &judged.scores, &decision);
            assert_eq!(judged.best, (!policies.is_empty()).then(|| iibt_core::math::argmax(&judged.scores)));
        });
    });
}

/// Whether the joint gain would be enumerated for too long.
fn too_long(description: &tests::oracle::description::Description, decision: &Decision) -> bool {
    let states: usize = description.states().iter().product();
    let outcomes: usize = description.modalities.iter().map(|sense| sense.outcomes).product();
    let steps = decision.policies().len() * decision.horizon;
    decision.scoring.gain == Gain::Joint && states * outcomes * steps > 40_000
}
