//! A path for each robot, and why there is none.

use super::super::{Cell, Map, Move, Path};
use super::ProblemError;
use super::execution::{Execution, capped};
use core::fmt;

/// How the robots of a plan come to their last cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Arrival {
    /// Each as soon as the order of the plan lets it.
    #[default]
    Staggered,
    /// Each waits before its last move until all others are before theirs.
    Together,
}

/// One path for each of at most `N` robots, in the order of the members.
///
/// A robot stays on the last cell of its path.
///
/// ```
/// use iibt_core::grid::joint::{JointConflictKind, JointPlan};
/// use iibt_core::grid::{Cell, Map, Path, words};
///
/// let map = Map::<{ words(7, 7) }>::new(7, 7)?;
/// let path = |cells: &[Cell]| Path::through(&map, cells).ok_or("no neighbours");
/// let right = path(&[28, 29, 30].map(Cell))?;
/// let after = path(&[22, 22, 29, 36].map(Cell))?;
/// let plan = JointPlan::<8>::new(&[right, after]).ok_or("more than eight")?;
/// assert_eq!((plan.paths().len(), plan.steps(), plan.short_by()), (2, 3, 0));
/// assert_eq!(plan.conflict(&map), None);
/// // The second robot enters cell 29 in the step in which the first one leaves it.
/// let conflict = plan.following(&map).ok_or("nobody follows")?;
/// assert_eq!((conflict.kind, conflict.step, conflict.cell), (JointConflictKind::Follow, 2, Cell(29)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "joint policy")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct JointPlan<const N: usize> {
    pub(super) paths: [Path; N],
    pub(super) robots: u8,
    pub(super) short_by: u8,
    pub(super) arrival: Arrival,
    pub(super) execution: Execution,
}

/// Why there is no joint plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Failure {
    /// Proved: no sequence of moves of these robots leads to these targets.
    Impossible,
    /// The search ended at the horizon, or at the most nodes or calls that it may use.
    NotFound,
    /// Obstacles cut a robot off from the target it owns, or all robots from all goals.
    NoWay,
    /// The problem makes no sense.
    Invalid(ProblemError),
}

/// What robots that follow their paths step by step must not do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum JointConflictKind {
    /// Two are on one cell.
    Same,
    /// Two exchange their cells.
    Swap,
    /// Three or more change their cells in a circle: each enters the cell that the next one leaves.
    Rotation,
    /// One enters the cell that another leaves in this step. It collides if the other is late.
    Follow,
}

/// The first step at which robots of a plan get in each other's way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct JointConflict {
    /// What happens.
    pub kind: JointConflictKind,
    /// The robot that enters the cell: its place among the paths.
    pub robot: u8,
    /// The step at whose end it has happened; the start is step 0.
    pub step: u8,
    /// The cell that it enters.
    pub cell: Cell,
}

impl<const N: usize> JointPlan<N> {
    /// The plan without robots.
    pub(super) const NOBODY: Self = Self {
        paths: [Path::at(Cell(0)); N],
        robots: 0,
        short_by: 0,
        arrival: Arrival::Staggered,
        execution: Execution::NONE,
    };

    /// The plan of these paths, staggered, short of nothing and with an
    /// [execution](Self::execution) by the clock: every robot moves in the steps of its path.
    /// `None` for more than `N` paths.
    #[must_use]
    pub fn new(paths: &[Path]) -> Option<Self> {
        let mut plan = Self::NOBODY;
        plan.set(paths, Arrival::Staggered).then_some(plan)
    }

    /// Makes it the plan of these paths in place, as [`new`](Self::new) does; returns whether there
    /// is room for all.
    pub(crate) fn set(&mut self, paths: &[Path], arrival: Arrival) -> bool {
        let Some(slots) = self.paths.get_mut(..paths.len()) else { return false };
        for (slot, &path) in slots.iter_mut().zip(paths) {
            *slot = path;
        }
        (self.robots, self.short_by, self.arrival) = (paths.len() as u8, 0, arrival);
        self.execution = self.by_the_clock();
        true
    }

    /// The plan in which every robot stays where it stands.
    ///
    /// Returns `None` for more than `N` robots.
    #[must_use]
    pub fn standing(starts: impl IntoIterator<Item = Cell>) -> Option<Self> {
        let mut plan = Self::NOBODY;
        plan.stand(starts).then_some(plan)
    }

