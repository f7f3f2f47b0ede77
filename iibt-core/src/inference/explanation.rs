//! Explanations of a choice: the terms of a policy by step and modality, and its lead over another.

use super::belief::Beliefs;
use super::error::{Argument, OutOfRange, below};
use super::evaluation::{PreferredModality, action_of, arrival, normalisers};
use super::free_energy::{Gain, PreferenceTiming, Terms};
use super::gain;
use super::model::MAX_MODALITIES;
use super::problem::Problem;

/// One contribution to the value of a joint policy.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Contribution {
    /// The step, from one.
    pub step: usize,
    /// Its source.
    pub source: Source,
    /// Its terms, in nats.
    pub terms: Terms,
}

/// The source of a contribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Source {
    /// A modality, by its number.
    Modality(usize),
    /// All modalities together: the information gain, where it is found jointly.
    Jointly,
    /// A preference for a pair of factors, by its number.
    PairPreference(usize),
    /// The moves: the information that they give about B while it is learned.
    Motion,
}

/// Rolls out one joint policy by itself and calls `visit` with every contribution to its value,
/// step by step.
///
/// The contributions add up to the policy's [`Terms`] in an [`Evaluation`](super::Evaluation), but
/// for the rounding of sums in another order. Costs one rollout, whatever the number of policies,
/// and memory for three lists of beliefs.
///
/// # Errors
/// [`OutOfRange`] when the problem does not fit its model or there is no such policy.
///
/// ```
/// use iibt_core::inference::explanation::trace;
/// use iibt_core::inference::{
///     Beliefs, Candidates, Factor, IdentityNoise, Modality, Model, NextState, Policy, Problem,
///     Scoring, Terms,
/// };
///
/// # static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 3);
/// # static MOVES: NextState = NextState::new(&[0, 0, 1, 1, 2, 2], 3);
/// # static FACTORS: [Factor; 1] = [Factor::new(&MOVES, MOVES.shape(), &[0.0, 1.0, 0.0])];
/// # static MODALITIES: [Modality; 1] =
/// #     [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 0.0, 2.0])];
/// # static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
/// static POLICIES: [Policy; 1] = [Policy::of(&[1, 0])]; // right, and back
/// static CANDIDATES: Candidates = Candidates::all(&[&POLICIES]);
/// let beliefs = Beliefs::<3, 1>::prior(&MODEL);
/// let problem = Problem::new(&MODEL, &beliefs, CANDIDATES, Scoring::JAX_PYMDP);
/// let mut steps = [Terms::ZERO; 2];
/// trace(&problem, 0, |part| steps[part.step - 1] += part.terms)?;
/// assert!(steps[0].utility > steps[1].utility); // the goal is on the right
/// # Ok::<(), iibt_core::inference::OutOfRange>(())
/// ```
pub fn trace<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
    policy: usize,
    mut visit: impl FnMut(Contribution),
) -> Result<(), OutOfRange> {
    problem.check()?;
    below(Argument::Policy, 0, policy, problem.candidates.len())?;
    let mut beliefs = *problem.beliefs;
    for step in 1..=problem.horizon {
        visit_pairs(problem, &beliefs, Some((policy, step)), step, &mut visit);
        let novelty = advance(problem, &mut beliefs, policy, step);
        visit(Contribution { step, source: Source::Motion, terms: Terms { novelty, ..Terms::ZERO } });
        visit_pairs(problem, &beliefs, None, step, &mut visit);
        observe(problem, &beliefs, policy, step, &mut visit);
    }
    Ok(())
}

/// Visits the preferences for pairs of factors, before a step of a policy or after it.
fn visit_pairs<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
    beliefs: &Beliefs<S, G>,
    departing: Option<(usize, usize)>,
    step: usize,
    visit: &mut impl FnMut(Contribution),
) {
    for (number, pair) in problem.pair_preferences.iter().enumerate() {
        let factors = pair.factors();
        if factors.iter().any(|&factor| problem.scope >> problem.model.group(factor) & 1 == 0) {
            continue;
        }
        let parts = factors.map(|factor| beliefs.part(problem.model, factor));
        let utility = match departing {
            Some((policy, step)) => {
                pair.departing(parts, factors.map(|factor| action_of(problem, factor, policy, step - 1)))
            }
            None => pair.arrived(parts),
        };
        let terms = Terms { utility, ..Terms::ZERO };
        visit(Contribution { step, source: Source::PairPreference(number), terms });
    }
}

