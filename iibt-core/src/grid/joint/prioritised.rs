//! Paths one after another for robots that own their targets, in the phased network of the
//! [flow](super::network).
//!
//! In such a network no robots follow, swap or rotate, so that all that paths must keep apart is
//! one cell on one layer. Let `b(k)` be the cells of the paths that are planned already on layer
//! `k`, where layer 0 is the arrival and layer `T` the start. The cells from which a robot can
//! still come to its target are
//!
//! ```text
//! reached(0)     = { target }
//! reached(k + 1) = { cells from which a step leads into reached(k), waits included } \ b(k + 1)
//! ```
//!
//! and its path is read off from its start in layer `T` on. Robots plan in an order, each past
//! those before it (prioritised planning; Erdmann and Lozano-Pérez 1987; Silver 2005). When one
//! finds no path it plans first in the next try.

use super::super::{Cell, CellSet, Map, Move};
use super::assignment::{self, Answer, Assignment};
use super::network::{Network, Turn};
use super::pibt::scramble;
use super::{Failure, JointPlan, Problem};
use crate::actions::HORIZON;

/// The most orders that are tried with plans of one length in one turn.
const ORDERS: u8 = 4;

/// The plans grow by one step this often, and then by a third.
const SMALL_INCREASES: u16 = 6;

/// The most paths that are searched for one plan.
const MOST_PATHS: u16 = 300;

/// Plans for up to `N` robots that own their targets on maps of `W` words, of at most `L - 1` steps
/// (0 to 64).
///
/// All paths are equally long. Nobody follows, swaps or rotates, so that a
/// robot enters a cell one step or more after the other one has left it. The planner may miss
/// plans: it never finds those in which a robot has to leave its way for one that plans later, and
/// proves nothing. Where it fails, ask [`Lacam`](super::Lacam).
///
/// It needs `(4 W + 2 N) L` bytes and some 130: 0.9 KB for eight robots on 64 cells and 32 steps,
/// 1.7 KB for 64 steps.
///
/// ```
/// use iibt_core::grid::joint::{Errand, Prioritised, Problem, Target, own_targets};
/// use iibt_core::grid::{Cell, Map};
///
/// // Two robots change places; the second one steps aside.
/// let map = Map::<1>::drawn("....\n#.##")?;
/// let own = |from, to| Errand { from: Cell(from), target: Target::Own(Cell(to)) };
/// let errands = [own(0, 3), own(3, 0)];
/// let problem = Problem::new(&map, &errands);
/// let targets = own_targets(&problem).ok_or("a robot without a target")?;
///
/// let mut planner = Prioritised::<1, 65, 2>::new();
/// assert_eq!(planner.work(&problem, &targets, &mut 10), None); // not enough: it goes on
/// let plan = planner.work(&problem, &targets, &mut 1000).ok_or("over budget")??;
/// assert_eq!((plan.conflict(&map), plan.following(&map)), (None, None));
/// assert!(plan.paths().iter().map(|path| path.end(&map)).eq([3, 0].map(Cell)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "prioritized planning")]
#[doc(alias = "MAPF")]
#[derive(Clone, Debug)]
pub struct Prioritised<const W: usize, const L: usize, const N: usize> {
    /// The cells from which the robot that plans can still come to its target, by layers.
    reached: [CellSet<W>; L],
    /// The cells of the paths that are planned, by robots and layers.
    planned: [[Cell; L]; N],
    /// The robots in the order in which they plan.
    order: [u8; N],
    network: Network<W>,
    /// The fewest steps in which every robot comes to its target if it is alone: with black cells
    /// entered last, and with white ones.
    fewest: [u16; 2],
    attempt: Attempt,
    paths: u16,
    stage: Stage,
}

/// A length of plans, a turn and an order that are tried together.
#[derive(Clone, Copy, Debug)]
struct Attempt {
    steps: u16,
    turn: Turn,
    /// How many orders have been tried with these two.
    orders: u8,
    /// How many attempts there were before.
    number: u16,
}

/// What is to be done next.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// Begin a search.
    Begin,
    /// Find from where this robot can come to its target in one more step if it is alone.
    Alone { robot: usize, steps: u16 },
    /// Find from where the robot at this place of the order can come to its target in one more
    /// step.
    Sweep { place: usize, layer: usize },
    /// Read off its path.
    Trace { place: usize },
}

