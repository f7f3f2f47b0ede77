//! The expected free energy of joint policies, evaluated factored and as far as there is time.
//!
//! G of a joint policy is the sum of each group's own part and of parts that couple groups. Each group's candidates are
//! rolled out once, all in step; only the coupled modalities are looked at combination by combination. For two
//! robots with `R` candidates each and `T` steps that is `2 R T` predictions instead of `2 R R T`.

use super::belief::Beliefs;
use super::free_energy::{Credit, Gain, Terms};
use super::gain;
use super::model::{MAX_MODALITIES, Modality, Parts};
use super::policy;
use super::problem::Problem;
use crate::actions::Action;
use crate::math;

/// An evaluation under way, and its results so far.
///
/// `S` and `G` are those of the [`Beliefs`], `R` is the most candidates of one group that are rolled out side by side, and there
/// is room for `R * P` joint policies. Memory is about `4 S G R + 24 G R + 36 R P` bytes and a third of a kilobyte. A model
/// with more than `G` groups is not evaluated: no joint policy is scored.
#[derive(Clone, Debug)]
pub struct Evaluation<const S: usize, const G: usize, const R: usize, const P: usize> {
    /// The predicted beliefs: in row `r`, each group's `r`-th candidate.
    rows: [Beliefs<S, G>; R],
    groups: [Group<R>; G],
    /// ln Σ exp C of each modality, when it counts in full and under way.
    normalisers: [[f32; 2]; MAX_MODALITIES],
    /// The row of each group's candidate, for each joint policy.
    places: [[Places<G>; R]; P],
    terms: [[Terms; R]; P],
    /// Terms of combinations of the groups that one coupled modality depends on.
    combinations: [[Terms; R]; P],
    scores: [[f32; R]; P],
    done: usize,
    window: f32,
}

/// The candidates of one group that are in the rows.
#[derive(Clone, Copy, Debug)]
struct Group<const R: usize> {
    used: usize,
    keys: [u32; R],
    /// A joint policy that each candidate is part of.
    policies: [u16; R],
    terms: [Terms; R],
}

impl<const R: usize> Group<R> {
    const EMPTY: Self = Self { used: 0, keys: [0; R], policies: [0; R], terms: [Terms::ZERO; R] };

    /// The row of the candidate with this key; a new one where there is room.
    fn place(&mut self, key: u32, policy: usize) -> Option<usize> {
        let known = self.keys.iter().take(self.used).position(|&known| known == key);
        known.or_else(|| {
            let row = self.used;
            *self.keys.get_mut(row)? = key;
            *self.policies.get_mut(row)? = policy as u16;
            self.used += 1;
            Some(row)
        })
    }
}

impl<const S: usize, const G: usize, const R: usize, const P: usize> Evaluation<S, G, R, P> {
    /// How many joint policies there is room for.
    pub const CAPACITY: usize = R * P;

