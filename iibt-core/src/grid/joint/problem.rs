//! What a team is to plan: where its robots stand and what each of them is for.

use super::super::{Cell, CellSet, Map};
use super::{Prefix, prefix};
use thiserror::Error;

/// Where a robot is to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Target {
    /// On any open goal; where fewer are needed than there are robots, anywhere.
    Any,
    /// On this very cell: a charger, a way-point, a goal of its own.
    Own(Cell),
    /// Where it stands. For the others it is a wall.
    Stand,
}

/// Where a robot stands and where it is to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Errand {
    /// The cell it stands on.
    pub from: Cell,
    /// Where it is to end.
    pub target: Target,
}

/// All that a joint plan depends on, beside the sizes of the planner.
///
/// ```
/// use iibt_core::grid::joint::{Errand, Problem, ProblemError, Target};
/// use iibt_core::grid::{Cell, Map, words};
///
/// let map = Map::<{ words(7, 7) }>::new(7, 7)?;
/// let errands = [
///     Errand { from: Cell(28), target: Target::Any },
///     Errand { from: Cell(48), target: Target::Own(Cell(0)) },
/// ];
/// let mut problem = Problem { goals: &[Cell(24)], need: 1, ..Problem::new(&map, &errands) };
/// assert_eq!(problem.check(8), Ok(()));
/// assert_eq!(problem.check(1), Err(ProblemError::TooManyRobots));
/// let crowded = [errands[1]; 2];
/// problem.errands = &crowded;
/// assert_eq!(problem.check(8), Err(ProblemError::SharedStart { cell: Cell(48) }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "MAPF")]
#[doc(alias = "multi-agent path finding")]
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a, const W: usize> {
    /// The terrain.
    pub map: &'a Map<W>,
    /// Cells that no robot may enter: obstacles, keep-outs, hypotheses. A robot that stands on one
    /// may leave it.
    pub closed: CellSet<W>,
    /// One for each robot, in the order of the members.
    pub errands: &'a [Errand],
    /// The goals that no robot owns: fewer than robots, as many or more.
    pub goals: &'a [Cell],
    /// On how many of the goals a robot must end.
    pub need: usize,
    /// Paths with which some of the robots begin in any plan, at most one for each.
    pub prefixes: &'a [Prefix],
}

/// Why a problem makes no sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ProblemError {
    /// More robots than the planner has room for.
    #[error("more robots than the planner has room for")]
    TooManyRobots,
    /// A robot is not on the map.
    #[error("a robot on cell {}, which the map has not", cell.0)]
    StartOutside {
        /// Where it says it stands.
        cell: Cell,
    },
    /// Two robots are on one cell.
    #[error("two robots on cell {}", cell.0)]
    SharedStart {
        /// The cell.
        cell: Cell,
    },
    /// A robot's own target or a goal is not on the map.
    #[error("a target {}, which the map has not", cell.0)]
    TargetOutside {
        /// The target.
        cell: Cell,
    },
    /// Two robots own one target.
    #[error("two robots own the target {}", cell.0)]
    SharedTarget {
        /// The target.
        cell: Cell,
    },
    /// A prefix is of a robot that there is not or that stands, or of one that has another prefix;
    /// or it does not begin where the robot is; or it enters a cell that no robot may enter.
    #[error("robot {robot} cannot begin with its prefix")]
    UnusablePrefix {
        /// The robot, by its place among the errands.
        robot: u8,
    },
    /// Two prefixes are on one cell at a time, or one enters the cell that the other one leaves.
    #[error("the prefix of robot {robot} gets in the way of another one")]
    CrossingPrefixes {
        /// The second of the two robots.
        robot: u8,
    },
}

impl<'a, const W: usize> Problem<'a, W> {
    /// Robots on a map on which no cell is closed, without goals that no robot owns.
    #[must_use]
    pub const fn new(map: &'a Map<W>, errands: &'a [Errand]) -> Self {
        Self { map, closed: CellSet::EMPTY, errands, goals: &[], need: 0, prefixes: &[] }
    }
}

impl<const W: usize> Problem<'_, W> {
    /// Whether the problem makes sense to a planner of at most `robots` robots.
    ///
    /// # Errors
    /// The first [`ProblemError`] in the order of its variants.
    pub fn check(&self, robots: usize) -> Result<(), ProblemError> {
        if self.errands.len() > robots {
            return Err(ProblemError::TooManyRobots);
        }
        let outside = |cell: &Cell| !self.map.contains(*cell);
        if let Some(cell) = self.starts().find(outside) {
            return Err(ProblemError::StartOutside { cell });
        }
        if let Some(cell) = repeated::<W>(self.starts()) {
            return Err(ProblemError::SharedStart { cell });
        }
        if let Some(cell) = self.owned().chain(self.goals.iter().copied()).find(outside) {
            return Err(ProblemError::TargetOutside { cell });
        }
        if let Some(cell) = repeated::<W>(self.owned()) {
            return Err(ProblemError::SharedTarget { cell });
        }
        prefix::check(self)
    }

    /// The cells that the robots stand on, in their order.
    pub fn starts(&self) -> impl Iterator<Item = Cell> + '_ {
        self.errands.iter().map(|errand| errand.from)
    }

    /// The targets that robots own, in the order of the robots.
    pub fn owned(&self) -> impl Iterator<Item = Cell> + '_ {
        self.errands.iter().filter_map(|errand| match errand.target {
            Target::Own(cell) => Some(cell),
            Target::Any | Target::Stand => None,
        })
    }

    /// The cells that robots of the team end on whatever the others do: where they stand to stay,
    /// and the targets they own.
    #[must_use]
    pub fn held(&self) -> CellSet<W> {
        self.standing().chain(self.owned()).collect()
    }

    /// The cells that the robots stand on that may end on any goal, in their order.
    pub fn free_starts(&self) -> impl Iterator<Item = Cell> + '_ {
        self.errands.iter().filter(|errand| errand.target == Target::Any).map(|errand| errand.from)
    }

    fn standing(&self) -> impl Iterator<Item = Cell> + '_ {
        self.errands.iter().filter(|errand| errand.target == Target::Stand).map(|errand| errand.from)
    }

    /// The cells that a robot may enter: free on the map, not closed, and no robot stands there to
    /// stay.
    #[must_use]
    pub fn enterable(&self) -> CellSet<W> {
        self.map.free_cells().without(&self.closed).without(&self.standing().collect())
    }
}

/// The first cell that comes a second time.
fn repeated<const W: usize>(mut cells: impl Iterator<Item = Cell>) -> Option<Cell> {
    let mut seen = CellSet::<W>::EMPTY;
    cells.find(|&cell| !seen.insert(cell))
}
