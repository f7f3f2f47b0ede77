//! One joint plan for a problem, by the cheapest search that has one.

use super::super::{Cell, CellSet, Map, Move, Path};
use super::attempt::{Attempt, Choice, Kind, LATER_TOGETHER};
use super::flow::{Flow, Query};
use super::network::{Network, Turn};
use super::owners::Precedence;
use super::survey::Survey;
use super::{Arrival, Failure, JointPlan, Lacam, Prioritised, Problem, Target, execution, owned};

/// Finds the joint plan of fewest steps in which robots take turns by the colour of their cells;
/// see the [module](super).
///
/// `W` are the words of a set of cells, `L` one more than the most steps, `N` the most robots, `M`
/// the nodes of the search for targets that several robots own.
///
/// ```
/// use iibt_core::grid::joint::{Errand, JointPlanner, Problem, Target};
/// use iibt_core::grid::{Cell, CellSet, Map};
///
/// // Two robots into a dead end: the first one has to go in first.
/// let map = Map::<1>::drawn(".#####\n......\n.#####").map_err(|_| "no map")?;
/// let errands = [0, 12].map(|from| Errand { from: Cell(from), target: Target::Any });
/// let goals = [10, 11].map(Cell);
/// let (closed, need) = (CellSet::EMPTY, 2);
/// let problem = Problem { map: &map, closed, errands: &errands, goals: &goals, need };
///
/// let mut planner = JointPlanner::<1, 33, 8, 64>::new();
/// planner.start();
/// let mut ticks = 0;
/// let plan = loop {
///     let mut budget = 10; // work units of one tick
///     ticks += 1;
///     if let Some(plan) = planner.work(&problem, &mut budget) {
///         break plan?;
///     }
/// };
/// assert!(ticks > 1 && plan.conflict(&map).is_none() && plan.following(&map).is_none());
/// assert_eq!(plan.steps(), 7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct JointPlanner<const W: usize, const L: usize, const N: usize, const M: usize> {
    pub(super) flow: Flow<W, L, N>,
    survey: Survey<W>,
    stage: Stage,
    pub(super) choice: Choice,
    /// Where the robots of the flow end, how many of them on goals, and how many goals fewer than
    /// needed that is.
    pub(super) goals: CellSet<W>,
    pub(super) need: usize,
    short_by: usize,
    /// The fewest steps to try, and the most goals that a failed attempt came to.
    pub(super) fewest_steps: usize,
    most_reached: usize,
    /// The units that the searches have taken since the start.
    pub(super) spent: u32,
    pub(super) attempt: Attempt,
    pub(super) precedence: Precedence,
    /// The best plan so far that arrives together, and the best one at all.
    together: Found<N>,
    pub(super) plain: Found<N>,
    /// What follows when no fixed path of the owners leaves the others a way.
    prioritised: Prioritised<W, L, N>,
    lacam: Lacam<W, N, M>,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Stage {
    Begin,
    Survey,
    Flow,
    /// Whether the robots of the plan that was found arrive together indeed.
    Execute,
    Choose,
    /// Robots plan one after the other, each with a target of its own.
    Prioritise,
    /// The search over the states of all robots.
    Search,
    /// With the plan in `plain`, or without one.
    Done(Option<Failure>),
}

/// A plan and the turns in which it was found.
type Found<const N: usize> = Option<(JointPlan<N>, Turn)>;

impl<const W: usize, const L: usize, const N: usize, const M: usize> JointPlanner<W, L, N, M> {
    pub(super) const LATEST: usize = Flow::<W, L, N>::LATEST;
    /// The most successors that the search over joint states tries.
    pub(super) const MOST_CALLS: u32 = 16 * M as u32;
    const SIZES: () = assert!(L >= 2 && L <= 256 && N >= 1 && N <= 32);

    /// A planner, ready for the first problem.
    #[must_use]
    pub const fn new() -> Self {
        let () = Self::SIZES;
        Self {
            flow: Flow::new(),
            survey: Survey::begin(CellSet::EMPTY, CellSet::EMPTY, 0),
            stage: Stage::Begin,
            choice: Choice { turn: None, without: None, latest: None, most_short: None, staggered: false },
            goals: CellSet::EMPTY,
            need: 0,
            short_by: 0,
            fewest_steps: 0,
            most_reached: 0,
            spent: 0,
            attempt: Attempt { kind: Kind::SoonTogether, turn: Turn::BlackLast, is_second: false },
            precedence: Precedence { second_first: false, rest: 0, steps: 0 },
            together: None,
            plain: None,
            prioritised: Prioritised::new(),
            lacam: Lacam::new(Self::MOST_CALLS),
        }
    }