    /// An evaluation not yet begun; usable in a `static`.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(R > 0 && P > 0 && R <= u8::MAX as usize && R * P <= u16::MAX as usize) }
        Self {
            rows: [Beliefs::EMPTY; R],
            groups: [Group::EMPTY; G],
            normalisers: [[0.0; 2]; MAX_MODALITIES],
            places: [[[0; G]; R]; P],
            terms: [[Terms::ZERO; R]; P],
            combinations: [[Terms::ZERO; R]; P],
            scores: [[f32::NEG_INFINITY; R]; P],
            done: 0,
            window: f32::INFINITY,
        }
    }

    /// Forgets all results and begins with `problem`.
    pub fn begin(&mut self, problem: &Problem<'_, S, G>) {
        self.done = 0;
        self.window = problem.scoring.window;
        self.scores = [[f32::NEG_INFINITY; R]; P];
        for (number, modality, _) in problem.modalities() {
            if let Some([full, under_way]) = self.normalisers.get_mut(number) {
                *full = math::log_sum_exp(problem.preference(number, modality, true));
                *under_way = match problem.scoring.credit {
                    Credit::EveryStep => *full,
                    Credit::OnArrival => math::log_sum_exp(problem.preference(number, modality, false)),
                };
            }
        }
    }

    /// Scores up to `count` more joint policies; returns whether there are more. Joint policies beyond the
    /// [`CAPACITY`](Self::CAPACITY) are left out.
    ///
    /// The problem must be the one that was begun with. Costs at most `count` rollouts of each group and `count`
    /// predictions of each coupled modality per step; candidates that joint policies have in common are rolled out
    /// once, `R` at a time.
    pub fn advance(&mut self, problem: &Problem<'_, S, G>, count: usize) -> bool {
        let room = if problem.model.groups() > G { 0 } else { Self::CAPACITY };
        let total = problem.candidates.len().min(room);
        let until = self.done.saturating_add(count).min(total);
        while self.done < until {
            let next = self.gather(problem, until);
            if next == self.done {
                return false;
            }
            self.roll_out(problem, next);
            self.score(problem, next);
            self.done = next;
        }
        self.done < total
    }

    /// Scores all joint policies.
    pub fn evaluate(&mut self, problem: &Problem<'_, S, G>) {
        self.begin(problem);
        while self.advance(problem, Self::CAPACITY) {}
    }

    /// How many joint policies are scored.
    #[must_use]
    pub const fn done(&self) -> usize {
        self.done
    }

    /// The terms of the joint policies scored so far, summed over modalities and steps.
    #[must_use]
    pub fn terms(&self) -> &[Terms] {
        self.terms.as_flattened().get(..self.done).unwrap_or(&[])
    }

    /// The terms of one group's own part for each of its candidates among those scored last, in the order in which joint
    /// policies brought them up.
    #[must_use]
    pub fn own_terms(&self, group: usize) -> &[Terms] {
        self.groups.get(group).and_then(|group| group.terms.get(..group.used)).unwrap_or(&[])
    }

    /// ln E - F - γ G of the joint policies scored so far: their log posterior up to a constant.
    #[must_use]
    pub fn scores(&self) -> &[f32] {
        self.scores.as_flattened().get(..self.done).unwrap_or(&[])
    }

    /// The most probable joint policy scored so far; the first of equals.
    #[must_use]
    pub fn best(&self) -> Option<usize> {
        (self.done > 0).then(|| math::argmax(self.scores()))
    }

    /// The posterior over the joint policies scored so far; zero beyond them.
    #[must_use]
    pub fn posterior(&self) -> [[f32; R]; P] {
        let mut posterior = self.scores;
        policy::posterior(posterior.as_flattened_mut(), self.window);
        posterior
    }

    /// Gathers joint policies from `self.done` on whose candidates find room, and returns where they end.
    fn gather(&mut self, problem: &Problem<'_, S, G>, until: usize) -> usize {
        let model = problem.model;
        self.groups.iter_mut().for_each(|group| group.used = 0);
        for policy in self.done..until {
            for group in 0..model.groups() {
                let key = key(problem, group, policy);
                let place = |of: &mut Group<R>| of.place(key?, policy);
                let Some(place) = self.groups.get_mut(group).and_then(place) else { return policy };
                if let Some(kept) =
                    self.places.as_flattened_mut().get_mut(policy).and_then(|of| of.get_mut(group))
                {
                    *kept = place as u8;
                }
            }
        }
        until
    }

    /// Rolls out what was gathered, all in step.
    fn roll_out(&mut self, problem: &Problem<'_, S, G>, until: usize) {
        self.rows = [*problem.beliefs; R];
        self.groups.iter_mut().for_each(|group| group.terms = [Terms::ZERO; R]);
        for terms in self.gathered(until) {
            *terms = Terms::ZERO;
        }
        for step in 0..problem.horizon {
            self.meet(problem, until, Some(step));
            self.step(problem, step);
            self.meet(problem, until, None);
            self.observe(problem, until, step);
        }
        for policy in self.done..until {
            let own = self.own_parts(policy, problem.model.groups());
            if let Some(terms) = self.terms.as_flattened_mut().get_mut(policy) {
                *terms += own;
            }
        }
    }

    fn gathered(&mut self, until: usize) -> &mut [Terms] {
        self.terms.as_flattened_mut().get_mut(self.done..until).unwrap_or(&mut [])
    }

    /// The sum of all groups' own parts of a joint policy.
    fn own_parts(&self, policy: usize, groups: usize) -> Terms {
        let mut sum = Terms::ZERO;
        for (group, of) in self.groups.iter().enumerate().take(groups) {
            if let Some(terms) = of.terms.get(self.place(policy, group)) {
                sum += *terms;
            }
        }
        sum
    }

    fn place(&self, policy: usize, group: usize) -> usize {
        self.places.as_flattened().get(policy).and_then(|of| of.get(group)).copied().map_or(0, usize::from)
    }

    /// Moves every candidate of every group by one step.
    fn step(&mut self, problem: &Problem<'_, S, G>, step: usize) {
        let model = problem.model;
        for (number, group) in self.groups.iter_mut().enumerate().take(model.groups()) {
            if problem.scope >> number & 1 == 0 {
                continue;
            }
            let rows = self.rows.iter_mut().zip(group.policies).zip(&mut group.terms).take(group.used);
            for ((row, policy), terms) in rows {
                let from = *row;
                for factor in model.in_group(number) {
                    if let Some(action) = action_of(problem, factor, usize::from(policy), step) {
                        terms.novelty += model.novelty_of_move(factor, action, from.as_flat());
                        let to = model.part_mut(row.as_flat_mut(), factor);
                        model.move_factor(factor, action, from.as_flat(), to);
                    }
                }
            }
        }
    }

    /// Adds what every modality is expected to bring after a step.
    fn observe(&mut self, problem: &Problem<'_, S, G>, until: usize, step: usize) {
        for (number, modality, groups) in problem.modalities() {
            let at = (number, modality, groups);
            if groups.is_power_of_two() {
                self.observe_own(problem, at, step);
            } else {
                self.observe_coupled(problem, at, until, step);
            }
        }
        if problem.scoring.gain == Gain::Joint {
            self.gain_jointly(problem, until, step);
        }
    }

    /// A modality that one group's states determine: once for each of its candidates.
    fn observe_own(
        &mut self,
        problem: &Problem<'_, S, G>,
        (number, modality, groups): At<'_, '_>,
        step: usize,
    ) {
        let Some(group) = self.groups.get_mut(groups.trailing_zeros() as usize) else { return };
        let [full, under_way] = self.normalisers.get(number).copied().unwrap_or_default();
        let candidates = self.rows.iter().zip(group.policies).zip(&mut group.terms).take(group.used);
        for ((row, policy), terms) in candidates {
            let arrives = step + 1 == arrival(problem, groups.trailing_zeros() as usize, usize::from(policy));
            let normaliser = if arrives { full } else { under_way };
            let mut now = match modality.factors() {
                &[factor] => {
                    problem.terms((number, modality), &[row.of(problem.model, factor)], arrives, normaliser)
                }
                factors => {
                    let parts = problem.model.parts(row.as_flat(), factors);
                    problem.terms((number, modality), parts.as_slice(), arrives, normaliser)
                }
            };
            if problem.scoring.gain == Gain::Joint {
                now.information_gain = 0.0;
            }
            *terms += now;
        }
    }

    /// Adds terms that several groups' candidates bring about together: found once for each combination of them that is
    /// gathered, or for each joint policy where those are fewer.
    fn couple(&mut self, groups: u16, until: usize, of: impl Fn(&Rows<S, G, R>, &Places<G>) -> Terms) {
        let combinations = Combinations { groups, used: &self.groups };
        let (from, gathered) = (self.done, until - self.done);
        let rows = Rows { beliefs: &self.rows, groups: &self.groups };
        let places =
            self.places.as_flattened().iter().zip(self.terms.as_flattened_mut()).skip(from).take(gathered);
        match combinations.count().filter(|&count| count < gathered) {
            Some(count) => {
                for (at, kept) in self.combinations.as_flattened_mut().iter_mut().enumerate().take(count) {
                    *kept = of(&rows, &combinations.places(at));
                }
                for (places, terms) in places {
                    *terms += self
                        .combinations
                        .as_flattened()
                        .get(combinations.at(places))
                        .copied()
                        .unwrap_or_default();
                }
            }
            None => places.for_each(|(places, terms)| *terms += of(&rows, places)),
        }
    }

    /// A modality that several groups' states determine.
    fn observe_coupled(&mut self, problem: &Problem<'_, S, G>, at: At<'_, '_>, until: usize, step: usize) {
        let (number, modality, groups) = at;
        let [full, under_way] = self.normalisers.get(number).copied().unwrap_or_default();
        self.couple(groups, until, |rows, places| {
            // What several bring about together is judged once: when the first of them arrives.
            let arrives = step + 1 == rows.first_arrival(problem, groups, places);
            if !arrives && problem.scoring.credit == Credit::OnArrival {
                return Terms::ZERO;
            }
            let parts = rows.parts(problem, modality.factors(), places);
            let normaliser = if arrives { full } else { under_way };
            let mut now = problem.terms((number, modality), parts.as_slice(), arrives, normaliser);
            if problem.scoring.gain == Gain::Joint {
                now.information_gain = 0.0;
            }
            now
        });
    }

    /// The encounters, before a step when there is one and after it otherwise.
    fn meet(&mut self, problem: &Problem<'_, S, G>, until: usize, departing: Option<usize>) {
        for encounter in problem.encounters {
            let factors = encounter.factors();
            let groups = factors.iter().fold(0, |groups, &factor| groups | 1 << problem.model.group(factor));
            if groups & !problem.scope != 0 {
                continue;
            }
            self.couple(groups, until, |rows, places| {
                let beliefs = factors.map(|factor| rows.part(problem, factor, places));
                let utility = match departing {
                    Some(step) => {
                        let actions = factors.map(|factor| rows.action(problem, factor, places, step));
                        encounter.departing(beliefs, actions)
                    }
                    None => encounter.arrived(beliefs),
                };
                Terms { utility, ..Terms::ZERO }
            });
        }
    }

    /// The joint gain of all modalities that have factors in common, directly or by way of others.
    fn gain_jointly(&mut self, problem: &Problem<'_, S, G>, until: usize, step: usize) {
        let all = problem.modalities().fold(0, |all, (number, ..)| all | 1 << number);
        for component in gain::components(problem.model, all) {
            self.couple(component.groups, until, |rows, places| {
                let mut beliefs = Beliefs::<S, G>::EMPTY;
                for factor in 0..problem.model.factors().len() {
                    let to = problem.model.part_mut(beliefs.as_flat_mut(), factor);
                    math::assign(to, rows.part(problem, factor, places));
                }
                let observed = rows.observed(problem, component.members, places, step);
                let information_gain = if observed == component.members {
                    component.gain(problem.model, &beliefs)
                } else {
                    let parts = gain::components(problem.model, observed);
                    parts.map(|part| part.gain(problem.model, &beliefs)).sum()
                };
                Terms { information_gain, ..Terms::ZERO }
            });
        }
    }

    /// Works out the log posterior of what was rolled out.
    fn score(&mut self, problem: &Problem<'_, S, G>, until: usize) {
        let results = self
            .scores
            .as_flattened_mut()
            .iter_mut()
            .zip(self.terms.as_flattened())
            .enumerate()
            .skip(self.done);
        for (policy, (score, terms)) in results.take(until - self.done) {
            let value = -terms.expected_free_energy(problem.scoring.convention);
            *score = problem.scoring.score(problem.candidates.ln_prior(policy), 0.0, value);
        }
    }
}

