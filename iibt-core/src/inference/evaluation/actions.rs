//! The actions of a joint policy on a group.

use crate::actions::Action;
use crate::inference::candidates::JointPolicy;
use crate::inference::free_energy::PreferenceTiming;
use crate::inference::model::Model;
use crate::inference::policy::Policy;
use crate::inference::problem::Problem;

/// The controls that move a group.
pub(super) fn controls(model: &Model, group: usize) -> impl Iterator<Item = usize> {
    bits(u32::from(model.moved_by(group)))
}

/// The numbers of the bits that are set.
#[inline]
pub(super) fn bits(mut left: u32) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let bit = left.trailing_zeros();
        left &= left.wrapping_sub(1);
        (bit < u32::BITS).then_some(bit as usize)
    })
}

/// The only control that moves a group in scope.
pub(super) fn only_control<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
    group: usize,
) -> Option<u8> {
    let moved_by = problem.model.moved_by(group);
    let moves = problem.scope >> group & 1 == 1 && moved_by.is_power_of_two();
    moves.then(|| moved_by.trailing_zeros() as u8)
}

/// A key of a joint policy's actions on a group; a check ensures that keys are large enough.
#[inline(never)]
pub(super) fn key<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
    group: usize,
    row: &JointPolicy,
) -> u32 {
    if problem.scope >> group & 1 == 0 {
        return 0;
    }
    controls(problem.model, group).fold(0, |key: u32, control| {
        let choices = problem.candidates.choices(control) as u32;
        key.wrapping_mul(choices).wrapping_add(row.get(control) as u32)
    })
}

/// The action of a joint policy on a factor at a step; `None` when it leaves it alone.
pub(in crate::inference) fn action_of<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
    factor: usize,
    policy: usize,
    step: usize,
) -> Option<Action> {
    let Some(control) = problem.model.control(factor) else { return Some(0) };
    let candidates = problem.candidates;
    candidates.policy(control, candidates.sequence(policy, control)).get(step)
}

/// The step at which a group arrives, when the last of its action sequences ends. Zero, which is
/// never, where every step counts.
pub(in crate::inference) fn arrival<const S: usize, const G: usize>(
    problem: &Problem<'_, S, G>,
    group: usize,
    row: &JointPolicy,
) -> u8 {
    if problem.scoring.timing == PreferenceTiming::EveryStep {
        return 0;
    }
    let arrivals =
        controls(problem.model, group).map(|control| problem.arrival(sequence(problem, control, row)));
    arrivals.max().unwrap_or(problem.horizon).min(usize::from(u8::MAX)) as u8
}

pub(super) fn sequence<'a, const S: usize, const G: usize>(
    problem: &Problem<'a, S, G>,
    control: usize,
    row: &JointPolicy,
) -> &'a Policy {
    problem.candidates.policy(control, row.get(control))
}
