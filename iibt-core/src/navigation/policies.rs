//! The list of joint policies of a round: made from its facts, alike in every robot.

use super::alternatives::{Alternatives, Variant};
use super::claim::{Blocks, Cells};
use super::combinations::Combinations;
use super::fact::{Fact, Purpose, blocked};
use super::frame_size::listed;
use super::mission::Mission;
use super::outlook::{Done, Seekers};
use super::prospects::Prospects;
use super::targets::Targets;
use super::unknown::MAX_WORLDS;
use crate::grid::joint::{Failure, JointPlan, LATER_TOGETHER, PolicyList};
use crate::grid::{Cell, CellSet, Map, Move, Path};
use crate::iibt::{cheapest_policy, weigh};
use crate::inference::{ExpectedTime, WeighedPolicies};
use crate::team::rounds::{JointPolicies, Proposal, Score, View};
use crate::team::{MAX_TEAM, RobotId};
use heapless::Vec;

/// A joint plan of a team.
pub type TeamPlan = JointPlan<MAX_TEAM>;

/// What it costs, in eighths of a tick, to end on a goal less than needed.
const SHORT: usize = 8 * 32;

/// What it costs, in eighths of a tick, not to arrive together: more than the steps by which a plan
/// may be longer for it, and an idle end.
const APART: usize = 8 * (LATER_TOGETHER + 1);

/// The members of a round with their facts, in the order of their numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Members<'a, const W: usize> {
    pub(super) view: View,
    facts: [Option<&'a Fact<W>>; MAX_TEAM],
}

impl<'a, const W: usize> Members<'a, W> {
    /// Members of a view, whose facts come by their numbers.
    pub(super) fn new(view: View, fact: impl Fn(RobotId) -> Option<&'a Fact<W>>) -> Self {
        let fact = |index: usize| fact(RobotId(index as u8)).filter(|_| view.contains(RobotId(index as u8)));
        Self { view, facts: core::array::from_fn(fact) }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (RobotId, &'a Fact<W>)> + Clone + '_ {
        (0..).map(RobotId).zip(self.facts).filter_map(|(robot, fact)| Some((robot, fact?)))
    }

    pub(super) fn facts(&self) -> impl Iterator<Item = &'a Fact<W>> + Clone + '_ {
        self.facts.iter().copied().flatten()
    }
}

/// The joint policies of a round, and the search that makes them.
///
/// All that know the facts of the members make the same list, whether or not they fly.
#[derive(Clone, Debug)]
pub struct Policies<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize> {
    list: PolicyList<W, L, MAX_TEAM, M, K>,
    /// Those of paths given by hand, as long as there may be more.
    combinations: Option<Combinations>,
    prospects: Prospects<S, W>,
    /// What the next plan is for, where something is unknown.
    alternatives: Alternatives,
    /// The expected times of the policies over the worlds, where something is unknown.
    expected: Vec<ExpectedTime, K>,
    seekers: Seekers,
    stage: Stage,
}

/// How far the list is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// The combinations of paths given by hand are taken.
    Combining,
    /// The unknowns are to be weighed.
    Begun,
    /// The distance tables of the worlds are made.
    Measuring,
    /// Plans are made for the worlds, and to look first.
    Branching,
    /// The plans are weighed over the worlds.
    Weighing,
    /// Nothing that matters is unknown: plans are made for the likeliest world.
    Planning,
    Done,
}

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize> Policies<S, W, L, M, K> {
    pub(super) const fn new() -> Self {
        Self {
            list: PolicyList::new(),
            combinations: Some(Combinations::new()),
            prospects: Prospects::NONE,
            alternatives: Alternatives::NONE,
            expected: Vec::new(),
            seekers: Seekers::NONE,
            stage: Stage::Combining,
        }
    }

    /// Makes the whole list of a round; `None` if the fact of a member is missing. On maps of up to
    /// `S` cells in `W` words, with sizes as in [`Navigation`](super::Navigation).
    ///
    /// The work has no bound but that of the searches: robots spread it over ticks.
    #[must_use]
    pub fn of_round<'a>(
        mission: &Mission<'_, W>,
        proposal: &Proposal<Cells<W>>,
        fact: impl Fn(RobotId) -> Option<&'a Fact<W>>,
    ) -> Option<Self> {
        if proposal.view.iter().any(|robot| fact(robot).is_none()) {
            return None;
        }
        let mut policies = Self::new();
        while !policies.is_done() {
            let mut budget = u32::MAX;
            policies.advance(mission, proposal, &fact, &mut budget);
        }
        Some(policies)
    }