impl<const S: usize, const G: usize, const R: usize, const P: usize> Default for Evaluation<S, G, R, P> {
    fn default() -> Self {
        Self::new()
    }
}

/// A modality: its number, itself, and the groups it depends on.
type At<'a, 'm> = (usize, &'a Modality<'m>, u16);

/// The row of each group's candidate.
type Places<const G: usize> = [u8; G];

/// What was rolled out so far.
struct Rows<'a, const S: usize, const G: usize, const R: usize> {
    beliefs: &'a [Beliefs<S, G>; R],
    groups: &'a [Group<R>; G],
}

impl<'a, const S: usize, const G: usize, const R: usize> Rows<'a, S, G, R> {
    fn place(problem: &Problem<'_, S, G>, factor: usize, places: &Places<G>) -> (usize, usize) {
        let group = problem.model.group(factor);
        (group, places.get(group).copied().map_or(0, usize::from))
    }

    /// The predicted belief about a factor.
    fn part(&self, problem: &Problem<'_, S, G>, factor: usize, places: &Places<G>) -> &'a [f32] {
        let (_, row) = Self::place(problem, factor, places);
        self.beliefs.get(row).map_or(&[], |row| row.of(problem.model, factor))
    }

    fn parts(&self, problem: &Problem<'_, S, G>, factors: &[usize], places: &Places<G>) -> Parts<'a> {
        Parts::new(factors.iter().map(|&factor| self.part(problem, factor, places)))
    }

    /// A joint policy that the candidate in a group's row is part of.
    fn policy(&self, group: usize, row: usize) -> usize {
        self.groups.get(group).and_then(|of| of.policies.get(row)).copied().map_or(0, usize::from)
    }

    fn action(
        &self,
        problem: &Problem<'_, S, G>,
        factor: usize,
        places: &Places<G>,
        step: usize,
    ) -> Option<Action> {
        let (group, row) = Self::place(problem, factor, places);
        action_of(problem, factor, self.policy(group, row), step)
    }

    /// Which of these modalities are observed at a step, a bit for each: what several groups bring about together is not
    /// before the first of them arrives, nor after.
    fn observed(&self, problem: &Problem<'_, S, G>, members: u64, places: &Places<G>, step: usize) -> u64 {
        if problem.scoring.credit == Credit::EveryStep {
            return members;
        }
        let together = |groups: u16| !groups.is_power_of_two();
        let left_out = problem.modalities().filter(|&(_, _, groups)| {
            together(groups) && step + 1 != self.first_arrival(problem, groups, places)
        });
        left_out.fold(members, |members, (number, ..)| members & !(1 << number))
    }

    fn first_arrival(&self, problem: &Problem<'_, S, G>, groups: u16, places: &Places<G>) -> usize {
        let members = places.iter().enumerate().filter(|(group, _)| groups >> group & 1 == 1);
        let arrivals =
            members.map(|(group, &row)| arrival(problem, group, self.policy(group, usize::from(row))));
        arrivals.min().unwrap_or(problem.horizon)
    }
}

/// The combinations of the candidates of a few groups, numbered.
#[derive(Clone, Copy)]
struct Combinations<'a, const G: usize, const R: usize> {
    groups: u16,
    used: &'a [Group<R>; G],
}

impl<const G: usize, const R: usize> Combinations<'_, G, R> {
    fn members(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let members = self.used.iter().enumerate().filter(|(group, _)| self.groups >> group & 1 == 1);
        members.map(|(group, of)| (group, of.used.max(1)))
    }

