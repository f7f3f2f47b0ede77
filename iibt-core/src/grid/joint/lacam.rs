//! A search over joint states for robots that own their targets.
//!
//! LaCAM (Okumura, AAAI 2023) goes depth first over joint states. A successor of a state is made by
//! [PIBT](super::pibt). In the next try of the same state the first robot of its order is bound to
//! a certain move, then the first two, and so on, until every successor has been made. The tries of
//! a state are numbered and the number says what is bound, so a counter is all that a state keeps.
//!
//! A search that runs out of states has seen all that can be reached: there is no plan. One that
//! runs out of memory begins again with other ties, until it has made the calls it may make.

use super::assignment::{self, Answer, Assignment, NOWHERE, State};
use super::distances::{Distances, UNREACHED};
use super::pibt::{Step, scramble};
use super::shorten::Shortening;
use super::states::{NONE, Node, States};
use super::{Failure, JointPlan, Problem};
use crate::grid::Cell;

/// Plans for up to `N` robots that own their targets on maps of `W` words, searching at most `M`
/// joint states (1 to 65,534) at a time.
///
/// Robots may follow on each other's heels. No plan has a shared cell, a swap or a rotation. The
/// plan is shortened, and is not always the shortest. It depends on the sizes, the calls, the
/// problem and the targets alone.
///
/// It needs `M (3 N + 8)` bytes for the states (32 for eight robots) and `48 W N` for distances:
/// 2.9 KB for eight robots on 64 cells with 64 states, 9.0 KB with 256.
///
/// ```
/// use iibt_core::grid::joint::{Errand, Failure, Lacam, Problem, Target, own_targets};
/// use iibt_core::grid::{Cell, Map};
///
/// let own = |from, to| Errand { from: Cell(from), target: Target::Own(Cell(to)) };
/// let mut planner = Lacam::<1, 2, 64>::new(600);
///
/// // Two robots change places where there is a cell to step aside.
/// let map = Map::<1>::drawn("....\n#.##")?;
/// let errands = [own(0, 3), own(3, 0)];
/// let problem = Problem::new(&map, &errands);
/// let targets = own_targets(&problem).ok_or("a robot without a target")?;
/// let plan = planner.work(&problem, &targets, &mut 1000).ok_or("over budget")??;
/// assert_eq!((plan.conflict(&map), plan.paths()[0].end(&map)), (None, Cell(3)));
///
/// // Without it there is no plan, which takes few states to prove.
/// let line = Map::<1>::drawn("....")?;
/// let problem = Problem { map: &line, ..problem };
/// assert_eq!(planner.work(&problem, &targets, &mut 1000), Some(Err(Failure::Impossible)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "MAPF")]
#[doc(alias = "PIBT")]
#[derive(Clone, Debug)]
pub struct Lacam<const W: usize, const N: usize, const M: usize> {
    states: States<N, M>,
    distances: [Distances<W>; N],
    most_calls: u32,
    calls: u32,
    /// How often the search has begun; breaks ties.
    run: u32,
    /// The state whose successors are tried. Its links are the states under it, down to the first.
    top: u16,
    stage: Stage,
}

/// What is to be done next. The first stage is all zeros, so that a new search is cleared memory.
#[derive(Clone, Copy, Debug)]
#[repr(u8)]
enum Stage {
    /// Measure the distances to the target of this robot.
    Measure { robot: usize },
    /// Try a successor.
    Search,
    /// Take detours out of the plan found.
    Shorten(Shortening),
    /// Hand the plan over, which begins with this state.
    Found { first: u16 },
}

/// What became of the moves that a number binds.
enum Binding {
    /// They are possible together, as far as the bound robots go.
    Possible,
    /// They are not.
    Excluded,
    /// All numbers have been tried.
    Exhausted,
}

impl<const W: usize, const N: usize, const M: usize> Lacam<W, N, M> {
    /// An arena for searches that try at most this many successors.
    #[must_use]
    pub const fn new(most_calls: u32) -> Self {
        Self {
            states: States::new(),
            distances: [Distances::EMPTY; N],
            most_calls,
            calls: 0,
            run: 0,
            top: 0,
            stage: Stage::Measure { robot: 0 },
        }
    }