    /// Works on the list of a round, as far as the budget lets it.
    pub(super) fn advance<'a>(
        &mut self,
        mission: &Mission<'_, W>,
        proposal: &Proposal<Cells<W>>,
        fact: impl Fn(RobotId) -> Option<&'a Fact<W>>,
        budget: &mut u32,
    ) {
        let members = Members::new(proposal.view, fact);
        let walls = proposal.left_out(mission.starts.len());
        let walls = walls.fold(CellSet::EMPTY, |all, (_, Cells(wall))| all.union(&wall));
        let most = listed(K, proposal.walls.iter().map(Blocks::bytes).sum());
        let closed = blocked::<W>(members.facts()).union(&walls);
        while self.work(mission, &members, &closed, most, budget) {}
    }

    /// Stands for all that the list depends on beside the facts: the generator and its sizes.
    pub(super) fn fingerprint(mission: &Mission<'_, W>) -> u64 {
        let list = PolicyList::<W, L, MAX_TEAM, M, K>::digest(mission.policies.into());
        // Robots without room for unknowns agree with others where there are none.
        let branching = if mission.unknowns.is_empty() { 0 } else { BRANCHING << 8 | MAX_WORLDS as u64 };
        list.wrapping_add(branching)
    }

    /// Forgets the list, to make another.
    pub(super) fn clear(&mut self) {
        self.list.start();
        self.combinations = Some(Combinations::new());
        self.expected.clear();
        self.stage = Stage::Combining;
    }

    pub(super) fn is_done(&self) -> bool {
        self.stage == Stage::Done
    }

    /// Returns the joint policies, as far as they are made.
    #[must_use]
    pub fn plans(&self) -> &[TeamPlan] {
        self.list.policies()
    }

    /// What lies ahead in each world, as of the round.
    pub(super) const fn prospects(&self) -> &Prospects<S, W> {
        &self.prospects
    }

    /// The members that go to goals which no robot owns.
    pub(super) const fn seekers(&self) -> Seekers {
        self.seekers
    }

    /// Whether something is unknown that matters: the policies are weighed over worlds.
    pub(super) fn is_branching(&self) -> bool {
        HAS_UNKNOWNS && !self.expected.is_empty()
    }

    /// The expected time of each policy over the worlds, as far as they are weighed; none where
    /// nothing is unknown that matters.
    #[must_use]
    pub fn expected(&self) -> &[ExpectedTime] {
        &self.expected
    }

    /// The first cell on the rest of a path from where something is seen that was not known.
    #[must_use]
    pub fn look_out(&self, map: &Map<W>, path: &Path, moves: u16) -> Option<Cell> {
        let mut later = ahead(path, map, moves).map(|(_, cell)| cell);
        later.find(|&cell| self.is_branching() && self.prospects.has_sight(cell))
    }

    /// The policies as far as they are made, with what the rounds ask about them.
    pub(super) fn on_map<'a>(&'a self, mission: &'a Mission<'a, W>, view: View) -> OnMap<'a, W, K> {
        OnMap { expected: &self.expected, ..OnMap::new(mission, self.plans(), view) }
    }

    /// Returns why the robots do not come to all their targets, if they do not.
    #[must_use]
    pub fn failure(&self) -> Option<Failure> {
        self.list.failure()
    }

    /// Does the next piece of work on the list; returns whether there is more, and budget for it.
    fn work(
        &mut self,
        mission: &Mission<'_, W>,
        members: &Members<'_, W>,
        closed: &CellSet<W>,
        most: usize,
        budget: &mut u32,
    ) -> bool {
        match self.stage {
            Stage::Combining => {
                if self.combine(mission, members, closed, most, budget).is_none() {
                    return false;
                }
                self.stage = if self.plans().is_empty() { Stage::Begun } else { Stage::Done };
            }
            Stage::Begun if HAS_UNKNOWNS && L > 0 => self.begin(mission, members, closed),
            Stage::Begun => self.stage = Stage::Planning,
            Stage::Measuring if HAS_UNKNOWNS => {
                let Some(left) = budget.checked_sub(1) else { return false };
                *budget = left;
                self.measure(mission, members, closed);
            }
            Stage::Branching if HAS_UNKNOWNS => {
                if !self.branch(mission, members, closed, most, budget) {
                    return false;
                }
            }
            Stage::Weighing if HAS_UNKNOWNS => {
                let Some(left) = budget.checked_sub(self.prospects.belief().len() as u32) else {
                    return false;
                };
                *budget = left;
                self.weigh_next(mission);
            }
            Stage::Planning if L == 0 => {
                self.stand(mission, members);
                self.stage = Stage::Done;
            }
            Stage::Planning => {
                let mut targets = Targets::of(mission, members, closed);
                let mut shut = *closed;
                if HAS_UNKNOWNS {
                    let world = self.prospects.likeliest();
                    targets = targets.in_world(mission, &self.prospects, world);
                    shut = shut.union(&self.prospects.closed(mission, world));
                }
                let problem = targets.problem(mission, shut);
                let count = usize::from(mission.policies).min(most);
                if !self.list.work(&problem, count, budget) {
                    return false;
                }
                self.stage = Stage::Done;
            }
            _ => return false,
        }
        true
    }

    /// Finds out whether something is unknown that matters.
    fn begin(&mut self, mission: &Mission<'_, W>, members: &Members<'_, W>, closed: &CellSet<W>) {
        let targets = Targets::of(mission, members, closed);
        self.seekers = targets.seekers();
        self.prospects.start(mission, members, targets.need);
        let is_open = !self.seekers.is_empty() && self.prospects.open(mission).next().is_some();
        self.stage = if is_open { Stage::Measuring } else { Stage::Planning };
    }

    fn measure(&mut self, mission: &Mission<'_, W>, members: &Members<'_, W>, closed: &CellSet<W>) {
        let targets = Targets::of(mission, members, closed);
        self.prospects.make(mission, &targets.goals, closed);
        if self.prospects.to_make() == 0 {
            let worth = self.prospects.value_of_knowing(mission, &targets.seeking());
            self.alternatives = Alternatives::new(mission.decider().looks() && worth >= LOOK_IF_WORTH);
            self.list.start_extending();
            self.stage = Stage::Branching;
        }
    }

    /// Makes the plan for the next alternative, as far as the budget lets it; returns whether that
    /// is done.
    #[inline(never)]
    fn branch(
        &mut self,
        mission: &Mission<'_, W>,
        members: &Members<'_, W>,
        closed: &CellSet<W>,
        most: usize,
        budget: &mut u32,
    ) -> bool {
        let targets = Targets::of(mission, members, closed);
        let current = self.alternatives.current();
        let is_listed = self.prospects.is_listed(mission, &targets.seeking(), current);
        let variant = is_listed.then(|| targets.variant(mission, &self.prospects, current, closed)).flatten();
        match variant {
            Some(Variant::Searched(targets, shut)) => {
                let shut = closed.union(&shut).union(&self.prospects.shut(mission));
                if !self.list.extend(&targets.problem(mission, shut), budget) {
                    return false;
                }
            }
            Some(Variant::Made(plan)) => self.list.include(plan, &mission.map),
            None => (),
        }
        let count = self.prospects.belief().len();
        let has_room = self.plans().len() < most;
        if !has_room || !self.alternatives.go_on(mission.unknowns.len(), count) {
            // Without any plan there is one by which all stand, which says why.
            self.stage = if self.plans().is_empty() { Stage::Planning } else { Stage::Weighing };
        }
        true
    }

    /// Weighs the next plan over the worlds.
    fn weigh_next(&mut self, mission: &Mission<'_, W>) {
        let (index, prospects) = (self.expected.len(), &self.prospects);
        let Some(plan) = self.plans().get(index) else {
            self.stage = Stage::Done;
            return;
        };
        let expected = if mission.decider().infers() {
            prospects.expected(mission, plan, self.seekers, Done::NOTHING, prospects.belief())
        } else {
            ExpectedTime { pragmatic: prospects.by_rule(mission, index, plan), epistemic: 0 }
        };
        if self.expected.push(expected).is_err() {
            self.stage = Stage::Done;
        }
    }

    /// Lets all members stand, where nothing plans for them; returns whether there is room.
    fn stand(&mut self, mission: &Mission<'_, W>, members: &Members<'_, W>) -> bool {
        let is_missing =
            |(robot, fact): &(_, &Fact<W>)| !mission.is_goal_of(members.view, *robot, fact.anchor);
        let missed = members.iter().filter(is_missing).count();
        let plan = TeamPlan::standing(members.facts().map(|fact| fact.anchor));
        plan.is_some_and(|plan| self.list.offer(plan.with_short_by(missed)))
    }

    /// Takes the combinations of paths given by hand, one for each work unit; returns whether it
    /// has come to their end.
    #[inline(never)]
    fn combine(
        &mut self,
        mission: &Mission<'_, W>,
        members: &Members<'_, W>,
        closed: &CellSet<W>,
        most: usize,
        budget: &mut u32,
    ) -> Option<()> {
        let is_for_goals = members.facts().all(|fact| fact.purpose == Purpose::Goal);
        while let Some(combinations) = self.combinations.as_mut().filter(|_| is_for_goals)
            && self.list.policies().len() < most
            && let Some(plan) = self.list.next_place()
        {
            *budget = budget.checked_sub(1)?;
            let Some(is_plan) = combinations.next(mission, members, closed, L == 0, plan) else { break };
            if is_plan {
                self.list.keep();
            }
        }
        self.combinations = None;
        Some(())
    }
}

