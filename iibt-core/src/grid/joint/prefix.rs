//! Paths with which robots begin in any plan: by a look-out, or on to where they can be stopped.

use super::super::spread::Spread;
use super::super::{Cell, CellSet, Move, Path};
use super::{Errand, Problem, ProblemError, Target};
use crate::actions::HORIZON;

/// The path that a robot follows from the first step on, before it goes wherever the plan leads it.
///
/// No other robot is on a cell of it one step before, while, or one step after it is there: no
/// robot follows this one, and it follows no other. A plan is at least as long as each of its
/// prefixes.
///
/// ```
/// use iibt_core::grid::joint::{Errand, JointPlanner, Prefix, Problem, Target};
/// use iibt_core::grid::{Cell, Map};
///
/// // The first robot looks into the upper end before it goes to a goal.
/// let map = Map::<1>::drawn("..####\n......\n..####")?;
/// let errands = [6, 12].map(|from| Errand { from: Cell(from), target: Target::Any });
/// let goals = [10, 11].map(Cell);
/// let problem = Problem { goals: &goals, need: 2, ..Problem::new(&map, &errands) };
/// let prefix = Prefix::by(&problem, 0, Cell(1), 0).ok_or("no way")?;
/// assert!(prefix.path.cells(&map).eq([6, 0, 1].map(Cell)));
///
/// let mut planner = JointPlanner::<1, 33, 8, 64>::new();
/// let problem = Problem { prefixes: &[prefix], ..problem };
/// let plan = planner.work(&problem, &mut u32::MAX.clone()).ok_or("a budget without end")??;
/// assert!(plan.paths()[0].cells(&map).take(3).eq([6, 0, 1].map(Cell)));
/// assert!(plan.paths().iter().all(|path| goals.contains(&path.end(&map))));
/// assert_eq!(plan.following(&map), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Prefix {
    /// The robot, by its place among the errands.
    pub robot: u8,
    /// Its first moves, waits included.
    pub path: Path,
}

impl Prefix {
    /// The shortest way of a robot to a cell after `waits` waits: past the cells where others
    /// stand, if there is such a way, else over them.
    ///
    /// Returns `None` when there is no such robot or way, or none as short as a path can be.
    ///
    /// Cost: linear in the distance and `W`. Takes `4 W` bytes of stack for each possible step.
    #[must_use]
    pub fn by<const W: usize>(problem: &Problem<'_, W>, robot: u8, cell: Cell, waits: usize) -> Option<Self> {
        let from = problem.errands.get(usize::from(robot))?.from;
        let open = problem.enterable();
        let past_others = open.without(&problem.starts().collect());
        let way =
            shortest(problem, from, cell, past_others).or_else(|| shortest(problem, from, cell, open))?;
        let mut path = Path::at(from);
        for step in core::iter::repeat_n(Move::Wait, waits).chain(way.moves()) {
            path.push(step).ok()?;
        }
        Some(Self { robot, path })
    }
}

/// The shortest way over these cells.
fn shortest<const W: usize>(
    problem: &Problem<'_, W>,
    from: Cell,
    to: Cell,
    cells: CellSet<W>,
) -> Option<Path> {
    let spread = Spread::within(problem.map, cells.union(&[from].into_iter().collect()));
    let mut layers = [CellSet::EMPTY; HORIZON + 1];
    let mut reached = [to].into_iter().collect::<CellSet<W>>().intersection(spread.cells());
    let mut distance = 0;
    while !reached.contains(from) {
        *layers.get_mut(distance)? = reached;
        reached = spread.from(&reached);
        distance += 1;
    }
    let (mut path, mut here) = (Path::at(from), from);
    for nearer in layers.get(..distance)?.iter().rev() {
        let mut next = problem.map.free_neighbours(here);
        let (step, cell) = next.find(|&(_, cell)| nearer.contains(cell))?;
        path.push(step).ok()?;
        here = cell;
    }
    Some(path)
}

/// Where and when a robot comes into the flow: at the end of its prefix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    pub(super) cell: Cell,
    pub(super) step: u8,
}

impl<const W: usize> Problem<'_, W> {
    /// Where and when a robot is free to go anywhere.
    pub(super) fn entry(&self, robot: usize, errand: &Errand) -> Entry {
        let path = self.prefixes.iter().find(|prefix| usize::from(prefix.robot) == robot);
        let entry =
            |prefix: &Prefix| Entry { cell: prefix.path.end(self.map), step: prefix.path.len() as u8 };
        path.map_or(Entry { cell: errand.from, step: 0 }, entry)
    }

    /// The entries of the robots that may end on any goal, in their order.
    pub(super) fn free_entries(&self) -> impl Iterator<Item = Entry> + '_ {
        let all = self.errands.iter().enumerate();
        let free = all.filter(|(_, errand)| errand.target == Target::Any);
        free.map(|(robot, errand)| self.entry(robot, errand))
    }

    /// The steps of the longest prefix.
    pub(super) fn longest_prefix(&self) -> usize {
        self.prefixes.iter().map(|prefix| prefix.path.len()).max().unwrap_or(0)
    }
}

/// The cells on which prefixes leave no room for other robots at a step: where their robots are one
/// step before, then, and one step after. The end of a prefix is open to its own robot from then
/// on.
pub(super) fn closed_around<const W: usize>(problem: &Problem<'_, W>, step: usize) -> CellSet<W> {
    let mut closed = CellSet::EMPTY;
    for Prefix { path, .. } in problem.prefixes.iter().filter(|prefix| step <= prefix.path.len()) {
        let entry = Some(path.end(problem.map)).filter(|_| step == path.len());
        let cells = path.cells(problem.map).take(step + 2).skip(step.saturating_sub(1));
        cells.filter(|&cell| Some(cell) != entry).for_each(|cell| _ = closed.insert(cell));
    }
    closed
}

/// Whether robots can begin with the prefixes of a problem.
pub(super) fn check<const W: usize>(problem: &Problem<'_, W>) -> Result<(), ProblemError> {
    for (index, prefix) in problem.prefixes.iter().enumerate() {
        let robot = prefix.robot;
        let earlier = || problem.prefixes.iter().take(index);
        if earlier().any(|other| other.robot == robot) || !is_usable(problem, prefix) {
            return Err(ProblemError::UnusablePrefix { robot });
        }
        if earlier().any(|other| is_in_the_way(problem, &prefix.path, &other.path)) {
            return Err(ProblemError::CrossingPrefixes { robot });
        }
    }
    Ok(())
}

fn is_usable<const W: usize>(problem: &Problem<'_, W>, prefix: &Prefix) -> bool {
    let Some(errand) = problem.errands.get(usize::from(prefix.robot)) else { return false };
    let open = problem.enterable();
    let mut here = errand.from;
    prefix.path.start == here
        && errand.target != Target::Stand
        && prefix.path.actions.iter().all(|code| {
            let Some(step) = Move::from_code(code) else { return false };
            let before = here;
            here = problem.map.neighbour(before, step);
            step == Move::Wait || here != before && open.contains(here)
        })
}

/// Whether two robots are on one cell at a time as long as both are on their prefixes, or one of
/// them enters the cell that the other one leaves.
fn is_in_the_way<const W: usize>(problem: &Problem<'_, W>, one: &Path, other: &Path) -> bool {
    let steps = one.len().min(other.len()) + 1;
    let pairs = one.cells(problem.map).zip(other.cells(problem.map)).take(steps);
    let mut before = None;
    pairs.into_iter().any(|(a, b)| {
        let (was_a, was_b) = before.replace((a, b)).unwrap_or((a, b));
        a == b || a == was_b || b == was_a
    })
}
