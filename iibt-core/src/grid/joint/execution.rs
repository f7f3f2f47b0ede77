//! How a plan runs when each robot moves as soon as the order of the plan lets it.
//!
//! Robots keep the order of a plan and not its clock: a robot enters a cell once all that are there
//! before it in the plan have left it as far as it has heard. A move that is commanded in tick `t`
//! is done, sensed and announced in `t + 1` and heard by the others in `t + 2`; its robot itself
//! goes on in `t + 1`. Before its last move a robot of a plan that arrives
//! [together](super::Arrival::Together) waits until it has heard that all others have made all of
//! theirs but the last.

use super::super::{Cell, Map};
use super::table::{Table, cell};
use super::{Arrival, JointPlan};
use crate::actions::HORIZON;

/// The execution of a plan without loss of messages; see [`JointPlan::execute`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Execution {
    /// The ticks up to the end of the last move; without any wait for a message, the steps of the
    /// plan. With all waits, two for each step and two more.
    pub ticks: u8,
    /// How many ticks the last moves of the first and of the last robot that moves are apart.
    pub spread: u8,
}

impl Execution {
    /// That of a plan in which no robot moves.
    pub(super) const NONE: Self = Self { ticks: 0, spread: 0 };

    /// Whether the robots that move come to their last cells at most one tick apart.
    #[must_use]
    pub const fn is_together(self) -> bool {
        self.spread <= 1
    }

    /// The same after this many ticks in which all stand.
    pub(super) fn after(self, ticks: usize) -> Self {
        Self { ticks: capped(usize::from(self.ticks) + ticks), ..self }
    }
}

/// A number of ticks, of which a plan has less than 255.
pub(super) fn capped(ticks: usize) -> u8 {
    ticks.min(u8::MAX.into()) as u8
}

/// What one robot has done of its path.
#[derive(Clone, Copy, Debug, Default)]
struct Progress {
    /// The step of the last move that it made, and of the last one that the others have heard of.
    done: usize,
    heard: usize,
    /// The step of its next move.
    next: Option<usize>,
    /// The last robot before it on the cell that this leads to.
    behind: Leave,
    /// The steps of the last move and of the one before it.
    last: usize,
    last_but_one: usize,
}

impl<const N: usize> JointPlan<N> {
    /// Executes the plan with every message heard at the next tick but one; `None` when it comes to
    /// a standstill before its end: robots wait at the barrier where another one has to pass.
    ///
    /// Cost: linear in the robots and in the ticks. Takes 160 bytes of stack for each robot, and 64
    /// for each word of the map.
    ///
    /// ```
    /// use iibt_core::grid::joint::{Arrival, JointPlan};
    /// use iibt_core::grid::{Cell, Map, Path, words};
    ///
    /// // Goals one behind the other: the first robot has to be on its goal for the second to go on.
    /// let map = Map::<{ words(4, 1) }>::new(4, 1)?;
    /// let path = |cells: [u16; 4]| Path::through(&map, &cells.map(Cell)).ok_or("no neighbours");
    /// let plan = JointPlan::<2>::new(&[path([1, 2, 3, 3])?, path([0, 0, 1, 2])?]).ok_or("too many")?;
    /// let execution = plan.execute(&map).ok_or("a standstill")?;
    /// assert_eq!((execution.ticks, execution.spread), (4, 2));
    /// assert_eq!(plan.arriving(Arrival::Together).execute(&map).map(|run| run.ticks), Some(7));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn execute<const W: usize>(&self, map: &Map<W>) -> Option<Execution> {
        let mut table = [[Cell(0); N]; HORIZON + 1];
        self.executed(self.is_together(), map, &mut table)
    }

    /// Executes the plan with or without a barrier before the last moves; `None` where that is a
    /// standstill. The table is overwritten.
    pub(super) fn executed<const W: usize, const L: usize>(
        &self,
        barrier: bool,
        map: &Map<W>,
        table: &mut Table<L, N>,
    ) -> Option<Execution> {
        let mut timetable = Timetable::new(table, self.steps());
        self.paths().iter().for_each(|path| timetable.add(path.timeline(map)));
        timetable.run::<W>(barrier)
    }

    /// Puts a barrier before the last moves if that brings them close together, and executes the
    /// plan.
    ///
    /// Takes as many cells of stack as the robots have in `L` steps.
    #[inline(never)]
    pub(super) fn execute_best<const W: usize, const L: usize>(&mut self, map: &Map<W>) {
        let mut table: Table<L, N> = [[Cell(0); N]; L];
        let run = self.executed(true, map, &mut table);
        self.arrive(run, map, &mut table);
    }

    /// Lets every robot make its last move when it can, and executes the plan.
    ///
    /// Takes as many cells of stack as the robots have in `L` steps.
    #[inline(never)]
    pub(super) fn stagger<const W: usize, const L: usize>(&mut self, map: &Map<W>) {
        let mut table: Table<L, N> = [[Cell(0); N]; L];
        self.arrive(None, map, &mut table);
    }

    /// Puts a barrier before the last moves if this execution with it brings them close together,
    /// and executes the plan without it if not. The table is overwritten.
    pub(super) fn arrive<const W: usize, const L: usize>(
        &mut self,
        with_barrier: Option<Execution>,
        map: &Map<W>,
        table: &mut Table<L, N>,
    ) {
        let close = with_barrier.filter(|run| self.is_close(*run));
        self.arrival = if close.is_some() { Arrival::Together } else { Arrival::Staggered };
        self.execution = close.or_else(|| self.executed(false, map, table)).unwrap_or_default();
    }

    /// Whether robots arrive as close together as goals in series let them: a tick apart from one
    /// robot to the next.
    fn is_close(&self, run: Execution) -> bool {
        let movers = self.paths().iter().filter(|path| !path.is_empty()).count();
        usize::from(run.spread) <= movers.saturating_sub(1).max(1)
    }
}