/// The version of the alternatives that a list has where something is unknown.
const BRANCHING: u64 = 3;

/// Whether there can be anything unknown: else no code for it is in the image.
pub(super) const HAS_UNKNOWNS: bool = MAX_WORLDS > 1;

/// What it must save to know everything for robots to look first, in eighths of a tick.
const LOOK_IF_WORTH: u16 = 4;

/// What [`OnMap::entry`] has found.
#[derive(Clone, Copy, Debug)]
struct Entry {
    /// The policy, the robot and the moves that it has made.
    question: (usize, RobotId, u16),
    answer: Option<(usize, Cell)>,
}

/// Policies as the rounds ask about them, on a map.
///
/// A step of a path is a move: its waits only keep it behind others, and the order does that.
#[derive(Clone, Debug)]
pub(super) struct OnMap<'a, const W: usize, const K: usize> {
    pub mission: &'a Mission<'a, W>,
    pub plans: &'a [TeamPlan],
    pub view: View,
    /// What each takes over the worlds, where something is unknown.
    pub expected: &'a [ExpectedTime],
    /// The question and the answer of the last [`entry`](Self::entry): it is asked of each
    /// teammate.
    entry: core::cell::Cell<Option<Entry>>,
}

impl<'a, const W: usize, const K: usize> OnMap<'a, W, K> {
    /// Policies of a round in which nothing is unknown.
    pub(super) const fn new(mission: &'a Mission<'a, W>, plans: &'a [TeamPlan], view: View) -> Self {
        Self { mission, plans, view, expected: &[], entry: core::cell::Cell::new(None) }
    }

