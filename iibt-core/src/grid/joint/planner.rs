//! One joint plan for a problem, by the cheapest search that has one.

use super::super::Cell;
use super::attempt::Choice;
use super::exhaustive::Exhaustive;
use super::flow_planner::{FlowPlanner, Outcome};
use super::network::Turn;
use super::{Failure, JointPlan, Lacam, Prioritised, Problem, assignment};

/// Finds the joint plan of fewest steps in which robots take turns by the colour of their cells;
/// see the [module](super).
///
/// Robots of which more own their targets than such a search can serve plan one by one; where that
/// fails, their joint states are searched, all of them if they are at most `160 M`. A team of so
/// few states is served whenever there is a plan, and [`Failure::Impossible`] where there is none,
/// unless a path would be longer than [`HORIZON`](crate::actions::HORIZON).
///
/// `W` are the words of a set of cells, `L` one more than the most steps, `N` the most robots, `M`
/// the nodes of the search for targets that several robots own. With `L` = 0 it has no plan.
///
/// ```
/// use iibt_core::grid::joint::{Errand, JointPlanner, Problem, Target};
/// use iibt_core::grid::{Cell, Map};
///
/// // Two robots into a dead end: the first one has to go in first.
/// let map = Map::<1>::drawn(".#####\n......\n.#####").map_err(|_| "no map")?;
/// let errands = [0, 12].map(|from| Errand { from: Cell(from), target: Target::Any });
/// let goals = [10, 11].map(Cell);
/// let problem = Problem { goals: &goals, need: 2, ..Problem::new(&map, &errands) };
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
    search: Search<W, L, N, M>,
    /// The targets of all robots when each has its own, and how many goals that is short of.
    targets: [Cell; N],
    short_by: usize,
}

/// The search that is at work. The memory of one is that of the next: the largest of them is needed
/// anyway.
#[expect(clippy::large_enum_variant, reason = "one is in use at a time")]
#[derive(Clone, Debug)]
enum Search<const W: usize, const L: usize, const N: usize, const M: usize> {
    Flow(FlowPlanner<W, L, N>),
    /// Robots plan one after the other.
    Prioritised(Prioritised<W, L, N>),
    /// Over the states of all robots, those first that look best.
    Lacam(Lacam<W, N, M>),
    /// Over all states.
    Exhaustive(Exhaustive<W, N, M>),
}

impl<const W: usize, const L: usize, const N: usize, const M: usize> JointPlanner<W, L, N, M> {
    pub(super) const LATEST: usize = FlowPlanner::<W, L, N>::LATEST;
    /// The most successors that the search over joint states tries.
    pub(super) const MOST_CALLS: u32 = 16 * M as u32;
    const SIZES: () = assert!(L != 1 && L <= 256 && N >= 1 && N <= 32);

    /// A planner, ready for the first problem.
    #[must_use]
    pub const fn new() -> Self {
        let () = Self::SIZES;
        Self { search: Search::Flow(FlowPlanner::CLEARED), targets: [Cell(0); N], short_by: 0 }
    }

    /// Starts over, for another problem.
    pub fn start(&mut self) {
        self.start_with(Choice::BEST);
    }

    /// Goes on with the plan for a problem, which must be the same from one start to the next.
    ///
    /// Takes one unit from the budget for each layer of a search, for each change of a path, for
    /// each joint state, and for each execution. Returns `None` when the budget is used up; the
    /// result does not depend on how the work was cut.
    ///
    /// # Errors
    /// Every [`Failure`].
    #[inline(never)] // the plan is on the stack once
    pub fn work(
        &mut self,
        problem: &Problem<'_, W>,
        budget: &mut u32,
    ) -> Option<Result<JointPlan<N>, Failure>> {
        if let Search::Flow(flow) = &mut self.search {
            match flow.work(problem, budget)? {
                Outcome::Found => return Some(Ok(*flow.plan())),
                Outcome::None(failure) => return Some(Err(failure)),
                Outcome::Beyond => {
                    (self.targets, self.short_by) = (assignment::assigned(problem), flow.short_by());
                    self.plan_one_by_one();
                }
            }
        }
        self.work_beyond(problem, budget)
    }

