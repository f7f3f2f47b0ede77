//! The choice of one robot in a team of several: exact over the product of all candidates while there is room for it,
//! pairwise beyond.

use super::candidates::{Candidates, Combinations};
use super::evaluation::Evaluation;
use super::model::MAX_FACTORS;
use super::policy::{Choice, Policy, Star};
use super::problem::Problem;

/// What one robot chooses, and how that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct JointChoice {
    /// The robot's own action sequence, by its number.
    pub choice: Choice,
    /// Whether all joint policies were weighed; otherwise the robot was paired with each teammate.
    pub exact: bool,
}

/// Decides for the robot whose action sequence is `control`, among the problem's candidates.
///
/// While all combinations have room in the evaluation they are all weighed, which is exact. Beyond that the robot is paired
/// with each teammate, as in the paper's section 6.1: p(π, π_1, ..., π_n) ∝ exp(own(π)) Π_k exp(peer_k(π_k) + pair_k(π, π_k)),
/// where a pair's part is what the modalities and encounters of the two robots alone bring; what three or more robots bring
/// about together is left out. That costs `n` evaluations of `R * R` pairs instead of one of `R^n` joint policies. A teammate that
/// has announced its policy has that one candidate, either way.
///
/// Listed combinations are always weighed as they are. `None` without candidates, when a pair has no room, or when robots are
/// coupled in motion so that the sequences do not move a group each.
pub fn decide<const S: usize, const G: usize, const R: usize, const P: usize>(
    evaluation: &mut Evaluation<S, G, R, P>,
    problem: &Problem<'_, S, G>,
    control: usize,
) -> Option<JointChoice> {
    let joint = problem.candidates.len();
    let listed = matches!(problem.candidates.combinations, Combinations::Listed(_));
    if listed || joint <= Evaluation::<S, G, R, P>::CAPACITY {
        evaluation.evaluate(problem);
        let choice = exactly(evaluation, problem, control)?;
        return Some(JointChoice { choice, exact: true });
    }
    let choice = pairwise(evaluation, problem, control)?;
    Some(JointChoice { choice, exact: false })
}

/// The most probable joint policy, and the mass of all that have the robot do the same.
fn exactly<const S: usize, const G: usize, const R: usize, const P: usize>(
    evaluation: &Evaluation<S, G, R, P>,
    problem: &Problem<'_, S, G>,
    control: usize,
) -> Option<Choice> {
    let best = evaluation.best()?;
    let posterior = evaluation.posterior();
    let policy = problem.candidates.sequence(best, control);
    let same = |joint: &usize| problem.candidates.sequence(*joint, control) == policy;
    let mass = |joint: usize| posterior.as_flattened().get(joint).copied().unwrap_or(0.0);
    let marginal: f32 = (0..evaluation.done()).filter(same).map(mass).sum();
    Some(Choice { policy, joint: mass(best), marginal: marginal.min(1.0) })
}

fn pairwise<const S: usize, const G: usize, const R: usize, const P: usize>(
    evaluation: &mut Evaluation<S, G, R, P>,
    problem: &Problem<'_, S, G>,
    own: usize,
) -> Option<Choice> {
    let model = problem.model;
    let count = problem.candidates.choices(own);
    let mut star: Option<Star<R>> = None;
    for teammate in (0..model.controls()).filter(|&control| control != own) {
        let (group, other) = (model.group_of_control(own)?, model.group_of_control(teammate)?);
        if group == other || count > R || problem.candidates.choices(teammate) > R {
            return None;
        }
        let mut sequences: [&[Policy]; MAX_FACTORS] = [&[]; MAX_FACTORS];
        for control in [own, teammate] {
            *sequences.get_mut(control)? = problem.candidates.sequences.get(control).copied().unwrap_or(&[]);
        }
        let candidates = Candidates { sequences: sequences.get(..model.controls())?, ..problem.candidates };
        let pair = Problem { candidates, scope: problem.scope & (1 << group | 1 << other), ..*problem };
        if candidates.len() > Evaluation::<S, G, R, P>::CAPACITY {
            return None;
        }
        evaluation.evaluate(&pair);
        let own_scores = own_scores(evaluation, &pair, own, group);
        let star = star.get_or_insert_with(|| Star::new(own_scores.into_iter().take(count)));
        let mut rows = [[f32::NEG_INFINITY; R]; R];
        for (joint, score) in evaluation.scores().iter().enumerate() {
            let at = [own, teammate].map(|control| candidates.sequence(joint, control));
            if let (Some(slot), Some(own)) =
                (rows.get_mut(at[0]).and_then(|row| row.get_mut(at[1])), own_scores.get(at[0]))
            {
                *slot = score - own;
            }
        }
        let width = candidates.choices(teammate);
        star.join(rows.iter().filter_map(|row| row.get(..width)));
    }
    star?.choose()
}

/// ln E - F - γ G of the robot's own part of each of its candidates.
fn own_scores<const S: usize, const G: usize, const R: usize, const P: usize>(
    evaluation: &Evaluation<S, G, R, P>,
    problem: &Problem<'_, S, G>,
    control: usize,
    group: usize,
) -> [f32; R] {
    let mut scores = [f32::NEG_INFINITY; R];
    for ((score, terms), sequence) in scores.iter_mut().zip(evaluation.own_terms(group)).zip(0..) {
        let value = -terms.expected_free_energy(problem.scoring.convention);
        let ln_prior = problem.candidates.habit_of(control, sequence);
        *score = problem.scoring.score(ln_prior, 0.0, value);
    }
    scores
}