/// Moves every group in scope by one step; returns the novelty of the moves.
fn advance<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
    beliefs: &mut Beliefs<S, G>,
    policy: usize,
    step: usize,
) -> f32 {
    let (model, before) = (problem.model, *beliefs);
    let mut novelty = 0.0;
    for factor in 0..model.factors().len() {
        if problem.scope >> model.group(factor) & 1 == 1
            && let Some(action) = action_of(problem, factor, policy, step - 1)
        {
            let to = model.part_mut(beliefs.as_flat_mut(), factor);
            novelty += model.move_factor(factor, action, before.as_flat(), to);
        }
    }
    novelty
}

fn observe<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
    beliefs: &Beliefs<S, G>,
    policy: usize,
    step: usize,
    visit: &mut impl FnMut(Contribution),
) {
    let row = problem.candidates.row(policy);
    let mut observed = 0;
    let normalisers = normalisers(problem);
    for ((number, modality, groups), normalisers) in problem.modalities().zip(normalisers) {
        let members = (0..u16::BITS as usize).filter(|group| groups >> group & 1 == 1);
        let first = members.map(|group| usize::from(arrival(problem, group, &row))).min();
        let arrives = first == Some(step);
        if problem.scoring.timing == PreferenceTiming::OnArrival && !groups.is_power_of_two() && !arrives {
            continue;
        }
        observed |= 1 << number;
        let sense = PreferredModality::new(problem, number, modality, normalisers);
        let parts = problem.model.parts(beliefs.as_flat(), modality.factors());
        let terms = sense.expect(parts.as_slice(), arrives);
        visit(Contribution { step, source: Source::Modality(number), terms });
    }
    if problem.scoring.gain == Gain::Joint {
        let gains = gain::components(problem.model, observed);
        let information_gain = gains.map(|component| gain::of(&component, beliefs)).sum();
        let terms = Terms { information_gain, ..Terms::ZERO };
        visit(Contribution { step, source: Source::Jointly, terms });
    }
}

/// The explanation of a choice against another joint policy: the source of the largest part of the
/// lead.
///
/// ```
/// use iibt_core::inference::explanation::{Explanation, Source};
/// use iibt_core::inference::{
///     Beliefs, Candidates, Factor, IdentityNoise, Modality, Model, NextState, Policy, Problem,
///     Scoring,
/// };
///
/// # static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 3);
/// # static MOVES: NextState = NextState::new(&[0, 0, 1, 1, 2, 2], 3);
/// # static FACTORS: [Factor; 1] = [Factor::new(&MOVES, MOVES.shape(), &[0.0, 1.0, 0.0])];
/// # static MODALITIES: [Modality; 1] =
/// #     [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 0.0, 2.0])];
/// # static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
/// # static POLICIES: [Policy; 2] = [Policy::of(&[0]), Policy::of(&[1])];
/// # static CANDIDATES: Candidates = Candidates::all(&[&POLICIES]);
/// let beliefs = Beliefs::<3, 1>::prior(&MODEL);
/// let problem = Problem::new(&MODEL, &beliefs, CANDIDATES, Scoring::DEFAULT);
/// // Why right, and not left?
/// let why = Explanation::of(&problem, 1, 0)?;
/// assert_eq!(why.decided_by.0, Source::Modality(0));
/// assert!(why.lead > 1.5 && why.chosen.utility > why.other.utility);
/// # Ok::<(), iibt_core::inference::OutOfRange>(())
/// ```
#[doc(alias = "interpretability")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Explanation {
    /// The terms of the chosen policy.
    pub chosen: Terms,
    /// The terms of the other.
    pub other: Terms,
    /// The deciding source, and its part of the lead in -G, in nats.
    pub decided_by: (Source, f32),
    /// The lead of the chosen policy in -G, in nats; negative where its prior decided.
    pub lead: f32,
}

impl Explanation {
    /// Compares two joint policies of a problem. Costs two rollouts and `4 * MAX_MODALITIES` bytes.
    ///
    /// # Errors
    /// [`OutOfRange`] when the problem does not fit its model or there is no such policy.
    pub fn of<const S: usize, const G: usize>(
        problem: &Problem<'_, S, G>,
        chosen: usize,
        other: usize,
    ) -> Result<Self, OutOfRange> {
        let mut leads =
            Leads { modalities: [0.0; MAX_MODALITIES], jointly: 0.0, pair_preferences: 0.0, motion: 0.0 };
        let mut terms = [Terms::ZERO; 2];
        for ((policy, sign), sum) in [(chosen, 1.0), (other, -1.0)].into_iter().zip(&mut terms) {
            trace(problem, policy, |part| {
                *sum += part.terms;
                *leads.of(part.source) -= sign * part.terms.expected_free_energy();
            })?;
        }
        let [chosen, other] = terms;
        let lead = other.expected_free_energy() - chosen.expected_free_energy();
        Ok(Self { chosen, other, decided_by: leads.largest(), lead })
    }
}