    /// Begins anew, for another problem.
    pub fn start(&mut self) {
        self.start_with(Choice::default());
    }

    /// Goes on with the plan for a problem, which must be the same from one start to the next.
    ///
    /// Takes one unit from the budget for each layer of a search, for each change of a path, and
    /// for each execution. Returns `None` when the budget is used up; the result does not depend on
    /// how the work was cut.
    ///
    /// # Errors
    /// Every [`Failure`].
    pub fn work(
        &mut self,
        problem: &Problem<'_, W>,
        budget: &mut u32,
    ) -> Option<Result<JointPlan<N>, Failure>> {
        loop {
            match self.stage {
                Stage::Done(failure) => return Some(self.result(failure)),
                Stage::Survey => {
                    self.survey.work(&self.flow.network, budget)?;
                    self.stage = self.surveyed(problem);
                }
                Stage::Flow => {
                    let before = *budget;
                    let found = self.flow.work(problem.map, budget);
                    self.spent += before - *budget;
                    let found = found?;
                    self.stage = self.searched(problem, found);
                }
                Stage::Prioritise => {
                    let targets = owned::assigned(problem);
                    self.stage = match self.prioritised.work(problem, &targets, budget)? {
                        Ok(plan) => self.found(problem, &plan),
                        Err(_) => Stage::Search,
                    };
                }
                Stage::Search => {
                    let targets = owned::assigned(problem);
                    self.stage = match self.lacam.work(problem, &targets, budget)? {
                        Ok(plan) => self.found(problem, &plan),
                        Err(failure) => Stage::Done(Some(failure)),
                    };
                }
                Stage::Begin | Stage::Execute | Stage::Choose => {
                    *budget = budget.checked_sub(1)?;
                    self.stage = self.unit(problem);
                }
            }
        }
    }

    /// Begins anew with one of the plans for a problem.
    pub(super) fn start_with(&mut self, choice: Choice) {
        self.choice = choice;
        self.stage = Stage::Begin;
        (self.together, self.plain, self.most_reached, self.spent) = (None, None, 0, 0);
        self.prioritised.start();
        self.lacam.start();
    }

    /// Takes a plan of all robots' own targets, with a barrier before the last moves if that is of
    /// use.
    fn found(&mut self, problem: &Problem<'_, W>, plan: &JointPlan<N>) -> Stage {
        let together = plan.arriving(Arrival::Together);
        let arrives = self.arrives(problem, &together);
        self.plain = Some((if arrives { together } else { *plan }, Turn::default()));
        Stage::Done(None)
    }

    /// Whether a plan could have fewer steps than the one that was found if the robots did not
    /// arrive together.
    pub(super) fn may_be_shorter(&self) -> bool {
        self.together.is_some_and(|(plan, _)| plan.steps() > self.fewest_steps)
    }

    /// The turns of the plan that was found.
    pub(super) fn turn(&self) -> Turn {
        self.plain.map_or(Turn::default(), |(_, turn)| turn)
    }

    fn unit(&mut self, problem: &Problem<'_, W>) -> Stage {
        match self.stage {
            Stage::Begin => self.begin(problem),
            Stage::Execute => self.execute(problem),
            Stage::Choose => self.choose(problem),
            stage => stage,
        }
    }

    fn begin(&mut self, problem: &Problem<'_, W>) -> Stage {
        if let Err(error) = problem.check(N) {
            return Stage::Done(Some(Failure::Invalid(error)));
        }
        self.flow.network = Network::of(problem);
        self.flow.unfix(0);
        let goals: CellSet<W> = problem.goals.iter().copied().collect();
        let held = problem.held();
        let closed = held.union(&self.choice.without.into_iter().collect());
        self.goals = goals.without(&closed).intersection(self.flow.network.enterable());
        self.need = problem.need.saturating_sub(goals.intersection(&held).len());
        self.survey = Survey::begin(problem.free_starts().collect(), self.goals, self.need);
        Stage::Survey
    }

