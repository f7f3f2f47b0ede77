//! The joint policies that a team chooses from: several plans for one problem.

use super::super::{Cell, CellSet, Map, WaitPlace};
use super::attempt::{Choice, LATER_TOGETHER};
use super::network::Turn;
use super::planner::JointPlanner;
use super::walk::MOST_CHANGES;
use super::{Errand, Failure, JointPlan, Problem, Target, fixed_paths, flow_planner};
use crate::actions::HORIZON;

/// The version of the generator. Robots that run different ones do not have equal plans, and must
/// not agree on any.
pub const VERSION: u16 = 5;

/// The goals of which other sets are tried.
const MOST_GOALS: usize = 8;

/// How many steps longer than the best plan another one may be.
const MOST_DETOUR: usize = 16;

/// Up to `K` different joint plans for one problem, in an order that all robots share.
///
/// The first one is the best: see [`JointPlanner`]. The others are, as far as there are any: the
/// plan of fewest steps, if it is shorter because the robots do not arrive together; the plan in
/// which the robots take turns the other way round; plans without one of the goals; plans to other
/// goals, those first that have most goals in common with the best one; plans around a cell of the
/// best one; the best one later by two steps, four, and so on. A list is never empty:
/// where no target can be reached, all robots stand.
///
/// ```
/// use iibt_core::grid::joint::{Errand, Failure, PolicyList, Problem, Target};
/// use iibt_core::grid::{Cell, Map, words};
///
/// let map = Map::<{ words(7, 7) }>::new(7, 7)?.avoiding([Cell(24)]);
/// let errands = [21, 35].map(|from| Errand { from: Cell(from), target: Target::Any });
/// let goals = [27, 41].map(Cell);
/// let problem = Problem { goals: &goals, need: 2, ..Problem::new(&map, &errands) };
///
/// let mut list = PolicyList::<2, 33, 8, 64, 16>::new();
/// list.start();
/// while !list.work(&problem, 4, &mut 10) {} // ten work units a tick
/// assert_eq!((list.policies().len(), list.failure()), (4, None));
/// for policy in list.policies() {
///     assert_eq!((policy.conflict(&map), policy.following(&map)), (None, None));
///     assert!(policy.paths().iter().all(|path| goals.contains(&path.end(&map))));
/// }
///
/// // A wall between the robots and their goals.
/// let wall = [3, 10, 17, 24, 31, 38, 45].map(Cell).into_iter().collect();
/// list.start();
/// while !list.work(&Problem { closed: wall, ..problem }, 4, &mut 10) {}
/// assert_eq!((list.policies().len(), list.policies()[0].steps()), (1, 0));
/// assert_eq!(list.failure(), Some(Failure::NoWay));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PolicyList<const W: usize, const L: usize, const N: usize, const M: usize, const K: usize> {
    planner: JointPlanner<W, L, N, M>,
    policies: [JointPlan<N>; K],
    len: usize,
    failure: Option<Failure>,
    source: Source,
    /// The turns of the best plan, and the cells that the others were led around so far.
    turn: Turn,
    avoided: CellSet<W>,
}

/// Where the next plan of a list comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    Best,
    Soonest,
    OtherTurn,
    /// Without the goal of this robot.
    OtherGoals(usize),
    /// To these of the first eight goals, a bit for each.
    Goals(u8),
    /// Around this cell.
    Around(Cell),
    /// For the targets of the owners, when there is no plan for all: the others end anywhere.
    Owners,
    /// For the targets of this owner alone, when there is no plan for all of them; for those of
    /// none when there is no such owner.
    Alone(usize),
    Done,
}