    /// Goes on with the searches in which every robot has a target of its own.
    #[inline(never)] // it takes more stack than the flow
    fn work_beyond(
        &mut self,
        problem: &Problem<'_, W>,
        budget: &mut u32,
    ) -> Option<Result<JointPlan<N>, Failure>> {
        loop {
            let mut answer = match &mut self.search {
                Search::Flow(_) => Some(Err(Failure::NotFound)),
                Search::Prioritised(search) => search.work(problem, &self.targets, budget),
                Search::Lacam(search) => search.work(problem, &self.targets, budget),
                Search::Exhaustive(search) => search.work(problem, &self.targets, budget),
            };
            match &mut answer {
                Some(Err(failure)) if self.go_on(*failure) => continue,
                Some(Ok(plan)) => {
                    plan.execute_best::<W, L>(problem.map);
                    plan.set_short_by(self.short_by);
                }
                _ => {}
            }
            return answer;
        }
    }

    /// Goes on with the next search after one that failed; returns whether there is one.
    ///
    /// All states are searched at once where that takes no longer than a search that is cut off,
    /// and after that one if they are more and there is room for them.
    fn go_on(&mut self, failure: Failure) -> bool {
        match (&self.search, failure) {
            (Search::Prioritised(_), Failure::NotFound) => self.search_all_states(Self::MOST_CALLS),
            (Search::Prioritised(_), _) => self.search_states(),
            (Search::Exhaustive(search), Failure::NotFound) if search.is_limited() => self.search_states(),
            (Search::Lacam(_), Failure::NotFound) => self.search_all_states(u32::MAX),
            _ => return false,
        }
        true
    }

    /// Starts over with one of the plans for a problem.
    pub(super) fn start_with(&mut self, choice: Choice) {
        match &mut self.search {
            Search::Flow(flow) => flow.start(choice),
            _ => self.search_flows(choice),
        }
    }

    // A search that is not a constant is built on the stack before it is moved to where it stays:
    // in functions of their own, the stack is only taken when that is done. The constants are
    // zeros, so that nothing is copied.

    #[inline(never)]
    fn search_flows(&mut self, choice: Choice) {
        self.search = Search::Flow(FlowPlanner::CLEARED);
        if let Search::Flow(flow) = &mut self.search {
            flow.start(choice);
        }
    }

    #[inline(never)]
    fn plan_one_by_one(&mut self) {
        self.search = Search::Prioritised(Prioritised::new());
    }

    #[inline(never)]
    fn search_states(&mut self) {
        self.search = Search::Lacam(const { Lacam::new(0) });
        if let Search::Lacam(search) = &mut self.search {
            search.start_with(Self::MOST_CALLS);
        }
    }

    #[inline(never)]
    fn search_all_states(&mut self, most: u32) {
        self.search = Search::Exhaustive(const { Exhaustive::new(0) });
        if let Search::Exhaustive(search) = &mut self.search {
            search.start_with(most);
        }
    }

    /// Whether a plan could have fewer steps than the one that was found if the robots did not
    /// arrive together.
    pub(super) fn may_be_shorter(&self) -> bool {
        matches!(&self.search, Search::Flow(flow) if flow.may_be_shorter())
    }

    /// The turns of the plan that was found.
    pub(super) fn turn(&self) -> Turn {
        match &self.search {
            Search::Flow(flow) => flow.turn(),
            _ => Turn::default(),
        }
    }
}

impl<const W: usize, const L: usize, const N: usize, const M: usize> Default for JointPlanner<W, L, N, M> {
    fn default() -> Self {
        Self::new()
    }
}