/// The cells of all robots of a plan at every step.
///
/// When it is executed its moves take the place of the cells, so that it needs no more memory.
pub(super) struct Timetable<'a, const L: usize, const N: usize> {
    table: &'a mut Table<L, N>,
    robots: usize,
    steps: usize,
}

/// A move in a table: this bit, and the [`Leave`] of the last other robot on the cell that it
/// enters. Without the bit, there is no move in this step.
const MOVE: u16 = 1 << 15;

/// When a robot left a cell: 256 times one more than the robot's number, plus the step; zero if
/// none did.
type Leave = u16;

impl<'a, const L: usize, const N: usize> Timetable<'a, L, N> {
    /// A plan of less than `L` steps without robots; the table is overwritten.
    pub(super) fn new(table: &'a mut Table<L, N>, steps: usize) -> Self {
        Self { table, robots: 0, steps }
    }

    /// Adds the cells of one more robot, from its start on.
    pub(super) fn add(&mut self, cells: impl Iterator<Item = Cell>) {
        for (row, at) in self.table.iter_mut().zip(cells).take(self.steps + 1) {
            if let Some(slot) = row.get_mut(self.robots) {
                *slot = at;
            }
        }
        self.robots += 1;
    }

    /// Executes the plan, on a map of `W` words; `None` where that is a standstill.
    #[inline(never)] // it is in the image once
    pub(super) fn run<const W: usize>(mut self, barrier: bool) -> Option<Execution> {
        self.find_moves::<W>();
        let mut robots = [Progress::default(); N];
        let robots = robots.get_mut(..self.robots)?;
        for (index, robot) in robots.iter_mut().enumerate() {
            *robot = self.at_start(index);
        }
        let mut first_end = None;
        let mut on_the_way = robots.iter().filter(|robot| robot.next.is_some()).count();
        for tick in 0.. {
            if on_the_way == 0 {
                let ends = tick - first_end.unwrap_or(tick);
                return Some(Execution { ticks: capped(tick), spread: capped(ends.saturating_sub(1)) });
            }
            let (moved, ended) = self.advance(robots, barrier);
            if ended > 0 {
                first_end = first_end.or(Some(tick));
                on_the_way -= ended;
            }
            if !moved {
                return None;
            }
        }
        None
    }

    /// Puts moves in the place of the cells. Who was on a cell before the last one had left when
    /// that one came.
    fn find_moves<const W: usize>(&mut self) {
        let mut left: [[Leave; 32]; W] = [[0; 32]; W]; // one for each cell of the map
        let Some((start, rows)) = self.table.split_first_mut() else { return };
        let mut here = *start;
        for (step, row) in (1..).zip(rows).take(self.steps) {
            // All leave before any enter: one may follow another.
            let mut movers = 0_u32; // one bit for each robot
            for ((cell, here), robot) in row.iter_mut().zip(&mut here).zip(0..).take(self.robots) {
                let from = core::mem::replace(here, *cell);
                if from == *cell {
                    *cell = Cell(0);
                } else if let Some(leave) = left.as_flattened_mut().get_mut(from.index()) {
                    *leave = (robot + 1) << 8 | step;
                    movers |= 1 << (robot % 32);
                }
            }
            while movers != 0 {
                let robot = movers.trailing_zeros();
                movers &= movers - 1;
                let Some(cell) = row.get_mut(robot as usize) else { continue };
                let last = left.as_flattened().get(cell.index()).copied().unwrap_or(0);
                let other = if u32::from(last >> 8) == robot + 1 { 0 } else { last };
                *cell = Cell(MOVE | other);
            }
        }
    }