impl<const W: usize, const L: usize, const N: usize, const M: usize, const K: usize>
    PolicyList<W, L, N, M, K>
{
    /// A list, ready for the first problem.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            planner: JointPlanner::new(),
            policies: [JointPlan::NOBODY; K],
            len: 0,
            failure: None,
            source: Source::Best,
            turn: Turn::BlackLast,
            avoided: CellSet::EMPTY,
        }
    }

    /// Returns a hash of all that the policies depend on beside the problem: the version of the
    /// generator, its sizes, its bounds, and the number of policies asked for. Robots whose hashes
    /// differ cannot agree.
    #[must_use]
    pub const fn digest(count: usize) -> u64 {
        let sizes = [VERSION as usize, W, L, N, M, K, HORIZON, count];
        let bounds = [
            LATER_TOGETHER,
            MOST_DETOUR,
            MOST_CHANGES,
            fixed_paths::LONGEST_REST,
            fixed_paths::MOST_UNITS as usize,
            flow_planner::MOST_UNITS as usize,
            JointPlanner::<W, L, N, M>::MOST_CALLS as usize,
        ];
        fnv(&bounds, fnv(&sizes, FNV_OFFSET))
    }

    /// Starts over, for another problem.
    pub fn start(&mut self) {
        (self.len, self.failure) = (0, None);
        self.avoided = CellSet::EMPTY;
        self.source = Source::Best;
        self.planner.start();
    }

    /// Goes on with the list of up to `count` policies, at most `K`; returns whether it is done.
    ///
    /// The problem and the count must be the same from one start to the next. Takes units from the
    /// budget as [`JointPlanner::work`] does; the list does not depend on how the work was cut.
    #[inline(never)]
    pub fn work(&mut self, problem: &Problem<'_, W>, count: usize, budget: &mut u32) -> bool {
        while self.source != Source::Done {
            let mut errands = [Errand { from: Cell(0), target: Target::Stand }; N];
            let mut goals = [Cell(0); MOST_GOALS];
            let variant = self.variant(problem, &mut errands, &mut goals);
            let result = &self.planner.work(&variant, budget); // where it is: it holds a plan
            let Some(result) = result else { return false };
            self.take(problem, result);
            self.go_on(problem, count.min(K));
        }
        true
    }

    /// Starts over, for a list whose plans are each for a [problem of its own](Self::extend).
    pub fn start_extending(&mut self) {
        self.start();
        self.planner.start_with(Choice::SOONEST);
    }

    /// Goes on with the soonest plan for one problem, whose robots arrive when they can, and adds
    /// it unless the list has it; returns whether that is done and another problem of the same
    /// robots may come.
    #[inline(never)]
    pub fn extend(&mut self, problem: &Problem<'_, W>, budget: &mut u32) -> bool {
        let result = &self.planner.work(problem, budget); // where it is: it holds a plan
        let Some(result) = result else { return false };
        if let Ok(plan) = result
            && let Some(slot) = self.policies.get_mut(self.len)
        {
            slot.clone_from(plan);
            slot.stagger::<W, L>(problem.map);
            self.keep_new();
        }
        self.planner.start_with(Choice::SOONEST);
        true
    }

    /// Adds a plan that was made elsewhere, whose robots arrive when they can, unless the list has
    /// it or is full. Only a list that is [extended](Self::start_extending) takes it.
    pub fn include(&mut self, plan: JointPlan<N>, map: &Map<W>) {
        if let Some(slot) = self.policies.get_mut(self.len) {
            *slot = plan;
            slot.stagger::<W, L>(map);
            self.keep_new();
        }
    }

    /// Adds a plan that was made elsewhere; returns whether there was room. Only a list that has
    /// just begun takes plans, and it is worked on no further.
    pub fn offer(&mut self, plan: JointPlan<N>) -> bool {
        let is_taken = self.next_place().map(|slot| *slot = plan).is_some();
        if is_taken {
            self.keep();
        }
        is_taken
    }

    /// Where the next plan is made that is made elsewhere: a copy of one takes much of a small
    /// stack. `None` in a full list; [`keep`](Self::keep) adds the plan.
    pub(crate) fn next_place(&mut self) -> Option<&mut JointPlan<N>> {
        self.policies.get_mut(self.len)
    }

    /// Adds the plan that was made in the [next place](Self::next_place).
    pub(crate) fn keep(&mut self) {
        self.len = (self.len + 1).min(K);
    }

    /// The policies so far, the best one first.
    #[must_use]
    pub fn policies(&self) -> &[JointPlan<N>] {
        self.policies.get(..self.len).unwrap_or(&self.policies)
    }

    /// Why there is no plan for all targets of the problem; the policies are then for one owner's
    /// target each, or all robots stand.
    #[must_use]
    pub fn failure(&self) -> Option<Failure> {
        self.failure
    }

    /// The problem that the plan from the present source is for.
    fn variant<'a>(
        &self,
        problem: &Problem<'a, W>,
        errands: &'a mut [Errand; N],
        goals: &'a mut [Cell; MOST_GOALS],
    ) -> Problem<'a, W> {
        match self.source {
            Source::Goals(chosen) => {
                let mut count = 0;
                for (slot, goal) in goals.iter_mut().zip(subset(problem.goals, chosen)) {
                    *slot = goal;
                    count += 1;
                }
                Problem { goals: goals.get(..count).unwrap_or_default(), ..*problem }
            }
            Source::Around(cell) => {
                let closed = problem.closed.union(&[cell].into_iter().collect());
                Problem { closed, ..*problem }
            }
            Source::Owners => Problem { need: 0, ..*problem },
            Source::Alone(owner) => {
                for (slot, errand) in errands.iter_mut().zip(released(problem, owner)) {
                    *slot = errand;
                }
                let count = problem.errands.len().min(N);
                Problem { errands: errands.get(..count).unwrap_or_default(), ..*problem }
            }
            _ => *problem,
        }
    }

    /// Adds what the planner has found.
    #[inline(never)]
    fn take(&mut self, problem: &Problem<'_, W>, result: &Result<JointPlan<N>, Failure>) {
        match (self.source, result) {
            (Source::Alone(owner), Ok(plan)) => {
                let owners = problem.owned().count();
                let unserved = owners - usize::from(owner < owners);
                self.add(plan, plan.short_by() + unserved);
            }
            (Source::Owners, Ok(plan)) => self.add(plan, problem.need),
            (_, Ok(plan)) => self.add(plan, plan.short_by()),
            (Source::Best, &Err(failure)) => self.failure = Some(failure),
            (_, Err(_)) => {}
        }
        if self.source == Source::Best {
            self.turn = self.planner.turn();
        }
    }

    /// Adds a plan that is short of `short_by` goals, unless it is one of the list.
    fn add(&mut self, plan: &JointPlan<N>, short_by: usize) {
        if let Some(slot) = self.policies.get_mut(self.len) {
            slot.clone_from(plan);
            slot.set_short_by(short_by);
            self.keep_new();
        }
    }

    /// Keeps the plan after the last one unless it is one of the list.
    fn keep_new(&mut self) {
        let Some((new, known)) = self.policies.get(..=self.len).and_then(<[_]>::split_last) else { return };
        let is_known = known.iter().any(|policy| policy.paths() == new.paths());
        self.len += usize::from(!is_known);
    }

    /// Begins with the next source, or ends the list.
    fn go_on(&mut self, problem: &Problem<'_, W>, count: usize) {
        self.source = match self.failure {
            _ if self.len >= count => Source::Done,
            Some(failure) => self.next_alone(problem, failure),
            None => self.next_source(problem, count),
        };
        if self.source == Source::Done {
            self.finish(problem, count);
        } else {
            self.planner.start_with(self.choice(problem));
        }
    }

    fn next_alone(&self, problem: &Problem<'_, W>, failure: Failure) -> Source {
        let owners = problem.owned().count();
        let next = match self.source {
            Source::Best if owners > 0 && problem.need > 0 && failure == Failure::NotFound => {
                return Source::Owners;
            }
            Source::Alone(owner) => owner + 1,
            _ if owners == 1 => 1,
            _ => 0,
        };
        let is_of_use = next < owners || (next == owners && self.len == 0);
        let is_sound = !matches!(failure, Failure::Invalid(_));
        if is_of_use && is_sound && owners > 0 { Source::Alone(next) } else { Source::Done }
    }

    /// The next source that can have a plan.
    fn next_source(&mut self, problem: &Problem<'_, W>, count: usize) -> Source {
        let has_owners = problem.owned().next().is_some();
        let robots = problem.errands.len();
        match self.source {
            Source::Best if !has_owners && self.planner.may_be_shorter() => Source::Soonest,
            Source::Best | Source::Soonest => Source::OtherTurn,
            Source::OtherTurn if problem.goals.len() > problem.need => Source::OtherGoals(0),
            Source::OtherGoals(robot) if robot + 1 < robots => Source::OtherGoals(robot + 1),
            Source::OtherGoals(_) | Source::Goals(_) => {
                self.next_goals(problem).unwrap_or_else(|| self.next_cell(problem, count))
            }
            Source::OtherTurn | Source::Around(_) => self.next_cell(problem, count),
            Source::Owners | Source::Alone(_) | Source::Done => Source::Done,
        }
    }

    /// The goals after those of the present source of which as many are not those of the best plan;
    /// or one more.
    fn next_goals(&self, problem: &Problem<'_, W>) -> Option<Source> {
        let chosen = if let Source::Goals(chosen) = self.source { chosen } else { 0 };
        let best = self.policies.first()?;
        let ends = best.paths().iter().map(|path| path.end(problem.map));
        let used =
            problem.goals.iter().take(MOST_GOALS).map(|goal| u8::from(ends.clone().any(|end| end == *goal)));
        let used = used.rev().fold(0, |mask: u8, used| mask << 1 | used);
        let all = u8::MAX >> MOST_GOALS.saturating_sub(problem.goals.len()).min(MOST_GOALS - 1);
        let others = |mask: u8| (mask & !used).count_ones();
        let is_choice = |mask: u8| mask & !all == 0 && mask.count_ones() == used.count_ones() && mask != used;
        let later = |mask: &u8| (others(*mask), *mask) > (others(chosen), chosen);
        let next = (1..=u8::MAX).filter(|&mask| is_choice(mask)).filter(later);
        next.min_by_key(|&mask| (others(mask), mask)).map(Source::Goals)
    }

    /// The cell nearest to the middle of the best plan that no plan was led around yet.
    fn next_cell(&mut self, problem: &Problem<'_, W>, count: usize) -> Source {
        let Some(best) = self.policies.first().filter(|_| self.avoided.len() < count) else {
            return Source::Done;
        };
        let starts: CellSet<W> = problem.starts().collect();
        let steps = best.steps();
        let cells = best.paths().iter().flat_map(|path| path.cells(problem.map).enumerate());
        let left = cells.filter(|&(_, cell)| !self.avoided.contains(cell) && !starts.contains(cell));
        let Some((_, cell)) = left.min_by_key(|&(step, _)| (2 * step).abs_diff(steps)) else {
            return Source::Done;
        };
        self.avoided.insert(cell);
        Source::Around(cell)
    }

    fn choice(&self, problem: &Problem<'_, W>) -> Choice {
        let Some(best) = self.policies.first().filter(|_| self.failure.is_none()) else {
            return Choice::BEST;
        };
        let other = Choice {
            latest: Some(best.steps() + MOST_DETOUR),
            most_short: Some(best.short_by()),
            ..Choice::BEST
        };
        match self.source {
            Source::Soonest => Choice { latest: best.steps().checked_sub(1), staggered: true, ..other },
            Source::OtherTurn => Choice { turn: Some(self.turn.other()), ..other },
            Source::OtherGoals(robot) => {
                let without = best.paths().get(robot).map(|path| path.end(problem.map));
                Choice { without, ..other }
            }
            _ => other,
        }
    }

    /// Fills the list with the best plan set out later, or lets all robots stand.
    #[inline(never)]
    fn finish(&mut self, problem: &Problem<'_, W>, count: usize) {
        if let Some(first) = self.policies.first_mut().filter(|_| self.len == 0) {
            first.stand(problem.starts().take(N));
            first.set_short_by(problem.need + problem.owned().count());
            self.len = 1;
        }
        // What begins at a certain step cannot begin later.
        let steps = self.policies.first().map_or(0, JointPlan::steps);
        let can_be_later = steps > 0 && problem.prefixes.is_empty();
        let most = if can_be_later { JointPlanner::<W, L, N, M>::LATEST.saturating_sub(steps) } else { 0 };
        for delay in (2..=most).step_by(2) {
            if self.len < count
                && let Some((best, later)) = self.policies.split_first_mut()
                && let Some(slot) = later.get_mut(self.len - 1)
            {
                slot.clone_from(best);
                slot.delay(delay);
                self.keep_new();
            }
        }
    }
}