    /// Begins a search that tries at most this many successors.
    pub(super) const fn start_with(&mut self, most_calls: u32) {
        self.most_calls = most_calls;
        self.start();
    }

    /// Drops an unfinished search, so that the next call begins another.
    pub const fn start(&mut self) {
        self.stage = Stage::Measure { robot: 0 };
    }

    /// Works on the plan of a problem whose robots have these targets, until it is found, or fails,
    /// or the budget is used up. Targets past the last robot mean nothing; what errands say of
    /// targets matters only for those that [stand](super::Target::Stand).
    ///
    /// Returns `None` when the budget was not enough: the next call, with the same problem and
    /// targets, goes on. After an answer the next call begins a new search.
    ///
    /// A work unit, one of the budget, is a table of distances, a successor tried, or a state of
    /// the plan shortened.
    ///
    /// # Errors
    /// - [`Failure::Invalid`]: the problem makes no sense, or two targets are the same, or one is
    ///   not on the map;
    /// - [`Failure::NoWay`]: obstacles cut a robot off from its target;
    /// - [`Failure::Impossible`]: all that can be reached has been searched;
    /// - [`Failure::NotFound`]: the calls are used up, or 65,535 of them for one state, or the plan
    ///   is longer than a path can be.
    #[inline(never)] // one search at a time is on the stack
    pub fn work(
        &mut self,
        problem: &Problem<'_, W>,
        targets: &[Cell; N],
        budget: &mut u32,
    ) -> Option<Result<JointPlan<N>, Failure>> {
        let answer = assignment::search(problem, targets, budget, |team| self.unit(team));
        if answer.is_some() {
            self.start();
        }
        answer
    }

    fn unit(&mut self, team: &Assignment<W, N>) -> Option<Answer<N>> {
        match &mut self.stage {
            Stage::Measure { robot } => {
                let robot = *robot;
                self.measure(team, robot).map(Err)
            }
            Stage::Search => self.search(team).map(Err),
            Stage::Shorten(shortening) => {
                if !shortening.work(self.states.nodes_mut(), &team.map) {
                    self.stage = Stage::Found { first: shortening.first() };
                }
                None
            }
            Stage::Found { first } => Some(self.states.plan(*first, team)),
        }
    }

    /// Measures the distances to the target of one robot, or begins the search after the last.
    fn measure(&mut self, team: &Assignment<W, N>, robot: usize) -> Option<Failure> {
        let places = team.from.get(robot).zip(team.to.get(robot)).filter(|_| robot < team.robots);
        let Some(((&from, &to), distances)) = places.zip(self.distances.get_mut(robot)) else {
            (self.calls, self.run) = (0, 0);
            self.begin(team);
            return None;
        };
        distances.measure(&team.map, to, from == to);
        self.stage = Stage::Measure { robot: robot + 1 };
        let mut near = team.map.free_neighbours(from).map(|(_, cell)| cell).chain([from]);
        near.all(|cell| distances.from(cell) == UNREACHED).then_some(Failure::NoWay)
    }

    /// Begins a search with nothing but the first state.
    fn begin(&mut self, team: &Assignment<W, N>) {
        self.states.clear();
        self.top = self.states.add(team.from, [0; N], NONE).unwrap_or(NONE);
        self.stage = Stage::Search;
    }

    /// Tries the next successor of the state on top.
    fn search(&mut self, team: &Assignment<W, N>) -> Option<Failure> {
        let Some(node) = self.states.node_mut(self.top) else { return Some(Failure::Impossible) };
        if node.cells == team.to {
            self.stage = Stage::Shorten(Shortening::new(self.states.turn_back(self.top)));
            return None;
        }
        if self.calls == self.most_calls || node.tried == u16::MAX {
            return Some(Failure::NotFound);
        }
        self.calls += 1;
        let before = *node;
        node.tried += 1;
        let order = self.order(&before);
        let order = order.get(..team.robots).unwrap_or(&order);
        let seed = scramble(self.run << 16 ^ u32::from(self.top));
        let mut step = Step::new(&team.map, &self.distances, &before.cells, seed);
        match bind(&mut step, before.tried.into(), order) {
            Binding::Exhausted => self.top = before.link,
            Binding::Excluded => {}
            Binding::Possible => {
                if let Some(cells) = step.complete(order) {
                    self.descend(team, &before, cells);
                }
            }
        }
        None
    }