/// The lead in -G that each source gives one policy over another.
struct Leads {
    modalities: [f32; MAX_MODALITIES],
    jointly: f32,
    pair_preferences: f32,
    motion: f32,
}

impl Leads {
    fn of(&mut self, source: Source) -> &mut f32 {
        match source {
            Source::Modality(number) => self.modalities.get_mut(number).unwrap_or(&mut self.motion),
            Source::Jointly => &mut self.jointly,
            Source::PairPreference(_) => &mut self.pair_preferences,
            Source::Motion => &mut self.motion,
        }
    }

    /// The source of the largest lead; the first of equals.
    fn largest(&self) -> (Source, f32) {
        let modalities =
            self.modalities.iter().enumerate().map(|(number, lead)| (Source::Modality(number), *lead));
        let others = [
            (Source::Jointly, self.jointly),
            (Source::PairPreference(0), self.pair_preferences),
            (Source::Motion, self.motion),
        ];
        let first = (Source::Modality(0), f32::NEG_INFINITY);
        modalities.chain(others).fold(first, |best, next| if next.1 > best.1 { next } else { best })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{
        Beliefs, Candidates, Evaluation, Factor, IdentityNoise, Modality, Model, NextState, OutcomeTable,
        Policy, Scoring,
    };
    use super::*;

    static MOTION: NextState = NextState::with_slip(&[0, 0, 0, 1, 1, 1, 2, 2, 2], 3, 0.1);
    static SENSOR: IdentityNoise = IdentityNoise::new(0.8, 3);
    static APART: OutcomeTable =
        OutcomeTable::new(&[&[0, 1, 2], &[0, 1, 2]], &[0, 1, 1, 1, 0, 1, 1, 1, 0], &[0.9, 0.1, 0.2, 0.8], 2);
    static FACTORS: [Factor; 2] = [Factor::new(&MOTION, MOTION.shape(), &[0.5, 0.3, 0.2]); 2];
    static MODALITIES: [Modality; 3] = [
        Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 0.6, 0.0]),
        Modality::new(&SENSOR, SENSOR.shape(), &[1], &[0.0, 0.6, 0.2]),
        Modality::new(&APART, APART.shape(), &[0, 1], &[0.0, 3.0]),
    ];
    static MODEL: Model = Model::new(&FACTORS, &MODALITIES);

    fn lists() -> [[Policy; 3]; 2] {
        [[0, 1, 2].map(|place| Policy::new(&[place, place]).unwrap()); 2]
    }

    #[test]
    fn the_contributions_of_a_policy_add_up_to_its_terms() {
        let (lists, beliefs) = (lists(), Beliefs::<3, 2>::prior(&MODEL));
        let lists = lists.each_ref().map(|list| list.as_slice());
        for scoring in [Scoring::DEFAULT, Scoring::JAX_PYMDP, Scoring::NUMPY_PYMDP] {
            let problem = Problem::new(&MODEL, &beliefs, Candidates::all(&lists), scoring);
            let mut evaluation = Evaluation::<3, 2, 3, 3>::new();
            evaluation.evaluate(&problem).unwrap();
            for (policy, terms) in evaluation.terms().iter().enumerate() {
                let mut sum = Terms::ZERO;
                trace(&problem, policy, |part| sum += part.terms).unwrap();
                let close = |a: f32, b: f32| (a - b).abs() < 1e-5;
                assert!(close(sum.utility, terms.utility) && close(sum.ambiguity, terms.ambiguity));
                assert!(close(sum.information_gain, terms.information_gain), "{sum:?} against {terms:?}");
            }
        }
    }

    #[test]
    fn the_modality_that_set_a_policy_apart_is_named() {
        let (lists, beliefs) = (lists(), Beliefs::<3, 2>::prior(&MODEL));
        let lists = lists.each_ref().map(|list| list.as_slice());
        let problem = Problem::new(&MODEL, &beliefs, Candidates::all(&lists), Scoring::JAX_PYMDP);
        // Places 1 and 2 instead of both on 1: they are apart, which modality 2 is about.
        let apart = Explanation::of(&problem, 5, 4).unwrap();
        assert_eq!(apart.decided_by.0, Source::Modality(2));
        assert!(apart.lead > 0.0 && apart.decided_by.1 > apart.lead / 2.0, "{apart:?}");
        // Robot 1 on place 1 instead of 0, robot 2 elsewhere: what robot 1 itself would like to
        // see.
        assert_eq!(Explanation::of(&problem, 5, 2).unwrap().decided_by.0, Source::Modality(0));
        assert_eq!(Explanation::of(&problem, 5, 5).unwrap().lead, 0.0);
    }
}
