//! What a round's facts ask of a planner: where each member is to end, and on which goals.

use super::fact::{Fact, Purpose};
use super::mission::{MAX_GOALS, Mission};
use super::outlook::Seekers;
use super::policies::Members;
use super::prospects::{Prospects, Robots};
use crate::bounded::up_to;
use crate::grid::joint::{Errand, Prefix, Problem, Target};
use crate::grid::{Cell, CellSet};
use crate::team::{MAX_TEAM, RobotId};
use heapless::Vec;

/// What a planner is asked for.
#[derive(Clone, Debug)]
pub(super) struct Targets {
    pub(super) errands: Vec<Errand, MAX_TEAM>,
    pub(super) goals: Vec<Cell, { MAX_GOALS + MAX_TEAM }>,
    pub(super) need: usize,
    /// How a robot begins that goes somewhere first.
    pub(super) prefix: Vec<Prefix, 1>,
}

impl Targets {
    pub(super) fn of<const W: usize>(
        mission: &Mission<'_, W>,
        members: &Members<'_, W>,
        closed: &CellSet<W>,
    ) -> Self {
        let errand = |(robot, fact): (_, &Fact<W>)| Errand {
            from: fact.anchor,
            target: target(mission, members, robot, fact),
        };
        let mut errands: Vec<Errand, MAX_TEAM> = up_to(members.iter().map(errand));
        let open = mission.open_goals(members.view);
        let held = hold_closed(&mut errands, open.clone(), closed);
        give_up_twins(&mut errands, closed);
        let goals = up_to(open.clone().filter(|&goal| !closed.contains(goal)));
        let seeking = errands.iter().filter(|errand| errand.target == Target::Any).count();
        // A goal that is blocked is still needed: the plan is then short of it, and says so.
        let all = open.count();
        let need = mission.need.map_or(all, usize::from).min(all).min(seeking + held);
        Self { errands, goals, need: need.saturating_sub(held), prefix: Vec::new() }
    }

    /// The members that go to any goal.
    pub(super) fn seekers(&self) -> Seekers {
        let places = self.errands.iter().enumerate().filter(|(_, errand)| errand.target == Target::Any);
        Seekers::of(places.map(|(place, _)| place))
    }

    /// Where those stand.
    pub(super) fn seeking(&self) -> Robots {
        up_to(self.errands.iter().filter(|errand| errand.target == Target::Any).map(|errand| errand.from))
    }

    /// The same with the goals that serve in a world.
    pub(super) fn in_world<const S: usize, const W: usize>(
        mut self,
        mission: &Mission<'_, W>,
        prospects: &Prospects<S, W>,
        world: usize,
    ) -> Self {
        let goals = core::mem::take(&mut self.goals);
        self.goals = up_to(prospects.goals(mission, world, &goals));
        // Goals that do not serve in this world are not missed.
        let lost = goals.len() - self.goals.len();
        if lost > 0 {
            self.need = self.need.min(self.goals.len());
        }
        self
    }

    pub(super) fn problem<'a, const W: usize>(
        &'a self,
        mission: &'a Mission<'_, W>,
        closed: CellSet<W>,
    ) -> Problem<'a, W> {
        let Self { errands, goals, need, prefix } = self;
        Problem { closed, goals, need: *need, prefixes: prefix, ..Problem::new(&mission.map, errands) }
    }
}

/// What a robot is to do, by its fact.
fn target<const W: usize>(
    mission: &Mission<'_, W>,
    members: &Members<'_, W>,
    robot: RobotId,
    fact: &Fact<W>,
) -> Target {
    let charges = |fact: &Fact<W>| matches!(fact.purpose, Purpose::Charge(_));
    if mission.waits_for_charging && !charges(fact) && members.facts().any(charges) {
        return Target::Stand;
    }
    match fact.purpose {
        Purpose::Goal => mission.own_goal(robot).map_or(Target::Any, Target::Own),
        Purpose::Visit(cell) | Purpose::Charge(cell) => Target::Own(cell),
        Purpose::Stand => Target::Stand,
    }
}

/// Lets robots stand that are at their targets in closed cells, in the wall of a robot left out
/// for example: no robot could come back there, and they are in no one's way. Returns how many of
/// the open goals they hold.
fn hold_closed<const W: usize>(
    errands: &mut [Errand],
    open: impl Iterator<Item = Cell> + Clone,
    closed: &CellSet<W>,
) -> usize {
    let mut held = 0;
    for errand in errands.iter_mut().filter(|errand| closed.contains(errand.from)) {
        let is_on_goal = errand.target == Target::Any && open.clone().any(|goal| goal == errand.from);
        if is_on_goal || errand.target == Target::Own(errand.from) {
            errand.target = Target::Stand;
            held += usize::from(is_on_goal);
        }
    }
    held
}

/// Gives up targets that are blocked, or that a robot with a lower number owns too.
fn give_up_twins<const W: usize>(errands: &mut [Errand], closed: &CellSet<W>) {
    let mut owned = CellSet::<W>::EMPTY;
    for errand in errands {
        if let Target::Own(cell) = errand.target
            && (closed.contains(cell) || !owned.insert(cell))
        {
            errand.target = Target::Any;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_that_are_blocked_or_wanted_twice_are_given_up() {
        let own = |cell| Target::Own(Cell(cell));
        let mut twins =
            [(0, 7), (1, 7), (2, 8)].map(|(from, to)| Errand { from: Cell(from), target: own(to) });
        give_up_twins::<2>(&mut twins, &[Cell(8)].into_iter().collect());
        assert_eq!(twins.map(|errand| errand.target), [own(7), Target::Any, Target::Any]);
    }
}
