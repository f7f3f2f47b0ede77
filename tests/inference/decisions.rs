//! Expected free energies and the choice of a joint policy.

use super::{Room, Trial, close, for_seeds, marginals};
use iibt_core::inference::{
    Agent, Beliefs, Candidates, Evaluation, Factor, Gain, Likelihood, Modality, Model, Policy,
    PreferenceTiming, Problem, Scoring, Shape, Terms, Transition, policy,
};
use tests::oracle::decision::Decision;
use tests::oracle::description::Description;
use tests::oracle::evaluation::Reference;
use tests::oracle::generator::{FACTORS, STATES};
use tests::oracle::{generator, softmax};

/// What the core makes of a decision.
struct Judged {
    terms: Vec<Terms>,
    scores: Vec<f32>,
    posterior: Vec<f32>,
    best: Option<usize>,
}

fn judge(problem: &Problem<'_, STATES, FACTORS>) -> Judged {
    let mut trial = Trial::new();
    trial.evaluate(problem).expect("it fits");
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
                let value = sums.value();
                assert!(same(-terms.expected_free_energy(), value));
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
pub(crate) fn too_long(description: &Description, decision: &Decision) -> bool {
    let states: usize = description.states().iter().product();
    let outcomes: usize = description.modalities.iter().map(|sense| sense.outcomes).product();
    let steps = decision.policies().len() * decision.horizon;
    decision.scoring.gain == Gain::Joint && states * outcomes * steps > 40_000
}

#[test]
fn risk_and_ambiguity_are_minus_utility_and_information_gain() {
    for_seeds(12, 4000, |chance| {
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
            for (policy, terms) in decision.policies().iter().zip(&judged.terms) {
                // The risk from its definition, a divergence, and not by way of the identity.
                let risk = reference.terms(&exact, &decision.actions(policy)).risk;
                let g = risk + f64::from(terms.ambiguity);
                assert!(close(-(terms.utility + terms.information_gain), g, 1e-4), "{terms:?}, risk {risk}");
                assert!(close(terms.expected_free_energy(), g, 1e-4));
            }
        });
    });
}

/// The information gain of every joint policy.
fn gains(description: &Description, decision: &Decision) -> Vec<f32> {
    description.build(|model| {
        let beliefs = Room::prior(model);
        decision.pose(model, &beliefs, judge).terms.iter().map(|terms| terms.information_gain).collect()
    })
}

#[test]
fn information_gain_is_never_negative_and_the_joint_gain_lies_between_the_largest_and_the_sum() {
    for_seeds(13, 4000, |chance| {
        let description = generator::description(chance);
        let mut decision = generator::decision(chance, &description);
        decision.scoring.timing = PreferenceTiming::EveryStep;
        decision.scoring.gain = Gain::Joint;
        if too_long(&description, &decision) {
            return;
        }
        decision.meetings.clear();
        (decision.preferences, decision.negative_preferences) = (vec![], vec![]);
        let joint = gains(&description, &decision);
        decision.scoring.gain = Gain::PerModality;
        let sum = gains(&description, &decision);
        let alone: Vec<Vec<f32>> = description
            .modalities
            .iter()
            .map(|sense| {
                gains(&Description { modalities: vec![sense.clone()], ..description.clone() }, &decision)
            })
            .collect();
        for (policy, (&joint, &sum)) in joint.iter().zip(&sum).enumerate() {
            let slack = 1e-4 * sum.abs().max(1.0);
            assert!(alone.iter().all(|gains| gains[policy] >= -slack), "{alone:?}");
            // Every outcome alone tells no more than all together; given the states outcomes are
            // independent, so all together tell no more than the sum.
            assert!(alone.iter().all(|gains| gains[policy] <= joint + slack), "{alone:?} {joint}");
            assert!(joint <= sum + slack, "{joint} of {sum}");
        }
    });
}

#[test]
fn the_posterior_is_the_softmax_of_the_scores_inside_the_window() {
    for_seeds(14, 4000, |chance| {
        let count = chance.within(1, 20);
        let scores: Vec<f32> = (0..count)
            .map(|_| if chance.once_in(6) { f32::NEG_INFINITY } else { chance.between(-40.0, 40.0) })
            .collect();
        let window = chance.pick(&[f32::INFINITY, 30.0, 3.0, 0.0]);
        let mut ours = scores.clone();
        policy::posterior(&mut ours, window);
        let best = scores.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        if best == f32::NEG_INFINITY {
            return assert!(ours.iter().all(|&p| p == 0.0));
        }
        let wide: Vec<f64> = scores.iter().map(|&score| score.into()).collect();
        for (policy, (&p, reference)) in ours.iter().zip(posterior(&wide, window.into())).enumerate() {
            assert!(close(p, reference, 1e-6), "policy {policy}: {p} against {reference}");
            assert!(p == 0.0 || scores[policy] >= best - window);
        }
    });
}