impl<const W: usize, const L: usize, const N: usize> Prioritised<W, L, N> {
    /// An arena.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(N > 0 && N <= 255 && L <= HORIZON + 1, "a robot, and no path longer than any") }
        Self {
            reached: [CellSet::EMPTY; L],
            planned: [[Cell(0); L]; N],
            order: [0; N],
            network: Network::NOTHING,
            fewest: [0; 2],
            attempt: Attempt::first([0; 2]),
            paths: 0,
            stage: Stage::Begin,
        }
    }

    /// Drops an unfinished search, so that the next call begins another.
    pub const fn start(&mut self) {
        self.stage = Stage::Begin;
    }

    /// Works on the plan of a problem whose robots have these targets, until it is found, or fails,
    /// or the budget is used up. Targets past the last robot mean nothing; what errands say of
    /// targets matters only for those that [stand](super::Target::Stand).
    ///
    /// Returns `None` when the budget was not enough: the next call, with the same problem and
    /// targets, goes on. After an answer the next call begins a new search.
    ///
    /// A work unit, one of the budget, is a layer of one robot, or a path read off.
    ///
    /// # Errors
    /// - [`Failure::Invalid`]: the problem makes no sense, or two targets are the same, or one is
    ///   not on the map;
    /// - [`Failure::NoWay`]: obstacles cut a robot off from its target;
    /// - [`Failure::NotFound`]: no order that was tried has a plan of at most `L - 1` steps.
    #[inline(never)] // one search at a time is on the stack
    pub fn work(
        &mut self,
        problem: &Problem<'_, W>,
        targets: &[Cell; N],
        budget: &mut u32,
    ) -> Option<Result<JointPlan<N>, Failure>> {
        let answer = assignment::search(problem, targets, budget, |team| self.unit(problem, team));
        if answer.is_some() {
            self.start();
        }
        answer
    }

    fn unit(&mut self, problem: &Problem<'_, W>, team: &Assignment<W, N>) -> Option<Answer<N>> {
        match self.stage {
            Stage::Begin => {
                self.begin(problem, team);
                None
            }
            Stage::Alone { robot, steps } => self.approach(team, robot, steps).map(Err),
            Stage::Sweep { place, layer } => self.sweep(team, place, layer).map(Err),
            Stage::Trace { place } => self.trace(team, place),
        }
    }

    fn begin(&mut self, problem: &Problem<'_, W>, team: &Assignment<W, N>) {
        for (robot, slot) in self.order.iter_mut().enumerate() {
            *slot = robot as u8;
        }
        self.network = Network::of(problem);
        self.fewest = [0; 2];
        self.paths = 0;
        self.arrive(team, 0);
        self.stage = Stage::Alone { robot: 0, steps: 0 };
    }

    /// Takes one robot that is alone one step further; after the last robot, begins to plan.
    fn approach(&mut self, team: &Assignment<W, N>, robot: usize, steps: u16) -> Option<Failure> {
        let places = team.from.get(robot).zip(team.to.get(robot));
        let Some((&from, &to)) = places.filter(|_| robot < team.robots) else {
            self.attempt = Attempt::first(self.fewest);
            return self.attempt(team);
        };
        let here = self.layer(0);
        if here.contains(from) {
            self.note_fewest(to, steps);
            self.arrive(team, robot + 1);
            self.stage = Stage::Alone { robot: robot + 1, steps: 0 };
            return None;
        }
        let around = self.network.around(&here);
        self.set_layer(0, around);
        self.stage = Stage::Alone { robot, steps: steps.saturating_add(1) };
        (around == here).then_some(Failure::NoWay)
    }

    /// A robot that comes to its target in this many steps needs one more in the turn that does not
    /// have it enter the target last.
    fn note_fewest(&mut self, target: Cell, steps: u16) {
        for (fewest, turn) in self.fewest.iter_mut().zip([Turn::BlackLast, Turn::WhiteLast]) {
            self.network.set_rules(turn, CellSet::EMPTY);
            let target = [target].into_iter().collect();
            let waits = steps > 0 && self.network.entered(&target, 0).is_empty();
            *fewest = steps.saturating_add(waits.into()).max(*fewest);
        }
    }

    /// Begins the next attempt whose plans are long enough for every robot.
    fn attempt(&mut self, team: &Assignment<W, N>) -> Option<Failure> {
        while !self.attempt.is_long_enough(self.fewest) {
            self.attempt.lengthen(self.fewest);
        }
        if usize::from(self.attempt.steps) >= L {
            return Some(Failure::NotFound);
        }
        self.network.set_rules(self.attempt.turn, CellSet::EMPTY);
        self.plan_path(team, 0)
    }

    /// Begins the path of the robot at a place of the order.
    fn plan_path(&mut self, team: &Assignment<W, N>, place: usize) -> Option<Failure> {
        self.paths += 1;
        self.arrive(team, self.robot(place));
        let moves = self.attempt.steps > 0;
        self.stage = if moves { Stage::Sweep { place, layer: 0 } } else { Stage::Trace { place } };
        (self.paths > MOST_PATHS).then_some(Failure::NotFound)
    }

    /// Finds the cells of the next layer from which a robot can come to its target.
    fn sweep(&mut self, team: &Assignment<W, N>, place: usize, layer: usize) -> Option<Failure> {
        let earlier = self.order.iter().take(place).filter_map(|&robot| self.planned.get(usize::from(robot)));
        let taken = earlier.filter_map(|cells| cells.get(layer + 1).copied()).collect();
        let reached = self.network.before(&self.layer(layer), layer).without(&taken);
        self.set_layer(layer + 1, reached);
        if layer + 1 < self.attempt.steps.into() && !reached.is_empty() {
            self.stage = Stage::Sweep { place, layer: layer + 1 };
            return None;
        }
        let from = team.from.get(self.robot(place));
        let is_start = layer + 1 == self.attempt.steps.into();
        if is_start && from.is_some_and(|&from| reached.contains(from)) {
            self.stage = Stage::Trace { place };
            return None;
        }
        self.reorder(team, place)
    }

    /// Has the robot that has no path plan first in the next attempt.
    fn reorder(&mut self, team: &Assignment<W, N>, place: usize) -> Option<Failure> {
        let mut displaced = self.robot(place) as u8;
        for slot in self.order.iter_mut().take(place + 1) {
            displaced = core::mem::replace(slot, displaced);
        }
        self.attempt.number += 1;
        self.attempt.orders += 1;
        if place == 0 || self.attempt.orders == ORDERS {
            self.attempt.lengthen(self.fewest);
        }
        self.attempt(team)
    }

    /// Reads a path off the reached cells; after the last robot, returns the plan.
    ///
    /// A robot is early, so that it waits on its target, or late, so that it waits where it starts:
    /// which of the two looks like chance.
    ///
    /// Cost: at most `5 T²` lookups of a bit for `T` steps.
    fn trace(&mut self, team: &Assignment<W, N>, place: usize) -> Option<Answer<N>> {
        let robot = self.robot(place);
        let late = scramble(u32::from(self.attempt.number) << 8 ^ robot as u32) & 1 == 1;
        let mut at = *team.from.get(robot)?;
        for layer in (0..=usize::from(self.attempt.steps)).rev() {
            *self.planned.get_mut(robot)?.get_mut(layer)? = at;
            if let Some(below) = layer.checked_sub(1) {
                at = self.next_cell(&team.map, at, below, late)?;
            }
        }
        if place + 1 < team.robots {
            return self.plan_path(team, place + 1).map(Err);
        }
        Some(self.plan(team))
    }

    /// The cell on a layer after one on the layer before: one on which the robot can wait longest,
    /// so as not to wander; a late robot waits first.
    fn next_cell(&self, map: &Map<W>, at: Cell, layer: usize, late: bool) -> Option<Cell> {
        let reached = self.layer(layer);
        let stays = reached.contains(at);
        let entered = self.network.entered(&reached, layer);
        let around = Move::ALL.into_iter().map(|step| map.neighbour(at, step));
        let moves =
            around.filter(|&to| to != at && entered.contains(to)).take(if late && stays { 0 } else { 4 });
        let choices = stays.then_some(at).into_iter().chain(moves);
        choices.min_by_key(|&cell| self.waits_until(cell, layer))
    }

    /// The last layer to which a robot can stay on a cell from a layer on.
    fn waits_until(&self, cell: Cell, layer: usize) -> usize {
        let reached = |&layer: &usize| self.reached.get(layer).is_some_and(|cells| cells.contains(cell));
        (0..layer).rev().take_while(reached).last().unwrap_or(layer)
    }

    /// The plan of the paths that are planned.
    #[inline(never)] // on the stack only once there is a plan
    fn plan(&self, team: &Assignment<W, N>) -> Answer<N> {
        let mut plan = team.standing();
        for (path, cells) in plan.paths_mut().iter_mut().zip(&self.planned) {
            let mut before = path.start;
            for &cell in cells.iter().take(self.attempt.steps.into()).rev() {
                let step = team.map.move_between(before, cell).ok_or(Failure::NotFound)?;
                path.push(step).or(Err(Failure::NotFound))?;
                before = cell;
            }
        }
        Ok(plan)
    }

    /// Puts a robot on its target, where its search begins.
    fn arrive(&mut self, team: &Assignment<W, N>, robot: usize) {
        self.set_layer(0, team.to.get(robot).copied().into_iter().collect());
    }

    fn robot(&self, place: usize) -> usize {
        self.order.get(place).map_or(N, |&robot| robot.into())
    }

    fn layer(&self, layer: usize) -> CellSet<W> {
        self.reached.get(layer).copied().unwrap_or(CellSet::EMPTY)
    }

    fn set_layer(&mut self, layer: usize, cells: CellSet<W>) {
        if let Some(slot) = self.reached.get_mut(layer) {
            *slot = cells;
        }
    }
}

impl<const W: usize, const L: usize, const N: usize> Default for Prioritised<W, L, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl Attempt {
    /// The first attempt with plans as short as any robot allows.
    const fn first([black, white]: [u16; 2]) -> Self {
        let steps = if black < white { black } else { white };
        Self { steps, turn: Turn::BlackLast, orders: 0, number: 0 }
    }

    const fn is_long_enough(&self, [black, white]: [u16; 2]) -> bool {
        self.steps >= if matches!(self.turn, Turn::BlackLast) { black } else { white }
    }

    /// Goes on to the other turn, and after that to longer plans.
    fn lengthen(&mut self, [black, white]: [u16; 2]) {
        self.orders = 0;
        self.turn = self.turn.other();
        if self.turn == Turn::BlackLast {
            let is_short = self.steps < black.min(white).saturating_add(SMALL_INCREASES);
            let more = if is_short { 1 } else { (self.steps / 3).max(1) };
            self.steps = self.steps.saturating_add(more);
        }
    }
}