impl<const W: usize, const L: usize, const N: usize, const M: usize, const K: usize> Default
    for PolicyList<W, L, N, M, K>
{
    fn default() -> Self {
        Self::new()
    }
}

/// The goals with a bit in a mask.
fn subset(goals: &[Cell], mask: u8) -> impl Iterator<Item = Cell> + '_ {
    let has_bit = move |&(index, _): &(usize, &Cell)| mask >> index & 1 == 1;
    goals.iter().take(MOST_GOALS).enumerate().filter(has_bit).map(|(_, goal)| *goal)
}

/// The errands with the target of one owner only: the others may end anywhere.
fn released<'a, const W: usize>(
    problem: &Problem<'a, W>,
    owner: usize,
) -> impl Iterator<Item = Errand> + use<'a, W> {
    let mut owners = 0;
    problem.errands.iter().map(move |&errand| {
        let Target::Own(_) = errand.target else { return errand };
        owners += 1;
        if owners == owner + 1 { errand } else { Errand { target: Target::Any, ..errand } }
    })
}

impl<const N: usize> JointPlan<N> {
    /// Puts waits before the first step of each robot that moves.
    fn delay(&mut self, steps: usize) {
        for path in self.paths_mut().iter_mut().filter(|path| !path.is_empty()) {
            *path = path.with_waits(path.len() + steps, WaitPlace::AtStart).unwrap_or(*path);
        }
        self.execution = self.execution.after(steps);
    }
}

const FNV_OFFSET: u64 = 0xcbf2_9ce4_8422_2325;

/// Fowler, Noll and Vo's hash 1a of numbers as 32-bit words, little-endian, after a hash so far.
const fn fnv(numbers: &[usize], so_far: u64) -> u64 {
    let (mut rest, mut hash) = (numbers, so_far);
    while let [number, others @ ..] = rest {
        let mut shift = 0;
        while shift < 32 {
            hash = (hash ^ ((*number >> shift) as u64 & 0xff)).wrapping_mul(0x0000_0100_0000_01b3);
            shift += 8;
        }
        rest = others;
    }
    hash
}