    /// The path of a member in a policy.
    pub(super) fn path(&self, policy: usize, robot: RobotId) -> Option<&'a Path> {
        self.plans.get(policy)?.paths().get(self.view.place(robot)?)
    }

    /// The next move of a member that has made `moves` moves, and its step in the plan.
    pub(super) fn next_move(&self, policy: usize, robot: RobotId, moves: u16) -> Option<(usize, Move)> {
        made(self.path(policy, robot)?).nth(moves.into())
    }

    /// The cell that a member enters with its next move, and the step at whose end it is there.
    fn entry(&self, policy: usize, robot: RobotId, moves: u16) -> Option<(usize, Cell)> {
        let question = (policy, robot, moves);
        if let Some(known) = self.entry.get().filter(|known| known.question == question) {
            return known.answer;
        }
        let (at, _) = self.next_move(policy, robot, moves)?;
        let path = self.path(policy, robot)?;
        let answer = Some((at + 1, path.cell_at(self.map(), at + 1)));
        self.entry.set(Some(Entry { question, answer }));
        answer
    }

    /// The posterior over the policies, by the scores of the members.
    pub(super) fn weigh<'s>(
        &self,
        members: impl Iterator<Item = (RobotId, &'s [Score])> + Clone,
    ) -> WeighedPolicies<K> {
        weigh(self, members, self.mission.precision)
    }

    fn map(&self) -> &'a Map<W> {
        &self.mission.map
    }
}

