//! The expected free energy of joint policies, factored and in batches.
//!
//! G of a joint policy is the sum of each group's own part and of parts that couple groups. Each
//! group's candidates are rolled out once, all in step; only the coupled modalities are looked at
//! combination by combination. For two robots with `R` candidates each and `T` steps that is `2 R
//! T` predictions instead of `2 R R T`.

mod actions;
mod group;
mod preferred_modality;
mod rows;

pub(super) use self::actions::{action_of, arrival};
pub(super) use self::preferred_modality::{Normalisers, PreferredModality, normalisers};

use self::actions::{bits, key, only_control};
use self::group::{Group, Places, Rollout};
use self::rows::{Rows, Tuples};
use super::belief::Beliefs;
use super::candidates::JointPolicy;
use super::error::{Argument, OutOfRange, at_most};
use super::free_energy::{Gain, Terms};
use super::gain;
use super::model::{Model, Parts};
use super::policy;
use super::problem::Problem;
use crate::bounded::up_to;
use crate::math;
use core::ops::Range;

/// The numbers of joint policies that are rolled out side by side.
type Batch = Range<usize>;

/// An evaluation under way, and its results so far.
///
/// `S` and `G` are those of the [`Beliefs`], `R` is the most candidates of one group that are
/// rolled out side by side, and there is room for `R * P` joint policies. Memory is about `4 S G R
/// + 24 G R + 36 R P` bytes.
///
/// ```
/// use iibt_core::inference::{
///     Beliefs, Candidates, Evaluation, Factor, IdentityNoise, Modality, Model, NextState, Policy,
///     Problem, Scoring,
/// };
///
/// # static SENSOR: IdentityNoise = IdentityNoise::new(0.9, 3);
/// # static MOVES: NextState = NextState::new(&[0, 0, 1, 1, 2, 2], 3);
/// # static FACTORS: [Factor; 1] = [Factor::new(&MOVES, MOVES.shape(), &[0.0, 1.0, 0.0])];
/// # static MODALITIES: [Modality; 1] =
/// #     [Modality::new(&SENSOR, SENSOR.shape(), &[0], &[0.0, 0.0, 2.0])];
/// # static MODEL: Model = Model::new(&FACTORS, &MODALITIES);
/// // Left and right in a corridor of three cells, from the middle, with the goal on the right.
/// static POLICIES: [Policy; 2] = [Policy::of(&[0]), Policy::of(&[1])];
/// static CANDIDATES: Candidates = Candidates::all(&[&POLICIES]);
/// let beliefs = Beliefs::<3, 1>::prior(&MODEL);
/// let problem = Problem::new(&MODEL, &beliefs, CANDIDATES, Scoring::DEFAULT);
/// let mut evaluation = Evaluation::<3, 1, 2, 1>::new();
/// evaluation.begin(&problem)?;
/// assert_eq!(evaluation.best(), None);
/// let mut ticks = 0;
/// while evaluation.advance(&problem, 1) {
///     ticks += 1; // one policy a tick
/// }
/// assert_eq!((ticks, evaluation.done(), evaluation.best()), (1, 2, Some(1)));
/// assert!(evaluation.posterior()[0][1] > 0.99);
/// # Ok::<(), iibt_core::inference::OutOfRange>(())
/// ```
#[doc(alias = "policy inference")]
#[derive(Clone, Debug)]
pub struct Evaluation<const S: usize, const G: usize, const R: usize, const P: usize> {
    /// The predicted beliefs: in row `r`, each group's `r`-th candidate.
    rows: [Beliefs<S, G>; R],
    groups: [Group<R>; G],
    /// The row of each group's candidate, for each joint policy.
    places: [[Places<G>; R]; P],
    terms: [[Terms; R]; P],
    /// Terms of combinations of the groups that one coupled modality depends on.
    combinations: [[Terms; R]; P],
    scores: [[f32; R]; P],
    done: u16,
    /// The joint policies of the problem that was begun with.
    total: u16,
    window: f32,
}

impl<const S: usize, const G: usize, const R: usize, const P: usize> Evaluation<S, G, R, P> {
    /// The number of joint policies that fit.
    pub const CAPACITY: usize = R * P;