#[test]
fn a_sample_is_drawn_as_often_as_its_probability_says() {
    for_seeds(15, 2000, |chance| {
        let count = chance.within(1, 8);
        let posterior = chance.distribution(count);
        const DRAWS: usize = 4096;
        let mut drawn = vec![0; count];
        for draw in 0..DRAWS {
            drawn[policy::sample(&posterior, (draw as f32 + 0.5) / DRAWS as f32)] += 1;
        }
        for (policy, (&times, &p)) in drawn.iter().zip(&posterior).enumerate() {
            assert!((times as f32 / DRAWS as f32 - p).abs() < 1.1 / DRAWS as f32, "{policy}: {times} of {p}");
            assert!(p > 0.0 || times == 0);
        }
        for u in [-1.0, 1.0, 7.0, f32::NAN, f32::INFINITY] {
            assert!(posterior[policy::sample(&posterior, u)] > 0.0);
        }
    });
}

/// A transition and a likelihood that are being learned, and say how much there is to learn.
struct Learned;

impl Transition for Learned {
    fn probability(&self, _: u8, next: usize, states: &[usize]) -> f32 {
        f32::from(u8::from(states == [next]))
    }

    fn novelty(&self, _: &Shape, action: u8, beliefs: &[&[f32]]) -> f32 {
        f32::from(action) * beliefs[0][0]
    }
}

impl Likelihood for Learned {
    fn probability(&self, outcome: usize, states: &[usize]) -> f32 {
        f32::from(u8::from(states == [outcome]))
    }

    fn novelty(&self, _: &Shape, beliefs: &[&[f32]]) -> f32 {
        0.5 * beliefs[0][1]
    }
}

#[test]
fn novelty_of_moves_and_outcomes_adds_up_over_the_steps_and_lowers_g() {
    let shape = Shape::new(2, &[2]).expect("it fits");
    let factors = [Factor::new(&Learned, shape, &[0.25, 0.75])];
    let modalities = [Modality::new(&Learned, shape, &[0], &[0.0, 0.0])];
    let model = Model::new(&factors, &modalities);
    let beliefs = Beliefs::<2, 1>::prior(&model);
    let policies = [Policy::new(&[2, 0, 1]).expect("it is short"), Policy::EMPTY];
    let sequences = [&policies[..]];
    let problem = Problem::new(&model, &beliefs, Candidates::all(&sequences), Scoring::DEFAULT);
    let mut evaluation = Evaluation::<2, 1, 2, 1>::new();
    evaluation.evaluate(&problem).expect("there is room");
    let [busy, idle] = [0, 1].map(|policy| evaluation.terms()[policy]);
    assert_eq!(busy.novelty, 3.0 * 0.25 + 3.0 * 0.5 * 0.75);
    assert_eq!(idle.novelty, 3.0 * 0.5 * 0.75);
    let gained = idle.expected_free_energy() - busy.expected_free_energy();
    assert!((gained - 0.75).abs() < 1e-6, "{gained}");
}

/// The joint decision against brute force: every joint policy with its habit, those that teammates
/// ruled out left out.
#[test]
fn an_agent_decides_as_brute_force_does_with_habits_and_announcements() {
    for_seeds(16, 6000, |chance| {
        let description = generator::description(chance);
        let mut decision = generator::decision(chance, &description);
        if too_long(&description, &decision) || description.controls() == 0 {
            return;
        }
        // What an agent has no word for.
        (decision.meetings, decision.scope) = (vec![], description.all_groups());
        let policies = decision.policies();
        let spoken = policies[chance.below(policies.len())].clone();
        let announced: Vec<Option<u16>> =
            spoken.iter().map(|&number| chance.once_in(3).then_some(u16::from(number))).collect();
        description.build(|model| {
            let reference = Reference::new(&description, &decision);
            let exact = marginals(&Room::prior(model), model);
            let score = |(number, policy): (usize, &Vec<u8>)| {
                let fits = announced
                    .iter()
                    .zip(policy)
                    .all(|(said, &number)| said.is_none_or(|said| said == u16::from(number)));
                let value = reference.terms(&exact, &decision.actions(policy)).value();
                let ln_prior = decision.ln_prior(number, policy);
                if fits {
                    ln_prior + f64::from(decision.scoring.precision) * value
                } else {
                    f64::NEG_INFINITY
                }
            };
            let scores: Vec<f64> = policies.iter().enumerate().map(score).collect();
            let mut agent = Agent::<STATES, FACTORS, 5, 7>::new(model)
                .with_scoring(decision.scoring)
                .with_horizon(decision.horizon);
            decision.pose(model, &Room::prior(model), |problem| {
                let candidates = problem.candidates.with_announced(&announced);
                let (preferences, negative) = (problem.preferences, problem.negative_preferences);
                let chosen = agent.decide_with(candidates, preferences, negative).expect("one was announced");
                let best = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let slack = 2e-4 * (best.abs() + f64::from(decision.scoring.precision) + 1.0);
                assert!(scores[chosen.policy()] >= best - slack, "{scores:?}: {}", chosen.policy());
                for (control, &number) in policies[chosen.policy()].iter().enumerate() {
                    assert_eq!(chosen.sequence(control), usize::from(number));
                    let marginal = agent.marginal(&candidates, control, number.into()).expect("it exists");
                    assert!(marginal >= chosen.probability() - 1e-6, "{marginal}");
                }
                let sum: f32 = agent.posterior().iter().sum();
                assert!((sum - 1.0).abs() < 1e-5);
                for (p, score) in agent.posterior().iter().zip(&scores) {
                    assert!(*score > f64::NEG_INFINITY || *p == 0.0, "what is not as announced is ruled out");
                }
            });
        });
    });
}