#[cfg(test)]
mod tests {
    use super::super::{
        Beliefs, Evidence, Factor, IdentityNoise, Modality, Model, NextState, OutcomeTable, Scoring,
    };
    use super::*;

    const STATES: usize = 3;
    static MOTION: NextState = NextState::with_slip(&[0, 0, 0, 1, 1, 1, 2, 2, 2], STATES, 0.1);
    static SENSOR: IdentityNoise = IdentityNoise::new(0.8, STATES);
    static APART: OutcomeTable =
        OutcomeTable::new(&[&[0, 1, 2], &[0, 1, 2]], &[0, 1, 1, 1, 0, 1, 1, 1, 0], &[0.9, 0.1, 0.2, 0.8], 2);
    static FACTORS: [Factor; 4] = [
        Factor::new(&MOTION, MOTION.shape(), &[0.5, 0.3, 0.2]),
        Factor::new(&MOTION, MOTION.shape(), &[0.2, 0.3, 0.5]),
        Factor::new(&MOTION, MOTION.shape(), &[0.1, 0.8, 0.1]),
        Factor::new(&MOTION, MOTION.shape(), &[0.4, 0.4, 0.2]),
    ];
    static MODALITIES: [Modality; 7] = [
        Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 0.6, 0.0]),
        Modality::new(&SENSOR, SENSOR.shape(), &[1], &[0.0, 0.5, 0.2]),
        Modality::new(&SENSOR, SENSOR.shape(), &[2], &[0.4, 0.5, 0.0]),
        Modality::new(&SENSOR, SENSOR.shape(), &[3], &[0.1, 0.5, 0.3]),
        Modality::new(&APART, APART.shape(), &[0, 1], &[0.0, 1.0]),
        Modality::new(&APART, APART.shape(), &[0, 2], &[0.0, 1.0]),
        Modality::new(&APART, APART.shape(), &[0, 3], &[0.0, 1.0]),
    ];
    static MODEL: Model = Model::new(&FACTORS, &MODALITIES);

    fn places() -> [Policy; STATES] {
        [0, 1, 2].map(|place| Policy::new(&[place]).unwrap())
    }

    #[test]
    fn robots_that_only_meet_one_of_them_are_decided_exactly_by_pairs() {
        let places = places();
        let lists = [&places[..]; 4];
        let mut beliefs = Beliefs::<STATES, 4>::prior(&MODEL);
        beliefs.update(&MODEL, &[Evidence::Outcome(1), Evidence::Outcome(2)]).unwrap();
        let scoring = Scoring { precision: 2.0, ..Scoring::JAX_PYMDP };
        let problem = Problem::new(&MODEL, &beliefs, Candidates::all(&lists), scoring);

        let mut roomy = Evaluation::<STATES, 4, 3, 27>::new();
        let exact = decide(&mut roomy, &problem, 0).unwrap();
        let mut tight = Evaluation::<STATES, 4, 3, 3>::new();
        let pairwise = decide(&mut tight, &problem, 0).unwrap();

        assert!(exact.exact && !pairwise.exact);
        assert_eq!(exact.choice.policy, pairwise.choice.policy);
        assert!((exact.choice.joint - pairwise.choice.joint).abs() < 1e-5, "{exact:?} {pairwise:?}");
        assert!((exact.choice.marginal - pairwise.choice.marginal).abs() < 1e-5, "{exact:?} {pairwise:?}");
    }

    #[test]
    fn an_announced_intention_fixes_a_teammate() {
        let places = places();
        let beliefs = Beliefs::<STATES, 4>::prior(&MODEL);
        let mut evaluation = Evaluation::<STATES, 4, 3, 27>::new();
        let mut choose = |announced: &[Policy]| {
            let lists = [&places[..], announced, &places[2..], &places[2..]];
            let problem = Problem::new(&MODEL, &beliefs, Candidates::all(&lists), Scoring::JAX_PYMDP);
            decide(&mut evaluation, &problem, 0).unwrap().choice.policy
        };
        assert_eq!((choose(&places[1..2]), choose(&places[..1])), (0, 1));
    }

    #[test]
    fn what_has_no_room_is_not_decided() {
        let places = places();
        let lists = [&places[..]; 4];
        let beliefs = Beliefs::<STATES, 4>::prior(&MODEL);
        let problem = Problem::new(&MODEL, &beliefs, Candidates::all(&lists), Scoring::JAX_PYMDP);
        assert_eq!(decide(&mut Evaluation::<STATES, 4, 2, 4>::new(), &problem, 0), None);
        assert_eq!(
            decide(
                &mut Evaluation::<STATES, 3, 3, 27>::new(),
                &Problem::new(
                    &MODEL,
                    &Beliefs::<STATES, 3>::prior(&MODEL),
                    Candidates::all(&lists),
                    Scoring::JAX_PYMDP
                ),
                0
            ),
            None
        );
    }
}