    fn surveyed(&mut self, problem: &Problem<'_, W>) -> Stage {
        let most = self.survey.reachable();
        self.short_by = self.need.saturating_sub(most);
        self.need = most;
        self.fewest_steps = self.survey.fewest_steps();
        if self.choice.most_short.is_some_and(|most| self.short_by > most) {
            return Stage::Done(Some(Failure::NotFound));
        }
        if problem.owned().next().is_some() {
            return self.with_owners(problem);
        }
        if most == 0 {
            return self.nothing_to_reach(problem);
        }
        let farthest = self.survey.farthest().unwrap_or_default();
        let turn = self.flow.network.turn_of(farthest, self.fewest_steps);
        let kind = if self.choice.staggered { Kind::Plain } else { Kind::SoonTogether };
        self.first_attempt(problem, kind, turn)
    }

    /// All stand: because no goal is needed, or because none can be reached.
    fn nothing_to_reach(&mut self, problem: &Problem<'_, W>) -> Stage {
        if self.short_by > 0 && problem.free_starts().next().is_some() {
            return Stage::Done(Some(Failure::NoWay));
        }
        self.plain = JointPlan::standing(problem.starts()).map(|plan| (plan, Turn::default()));
        Stage::Done(None)
    }

    fn first_attempt(&mut self, problem: &Problem<'_, W>, kind: Kind, turn: Turn) -> Stage {
        let turn = self.choice.turn.unwrap_or(turn);
        self.attempt(problem, Attempt { kind, turn, is_second: false })
    }

    fn attempt(&mut self, problem: &Problem<'_, W>, attempt: Attempt) -> Stage {
        self.attempt = attempt;
        let starts: CellSet<W> = problem.free_starts().collect();
        let is_plain = attempt.kind == Kind::Plain;
        let entered_last = if is_plain { CellSet::EMPTY } else { self.goals.without(&starts) };
        self.flow.network.set_rules(attempt.turn, entered_last);
        let (first, latest) = self.steps_to_try();
        let query = Query { goals: self.goals, need: self.need, first, latest };
        self.flow.begin(problem.free_starts(), query);
        Stage::Flow
    }

    /// The fewest and the most steps of an attempt, which must have fewer than what was found
    /// before.
    fn steps_to_try(&self) -> (usize, usize) {
        let below = |found: &Found<N>| found.map_or(usize::MAX, |(plan, _)| plan.steps().saturating_sub(1));
        let fewest = self.fewest_steps;
        let (first, most) = match self.attempt.kind {
            Kind::Plain | Kind::Owner(_) | Kind::Around => (fewest.min(Self::LATEST), below(&self.plain)),
            Kind::SoonTogether => (fewest, below(&self.together).min(fewest + LATER_TOGETHER)),
            Kind::LateTogether => {
                let plain = self.plain.map_or(0, |(plan, _)| plan.steps());
                (fewest + LATER_TOGETHER + 1, below(&self.together).min(plain + LATER_TOGETHER))
            }
        };
        (first, most.min(self.choice.latest.unwrap_or(usize::MAX)))
    }

    fn searched(&mut self, problem: &Problem<'_, W>, found: bool) -> Stage {
        if let Kind::Owner(row) = self.attempt.kind {
            return self.owner_searched(problem, row, found);
        }
        if !found {
            self.most_reached = self.most_reached.max(self.flow.reached_goals());
            return self.next_attempt(problem);
        }
        if matches!(self.attempt.kind, Kind::SoonTogether | Kind::LateTogether) {
            return Stage::Execute;
        }
        self.plain = self.read_plan(problem).map(|plan| (plan, self.attempt.turn));
        self.next_attempt(problem)
    }

    fn execute(&mut self, problem: &Problem<'_, W>) -> Stage {
        let plan = self.read_plan(problem).map(|plan| plan.arriving(Arrival::Together));
        let execution = plan.and_then(|plan| execution::run(&plan, problem.map, self.flow.scratch()));
        if execution.is_some_and(|execution| execution.spread <= 1) {
            self.together = plan.map(|plan| (plan, self.attempt.turn));
        }
        self.next_attempt(problem)
    }

