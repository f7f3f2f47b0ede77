//! Teams whose robots own their targets, drawn or random, what planners say of them, and whether
//! that is so.

use super::super::pictures::Random;
use super::super::{Cell, CellSet, Map};
use super::{Errand, Failure, JointPlan, Lacam, Prioritised, Problem, Target, own_targets};
use std::collections::HashSet;
use std::println;
use std::vec::Vec;

pub(super) type Answer = Result<JointPlan<8>, Failure>;

pub(super) const CORRIDORS: [&[&str]; 6] = [
    &["..#..", ".....", "..#.."],
    &["....#", ".##..", ".#.#.", "..#.."],
    &["...#...", ".#...#.", "...#..."],
    &[".#.#.#.", ".......", "###.###"],
    &[".#.", "...", "#.#", "...", ".#."],
    &[".........", "#.###.###"],
];

/// A team on a map of up to 64 cells.
pub(super) struct Trial {
    pub(super) map: Map<2>,
    pub(super) closed: CellSet<2>,
    pub(super) errands: Vec<Errand>,
}

impl Trial {
    /// Robots on the cells marked with digits, each of which goes to the cell marked with the
    /// letter of the same place in the alphabet.
    pub(super) fn drawn(rows: &[&str]) -> Self {
        let signs: Vec<char> = rows.concat().chars().collect();
        let at = |sign| signs.iter().position(|&other| other == sign).map(|cell| Cell(cell as u16));
        let robots = ('1'..='8').zip('a'..='h');
        let errands = robots.map_while(|(from, to)| Some(own(at(from)?, at(to)?))).collect();
        let free: Vec<_> = rows.iter().map(|row| row.replace(|sign| sign != '#', ".")).collect();
        Self { map: Map::drawn(&free.join("\n")).unwrap(), closed: CellSet::EMPTY, errands }
    }

    /// Robots on random cells of one part of the map to random cells of it; `None` when there is no
    /// cell to spare.
    pub(super) fn on(map: Map<2>, robots: usize, random: &mut Random) -> Option<Self> {
        let cells = part(&map, random);
        let (starts, targets) = (draw(&cells, robots, random)?, draw(&cells, robots, random)?);
        let errands = starts.into_iter().zip(targets).map(|(from, to)| own(from, to)).collect();
        (cells.len() > robots).then_some(Self { map, closed: CellSet::EMPTY, errands })
    }

    /// A random team on a map of 4 to 64 cells, every fifth one a corridor.
    pub(super) fn random(number: usize, random: &mut Random) -> Self {
        loop {
            let map = match number % 5 {
                0 => corridor(number / 5),
                _ => random_map(8, random),
            };
            let robots = 2 + random.below(7);
            if let Some(trial) = Self::on(map, robots, random) {
                return trial;
            }
        }
    }

    pub(super) fn problem(&self) -> Problem<'_, 2> {
        Problem { closed: self.closed, ..Problem::new(&self.map, &self.errands) }
    }

    pub(super) fn targets(&self) -> [Cell; 8] {
        own_targets(&self.problem()).unwrap()
    }

    /// The answer of LaCAM and the work units it took, in slices of this many.
    pub(super) fn lacam<const M: usize>(&self, planner: &mut Lacam<2, 8, M>, slice: u32) -> (Answer, u32) {
        let (problem, targets) = (self.problem(), self.targets());
        finish(slice, |budget| planner.work(&problem, &targets, budget))
    }

    /// The same by prioritised planning.
    pub(super) fn prioritised(&self, planner: &mut Prioritised<2, 65, 8>, slice: u32) -> (Answer, u32) {
        let (problem, targets) = (self.problem(), self.targets());
        finish(slice, |budget| planner.work(&problem, &targets, budget))
    }

    /// Panics unless the plan takes every robot from its start to its target, cell by cell, without
    /// a shared cell or a ring; returns whether a robot enters a cell that another one leaves.
    pub(super) fn check(&self, plan: &JointPlan<8>) -> bool {
        let targets = &self.targets()[..self.errands.len()];
        let at = |step| plan.paths().iter().map(move |path| path.cell_at(&self.map, step));
        assert!(at(0).eq(self.errands.iter().map(|errand| errand.from)), "{plan:?}");
        assert!(at(plan.steps()).eq(targets.iter().copied()), "{plan:?}");
        let steps: Vec<Vec<Cell>> = (0..=plan.steps()).map(|step| at(step).collect()).collect();
        let follows = steps.windows(2).map(|pair| self.check_step(&pair[0], &pair[1]));
        follows.fold(false, |some, follows| some | follows)
    }

    fn check_step(&self, before: &[Cell], after: &[Cell]) -> bool {
        for (robot, (&from, &to)) in before.iter().zip(after).enumerate() {
            assert!(self.map.move_between(from, to).is_some(), "a jump to {to:?}");
            assert!(from == to || self.may_enter(robot, to), "robot {robot} enters {to:?}");
        }
        assert!(is_possible(before, after), "{before:?} {after:?}");
        let enters = |robot: &usize| before[*robot] != after[*robot];
        (0..before.len()).filter(enters).any(|robot| before.contains(&after[robot]))
    }

    fn may_enter(&self, robot: usize, cell: Cell) -> bool {
        let stands = |errand: &Errand| errand.target == Target::Stand && errand.from == cell;
        self.map.is_free(cell)
            && !self.closed.contains(cell)
            && !self.errands.iter().any(stands)
            && self.errands[robot].target != Target::Stand
    }

    /// The fewest steps in which the team can be on its targets, following allowed: breadth first
    /// over all joint states.
    pub(super) fn exact(&self) -> Option<usize> {
        let start: Vec<Cell> = self.errands.iter().map(|errand| errand.from).collect();
        let targets = &self.targets()[..start.len()];
        let mut seen = HashSet::from([start.clone()]);
        let mut layer = std::vec![start];
        for steps in 0.. {
            if layer.iter().any(|state| state == targets) {
                return Some(steps);
            }
            let mut next = Vec::new();
            for state in &layer {
                self.successors(state, &mut Vec::new(), &mut |after| {
                    if !seen.contains(after) {
                        seen.insert(after.to_vec());
                        next.push(after.to_vec());
                    }
                });
            }
            layer = next;
            if layer.is_empty() {
                return None;
            }
        }
        None
    }

    fn successors(&self, before: &[Cell], after: &mut Vec<Cell>, visit: &mut impl FnMut(&[Cell])) {
        let Some(&at) = before.get(after.len()) else {
            if is_possible(before, after) {
                visit(after);
            }
            return;
        };
        let moves: Vec<Cell> = self.map.free_neighbours(at).map(|(_, to)| to).chain([at]).collect();
        for to in moves {
            if (to == at || self.may_enter(after.len(), to)) && !after.contains(&to) {
                after.push(to);
                self.successors(before, after, visit);
                after.pop();
            }
        }
    }
}

