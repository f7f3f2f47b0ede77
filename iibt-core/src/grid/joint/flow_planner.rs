//! The joint plan of fewest steps that a flow has for a problem, around the fixed paths of one or
//! two owners.

use super::super::{Cell, CellSet, Map, Move, Path};
use super::attempt::{Attempt, Choice, Kind, LATER_TOGETHER};
use super::fixed_paths::Precedence;
use super::flow::{Flow, Query};
use super::network::{Network, Turn};
use super::survey::Survey;
use super::{Execution, Failure, JointPlan, Problem, Target};

/// No plan whose robots arrive together is searched for any longer when the searches have taken so
/// many work units.
pub(super) const MOST_UNITS: u32 = 360;

/// What became of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// A plan was found.
    Found,
    /// There is none, or none was found.
    None(Failure),
    /// No flow leaves owners their ways: a search follows in which every robot has a target of its
    /// own.
    Beyond,
}

/// The search for the best flow, one attempt after another.
#[derive(Clone, Debug)]
pub(super) struct FlowPlanner<const W: usize, const L: usize, const N: usize> {
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
    /// The best plan so far, if there is one.
    plan: JointPlan<N>,
    pub(super) found: Option<Found>,
    /// The fewest steps of a plan, whether or not its robots arrive together.
    soonest: usize,
}

/// What is known of a plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub(super) steps: usize,
    turn: Turn,
    /// The execution with a barrier before the last moves; `None` where that is a standstill, or
    /// not known yet.
    execution: Option<Execution>,
    is_executed: bool,
}

/// What is to be done next. The first stage is all zeros.
#[derive(Clone, Copy, Debug)]
#[repr(u8)]
pub(super) enum Stage {
    /// Nothing was started: the best plan is asked for.
    Idle,
    Begin,
    Survey,
    Flow,
    /// Read the plan that was found off the flow, and how its robots arrive.
    Execute,
    /// How the robots of the plan that was found first arrive, since there is no shorter one.
    ExecuteFirst,
    Choose,
    Done(Outcome),
}

impl<const W: usize, const L: usize, const N: usize> FlowPlanner<W, L, N> {
    pub(super) const LATEST: usize = Flow::<W, L, N>::LATEST;

    /// A search for the best plan. It is all zeros, so that it is cleared where it stays: none of
    /// it is on the stack, and none in flash. What is no zero is set when the search begins.
    pub(super) const CLEARED: Self = {
        let turn = Some(Turn::BlackLast); // zero, which `None` is not
        Self {
            flow: Flow::new(),
            survey: Survey::begin(CellSet::EMPTY, CellSet::EMPTY, 0),
            stage: Stage::Idle,
            choice: Choice { turn, ..Choice::BEST },
            goals: CellSet::EMPTY,
            need: 0,
            short_by: 0,
            fewest_steps: 0,
            most_reached: 0,
            spent: 0,
            attempt: Attempt { kind: Kind::Plain, turn: Turn::BlackLast, is_second: false },
            precedence: Precedence { second_first: false, rest: 0, steps: 0 },
            plan: JointPlan::NOBODY,
            found: Some(Found { steps: 0, turn: Turn::BlackLast, execution: None, is_executed: false }),
            soonest: 0,
        }
    };

    /// Starts over with one of the plans for a problem.
    pub(super) fn start(&mut self, choice: Choice) {
        self.choice = choice;
        self.stage = Stage::Begin;
        (self.found, self.most_reached, self.spent) = (None, 0, 0);
    }

    /// Goes on; `None` when the budget is used up.
    #[inline(never)] // not on the stack of the searches that follow
    pub(super) fn work(&mut self, problem: &Problem<'_, W>, budget: &mut u32) -> Option<Outcome> {
        loop {
            match self.stage {
                Stage::Done(outcome) => return Some(outcome),
                Stage::Idle => self.start(Choice::BEST),
                Stage::Survey => {
                    self.survey.work(&self.flow.network, budget)?;
                    self.stage = self.surveyed(problem);
                }
                Stage::Flow => {
                    let found = self.search(budget)?;
                    self.stage = self.searched(problem, found);
                }
                Stage::Begin | Stage::Execute | Stage::ExecuteFirst | Stage::Choose => {
                    *budget = budget.checked_sub(1)?;
                    self.stage = self.unit(problem);
                }
            }
        }
    }

    /// Goes on with the flow of an attempt. One whose robots arrive together is given up when the
    /// searches have become too long for it: there is a plan already.
    fn search(&mut self, budget: &mut u32) -> Option<bool> {
        let most = match self.attempt.kind {
            Kind::Together => MOST_UNITS.saturating_sub(self.spent),
            Kind::Plain | Kind::Owner(_) | Kind::Around => u32::MAX,
        };
        let allowed = most.min(*budget);
        let mut left = allowed;
        let found = self.flow.work(&mut left);
        *budget -= allowed - left;
        self.spent += allowed - left;
        if found.is_none() && self.attempt.kind == Kind::Together && self.spent >= MOST_UNITS {
            return Some(false);
        }
        found
    }

