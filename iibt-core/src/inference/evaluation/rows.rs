//! The candidates rolled out so far, and their combinations.

use super::action_of;
use super::group::{Group, Places, Rollout};
use crate::actions::Action;
use crate::inference::belief::Beliefs;
use crate::inference::free_energy::PreferenceTiming;
use crate::inference::model::Model;
use crate::inference::problem::Problem;

/// The candidates rolled out so far.
pub(super) struct Rows<'a, const S: usize, const G: usize, const R: usize> {
    pub(super) beliefs: &'a [Beliefs<S, G>; R],
    pub(super) groups: &'a [Group<R>; G],
}

impl<'a, const S: usize, const G: usize, const R: usize> Rows<'a, S, G, R> {
    /// The predicted belief about a factor.
    #[inline]
    pub(super) fn part(&self, model: &Model, factor: usize, places: &Places<G>) -> &'a [f32] {
        let row = places.get(model.group(factor)).copied().map_or(0, usize::from);
        self.beliefs.get(row).map_or(&[], |row| row.part(model, factor))
    }

    pub(super) fn candidate(&self, group: usize, places: &Places<G>) -> Option<&Rollout> {
        let row = places.get(group).copied().map_or(0, usize::from);
        self.groups.get(group).and_then(|of| of.candidates.get(row))
    }

    pub(super) fn action(
        &self,
        problem: &Problem<'_, S, G>,
        factor: usize,
        places: &Places<G>,
        step: usize,
    ) -> Option<Action> {
        let candidate = self.candidate(problem.model.group(factor), places)?;
        action_of(problem, factor, usize::from(candidate.policy), step)
    }

    /// The modalities among these that are observed at a step, a bit for each: an outcome of
    /// several groups is observed only when the first of them arrives.
    pub(super) fn observed(
        &self,
        problem: &Problem<'_, S, G>,
        members: u64,
        places: &Places<G>,
        step: usize,
    ) -> u64 {
        if problem.scoring.timing == PreferenceTiming::EveryStep {
            return members;
        }
        let together = |groups: u16| !groups.is_power_of_two();
        let left_out = problem
            .modalities()
            .filter(|&(_, _, groups)| together(groups) && step + 1 != self.first_arrival(groups, places));
        left_out.fold(members, |members, (number, ..)| members & !(1 << number))
    }

    pub(super) fn first_arrival(&self, groups: u16, places: &Places<G>) -> usize {
        let members = (0..G).filter(|group| groups >> group & 1 == 1);
        let arrivals = members.filter_map(|group| self.candidate(group, places)).map(|of| of.arrival);
        arrivals.min().map_or(0, usize::from)
    }
}

/// The combinations of the candidates of a few groups, numbered.
#[derive(Clone, Copy)]
pub(super) struct Tuples<'a, const G: usize, const R: usize> {
    pub(super) groups: u16,
    pub(super) used: &'a [Group<R>; G],
}

impl<const G: usize, const R: usize> Tuples<'_, G, R> {
    pub(super) fn members(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let members = self.used.iter().enumerate().filter(|(group, _)| self.groups >> group & 1 == 1);
        members.map(|(group, of)| (group, of.used().max(1)))
    }

    pub(super) fn count(&self) -> Option<usize> {
        self.members().try_fold(1_usize, |count, (_, used)| count.checked_mul(used))
    }

    pub(super) fn at(&self, places: &Places<G>) -> usize {
        self.members()
            .fold(0, |at, (group, used)| at * used + places.get(group).copied().map_or(0, usize::from))
    }

    pub(super) fn places(&self, mut at: usize) -> Places<G> {
        let mut places = [0; G];
        let mut faster = self.count().unwrap_or(1);
        for (group, used) in self.members() {
            faster = faster.checked_div(used).unwrap_or(1).max(1);
            if let Some(place) = places.get_mut(group) {
                *place = (at / faster) as u8;
            }
            at %= faster;
        }
        places
    }
}