pub(super) fn own(from: Cell, to: Cell) -> Errand {
    Errand { from, target: Target::Own(to) }
}

pub(super) fn corridor(number: usize) -> Map<2> {
    Map::drawn(&CORRIDORS[number % CORRIDORS.len()].join("\n")).unwrap()
}

/// A map of 2 x 2 to `side` x `side` cells, a quarter of which is blocked.
pub(super) fn random_map(side: usize, random: &mut Random) -> Map<2> {
    let [width, height] = [(); 2].map(|()| 2 + random.below(side - 1) as u16);
    random.map(width, height, 25)
}

/// All cells that can be reached from a random one.
pub(super) fn part(map: &Map<2>, random: &mut Random) -> Vec<Cell> {
    let free: Vec<Cell> = map.free_cells().iter().collect();
    let mut cells: Vec<Cell> = free.get(random.below(free.len().max(1))).copied().into_iter().collect();
    let mut done = 0;
    while let Some(&cell) = cells.get(done) {
        let next: Vec<Cell> = map.free_neighbours(cell).map(|(_, next)| next).collect();
        cells.extend(next.into_iter().filter(|next| !cells.contains(next)).collect::<Vec<_>>());
        done += 1;
    }
    cells
}

pub(super) fn draw(cells: &[Cell], count: usize, random: &mut Random) -> Option<Vec<Cell>> {
    let mut left = cells.to_vec();
    (0..count).map(|_| (!left.is_empty()).then(|| left.swap_remove(random.below(left.len())))).collect()
}

/// Whether no two robots share a cell after a step, and robots leave no circle of cells to each
/// other: taking away again and again the robots that wait or whose new cell is empty leaves
/// none.
pub(super) fn is_possible(before: &[Cell], after: &[Cell]) -> bool {
    let shared = after.iter().enumerate().any(|(robot, cell)| after[..robot].contains(cell));
    let mut left: Vec<usize> = (0..before.len()).filter(|&robot| before[robot] != after[robot]).collect();
    loop {
        let blocked = |&robot: &usize| left.iter().any(|&other| before[other] == after[robot]);
        let still: Vec<usize> = left.iter().copied().filter(blocked).collect();
        if still.len() == left.len() {
            return !shared && left.is_empty();
        }
        left = still;
    }
}

pub(super) fn finish(slice: u32, mut work: impl FnMut(&mut u32) -> Option<Answer>) -> (Answer, u32) {
    let mut units = 0;
    loop {
        let mut budget = slice;
        let answer = work(&mut budget);
        units += slice - budget;
        match answer {
            Some(answer) => return (answer, units),
            None => assert_eq!(budget, 0, "stopped before the budget was used up"),
        }
    }
}

/// How many teams were solved, in how many steps, and with how many work units.
pub(super) fn print_units(name: &str, answers: &[(Answer, u32)]) {
    let steps: Vec<usize> = answers.iter().filter_map(|(answer, _)| Some(answer.ok()?.steps())).collect();
    let units = answers.iter().map(|&(_, units)| units);
    println!(
        "{name}: {} of {} solved, {:.1} steps; {} work units, worst {}",
        steps.len(),
        answers.len(),
        steps.iter().sum::<usize>() as f64 / steps.len() as f64,
        units.clone().sum::<u32>() as usize / answers.len(),
        units.max().unwrap()
    );
}