    /// The plan that was found.
    pub(super) fn plan(&self) -> &JointPlan<N> {
        &self.plan
    }

    /// How many goals fewer than needed can be reached.
    pub(super) fn short_by(&self) -> usize {
        self.short_by
    }

    /// Whether a plan has fewer steps than the one that was found if the robots do not arrive
    /// together.
    pub(super) fn may_be_shorter(&self) -> bool {
        self.found.is_some_and(|found| found.steps > self.soonest)
    }

    /// The turns of the plan that was found.
    pub(super) fn turn(&self) -> Turn {
        self.found.map_or(Turn::default(), |found| found.turn)
    }

    fn unit(&mut self, problem: &Problem<'_, W>) -> Stage {
        match self.stage {
            Stage::Begin => self.begin(problem),
            Stage::Execute => self.execute(problem),
            Stage::ExecuteFirst => self.execute_first(problem),
            Stage::Choose => self.choose(problem),
            stage => stage,
        }
    }

    fn begin(&mut self, problem: &Problem<'_, W>) -> Stage {
        if let Err(error) = problem.check(N) {
            return Stage::Done(Outcome::None(Failure::Invalid(error)));
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
            return Stage::Done(Outcome::None(Failure::NotFound));
        }
        if problem.owned().next().is_some() {
            return self.with_owners(problem);
        }
        if most == 0 && (self.short_by > 0 || problem.prefixes.is_empty()) {
            return self.nothing_to_reach(problem);
        }
        let farthest = self.survey.farthest().unwrap_or_default();
        let turn = self.flow.network.turn_of(farthest, self.fewest_steps);
        self.first_attempt(problem, Kind::Plain, turn)
    }

    /// All stand: because no goal is needed, or because none can be reached.
    fn nothing_to_reach(&mut self, problem: &Problem<'_, W>) -> Stage {
        if self.short_by > 0 && problem.free_starts().next().is_some() {
            return Stage::Done(Outcome::None(Failure::NoWay));
        }
        self.plan.stand(problem.starts());
        self.plan.short_by = self.short_by as u8;
        Stage::Done(Outcome::Found)
    }

    fn first_attempt(&mut self, problem: &Problem<'_, W>, kind: Kind, turn: Turn) -> Stage {
        let turn = self.choice.turn.unwrap_or(turn);
        self.attempt(problem, Attempt { kind, turn, is_second: false })
    }

    fn attempt(&mut self, problem: &Problem<'_, W>, attempt: Attempt) -> Stage {
        self.attempt = attempt;
        let starts: CellSet<W> = problem.free_entries().map(|entry| entry.cell).collect();
        let is_together = attempt.kind == Kind::Together;
        let entered_last = if is_together { self.goals.without(&starts) } else { CellSet::EMPTY };
        self.flow.network.set_rules(attempt.turn, entered_last);
        let (first, latest) = self.steps_to_try();
        let query = Query { goals: self.goals, need: self.need, first, latest };
        self.flow.begin(problem, problem.free_entries(), query);
        Stage::Flow
    }

    /// The fewest and the most steps of an attempt, which must have fewer than what was found
    /// before.
    ///
    /// A plan in the one turn has at most one step more than the best one in the other.
    fn steps_to_try(&self) -> (usize, usize) {
        let below = self.found.map(|found| found.steps.saturating_sub(1));
        let fewest = self.fewest_steps;
        let (first, most) = match (self.attempt.kind, below) {
            (Kind::Together, below) => {
                let latest = self.soonest + LATER_TOGETHER;
                let is_better = self.found.is_some_and(|found| found.arrives_together());
                (self.soonest, if is_better { below.unwrap_or(latest).min(latest) } else { latest })
            }
            (_, Some(below)) => (fewest.max(below), below),
            (_, None) => (fewest.min(Self::LATEST), usize::MAX),
        };
        (first, most.min(self.choice.latest.unwrap_or(usize::MAX)))
    }

    fn searched(&mut self, problem: &Problem<'_, W>, found: bool) -> Stage {
        if let Kind::Owner(row) = self.attempt.kind {
            return self.owner_searched(problem, row, found);
        }
        if found {
            return Stage::Execute;
        }
        self.most_reached = self.most_reached.max(self.flow.reached_goals());
        self.next_attempt(problem)
    }