    fn count(&self) -> Option<usize> {
        self.members().try_fold(1_usize, |count, (_, used)| count.checked_mul(used))
    }

    fn at(&self, places: &Places<G>) -> usize {
        self.members()
            .fold(0, |at, (group, used)| at * used + places.get(group).copied().map_or(0, usize::from))
    }

    fn places(&self, mut at: usize) -> Places<G> {
        let mut places = [0; G];
        let mut faster = self.count().unwrap_or(1);
        for (group, used) in self.members() {
            faster /= used;
            if let Some(place) = places.get_mut(group) {
                *place = (at / faster) as u8;
            }
            at %= faster;
        }
        places
    }
}

/// A number for what a joint policy does to a group; `None` where numbers are too small. Sequences that do not exist stay,
/// and count as one.
fn key<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
    group: usize,
    policy: usize,
) -> Option<u32> {
    let mut key: u32 = 0;
    if problem.scope >> group & 1 == 0 {
        return Some(key);
    }
    for control in (0..problem.model.controls()).filter(|&control| problem.model.is_moved(group, control)) {
        let choices = problem.candidates.choices(control);
        let sequence = problem.candidates.sequence(policy, control).min(choices);
        key = key.checked_mul(choices as u32 + 1)?.checked_add(sequence as u32)?;
    }
    Some(key)
}

/// What a joint policy does to a factor at a step; `None` when it leaves it alone.
fn action_of<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
    factor: usize,
    policy: usize,
    step: usize,
) -> Option<Action> {
    let Some(control) = problem.model.control_of(factor) else { return Some(0) };
    let sequence = problem.candidates.sequence(policy, control);
    problem.action(&problem.candidates.actions(control, sequence), step)
}

/// After how many steps a group arrives under a joint policy: when the last of its action sequences ends.
fn arrival<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
    group: usize,
    policy: usize,
) -> usize {
    let controls = (0..problem.model.controls()).filter(|&control| problem.model.is_moved(group, control));
    let arrivals = controls.map(|control| {
        let sequence = problem.candidates.sequence(policy, control);
        problem.arrival(&problem.candidates.actions(control, sequence))
    });
    arrivals.max().unwrap_or(problem.horizon)
}