    /// Goes on with a successor that is new; without room for it, begins another search.
    fn descend(&mut self, team: &Assignment<W, N>, before: &Node<N>, cells: State<N>) {
        if self.states.contains(&cells) {
            return;
        }
        let mut patience = before.patience;
        for (steps, (cell, target)) in patience.iter_mut().zip(cells.iter().zip(&team.to)) {
            *steps = if cell == target { 0 } else { steps.saturating_add(1) };
        }
        match self.states.add(cells, patience, self.top) {
            Some(state) => self.top = state,
            None => {
                self.run = self.run.wrapping_add(1);
                self.begin(team);
            }
        }
    }

    /// The robots in the order in which they decide: first those that have not been on their target
    /// for longest, then those that are farthest, then by their numbers.
    fn order(&self, node: &Node<N>) -> [u8; N] {
        let mut urgency = [(0, 0); N];
        for (urgency, (patience, (distances, &cell))) in
            urgency.iter_mut().zip(node.patience.iter().zip(self.distances.iter().zip(&node.cells)))
        {
            *urgency =
                if cell == NOWHERE { (0, 0) } else { (u16::from(*patience) + 1, distances.from(cell)) };
        }
        let mut order = [0; N];
        for (robot, mine) in urgency.iter().enumerate() {
            let earlier = urgency.iter().take(robot).filter(|&theirs| theirs >= mine).count();
            let later = urgency.iter().skip(robot + 1).filter(|&theirs| theirs > mine).count();
            if let Some(slot) = order.get_mut(earlier + later) {
                *slot = robot as u8;
            }
        }
        order
    }
}

/// Binds the first robots of an order to the moves that a number stands for: none to number 0, the
/// first robot to the numbers after it, one for each of its moves, then the first two to one for
/// each pair, and so on.
fn bind<const W: usize, const N: usize>(step: &mut Step<'_, W, N>, number: u32, order: &[u8]) -> Binding {
    let (mut rest, mut numbers) = (number, 1_u32);
    let mut bound = 0;
    while rest >= numbers {
        let Some(&robot) = order.get(bound) else { return Binding::Exhausted };
        rest -= numbers;
        numbers = numbers.saturating_mul(step.moves(robot.into()).count() as u32);
        bound += 1;
    }
    for robot in order.iter().take(bound).map(|&robot| usize::from(robot)) {
        let moves = step.moves(robot).count() as u32;
        let cell = step.moves(robot).nth(rest.checked_rem(moves).unwrap_or(0) as usize);
        rest = rest.checked_div(moves).unwrap_or(0);
        if !cell.is_some_and(|cell| step.bind(robot, cell)) {
            return Binding::Excluded;
        }
    }
    Binding::Possible
}

impl<const N: usize, const M: usize> States<N, M> {
    /// The plan through the states that are linked from the first one on.
    #[inline(never)] // on the stack only once there is a plan
    fn plan<const W: usize>(&self, first: u16, team: &Assignment<W, N>) -> Answer<N> {
        let mut plan = team.standing();
        let mut before = team.from;
        let states = core::iter::successors(self.node(first), |node| self.node(node.link));
        for node in states.skip(1) {
            for (path, (from, to)) in plan.paths_mut().iter_mut().zip(before.iter().zip(&node.cells)) {
                let step = team.map.move_between(*from, *to).ok_or(Failure::NotFound)?;
                path.push(step).or(Err(Failure::NotFound))?;
            }
            before = node.cells;
        }
        Ok(plan)
    }
}
