//! How a plan runs when each robot moves as soon as the order of the plan lets it.
//!
//! Robots keep the order of a plan and not its clock: a robot enters a cell once all that are there
//! before it in the plan have left it as far as it has heard. A move that is commanded in tick `t` is
//! done, sensed and announced in `t + 1` and heard by the others in `t + 2`; its robot itself goes on
//! in `t + 1`. Before its last move a robot of a plan that arrives [together](super::Arrival::Together)
//! waits until it has heard that all others have made all of theirs but the last.

use super::super::{Cell, Map};
use super::JointPlan;
use super::flow::{Row, cell};
use crate::actions::HORIZON;

/// What comes of a plan that is executed without loss of messages; see [`JointPlan::execution`].
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
    /// The steps of the last move and of the one before it.
    last: usize,
    last_but_one: usize,
}

impl<const N: usize> JointPlan<N> {
    /// Executes the plan with every message heard at the next tick but one; `None` when it comes to a
    /// standstill before its end: robots wait at the barrier where another one has to pass.
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
        let mut rows = [[Cell(0); HORIZON + 1]; N];
        run(self, map, &mut rows)
    }
}

/// Executes a plan of less than `L` steps; the table is overwritten.
pub(super) fn run<const W: usize, const L: usize, const N: usize>(
    plan: &JointPlan<N>,
    map: &Map<W>,
    table: &mut [Row<L>; N],
) -> Option<Execution> {
    let mut robots = [Progress::default(); N];
    for ((row, robot), path) in table.iter_mut().zip(&mut robots).zip(plan.paths()) {
        *robot = decode(row, path.timeline(map));
    }
    let rows = table.get(..plan.paths().len())?;
    let robots = robots.get_mut(..rows.len())?;
    let mut first_end = None;
    for tick in 0.. {
        if robots.iter().all(|robot| robot.done >= robot.last) {
            let ends = tick - first_end.unwrap_or(tick);
            return Some(Execution { ticks: tick, spread: ends.saturating_sub(1) });
        }
        let (moved, ended) = advance(rows, robots, plan.is_together());
        if ended {
            first_end = first_end.or(Some(tick));
        }
        if !moved {
            return None;
        }
    }
    None
}

/// Writes the cells of a path at every step, and finds its last moves.
fn decode<const L: usize>(row: &mut Row<L>, cells: impl Iterator<Item = Cell>) -> Progress {
    let mut robot = Progress::default();
    let mut before = None;
    for (step, (slot, at)) in row.iter_mut().zip(cells).enumerate() {
        *slot = at;
        if before.replace(at).is_some_and(|before| before != at) {
            (robot.last_but_one, robot.last) = (robot.last, step);
        }
    }
    robot
}

/// One tick; returns whether anything was done or heard, and whether a robot made its last move.
fn advance<const L: usize>(rows: &[Row<L>], robots: &mut [Progress], barrier: bool) -> (bool, bool) {
    let mut next = 0_u32; // one bit for each robot that moves
    for robot in 0..rows.len() {
        let may =
            next_step(rows, robots, robot).is_some_and(|step| may_move(rows, robots, robot, step, barrier));
        next |= u32::from(may) << (robot % 32);
    }
    let (mut moved, mut ended) = (false, false);
    for index in 0..rows.len() {
        let step = next_step(rows, robots, index).filter(|_| next & (1 << (index % 32)) != 0);
        let Some(robot) = robots.get_mut(index) else { continue };
        moved |= robot.heard != robot.done || step.is_some();
        robot.heard = robot.done;
        robot.done = step.unwrap_or(robot.done);
        ended |= step == Some(robot.last);
    }
    (moved, ended)
}

/// The step of the next move of a robot.
fn next_step<const L: usize>(rows: &[Row<L>], robots: &[Progress], robot: usize) -> Option<usize> {
    let (row, progress) = (rows.get(robot)?, robots.get(robot)?);
    let here = cell(row, progress.done);
    (progress.done + 1..=progress.last).find(|&step| cell(row, step) != here)
}

/// Whether the order of the plan, as far as it was heard, lets a robot make the move of a step.
fn may_move<const L: usize>(
    rows: &[Row<L>],
    robots: &[Progress],
    robot: usize,
    step: usize,
    barrier: bool,
) -> bool {
    let target = rows.get(robot).map(|row| cell(row, step));
    let is_last = barrier && robots.get(robot).is_some_and(|robot| robot.last == step);
    rows.iter().zip(robots).enumerate().filter(|&(other, _)| other != robot).all(|(_, (row, other))| {
        let still_to_come = row.iter().take(step).skip(other.heard);
        let is_clear = !still_to_come.copied().any(|at| Some(at) == target);
        is_clear && !(is_last && other.heard < other.last_but_one)
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::pictures::{drawn, moving};
    use super::super::Arrival;
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
