//! How a plan runs when each robot moves as soon as the order of the plan lets it.
//!
//! Robots keep the order of a plan and not its clock: a robot enters a cell once all that are there
//! before it in the plan have left it as far as it has heard. A move that is commanded in tick `t`
//! is done, sensed and announced in `t + 1` and heard by the others in `t + 2`; its robot itself
//! goes on in `t + 1`. Before its last move a robot of a plan that arrives
//! [together](super::Arrival::Together) waits until it has heard that all others have made all of
//! theirs but the last.

use super::super::{Cell, Map};
use super::table::{Table, cell, set};
use super::{Arrival, JointPlan};
use crate::actions::HORIZON;
use core::ops::Range;

/// The execution of a plan without loss of messages; see [`JointPlan::execution`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Execution {
    /// The ticks up to the end of the last move; without any wait for a message, the steps of the
    /// plan.
    pub ticks: usize,
    /// How many ticks the last moves of the first and of the last robot that moves are apart.
    pub spread: usize,
}

/// What one robot has done of its path.
#[derive(Clone, Copy, Debug, Default)]
struct Progress {
    /// The step of the last move that it made, and of the last one that the others have heard of.
    done: usize,
    heard: usize,
    /// The step of its next move.
    next: Option<usize>,
    /// The last robot before it on the cell that this leads to, and the step after which that one
    /// is there no longer.
    behind: Option<(usize, usize)>,
    /// The steps of the last move and of the one before it.
    last: usize,
    last_but_one: usize,
}

impl<const N: usize> JointPlan<N> {
    /// Executes the plan with every message heard at the next tick but one; `None` when it comes to
    /// a standstill before its end: robots wait at the barrier where another one has to pass.
    ///
    /// Cost: quadratic in the robots, linear in the ticks. Takes 130 bytes of stack for each robot.
    ///
    /// ```
    /// use iibt_core::grid::joint::{Arrival, JointPlan};
    /// use iibt_core::grid::{Cell, Map, Path, words};
    ///
    /// // Goals one behind the other: the first robot has to be on its goal for the second to go on.
    /// let map = Map::<{ words(4, 1) }>::new(4, 1)?;
    /// let path = |cells: [u16; 4]| Path::through(&map, &cells.map(Cell)).ok_or("no neighbours");
    /// let plan = JointPlan::<2>::new(&[path([1, 2, 3, 3])?, path([0, 0, 1, 2])?]).ok_or("too many")?;
    /// let execution = plan.execution(&map).ok_or("a standstill")?;
    /// assert_eq!((execution.ticks, execution.spread), (4, 2));
    /// assert_eq!(plan.arriving(Arrival::Together).execution(&map).map(|run| run.ticks), Some(7));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn execution<const W: usize>(&self, map: &Map<W>) -> Option<Execution> {
        let mut table = [[Cell(0); N]; HORIZON + 1];
        run(self.timelines(map), self.is_together(), &mut table)
    }
}

impl<const N: usize> JointPlan<N> {
    /// Puts a barrier before the last moves, if that brings them close together.
    ///
    /// Takes as many cells of stack as the robots have in `L` steps.
    #[inline(never)]
    pub(super) fn add_useful_barrier<const W: usize, const L: usize>(&mut self, map: &Map<W>) {
        let mut table: Table<L, N> = [[Cell(0); N]; L];
        if self.spread(map, &mut table).is_some_and(|spread| self.is_close(spread)) {
            self.arrival = Arrival::Together;
        }
    }

    /// How many ticks the robots arrive apart with a barrier before their last moves; `None` where
    /// that is a standstill. The table is overwritten.
    pub(super) fn spread<const W: usize, const L: usize>(
        &self,
        map: &Map<W>,
        table: &mut Table<L, N>,
    ) -> Option<usize> {
        run(self.timelines(map), true, table).map(|run| run.spread)
    }

    /// Whether robots that arrive this many ticks apart are as close together as goals in series
    /// let them be: a tick apart from one robot to the next.
    pub(super) fn is_close(&self, spread: usize) -> bool {
        let movers = self.paths().iter().filter(|path| !path.is_empty()).count();
        spread <= movers.saturating_sub(1).max(1)
    }

    fn timelines<'a, const W: usize>(
        &'a self,
        map: &'a Map<W>,
    ) -> impl Iterator<Item = impl Iterator<Item = Cell> + 'a> + 'a {
        let cells = self.steps() + 1;
        self.paths().iter().map(move |path| path.timeline(map).take(cells))
    }
}