    fn next_attempt(&mut self, problem: &Problem<'_, W>) -> Stage {
        let Attempt { kind, turn, is_second } = self.attempt;
        if kind == Kind::Around {
            return self.searched_around(problem);
        }
        if !is_second && self.choice.turn.is_none() {
            return self.attempt(problem, Attempt { kind, turn: turn.other(), is_second: true });
        }
        match kind {
            Kind::SoonTogether if self.together.is_some() => Stage::Choose,
            Kind::SoonTogether => self.first_attempt(problem, Kind::Plain, turn.other()),
            Kind::Plain if self.choice.staggered => Stage::Choose,
            Kind::Plain if self.plain.is_none() => self.fewer_goals(problem),
            Kind::Plain => self.first_attempt(problem, Kind::LateTogether, turn.other()),
            Kind::LateTogether | Kind::Owner(_) | Kind::Around => Stage::Choose,
        }
    }

    /// Goes on with as many goals as the failed attempts came to.
    fn fewer_goals(&mut self, problem: &Problem<'_, W>) -> Stage {
        self.lower_need();
        if self.need == 0 || self.choice != Choice::default() {
            return Stage::Done(Some(Failure::NotFound));
        }
        self.first_attempt(problem, Kind::SoonTogether, self.attempt.turn)
    }

    pub(super) fn lower_need(&mut self) {
        let need = self.most_reached.min(self.need.saturating_sub(1));
        self.short_by += self.need - need;
        (self.need, self.most_reached, self.fewest_steps) = (need, 0, 0);
    }

    /// The plan that arrives together if there is one; else the plain one, with a barrier before
    /// the last moves if that is of use.
    fn choose(&mut self, problem: &Problem<'_, W>) -> Stage {
        let Some((plan, turn)) = self.together.or(self.plain) else {
            return Stage::Done(Some(Failure::NotFound));
        };
        let together = plan.arriving(Arrival::Together);
        let arrives = plan.is_together() || (!self.choice.staggered && self.arrives(problem, &together));
        self.plain = Some((if arrives { together } else { plan }, turn));
        Stage::Done(None)
    }

    /// Whether the barrier of a plan brings its last moves as close together as goals in series let
    /// them be: a tick apart from one robot to the next.
    fn arrives(&mut self, problem: &Problem<'_, W>, plan: &JointPlan<N>) -> bool {
        let movers = plan.paths().iter().filter(|path| !path.is_empty()).count();
        let execution = execution::run(plan, problem.map, self.flow.scratch());
        execution.is_some_and(|execution| execution.spread <= movers.saturating_sub(1).max(1))
    }

    fn result(&self, failure: Option<Failure>) -> Result<JointPlan<N>, Failure> {
        match (failure, self.plain) {
            (None, Some((plan, _))) => Ok(plan.with_short_by(self.short_by)),
            _ => Err(failure.unwrap_or(Failure::NotFound)),
        }
    }

    /// The plan that the flow has found.
    fn read_plan(&self, problem: &Problem<'_, W>) -> Option<JointPlan<N>> {
        let mut paths = [Path::default(); N];
        let mut owners = 0..;
        for (slot, errand) in paths.iter_mut().zip(problem.errands) {
            *slot = match errand.target {
                Target::Any => path_through(problem.map, self.flow.path_from(errand.from)?)?,
                Target::Own(_) => {
                    let row = self.row_of_owner(problem, owners.next()?);
                    path_through(problem.map, self.flow.fixed_path(row))?
                }
                Target::Stand => Path::at(errand.from),
            };
        }
        JointPlan::new(paths.get(..problem.errands.len())?)
    }
}

impl<const W: usize, const L: usize, const N: usize, const M: usize> Default for JointPlanner<W, L, N, M> {
    fn default() -> Self {
        Self::new()
    }
}

/// The path through some cells, without the waits at its end.
fn path_through<const W: usize>(map: &Map<W>, mut cells: impl Iterator<Item = Cell>) -> Option<Path> {
    let mut here = cells.next()?;
    let mut path = Path::at(here);
    let mut waits = 0;
    for next in cells {
        match map.move_between(here, next)? {
            Move::Wait => waits += 1,
            step => {
                for _ in 0..waits {
                    path.push(Move::Wait).ok()?;
                }
                path.push(step).ok()?;
                (here, waits) = (next, 0);
            }
        }
    }
    Some(path)
}