/// The moves of a path that are no waits, with their steps.
fn made(path: &Path) -> impl Iterator<Item = (usize, Move)> + '_ {
    path.moves().enumerate().filter(|&(_, step)| step != Move::Wait)
}

/// The cells of a path at every step from its start to its end, with the moves made until then.
pub(super) fn visits<'a, const W: usize>(
    path: &'a Path,
    map: &'a Map<W>,
) -> impl Iterator<Item = (u16, Cell)> + 'a {
    let (mut moves, mut visit) = (path.moves(), Some((0, path.start)));
    core::iter::from_fn(move || {
        let (made, here) = visit?;
        let next = |step| match step {
            Move::Wait => (made, here),
            _ => (made + 1, map.neighbour(here, step)),
        };
        visit = moves.next().map(next);
        Some((made, here))
    })
}

/// The cells of a path that come after so many moves, with the moves made until then.
pub(super) fn ahead<'a, const W: usize>(
    path: &'a Path,
    map: &'a Map<W>,
    moves: u16,
) -> impl Iterator<Item = (u16, Cell)> + 'a {
    visits(path, map).filter(move |&(made, _)| made > moves)
}

/// The number of moves, waits left out, that a path makes.
pub(super) fn moves_of(path: &Path) -> u16 {
    path.moves().map(|step| u16::from(step != Move::Wait)).sum()
}