    /// Finds the first and the last moves of a robot.
    fn at_start(&self, index: usize) -> Progress {
        let mut robot = Progress::default();
        for step in 1..=self.steps {
            if self.entry(step, index).is_some() {
                (robot.last_but_one, robot.last) = (robot.last, step);
            }
        }
        self.look_ahead(&mut robot, index);
        robot
    }

    /// Finds the next move of a robot.
    fn look_ahead(&self, robot: &mut Progress, index: usize) {
        let mut later = robot.done + 1..=robot.last;
        let next = later.find_map(|step| Some((step, self.entry(step, index)?)));
        (robot.next, robot.behind) = (next.map(|(step, _)| step), next.map_or(0, |(_, leave)| leave));
    }

    /// The last other robot on the cell that a robot enters in a step; `None` if it does not move.
    fn entry(&self, step: usize, index: usize) -> Option<Leave> {
        let Cell(entry) = cell(self.table, step, index);
        (entry & MOVE != 0).then_some(entry & !MOVE)
    }

    /// One tick; returns whether anything was done or heard, and how many robots made their last
    /// moves.
    fn advance(&self, robots: &mut [Progress], barrier: bool) -> (bool, usize) {
        let mut due = 0_u32; // one bit for each robot that moves
        let early = if barrier { robots.iter().filter(|robot| !robot.is_before_last()).count() } else { 0 };
        for (index, robot) in robots.iter().enumerate() {
            let Some(step) = robot.next else { continue };
            let others_are_early = early > usize::from(!robot.is_before_last());
            let must_wait = step == robot.last && others_are_early;
            let may_move = !must_wait && has_left(robots, robot.behind);
            due |= u32::from(may_move) << (index % 32);
        }
        let (mut moved, mut ended) = (false, 0);
        for (index, robot) in robots.iter_mut().enumerate() {
            moved |= robot.heard != robot.done;
            robot.heard = robot.done;
            let Some(step) = robot.next.filter(|_| due & (1 << (index % 32)) != 0) else { continue };
            robot.done = step;
            self.look_ahead(robot, index);
            moved = true;
            ended += usize::from(robot.next.is_none());
        }
        (moved, ended)
    }
}

/// Whether the others have heard of a leave.
fn has_left(robots: &[Progress], leave: Leave) -> bool {
    let robot = usize::from(leave >> 8).checked_sub(1).and_then(|robot| robots.get(robot));
    robot.is_none_or(|robot| robot.heard >= usize::from(leave & 0xff))
}

impl Progress {
    /// Whether the others have heard that it has made all moves but the last one.
    fn is_before_last(&self) -> bool {
        self.heard >= self.last_but_one
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::pictures::{drawn, moving};
    use super::*;
    use std::vec::Vec;

    /// Ticks and spread without and with the barrier.
    #[track_caller]
    fn check(names: &str, frames: &[&str], without: (u8, u8), with: Option<(u8, u8)>) {
        let map = drawn(&frames[0].split(' ').collect::<Vec<_>>());
        let paths: Vec<_> = names.chars().map(|name| moving(frames, name)).collect();
        let plan = JointPlan::<4>::new(&paths).unwrap();
        let run = |plan: JointPlan<4>| plan.execute(&map).map(|run| (run.ticks, run.spread));
        assert_eq!(run(plan), Some(without));
        assert_eq!(run(plan.arriving(Arrival::Together)), with);
    }

    #[test]
    fn a_robot_alone_waits_for_nobody() {
        check("a", &["a...", "a...", ".a..", "..a.", "...a"], (3, 0), Some((3, 0)));
    }

    #[test]
    fn a_cell_is_free_when_it_is_heard_to_be() {
        // Left with the move commanded in tick 0, entered with the one commanded in tick 2.
        check("ab", &["ab..", "a.b.", ".a.b"], (3, 1), Some((3, 1)));
    }

    #[test]
    fn robots_side_by_side_arrive_together() {
        check("ab", &["a... b...", ".a.. b...", "..a. b...", "...a .b.."], (3, 2), Some((4, 1)));
    }

    #[test]
    fn a_barrier_before_a_cell_that_another_passes_is_a_standstill() {
        let frames = [
            ".a..b ##.##", //
            "..a.b ##.##",
            "....b ##a##",
            "...b. ##a##",
            "..b.. ##a##",
            ".b... ##a##",
            "b.... ##a##",
        ];
        check("ab", &frames, (6, 4), None);
    }
}