/// Executes a plan of less than `L` steps, given the cells of each robot at every step; the table
/// is overwritten.
pub(super) fn run<const L: usize, const N: usize>(
    plan: impl Iterator<Item = impl Iterator<Item = Cell>>,
    barrier: bool,
    table: &mut Table<L, N>,
) -> Option<Execution> {
    let mut robots = [Progress::default(); N];
    let mut count = 0;
    for (robot, cells) in robots.iter_mut().zip(plan) {
        *robot = decode(table, count, cells);
        count += 1;
    }
    let robots = robots.get_mut(..count)?;
    for (index, robot) in robots.iter_mut().enumerate() {
        robot.behind = robot.next.and_then(|step| last_on_target(table, count, index, 0..step));
    }
    let mut first_end = None;
    for tick in 0.. {
        if robots.iter().all(|robot| robot.next.is_none()) {
            let ends = tick - first_end.unwrap_or(tick);
            return Some(Execution { ticks: tick, spread: ends.saturating_sub(1) });
        }
        let (moved, ended) = advance(table, robots, barrier);
        if ended {
            first_end = first_end.or(Some(tick));
        }
        if !moved {
            return None;
        }
    }
    None
}

/// Writes the cells of a path at every step, and finds its first and last moves.
fn decode<const L: usize, const N: usize>(
    table: &mut Table<L, N>,
    index: usize,
    cells: impl Iterator<Item = Cell>,
) -> Progress {
    let mut robot = Progress::default();
    let mut before = None;
    for (step, at) in cells.take(L).enumerate() {
        set(table, step, index, at);
        if before.replace(at).is_some_and(|before| before != at) {
            (robot.last_but_one, robot.last) = (robot.last, step);
            robot.next = robot.next.or(Some(step));
        }
    }
    robot
}

/// The last of the others that is, in one of these steps, on the cell that a robot enters after
/// them, and the step after which it is there no longer. Those that were there before that one had
/// left when it came.
fn last_on_target<const L: usize, const N: usize>(
    table: &Table<L, N>,
    robots: usize,
    index: usize,
    steps: Range<usize>,
) -> Option<(usize, usize)> {
    let target = cell(table, steps.end, index);
    let before = steps.clone().zip(table.get(steps)?).rev();
    let mut visits = before.filter_map(|(step, cells)| {
        let robot = cells.iter().take(robots).position(|&cell| cell == target)?;
        Some((robot, step + 1))
    });
    visits.next().filter(|&(robot, _)| robot != index)
}

/// One tick; returns whether anything was done or heard, and whether a robot made its last move.
fn advance<const L: usize, const N: usize>(
    table: &Table<L, N>,
    robots: &mut [Progress],
    barrier: bool,
) -> (bool, bool) {
    let mut due = 0_u32; // one bit for each robot that moves
    let early = robots.iter().filter(|robot| !robot.is_before_last()).count();
    for (index, robot) in robots.iter().enumerate() {
        let others_are_early = early > usize::from(!robot.is_before_last());
        let must_wait = barrier && robot.next == Some(robot.last) && others_are_early;
        let has_left = |(other, step)| robots.get(other).is_some_and(|other: &Progress| other.heard >= step);
        let may_move = robot.next.is_some() && !must_wait && robot.behind.is_none_or(has_left);
        due |= u32::from(may_move) << (index % 32);
    }
    let (mut moved, mut ended) = (false, false);
    let count = robots.len();
    // What is before that, all have heard of.
    let is_at_work = |robot: &&Progress| robot.next.is_some() || robot.heard != robot.done;
    let heard = robots.iter().filter(is_at_work).map(|robot| robot.heard).min().unwrap_or(0);
    for (index, robot) in robots.iter_mut().enumerate() {
        moved |= robot.heard != robot.done;
        robot.heard = robot.done;
        let Some(step) = robot.next.filter(|_| due & (1 << (index % 32)) != 0) else { continue };
        let at = cell(table, step, index);
        robot.done = step;
        robot.next = (step + 1..=robot.last).find(|&step| cell(table, step, index) != at);
        robot.behind = robot.next.and_then(|step| last_on_target(table, count, index, heard..step));
        moved = true;
        ended |= robot.next.is_none();
    }
    (moved, ended)
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
    fn check(names: &str, frames: &[&str], without: (usize, usize), with: Option<(usize, usize)>) {
        let map = drawn(&frames[0].split(' ').collect::<Vec<_>>());
        let paths: Vec<_> = names.chars().map(|name| moving(frames, name)).collect();
        let plan = JointPlan::<4>::new(&paths).unwrap();
        let run = |plan: JointPlan<4>| plan.execution(&map).map(|run| (run.ticks, run.spread));
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