    /// Lets every robot stay where it stands; returns whether there is room for all.
    pub(super) fn stand(&mut self, starts: impl IntoIterator<Item = Cell>) -> bool {
        (self.robots, self.arrival, self.execution) = (0, Arrival::Staggered, Execution::NONE);
        for start in starts {
            let Some(path) = self.paths.get_mut(usize::from(self.robots)) else { return false };
            *path = Path::at(start);
            self.robots += 1;
        }
        true
    }

    /// This plan, short of this many of the goals that the problem needs.
    #[must_use]
    pub fn with_short_by(mut self, goals: usize) -> Self {
        self.set_short_by(goals);
        self
    }

    pub(super) fn set_short_by(&mut self, goals: usize) {
        self.short_by = goals.min(u8::MAX.into()) as u8;
    }

    /// This plan with another way to arrive.
    #[must_use]
    pub fn arriving(mut self, arrival: Arrival) -> Self {
        self.arrival = arrival;
        self
    }

    /// The paths in the order of the members.
    #[must_use]
    pub fn paths(&self) -> &[Path] {
        self.paths.get(..self.robots.into()).unwrap_or(&self.paths)
    }

    pub(super) fn paths_mut(&mut self) -> &mut [Path] {
        self.paths.get_mut(..self.robots.into()).unwrap_or_default()
    }

    /// The steps of the longest path, 0 to [`HORIZON`](crate::actions::HORIZON).
    #[doc(alias = "makespan")]
    #[must_use]
    pub fn steps(&self) -> usize {
        self.paths().iter().map(Path::len).max().unwrap_or(0)
    }

    /// Whether the robots wait for each other before their last moves.
    #[must_use]
    pub fn is_together(&self) -> bool {
        self.arrival == Arrival::Together
    }

    /// What is known of the plan's execution: of one that a planner has made, that of
    /// [`execute`](Self::execute), and as many ticks more as it begins later than another one.
    #[must_use]
    pub fn execution(&self) -> Execution {
        self.execution
    }

    /// The execution in which no robot waits for another.
    fn by_the_clock(&self) -> Execution {
        let is_move = |&(_, step): &(usize, Move)| step != Move::Wait;
        let last = |path: &Path| path.moves().enumerate().filter(is_move).last();
        let first = self.paths().iter().filter_map(|path| Some(last(path)?.0 + 1)).min();
        let steps = self.steps();
        Execution { ticks: capped(steps), spread: first.map_or(0, |first| capped(steps - first)) }
    }

    /// How many goals fewer than needed a robot ends on.
    #[must_use]
    pub fn short_by(&self) -> usize {
        self.short_by.into()
    }

    /// The first shared cell, swap or rotation, with which no plan can be executed; `None` for
    /// none.
    ///
    /// Cost: quadratic in the robots, linear in the steps.
    #[must_use]
    pub fn conflict<const W: usize>(&self, map: &Map<W>) -> Option<JointConflict> {
        self.find(map, |step| step.shared().or_else(|| step.circle()))
    }

    /// The first step in which a robot enters a cell that another one leaves; `None` for none.
    #[must_use]
    pub fn following<const W: usize>(&self, map: &Map<W>) -> Option<JointConflict> {
        self.find(map, |step| step.follower())
    }

    fn find<const W: usize>(
        &self,
        map: &Map<W>,
        kind: impl Fn(&Step<'_>) -> Option<(JointConflictKind, usize)>,
    ) -> Option<JointConflict> {
        let mut now = [Cell::default(); N];
        (0..=self.steps()).find_map(|step| {
            let before = now;
            for (cell, path) in now.iter_mut().zip(self.paths()) {
                let code = step.checked_sub(1).and_then(|before| path.actions.get(before));
                let here = if step == 0 { path.start } else { *cell };
                *cell = map.neighbour(here, code.and_then(Move::from_code).unwrap_or(Move::Wait));
            }
            let before = before.get(..self.paths().len()).filter(|_| step > 0);
            let now = now.get(..self.paths().len())?;
            let (kind, robot) = kind(&Step { before: before.unwrap_or(now), now })?;
            let cell = *now.get(robot)?;
            Some(JointConflict { kind, robot: robot as u8, step: step as u8, cell })
        })
    }
}

/// Where all robots are before and after one step.
struct Step<'a> {
    before: &'a [Cell],
    now: &'a [Cell],
}