    /// An evaluation not yet begun; usable in a `static`.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(R > 0 && P > 0 && R <= u8::MAX as usize && R * P <= u16::MAX as usize) }
        Self {
            rows: [Beliefs::EMPTY; R],
            groups: [Group::EMPTY; G],
            places: [[[0; G]; R]; P],
            terms: [[Terms::ZERO; R]; P],
            combinations: [[Terms::ZERO; R]; P],
            scores: [[f32::NEG_INFINITY; R]; P],
            done: 0,
            total: 0,
            window: f32::INFINITY,
        }
    }

    /// Discards all results and begins with `problem`, which is checked as a whole.
    ///
    /// # Errors
    /// [`OutOfRange`] when the problem does not fit its model, or has more joint policies than the
    /// [`CAPACITY`](Self::CAPACITY). Nothing can be scored then.
    pub fn begin(&mut self, problem: &Problem<'_, S, G>) -> Result<(), OutOfRange> {
        self.forget(problem);
        problem.check()?;
        at_most(Argument::Policies, 0, problem.candidates.len(), Self::CAPACITY)?;
        // There is room for this many, and not for more than a `u16` counts.
        self.total = problem.candidates.len() as u16;
        Ok(())
    }

    fn forget(&mut self, problem: &Problem<'_, S, G>) {
        (self.done, self.total) = (0, 0);
        self.groups.iter_mut().for_each(|group| group.used = 0);
        self.window = problem.scoring.window;
        self.scores = [[f32::NEG_INFINITY; R]; P];
    }

    /// Scores up to `count` more joint policies; returns whether there are more.
    ///
    /// The problem must be the one that was begun with. Costs at most `count` rollouts of each
    /// group and `count` predictions of each coupled modality per step; candidates that joint
    /// policies have in common are rolled out once, `R` at a time.
    pub fn advance(&mut self, problem: &Problem<'_, S, G>, count: usize) -> bool {
        let until = self.done().saturating_add(count).min(usize::from(self.total));
        while self.done() < until {
            let batch = self.gather(problem, self.done()..until);
            self.roll_out(problem, &batch);
            self.score(problem, &batch);
            self.done = batch.end as u16;
        }
        self.done < self.total
    }

    /// Scores all joint policies.
    ///
    /// # Errors
    /// As [`begin`](Self::begin).
    pub fn evaluate(&mut self, problem: &Problem<'_, S, G>) -> Result<(), OutOfRange> {
        self.begin(problem)?;
        while self.advance(problem, Self::CAPACITY) {}
        Ok(())
    }

    /// The number of joint policies scored so far.
    #[must_use]
    pub const fn done(&self) -> usize {
        self.done as usize
    }

    /// The terms of the joint policies scored so far, summed over modalities and steps.
    #[must_use]
    pub fn terms(&self) -> &[Terms] {
        self.terms.as_flattened().get(..self.done()).unwrap_or(&[])
    }

    /// ln E - F - γ G of the joint policies scored so far: their log posterior up to a constant.
    #[must_use]
    pub fn scores(&self) -> &[f32] {
        self.scores.as_flattened().get(..self.done()).unwrap_or(&[])
    }

    /// The most probable joint policy scored so far, the first of equals; `None` while there is
    /// none that can be chosen: one that is ruled out, or has a score that is no number, cannot.
    #[must_use]
    pub fn best(&self) -> Option<usize> {
        let best = math::argmax(self.scores());
        self.scores().get(best).filter(|score| **score > f32::NEG_INFINITY).map(|_| best)
    }

    /// The posterior over the joint policies scored so far; zero beyond them.
    #[must_use]
    pub fn posterior(&self) -> [[f32; R]; P] {
        let mut posterior = self.scores;
        policy::posterior(posterior.as_flattened_mut(), self.window);
        posterior
    }

    /// Ends the evaluation: the scores become the posterior, in their own place. Returns the best
    /// joint policy, as [`best`](Self::best) does.
    pub(super) fn conclude(&mut self) -> Option<usize> {
        let best = self.best();
        policy::posterior(self.scores.as_flattened_mut(), self.window);
        best
    }

    /// Gathers the first of these joint policies, as far as their candidates find room.
    #[inline(never)]
    fn gather(&mut self, problem: &Problem<'_, S, G>, batch: Batch) -> Batch {
        let groups = problem.model.groups();
        let mut row = problem.candidates.row(batch.start);
        let places = self.places.as_flattened_mut().get_mut(batch.clone()).unwrap_or_default();
        let of = self.groups.get_mut(..groups).unwrap_or_default();
        for (group, number) in of.iter_mut().zip(0..) {
            (group.used, group.control) = (0, only_control(problem, number));
            group.factors = problem.model.members_of(number);
        }
        for (places, policy) in places.iter_mut().zip(batch.start..) {
            for ((group, place), number) in of.iter_mut().zip(places).zip(0..) {
                let key = match group.control {
                    Some(control) => row.get(usize::from(control)) as u32,
                    None => key(problem, number, &row),
                };
                match group.find(key).or_else(|| admit(group, problem, number, (policy, &row), key)) {
                    Some(row) => *place = row as u8,
                    None => return batch.start..policy,
                }
            }
            problem.candidates.go_on(policy + 1, &mut row);
        }
        batch
    }

    /// Rolls out the gathered candidates, all in step.
    #[inline(never)]
    fn roll_out(&mut self, problem: &Problem<'_, S, G>, batch: &Batch) {
        self.rows = [*problem.beliefs; R];
        self.terms.as_flattened_mut().get_mut(batch.clone()).unwrap_or_default().fill(Terms::ZERO);
        let normalisers = normalisers(problem);
        for step in 0..problem.horizon {
            self.add_pairs(problem, batch, Some(step));
            self.step(problem, step);
            self.add_pairs(problem, batch, None);
            self.observe(problem, &normalisers, batch, step);
        }
    }

    /// Moves every candidate of every group by one step.
    #[inline(never)]
    fn step(&mut self, problem: &Problem<'_, S, G>, step: usize) {
        let model = problem.model;
        let mut copy = Beliefs::<S, G>::EMPTY;
        for (number, group) in self.groups.iter_mut().enumerate().take(model.groups()) {
            if problem.scope >> number & 1 == 0 {
                continue;
            }
            let (used, control, factors) = (group.used(), group.control, group.factors);
            for (row, candidate) in self.rows.iter_mut().zip(&mut group.candidates).take(used) {
                // Before the first step there is no need for a copy: the beliefs are still those of
                // the problem.
                let before = if step == 0 {
                    problem.beliefs
                } else {
                    for factor in bits(factors) {
                        math::assign(model.part_mut(copy.as_flat_mut(), factor), row.part(model, factor));
                    }
                    &copy
                };
                for factor in bits(factors) {
                    let action = match control {
                        Some(control) if model.control(factor).is_some() => {
                            let control = usize::from(control);
                            problem.candidates.policy(control, candidate.key as usize).get(step)
                        }
                        _ => action_of(problem, factor, usize::from(candidate.policy), step),
                    };
                    if let Some(action) = action {
                        let to = model.part_mut(row.as_flat_mut(), factor);
                        candidate.terms.novelty += model.move_factor(factor, action, before.as_flat(), to);
                    }
                }
            }
        }
    }

    /// Adds the expected terms of every modality after a step.
    #[inline(never)]
    fn observe(
        &mut self,
        problem: &Problem<'_, S, G>,
        normalisers: &Normalisers,
        batch: &Batch,
        step: usize,
    ) {
        for ((number, modality, groups), normalisers) in problem.modalities().zip(normalisers) {
            let sense = PreferredModality::new(problem, number, modality, *normalisers);
            if groups.is_power_of_two() {
                self.observe_own(problem.model, &sense, groups, step);
            } else {
                self.observe_coupled(problem.model, &sense, groups, batch, step);
            }
        }
        if problem.scoring.gain == Gain::Joint {
            self.gain_jointly(problem, batch, step);
        }
    }

    /// A modality that one group's states determine: once for each of its candidates.
    #[inline(never)]
    fn observe_own(&mut self, model: &Model, sense: &PreferredModality, groups: u16, step: usize) {
        let Some(group) = self.groups.get_mut(groups.trailing_zeros() as usize) else { return };
        let used = group.used();
        for (row, candidate) in self.rows.iter().zip(&mut group.candidates).take(used) {
            let arrives = step + 1 == usize::from(candidate.arrival);
            candidate.terms += match *sense.modality.factors() {
                [factor] => sense.expect(&[row.part(model, factor)], arrives),
                ref factors => sense.expect(model.parts(row.as_flat(), factors).as_slice(), arrives),
            };
        }
    }

    /// A modality that several groups' states determine. Their joint outcome is judged
    /// once, when the first of them arrives, if arrivals count.
    fn observe_coupled(
        &mut self,
        model: &Model,
        sense: &PreferredModality,
        groups: u16,
        batch: &Batch,
        step: usize,
    ) {
        if !sense.on_arrival
            && let &[first, second] = sense.modality.factors()
            && self.observe_pairs(model, sense, [first, second], batch)
        {
            return;
        }
        self.couple(groups, batch, &|rows, places| {
            let arrives = sense.on_arrival && step + 1 == rows.first_arrival(groups, places);
            if sense.on_arrival && !arrives {
                return Terms::ZERO;
            }
            match *sense.modality.factors() {
                [first, second] => {
                    sense.expect(&[first, second].map(|factor| rows.part(model, factor, places)), arrives)
                }
                ref factors => {
                    let parts: Parts = up_to(factors.iter().map(|&factor| rows.part(model, factor, places)));
                    sense.expect(parts.as_slice(), arrives)
                }
            }
        });
    }

    /// A modality of two factors in different groups, for all pairs of their candidates at once;
    /// returns whether there are as many as joint policies at the most.
    #[inline(never)]
    fn observe_pairs(
        &mut self,
        model: &Model,
        sense: &PreferredModality,
        factors: [usize; 2],
        batch: &Batch,
    ) -> bool {
        let groups = factors.map(|factor| model.group(factor));
        let used = groups.map(|group| self.groups.get(group).map_or(0, Group::used));
        let Some(pairs) = self.combinations.as_flattened_mut().get_mut(..used[0] * used[1]) else {
            return false;
        };
        if pairs.len() > batch.len() {
            return false;
        }
        let beliefs = factors.map(|factor| self.rows.each_ref().map(|row| row.part(model, factor)));
        let [Some(firsts), Some(seconds)] = [beliefs[0].get(..used[0]), beliefs[1].get(..used[1])] else {
            return false;
        };
        let (form, shape, preference) =
            (sense.modality.likelihood(), sense.modality.shape(), sense.under_way);
        form.expect_pairs(shape, firsts, seconds, preference.preference, pairs);
        pairs.iter_mut().for_each(|terms| *terms = sense.weigh_up(*terms, preference.normaliser));
        let places = self.places.as_flattened().get(batch.clone()).unwrap_or(&[]);
        let terms = self.terms.as_flattened_mut().get_mut(batch.clone()).unwrap_or(&mut []);
        for (places, terms) in places.iter().zip(terms) {
            let [first, second] = groups.map(|group| places.get(group).copied().map_or(0, usize::from));
            if let Some(expected) = pairs.get(first * used[1] + second) {
                *terms += *expected;
            }
        }
        true
    }

    /// Adds terms of several groups' candidates together: found once for each
    /// combination of them that is gathered, or for each joint policy where those are fewer.
    fn couple(&mut self, groups: u16, batch: &Batch, of: &dyn Fn(&Rows<S, G, R>, &Places<G>) -> Terms) {
        let combinations = Tuples { groups, used: &self.groups };
        let rows = Rows { beliefs: &self.rows, groups: &self.groups };
        let places = self.places.as_flattened().get(batch.clone()).unwrap_or_default().iter();
        let places = places.zip(self.terms.as_flattened_mut().get_mut(batch.clone()).unwrap_or_default());
        match combinations.count().filter(|&count| count < batch.len()) {
            Some(count) => {
                for (at, kept) in self.combinations.as_flattened_mut().iter_mut().enumerate().take(count) {
                    *kept = of(&rows, &combinations.places(at));
                }
                let combined = self.combinations.as_flattened();
                for (places, terms) in places {
                    *terms += combined.get(combinations.at(places)).copied().unwrap_or_default();
                }
            }
            None => places.for_each(|(places, terms)| *terms += of(&rows, places)),
        }
    }

    /// Adds the preferences for pairs of factors, before a step when there is one and after it
    /// otherwise.
    fn add_pairs(&mut self, problem: &Problem<'_, S, G>, batch: &Batch, departing: Option<usize>) {
        for pair in problem.pair_preferences {
            let factors = pair.factors();
            let groups = factors.iter().fold(0, |groups, &factor| groups | 1 << problem.model.group(factor));
            if groups & !problem.scope != 0 {
                continue;
            }
            self.couple(groups, batch, &|rows, places| {
                let beliefs = factors.map(|factor| rows.part(problem.model, factor, places));
                let utility = match departing {
                    Some(step) => {
                        let actions = factors.map(|factor| rows.action(problem, factor, places, step));
                        pair.departing(beliefs, actions)
                    }
                    None => pair.arrived(beliefs),
                };
                Terms { utility, ..Terms::ZERO }
            });
        }
    }

    /// The joint gain of all modalities that have factors in common, directly or by way of others.
    fn gain_jointly(&mut self, problem: &Problem<'_, S, G>, batch: &Batch, step: usize) {
        let model = problem.model;
        let all = problem.modalities().fold(0, |all, (number, ..)| all | 1 << number);
        for component in gain::components(model, all) {
            self.couple(component.groups(), batch, &|rows, places| {
                let mut beliefs = Beliefs::<S, G>::EMPTY;
                for factor in 0..model.factors().len() {
                    math::assign(
                        model.part_mut(beliefs.as_flat_mut(), factor),
                        rows.part(model, factor, places),
                    );
                }
                let observed = rows.observed(problem, component.bits, places, step);
                let information_gain = if observed == component.bits {
                    gain::of(&component, &beliefs)
                } else {
                    gain::components(model, observed).map(|part| gain::of(&part, &beliefs)).sum()
                };
                Terms { information_gain, ..Terms::ZERO }
            });
        }
    }

    /// Sums the terms of the rolled-out candidates, and computes their log posterior.
    #[inline(never)]
    fn score(&mut self, problem: &Problem<'_, S, G>, batch: &Batch) {
        let scores = self.scores.as_flattened_mut().get_mut(batch.clone()).unwrap_or_default();
        let terms = self.terms.as_flattened_mut().get_mut(batch.clone()).unwrap_or_default();
        let places = self.places.as_flattened().get(batch.clone()).unwrap_or_default();
        let groups = self.groups.get(..problem.model.groups()).unwrap_or_default();
        for (((score, terms), places), policy) in scores.iter_mut().zip(terms).zip(places).zip(batch.start..)
        {
            for (group, &place) in groups.iter().zip(places) {
                if let Some(candidate) = group.candidates.get(usize::from(place)) {
                    *terms += candidate.terms;
                }
            }
            let value = -terms.expected_free_energy();
            *score = problem.scoring.score(problem.candidates.ln_prior(policy), 0.0, value);
        }
    }
}

/// Assigns a row to a joint policy's actions on a group; `None` when there is no room.
// Apart, and few times called: the loop around it is short enough for registers then.
#[inline(never)]
fn admit<const S: usize, const G: usize, const R: usize>(
    group: &mut Group<R>,
    problem: &Problem<'_, S, G>,
    number: usize,
    (policy, row): (usize, &JointPolicy),
    key: u32,
) -> Option<usize> {
    let arrival = arrival(problem, number, row);
    group.add(Rollout { key, policy: policy as u16, arrival, terms: Terms::ZERO })
}

impl<const S: usize, const G: usize, const R: usize, const P: usize> Default for Evaluation<S, G, R, P> {
    fn default() -> Self {
        Self::new()
    }
}