    fn execute(&mut self, problem: &Problem<'_, W>) -> Stage {
        for prefix in problem.prefixes {
            if let Some(row) = self.row_of(problem, prefix.robot.into()) {
                self.flow.begin_with(row, prefix.path.cells(problem.map));
            }
        }
        let Attempt { kind, turn, is_second } = self.attempt;
        // If there is a shorter plan, it does not matter how the robots of this one arrive.
        let is_executed = kind != Kind::Plain || is_second || self.choice.turn.is_some();
        let execution = if is_executed { self.flow.execution() } else { None };
        let mut found = Found { steps: 0, turn, execution, is_executed };
        if (self.attempt.kind != Kind::Together || found.arrives_together())
            && self.read_plan(problem).is_some()
        {
            found.steps = self.plan.steps();
            self.found = Some(found);
        }
        self.next_attempt(problem)
    }

    fn execute_first(&mut self, problem: &Problem<'_, W>) -> Stage {
        let execution = self.plan.executed(true, problem.map, &mut self.flow.walk.paths);
        self.found = self.found.map(|found| Found { execution, is_executed: true, ..found });
        self.next_attempt(problem)
    }

    fn next_attempt(&mut self, problem: &Problem<'_, W>) -> Stage {
        let Attempt { kind, turn, is_second } = self.attempt;
        if kind == Kind::Around {
            return self.searched_around(problem);
        }
        if !is_second && self.choice.turn.is_none() {
            let second = Attempt { kind, turn: turn.other(), is_second: true };
            return match self.found {
                Some(found) if kind == Kind::Plain && problem.prefixes.is_empty() => {
                    self.attempt = second;
                    self.flow.network.set_rules(second.turn, CellSet::EMPTY);
                    self.flow.begin_shorter(found.steps.saturating_sub(1));
                    Stage::Flow
                }
                _ => self.attempt(problem, second),
            };
        }
        let Some(found) = self.found else { return self.fewer_goals(problem) };
        if !found.is_executed {
            return Stage::ExecuteFirst;
        }
        if kind == Kind::Plain {
            self.soonest = found.steps;
            if !self.choice.staggered && !found.arrives_together() {
                return self.first_attempt(problem, Kind::Together, found.turn);
            }
        }
        Stage::Choose
    }

    /// Goes on with as many goals as the failed attempts came to.
    fn fewer_goals(&mut self, problem: &Problem<'_, W>) -> Stage {
        self.lower_need();
        if self.need == 0 || self.choice != Choice::BEST {
            return Stage::Done(Outcome::None(Failure::NotFound));
        }
        self.first_attempt(problem, Kind::Plain, self.attempt.turn)
    }

    pub(super) fn lower_need(&mut self) {
        let need = self.most_reached.min(self.need.saturating_sub(1));
        self.short_by += self.need - need;
        (self.need, self.most_reached, self.fewest_steps) = (need, 0, 0);
    }

    /// Has the robots of the plan wait for each other before their last moves, if that is of use.
    fn choose(&mut self, problem: &Problem<'_, W>) -> Stage {
        let Some(found) = self.found else { return Stage::Done(Outcome::None(Failure::NotFound)) };
        let with_barrier = found.execution.filter(|_| !self.choice.staggered);
        self.plan.arrive(with_barrier, problem.map, &mut self.flow.walk.paths);
        self.plan.short_by = self.short_by as u8;
        Stage::Done(Outcome::Found)
    }

    /// Reads the plan off that the flow has found.
    fn read_plan(&mut self, problem: &Problem<'_, W>) -> Option<()> {
        self.plan.robots = problem.errands.len() as u8;
        for (robot, errand) in problem.errands.iter().enumerate() {
            let row = self.row_of(problem, robot);
            let path = self.plan.paths.get_mut(robot)?;
            *path = Path::at(errand.from);
            if errand.target != Target::Stand {
                extend_through(path, problem.map, self.flow.cells_of(row?))?;
            }
        }
        Some(())
    }

    /// The path of a robot among those of the flow and the fixed ones.
    fn row_of(&self, problem: &Problem<'_, W>, robot: usize) -> Option<usize> {
        let errand = problem.errands.get(robot)?;
        match errand.target {
            Target::Any => {
                let entry = problem.entry(robot, errand);
                self.flow.path_on(entry.cell, self.flow.layer_of(entry))
            }
            Target::Own(_) => {
                let own = problem.errands.iter().take(robot);
                let owner = own.filter(|errand| matches!(errand.target, Target::Own(_))).count();
                Some(self.flow.row_of_fixed(self.row_of_owner(problem, owner)))
            }
            Target::Stand => None,
        }
    }
}

impl Found {
    fn arrives_together(self) -> bool {
        self.execution.is_some_and(Execution::is_together)
    }
}

/// Extends a path through some cells, but for the waits at their end.
fn extend_through<const W: usize>(
    path: &mut Path,
    map: &Map<W>,
    cells: impl Iterator<Item = Cell>,
) -> Option<()> {
    let (mut here, mut waits) = (path.start, 0);
    for next in cells.skip(1) {
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
    Some(())
}