impl Step<'_> {
    fn shared(&self) -> Option<(JointConflictKind, usize)> {
        let earlier = |robot: usize| self.now.iter().take(robot);
        let mut robots = self.now.iter().enumerate();
        let (robot, _) = robots.find(|&(robot, cell)| earlier(robot).any(|other| other == cell))?;
        Some((JointConflictKind::Same, robot))
    }

    /// The robot that leaves the cell that this one enters.
    fn leaver(&self, robot: usize) -> Option<usize> {
        let cell = self.now.get(robot)?;
        let other = self.before.iter().position(|before| before == cell)?;
        (self.now.get(other) != Some(cell)).then_some(other)
    }

    fn follower(&self) -> Option<(JointConflictKind, usize)> {
        let robot = (0..self.now.len()).find(|&robot| self.leaver(robot).is_some())?;
        Some((JointConflictKind::Follow, robot))
    }

    fn circle(&self) -> Option<(JointConflictKind, usize)> {
        (0..self.now.len()).find_map(|robot| {
            let mut chain = core::iter::successors(self.leaver(robot), |&next| self.leaver(next));
            let others = chain.by_ref().take(self.now.len()).position(|next| next == robot)?;
            let kind = if others == 1 { JointConflictKind::Swap } else { JointConflictKind::Rotation };
            Some((kind, robot))
        })
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Impossible => f.write_str("impossible: no moves of these robots lead to these targets"),
            Self::NotFound => f.write_str("not found within the horizon and the size of the search"),
            Self::NoWay => f.write_str("no way: obstacles cut the targets off"),
            Self::Invalid(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for Failure {}

impl fmt::Display for JointConflict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.kind {
            JointConflictKind::Same => "is not alone on",
            JointConflictKind::Swap => "swaps into",
            JointConflictKind::Rotation => "rotates into",
            JointConflictKind::Follow => "follows into",
        };
        write!(f, "path {} {what} cell {} at step {}", self.robot, self.cell.0, self.step)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::pictures::{drawn, moving};
    use super::*;
    use std::vec::Vec;

    /// Robots drawn at every step, and the first conflict and the first following.
    #[track_caller]
    fn check(names: &str, frames: &[&str], conflict: Option<(JointConflictKind, u8)>, follows: Option<u8>) {
        let map = drawn(&frames[0].split(' ').collect::<Vec<_>>());
        let paths: Vec<Path> = names.chars().map(|name| moving(frames, name)).collect();
        let plan = JointPlan::<8>::new(&paths).unwrap();
        assert_eq!(plan.conflict(&map).map(|found| (found.kind, found.step)), conflict);
        assert_eq!(plan.following(&map).map(|found| found.step), follows);
    }

    #[test]
    fn tells_shared_cells_swaps_rotations_and_followers_apart() {
        check("ab", &["a..b", ".ab."], None, None);
        check("ab", &["a.b", ".x."], Some((JointConflictKind::Same, 1)), None);
        check("ab", &["ab.", "ba."], Some((JointConflictKind::Swap, 1)), Some(1));
        check("abc", &["abc.", "abc.", ".abc"], None, Some(2));
        check("abcd", &["ab dc", "da cb"], Some((JointConflictKind::Rotation, 1)), Some(1));
        check("abc", &["ab .c", "ba .c"], Some((JointConflictKind::Swap, 1)), Some(1));
    }

    #[test]
    fn a_circle_is_found_beside_a_chain() {
        check("fgabcd", &["fg.ab ...dc", ".fgab ...dc"], None, Some(1));
        check("fgabcd", &["fg.ab ...dc", ".fgda ...cb"], Some((JointConflictKind::Rotation, 1)), Some(1));
    }

    #[test]
    fn holds_as_many_paths_as_its_size_says() {
        assert!(JointPlan::<2>::new(&[Path::default(); 3]).is_none());
        assert!(JointPlan::<2>::standing([1, 2, 3].map(Cell)).is_none());
        let plan = JointPlan::<3>::standing([1, 2].map(Cell)).unwrap();
        assert_eq!((plan.paths().len(), plan.steps()), (2, 0));
    }
}
