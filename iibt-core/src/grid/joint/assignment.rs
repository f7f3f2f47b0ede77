//! Teams in which every robot has a target of its own.

use super::super::{Cell, CellSet, Map};
use super::{Failure, JointPlan, Problem, ProblemError, Target};

/// The cell of a robot that there is not, and of a move that is not decided.
pub(super) const NOWHERE: Cell = Cell(u16::MAX);

/// One cell for each robot; [`NOWHERE`] past the last one.
pub(super) type State<const N: usize> = [Cell; N];

/// What a search says.
pub(super) type Answer<const N: usize> = Result<JointPlan<N>, Failure>;

/// Where each robot of a checked problem begins and ends.
pub(super) struct Assignment<const W: usize, const N: usize> {
    /// The map on which only cells that a robot may enter are free.
    pub(super) map: Map<W>,
    pub(super) from: State<N>,
    pub(super) to: State<N>,
    pub(super) robots: usize,
}

/// The target of every robot of a problem in which each has its own: of one that stands, the cell
/// where it is.
///
/// Returns `None` when a robot goes to [any](Target::Any) open goal: such robots need an
/// assignment. Entries past the last robot mean nothing.
///
/// ```
/// use iibt_core::grid::joint::{Errand, Problem, Target, own_targets};
/// use iibt_core::grid::{Cell, Map};
///
/// let map = Map::<1>::drawn("....")?;
/// let own = Errand { from: Cell(0), target: Target::Own(Cell(2)) };
/// let stands = Errand { from: Cell(3), target: Target::Stand };
/// let errands = [own, stands];
/// let problem = Problem::new(&map, &errands);
/// assert_eq!(own_targets(&problem), Some([Cell(2), Cell(3)]));
///
/// let errands = [own, Errand { target: Target::Any, ..stands }];
/// assert_eq!(own_targets::<1, 2>(&Problem { errands: &errands, ..problem }), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn own_targets<const W: usize, const N: usize>(problem: &Problem<'_, W>) -> Option<[Cell; N]> {
    let mut targets = [NOWHERE; N];
    for (to, errand) in targets.iter_mut().zip(problem.errands) {
        *to = match errand.target {
            Target::Own(cell) => cell,
            Target::Stand => errand.from,
            Target::Any => return None,
        };
    }
    Some(targets)
}

/// A target for every robot: its own, the cell where it stands, or, for a robot that goes to any
/// goal, the nearest goal that is left as long as goals are needed, and then a cell near its start.
pub(super) fn assigned<const W: usize, const N: usize>(problem: &Problem<'_, W>) -> [Cell; N] {
    let mut targets = [NOWHERE; N];
    let mut taken = problem.held();
    for (to, errand) in targets.iter_mut().zip(problem.errands) {
        match errand.target {
            Target::Own(cell) => *to = cell,
            Target::Stand => *to = errand.from,
            Target::Any => {}
        }
    }
    let goals: CellSet<W> = problem.goals.iter().copied().collect();
    let mut needed = problem.need.saturating_sub(goals.intersection(&taken).len());
    for (to, errand) in targets.iter_mut().zip(problem.errands) {
        if *to != NOWHERE {
            continue;
        }
        let goals = if needed > 0 { goals } else { CellSet::EMPTY };
        let free = problem.enterable().without(&taken);
        let nearest = |cells: CellSet<W>| {
            cells.iter().min_by_key(|&cell| (problem.map.manhattan(errand.from, cell), cell))
        };
        let goal = nearest(goals.intersection(&free));
        needed -= usize::from(goal.is_some());
        *to = goal.or_else(|| nearest(free)).unwrap_or(errand.from);
        taken.insert(*to);
    }
    targets
}

/// Does one work unit of a search after another for robots that have these targets, until there is
/// an answer.
pub(super) fn search<const W: usize, const N: usize>(
    problem: &Problem<'_, W>,
    targets: &[Cell; N],
    budget: &mut u32,
    mut unit: impl FnMut(&Assignment<W, N>) -> Option<Answer<N>>,
) -> Option<Answer<N>> {
    let team = match Assignment::new(problem, targets) {
        Err(invalid) => return Some(Err(invalid)),
        Ok(team) => team,
    };
    loop {
        *budget = budget.checked_sub(1)?;
        let answer = unit(&team);
        if answer.is_some() {
            return answer;
        }
    }
}

impl<const W: usize, const N: usize> Assignment<W, N> {
    /// Checks a problem and the targets that its robots are given.
    pub(super) fn new(problem: &Problem<'_, W>, targets: &[Cell; N]) -> Result<Self, Failure> {
        problem.check(N).map_err(Failure::Invalid)?;
        let robots = problem.errands.len();
        let (mut from, mut to) = ([NOWHERE; N], [NOWHERE; N]);
        for ((from, to), (errand, &target)) in
            from.iter_mut().zip(&mut to).zip(problem.errands.iter().zip(targets))
        {
            (*from, *to) = (errand.from, target);
        }
        check_targets(problem.map, to.get(..robots).unwrap_or_default()).map_err(Failure::Invalid)?;
        let closed = problem.map.free_cells().without(&problem.enterable());
        Ok(Self { map: problem.map.avoiding(closed.iter()), from, to, robots })
    }

    /// The plan in which all stay where they are.
    pub(super) fn standing(&self) -> JointPlan<N> {
        let mut plan = JointPlan::NOBODY;
        plan.stand(self.from.iter().copied().take(self.robots));
        plan
    }
}

/// Whether all targets are on the map and no two are the same.
fn check_targets<const W: usize>(map: &Map<W>, targets: &[Cell]) -> Result<(), ProblemError> {
    for (robot, &cell) in targets.iter().enumerate() {
        if !map.contains(cell) {
            return Err(ProblemError::TargetOutside { cell });
        }
        if targets.iter().take(robot).any(|&other| other == cell) {
            return Err(ProblemError::SharedTarget { cell });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::Errand;
    use super::*;

    #[test]
    fn every_robot_has_a_target_and_no_two_the_same() {
        let map = Map::<1>::drawn("......\n......").unwrap();
        let errand = |(from, target)| Errand { from: Cell(from), target };
        let errands = [
            (0, Target::Any),
            (1, Target::Own(Cell(0))),
            (2, Target::Stand),
            (3, Target::Any),
            (4, Target::Any),
        ]
        .map(errand);
        let goals = [5, 0].map(Cell);
        let problem = Problem { goals: &goals, need: 2, ..Problem::new(&map, &errands) };
        // Goal 0 is held by its owner, so one more is needed, and the first robot takes it.
        assert_eq!(assigned::<1, 5>(&problem), [5, 0, 2, 3, 4].map(Cell));
        let crowded = Problem { closed: [3].into_iter().map(Cell).collect(), need: 0, ..problem };
        let targets = assigned::<1, 5>(&crowded);
        assert!(targets[0] != Cell(0) && targets[3] != Cell(3), "{targets:?}");
    }
}