impl<const W: usize, const K: usize> JointPolicies for OnMap<'_, W, K> {
    type Claim = Cells<W>;

    fn len(&self) -> usize {
        self.plans.len()
    }

    /// The ticks of the execution, an eighth of a tick for each that the first robot to arrive
    /// waits for the last, five ticks if they come more than a tick apart, and five if they do not
    /// wait for each other, and the goals that are missed; where something is unknown, the expected
    /// time over the worlds.
    fn cost(&self, policy: usize) -> u16 {
        let Some(plan) = self.plans.get(policy) else { return u16::MAX };
        if let Some(expected) = self.expected.get(policy) {
            return expected.pragmatic;
        }
        let run = plan.execution();
        let idle = if run.is_together() { 0 } else { run.spread.into() };
        let time = 8 * usize::from(run.ticks) + idle;
        let faults = usize::from(!plan.is_together()) + usize::from(!run.is_together());
        let cost = time + APART * faults + SHORT * plan.short_by();
        u16::try_from(cost).unwrap_or(u16::MAX)
    }

    /// What branching is worth: how much earlier the team is done because it goes on by what it
    /// sees.
    fn epistemic(&self, policy: usize) -> u16 {
        self.expected.get(policy).map_or(0, |expected| expected.epistemic)
    }

    /// Whether it ends on a goal of its own. A robot to spare may come as late as it likes.
    fn needs(&self, policy: usize, robot: RobotId) -> bool {
        let is_goal = |path: &Path| self.mission.is_goal_of(self.view, robot, path.end(self.map()));
        self.path(policy, robot).is_some_and(is_goal)
    }

    fn claim(&self, policy: usize, robot: RobotId, step: u16) -> Cells<W> {
        let Some(path) = self.path(policy, robot) else { return Cells(CellSet::EMPTY) };
        let (mut left, mut end) = (CellSet::EMPTY, path.start);
        for (moves, cell) in visits(path, self.map()) {
            end = cell;
            if moves >= step {
                left.insert(cell);
            }
        }
        left.insert(end);
        Cells(left)
    }

    fn moves(&self, policy: usize, robot: RobotId) -> u16 {
        self.path(policy, robot).map_or(0, moves_of)
    }

    fn is_clear(&self, policy: usize, robot: RobotId, step: u16, teammate: RobotId, reported: u16) -> bool {
        let Some((at, to)) = self.entry(policy, robot, step) else { return true };
        let Some(other) = self.path(policy, teammate) else { return false };
        // Most paths have not come that far by then, at a cell a step.
        if usize::from(self.map().manhattan(other.start, to)) > at {
            return true;
        }
        // It has left a cell to which it comes with fewer moves than it has made.
        let mut earlier = visits(other, self.map()).take(at + 1);
        !earlier.any(|(moves, cell)| moves >= reported && cell == to)
    }

    fn is_together(&self, policy: usize) -> bool {
        self.plans.get(policy).is_some_and(JointPlan::is_together)
    }

    fn choose<'s>(&self, members: impl Iterator<Item = (RobotId, &'s [Score])> + Clone) -> Option<usize> {
        cheapest_policy(self, members)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounded::up_to;
    use crate::grid::joint::{Arrival, Errand, Problem, Target};
    use crate::team::rounds::Claim;

    const STARTS: [Cell; 3] = [Cell(0), Cell(14), Cell(40)];

    fn mission() -> Mission<'static, 2> {
        Mission::new(Map::new(7, 7).unwrap(), &STARTS, &[Cell(2), Cell(1), Cell(46)])
    }

    fn plan(paths: &[&[u16]]) -> TeamPlan {
        let cells = |cells: &[u16]| cells.iter().copied().map(Cell).collect::<std::vec::Vec<_>>();
        let through = |path: &&[u16]| Path::through(&mission().map, &cells(path)).unwrap();
        TeamPlan::new(&paths.iter().map(through).collect::<std::vec::Vec<_>>()).unwrap()
    }

    #[test]
    fn a_cell_is_entered_once_those_before_have_left_it() {
        // Robot 0 waits on cell 1 and goes on to 2; robot 2 comes after it; robot 1 is left out.
        let plans = [plan(&[&[0, 1, 1, 2], &[8, 8, 8, 8, 1]])];
        let view = View::full(3).without(RobotId(1));
        let mission = mission();
        let policies = OnMap::<2, 16>::new(&mission, &plans, view);
        let (first, second) = (RobotId(0), RobotId(2));
        assert_eq!([0, 1, 2].map(|done| policies.is_clear(0, second, 0, first, done)), [false, false, true]);
        assert!(policies.is_clear(0, first, 0, second, 0), "who comes later is not waited for");
        assert!(policies.is_clear(0, first, 2, second, 0), "there is no next move");
        assert_eq!([first, RobotId(1), second].map(|robot| policies.moves(0, robot)), [2, 0, 1]);
        assert_eq!(policies.next_move(0, second, 0), Some((3, Move::Up)));
    }

    /// Claims and entries by their definitions, step by step, for random walks of two robots.
    #[test]
    fn claims_and_entries_follow_from_the_cells_at_every_step() {
        let (mission, view) = (mission(), View::full(2));
        let mut random = 1_u32;
        let mut walk = |start: u16| {
            let mut path = Path::at(Cell(start));
            for _ in 0..9 {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let step = Move::from_code((random >> 24) as u8 % 5).unwrap_or(Move::Wait);
                let here = path.end(&mission.map);
                let is_move = mission.map.neighbour(here, step) != here;
                path.push(if is_move { step } else { Move::Wait }).unwrap();
            }
            path
        };
        let mut kept = 0;
        for _ in 0..500 {
            let (own, other) = (walk(8), walk(10));
            let plans = [TeamPlan::new(&[own, other]).unwrap()];
            let policies = OnMap::<2, 16>::new(&mission, &plans, view);
            let at = |path: &Path, time: usize| path.cell_at(&mission.map, time);
            let made =
                |path: &Path, time: usize| path.moves().take(time).filter(|&step| step != Move::Wait).count();
            for (step, reported) in (0..10).flat_map(|step| (0..10).map(move |reported| (step, reported))) {
                let done = made(&other, 9).min(reported);
                let left: CellSet<2> =
                    (0..=9).filter(|&time| made(&other, time) >= done).map(|time| at(&other, time)).collect();
                let (first, second) = (RobotId(0), RobotId(1));
                // What was passed before the last of the moves that are made is not left.
                let claim = policies.claim(0, second, reported as u16).0;
                assert_eq!(
                    claim,
                    if done == reported { left } else { [at(&other, 9)].into_iter().collect() }
                );
                let enters = (1..=9).find(|&time| made(&own, time) == step + 1);
                let last =
                    enters.and_then(|time| (0..=time).rev().find(|&t| at(&other, t) == at(&own, time)));
                let is_clear = last.is_none_or(|last| made(&other, last) < reported);
                assert_eq!(policies.is_clear(0, first, step as u16, second, reported as u16), is_clear);
                kept += usize::from(!is_clear);
            }
        }
        assert!(kept > 1000);
    }

    #[test]
    fn a_claim_is_what_is_left_of_the_path() {
        let plans = [plan(&[&[0, 1, 1, 2], &[14]])];
        let mission = mission();
        let policies = OnMap::<2, 16>::new(&mission, &plans, View::full(2));
        let left = |step| {
            policies.claim(0, RobotId(0), step).0.iter().map(|cell| cell.0).collect::<std::vec::Vec<_>>()
        };
        assert_eq!([0, 1, 2, 9].map(left), [vec(&[0, 1, 2]), vec(&[1, 2]), vec(&[2]), vec(&[2])]);
    }

    fn vec(cells: &[u16]) -> std::vec::Vec<u16> {
        cells.to_vec()
    }

    #[test]
    fn a_plan_costs_its_ticks_its_idle_ends_and_the_goals_it_misses() {
        let even = plan(&[&[0, 1, 2], &[14, 15, 16], &[40]]);
        let [uneven, wide] = [&[14, 15, 16][..], &[14, 15, 16, 17]].map(|own| plan(&[&[0, 1], own, &[40]]));
        let plans = [even, uneven, wide, even.with_short_by(1)];
        let mission = mission();
        let policies = OnMap::<2, 16>::new(&mission, &plans, View::full(3));
        let costs = [0, 1, 2, 3, 4].map(|policy| policies.cost(policy));
        assert_eq!(costs, [16 + 40, 16 + 40, 24 + 2 + 80, 16 + 40 + 256, u16::MAX]);
        assert!(policies.needs(0, RobotId(0)) && !policies.needs(0, RobotId(1)));
        assert!(!policies.is_together(0));
        let joint = [even.arriving(Arrival::Together)];
        let policies = OnMap::<2, 16>::new(&mission, &joint, policies.view);
        assert!(policies.is_together(0));
        assert_eq!(policies.cost(0), 16);
    }

    /// The best plan on an open floor, and where one of the goals is behind another.
    #[test]
    fn a_plan_with_a_barrier_costs_its_spread_unless_its_robots_come_together() {
        let goals = [8, 9, 47].map(Cell);
        let mission = Mission { goals: &goals, ..mission() };
        let errands = STARTS.map(|from| Errand { from, target: Target::Any });
        let blind_alley = (0..21).filter(|cell| ![0, 7, 8, 9, 14].contains(cell)).map(Cell).collect();
        for (closed, is_together) in [(CellSet::EMPTY, true), (blind_alley, false)] {
            let problem = Problem { closed, goals: &goals, need: 3, ..Problem::new(&mission.map, &errands) };
            let mut list = PolicyList::<2, 33, MAX_TEAM, 64, 16>::new();
            list.start();
            assert!(list.work(&problem, 1, &mut u32::MAX.clone()));
            let plans = list.policies();
            let run = plans[0].execute(&mission.map).unwrap();
            assert_eq!((plans[0].is_together(), run.is_together()), (true, is_together), "{run:?}");
            let apart = if is_together { 0 } else { 40 + u16::from(run.spread) };
            let cost = OnMap::<2, 16>::new(&mission, plans, View::full(3)).cost(0);
            assert_eq!(cost, 8 * u16::from(run.ticks) + apart);
        }
    }

    #[test]
    fn inference_chooses_the_policy_of_the_least_cost_that_is_possible_for_all() {
        let paths: [&[&[u16]]; 4] = [
            &[&[0, 1, 2], &[14, 15], &[40]],
            &[&[0, 1], &[14, 7], &[40, 39, 46]],
            &[&[0, 1, 2], &[14, 15, 8, 1], &[40]],
            &[&[0], &[14], &[40]],
        ];
        let plans = paths.map(plan);
        let mission = mission();
        let policies = OnMap::<2, 16>::new(&mission, &plans, View::full(3));
        let mut random = 1_u32;
        for _ in 0..2000 {
            let mut draw = || {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                if random >> 28 == 0 { u8::MAX } else { (random >> 24) as u8 / 16 }
            };
            let scores: [[Score; 4]; 3] =
                core::array::from_fn(|_| core::array::from_fn(|_| Score { delay: draw(), price: draw() }));
            let members = scores.iter().enumerate().map(|(robot, list)| (RobotId(robot as u8), &list[..]));
            let weighed = policies.weigh(members.clone());
            assert_eq!(policies.choose(members), weighed.choose().map(|choice| choice.policy));
            let likeliest = weighed.choose().map_or(0.0, |choice| choice.joint);
            assert!(weighed.posterior().iter().all(|&p| p <= likeliest));
        }
    }

    /// The best joint policy of robots 0 and 1, on these cells, where robot 2 may be on `wall`.
    fn best_without_robot_2(
        own_goals: &[Option<Cell>],
        anchors: [u16; 2],
        wall: &[u16],
    ) -> (std::vec::Vec<u16>, usize) {
        let mission = Mission { own_goals, ..mission() };
        let wall = Cells(wall.iter().copied().map(Cell).collect::<CellSet<2>>());
        let view = View::full(2);
        let proposal = Proposal { round: 3, view, walls: up_to([wall.to_wire(1)]) };
        let facts = anchors.map(|anchor| Fact { anchor: Cell(anchor), ..Fact::default() });
        let fact = |robot: RobotId| facts.get(robot.index());
        let policies = Policies::<49, 2, 33, 64, 16>::of_round(&mission, &proposal, fact).unwrap();
        let best = policies.plans()[0];
        (best.paths().iter().map(|path| path.end(&mission.map).0).collect(), best.short_by())
    }

    #[test]
    fn a_robot_on_a_goal_where_a_lost_one_may_be_keeps_it() {
        let keeps = |anchors, wall: &[u16]| best_without_robot_2(&[], anchors, wall);
        assert_eq!(keeps([2, 14], &[1, 2, 3]), (std::vec![2, 46], 0));
        assert_eq!(keeps([3, 14], &[1, 2, 3]).1, 1, "nobody enters the wall");
        assert_eq!(keeps([2, 1], &[1, 2, 3]), (std::vec![2, 1], 0));
        let own = [Some(Cell(2)), None, None];
        assert_eq!(best_without_robot_2(&own, [2, 14], &[2]), (std::vec![2, 1], 0));
    }
}
