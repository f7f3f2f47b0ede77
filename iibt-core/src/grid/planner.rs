//! Shortest paths and distances, in an arena of fixed size.
//!
//! The search is A* (Hart, Nilsson, Raphael 1968) from the goal back to the start, with the
//! Manhattan distance as the estimate, which is consistent on a grid of unit moves. All that ties
//! with the shortest way is expanded, so that the way can be read off from the start: at every
//! cell, the first move in the order of the codes (up, down, left, right) on any shortest way. The
//! path is thus a property of the map alone, not of the order in which cells were searched.

use super::open_list::OpenList;
use super::spread::Spread;
use super::{Cell, Map, Path};

/// Plans over maps of up to `S` cells; needs 9 bytes per cell and keeps nothing from one call to
/// the next.
///
/// ```
/// use iibt_core::grid::{Cell, Map, Planner, words};
///
/// let map = Map::<{ words(7, 7) }>::new(7, 7).unwrap();
/// let mut planner = Planner::<49>::new();
/// let path = planner.shortest(&map, Cell(28), Cell(26)).unwrap();
/// assert!(path.cells(&map).eq([28, 21, 22, 23, 24, 25, 26].map(Cell)));
/// let around = planner.shortest(&map.avoiding([Cell(23)]), Cell(28), Cell(26)).unwrap();
/// assert_eq!(around.len(), 6);
/// ```
#[doc(alias = "A*")]
#[doc(alias = "a-star")]
#[doc(alias = "shortest path")]
#[derive(Clone, Debug)]
pub struct Planner<const S: usize> {
    /// The cost of the cheapest way found to the goal, or [`UNREACHED`].
    cost: [u16; S],
    open: OpenList<S>,
}

/// The reason why there is no path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PlanError {
    /// The map has more cells than the planner's arena.
    #[error("the map has more cells than the planner's arena")]
    MapTooLarge,
    /// The start is not on the map.
    #[error("the start is not on the map")]
    StartOutside,
    /// The start is blocked.
    #[error("the start is blocked")]
    StartBlocked,
    /// The goal is not on the map.
    #[error("the goal is not on the map")]
    GoalOutside,
    /// The goal is blocked.
    #[error("the goal is blocked")]
    GoalBlocked,
    /// Obstacles separate the start from the goal.
    #[error("no way leads from the start to the goal")]
    NoWay,
    /// The way has more moves than the [`HORIZON`](crate::actions::HORIZON).
    #[error("the way to the goal is longer than the horizon")]
    TooLong,
}

/// The moves from one cell to every other; see [`Planner::distances`].
#[derive(Clone, Copy, Debug)]
pub struct Distances<'a> {
    table: &'a [u16],
}

const UNREACHED: u16 = u16::MAX;

impl<const S: usize> Planner<S> {
    /// A planner, ready for any map of at most `S` cells.
    #[must_use]
    pub const fn new() -> Self {
        Self { cost: [UNREACHED; S], open: OpenList::new() }
    }

    /// A shortest path; of several, the one whose first differing move has the lowest code.
    ///
    /// Cost: at most `4 S` relaxations of `log2(S)` heap steps each; on open ground only the cells
    /// between start and goal are visited.
    ///
    /// # Errors
    /// Every [`PlanError`].
    pub fn shortest<const W: usize>(
        &mut self,
        map: &Map<W>,
        from: Cell,
        to: Cell,
    ) -> Result<Path, PlanError> {
        self.check_start(map, from)?;
        if !map.contains(to) {
            return Err(PlanError::GoalOutside);
        }
        if !map.is_free(to) {
            return Err(PlanError::GoalBlocked);
        }
        self.search(map, from, to);
        self.read_off(map, from, to)
    }

    /// The moves from `from` to every cell, breadth first.
    ///
    /// Cost: linear in `W` per layer of equal distance, and one visit of every cell reached.
    ///
    /// # Errors
    /// [`PlanError::MapTooLarge`], [`PlanError::StartOutside`], [`PlanError::StartBlocked`].
    ///
    /// ```
    /// use iibt_core::grid::{Cell, Map, Planner, words};
    ///
    /// let map = Map::<{ words(3, 3) }>::new(3, 3)?.avoiding([Cell(1), Cell(4)]);
    /// let mut planner = Planner::<9>::new();
    /// let distances = planner.distances(&map, Cell(0))?;
    /// assert_eq!(distances.to(Cell(2)), Some(6)); // around the wall
    /// assert_eq!(distances.to(Cell(4)), None); // blocked
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn distances<const W: usize>(
        &mut self,
        map: &Map<W>,
        from: Cell,
    ) -> Result<Distances<'_>, PlanError> {
        self.check_start(map, from)?;
        self.cost.fill(UNREACHED);
        Spread::over(map).flood(from, |cell, distance| self.set_cost(cell, distance));
        Ok(Distances { table: &self.cost })
    }

    fn check_start<const W: usize>(&self, map: &Map<W>, from: Cell) -> Result<(), PlanError> {
        if map.len() > S {
            return Err(PlanError::MapTooLarge);
        }
        if !map.contains(from) {
            return Err(PlanError::StartOutside);
        }
        if !map.is_free(from) {
            return Err(PlanError::StartBlocked);
        }
        Ok(())
    }

    /// Finds the cost to the goal of every cell on a cheapest way from the start.
    fn search<const W: usize>(&mut self, map: &Map<W>, from: Cell, to: Cell) {
        self.cost.fill(UNREACHED);
        self.open.clear();
        self.set_cost(to, 0);
        self.open.put(to, map.manhattan(from, to));
        while let Some(cell) = self.open.pop(self.cost(from)) {
            let cost = self.cost(cell).saturating_add(1);
            for (_, next) in map.free_neighbours(cell) {
                let ahead = map.manhattan(from, next);
                if cost < self.cost(next) {
                    self.set_cost(next, cost);
                    self.open.put(next, cost.saturating_add(ahead));
                }
            }
        }
    }

    /// Reads the path off the costs that the search left, by the lowest move code.
    fn read_off<const W: usize>(&self, map: &Map<W>, from: Cell, to: Cell) -> Result<Path, PlanError> {
        if self.cost(from) == UNREACHED {
            return Err(PlanError::NoWay);
        }
        let mut path = Path::at(from);
        let mut here = from;
        while here != to {
            let down = |next| self.cost(next).saturating_add(1) == self.cost(here);
            let (step, next) =
                map.free_neighbours(here).find(|&(_, next)| down(next)).ok_or(PlanError::NoWay)?;
            path.push(step).map_err(|_| PlanError::TooLong)?;
            here = next;
        }
        Ok(path)
    }

    fn cost(&self, cell: Cell) -> u16 {
        self.cost.get(cell.index()).copied().unwrap_or(UNREACHED)
    }

    fn set_cost(&mut self, cell: Cell, cost: u16) {
        if let Some(entry) = self.cost.get_mut(cell.index()) {
            *entry = cost;
        }
    }
}

impl<const S: usize> Default for Planner<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl Distances<'_> {
    /// The moves to a cell, or `None` when no way leads there.
    #[must_use]
    pub fn to(&self, cell: Cell) -> Option<u16> {
        self.table.get(cell.index()).copied().filter(|&distance| distance != UNREACHED)
    }
}

#[cfg(test)]
mod tests {
    use super::super::pictures::{Random, assert_picture, drawn, marked, paper, picture};
    use super::*;
    use crate::actions::HORIZON;
    use std::collections::VecDeque;
    use std::vec::Vec;

    fn plan(rows: &[&str]) -> Result<Path, PlanError> {
        Planner::<1024>::new().shortest(&drawn(rows), marked(rows, 'S'), marked(rows, 'G'))
    }

    #[track_caller]
    fn check(rows: &[&str], expected: &[&str]) {
        assert_picture(&picture(&drawn(rows), &plan(rows).unwrap()), expected);
    }

    #[test]
    fn goes_around_a_wall() {
        check(
            &[
                "S.#.", //
                "..#.", //
                "...G",
            ],
            &[
                "0.#.", //
                "1.#.", //
                "2345",
            ],
        );
    }

    #[test]
    fn finds_the_only_way_through_a_maze() {
        check(
            &[
                "S#...", //
                ".#.#.", //
                ".#.#.", //
                "...#G",
            ],
            &[
                "0#89a", //
                "1#7#b", //
                "2#6#c", //
                "345#d",
            ],
        );
    }

    #[test]
    fn breaks_ties_by_up_before_down_before_left_before_right() {
        check(
            &[
                "...", //
                "S..", //
                "..G",
            ],
            &[
                "...", //
                "0..", //
                "123",
            ],
        );
        check(
            &[
                "..G", //
                "...", //
                "S..",
            ],
            &[
                "234", //
                "1..", //
                "0..",
            ],
        );
        check(
            &[
                "..S", //
                "...", //
                "G..",
            ],
            &[
                "..0", //
                "..1", //
                "432",
            ],
        );
    }

    #[test]
    fn keeps_to_the_borders() {
        check(&["S..", "##.", "G.."], &["012", "##3", "654"]);
        check(&["G.S"], &["210"]);
        check(&["G", ".", "S"], &["2", "1", "0"]);
    }

    #[test]
    fn stays_where_it_is_when_that_is_the_goal() {
        let map = paper(&[]);
        assert_eq!(Planner::<49>::new().shortest(&map, Cell(24), Cell(24)), Ok(Path::at(Cell(24))));
    }

    #[test]
    fn goes_around_an_obstacle_that_appears() {
        let mut planner = Planner::<49>::new();
        let mut numbers = |map, from, to| -> Vec<u16> {
            let path = planner.shortest(&map, Cell(from), Cell(to)).unwrap();
            path.cells(&map).map(|cell| cell.0).collect()
        };
        assert_eq!(numbers(paper(&[]), 29, 24), [29, 22, 23, 24]);
        assert_eq!(numbers(paper(&[22, 30]), 29, 24), [29, 36, 37, 38, 31, 24]);
        assert_eq!(numbers(paper(&[23]), 21, 24), [21, 14, 15, 16, 17, 24]);
        assert_eq!(numbers(paper(&[23, 31]), 14, 26), [14, 15, 16, 17, 24, 25, 26]);
    }

    #[test]
    fn says_why_there_is_no_path() {
        let map = paper(&[10, 1, 7]);
        let plan = |from, to| Planner::<49>::new().shortest(&map, Cell(from), Cell(to));
        assert_eq!(plan(49, 3), Err(PlanError::StartOutside));
        assert_eq!(plan(10, 3), Err(PlanError::StartBlocked));
        assert_eq!(plan(3, u16::MAX), Err(PlanError::GoalOutside));
        assert_eq!(plan(3, 10), Err(PlanError::GoalBlocked));
        assert_eq!(plan(3, 0), Err(PlanError::NoWay));
        assert_eq!(plan(0, 3), Err(PlanError::NoWay));
        assert_eq!(Planner::<48>::new().shortest(&map, Cell(3), Cell(4)), Err(PlanError::MapTooLarge));
    }

    #[test]
    fn reaches_exactly_to_the_horizon() {
        let map: Map<3> = Map::new(HORIZON as u16 + 2, 1).unwrap();
        let mut planner = Planner::<70>::new();
        let mut plan = |to| planner.shortest(&map, Cell(0), Cell(to)).map(|path| path.len());
        assert_eq!(plan(HORIZON as u16), Ok(HORIZON));
        assert_eq!(plan(HORIZON as u16 + 1), Err(PlanError::TooLong));
    }

    #[test]
    fn takes_eight_bytes_per_cell() {
        let fixed = 2 * size_of::<usize>();
        assert!(size_of::<Planner<49>>() <= 8 * 49 + fixed);
        assert!(size_of::<Planner<1024>>() <= 8 * 1024 + fixed);
    }

    #[test]
    fn measures_the_distance_to_every_cell() {
        let map = drawn(&[
            "..#.", //
            ".##.", //
            "...#",
        ]);
        let mut planner = Planner::<12>::new();
        let distances = planner.distances(&map, Cell(0)).unwrap();
        let to = |cell| distances.to(Cell(cell));
        assert_eq!([0, 1, 4, 8, 9, 10].map(to), [0, 1, 1, 2, 3, 4].map(Some));
        assert_eq!([2, 3, 5, 6, 7, 11, 12].map(to), [None; 7]);
        assert_eq!(planner.distances(&map, Cell(2)).unwrap_err(), PlanError::StartBlocked);
        assert_eq!(planner.distances(&map, Cell(12)).unwrap_err(), PlanError::StartOutside);
        assert_eq!(Planner::<11>::new().distances(&map, Cell(0)).unwrap_err(), PlanError::MapTooLarge);
    }

    /// Textbook breadth-first search with a queue.
    fn by_queue<const W: usize>(map: &Map<W>, from: Cell) -> Vec<Option<u16>> {
        let mut distance = std::vec![None; map.len()];
        distance[from.index()] = Some(0);
        let mut queue = VecDeque::from([from]);
        while let Some(cell) = queue.pop_front() {
            for (_, next) in map.free_neighbours(cell) {
                if distance[next.index()].is_none() {
                    distance[next.index()] = distance[cell.index()].map(|moves| moves + 1);
                    queue.push_back(next);
                }
            }
        }
        distance
    }

    /// The shortest path by the definition of its ties: at every cell the lowest move that comes
    /// closer.
    fn by_distance<const W: usize>(map: &Map<W>, from: Cell, to: Cell) -> Vec<Cell> {
        let left = by_queue(map, to);
        let mut cells = std::vec![from];
        let mut here = from;
        while here != to {
            let closer = |next: Cell| left[next.index()].map(|moves| moves + 1) == left[here.index()];
            here = map.free_neighbours(here).map(|(_, next)| next).find(|&next| closer(next)).unwrap();
            cells.push(here);
        }
        cells
    }

    #[test]
    fn agrees_with_breadth_first_search_on_random_maps() {
        let mut random = Random(1);
        let mut planner = Planner::<1024>::new();
        let mut outcomes = [0; 3];
        for round in 0..300 {
            let (width, height) = (1 + random.below(32) as u16, 1 + random.below(32) as u16);
            let map: Map<32> = random.map(width, height, round % 45);
            let (from, to) = (random.cell(&map), random.cell(&map));
            if !map.is_free(from) || !map.is_free(to) {
                continue;
            }
            let expected = by_queue(&map, from);
            let distances = planner.distances(&map, from).unwrap();
            assert!(
                (0..map.len() as u16).all(|cell| distances.to(Cell(cell)) == expected[usize::from(cell)])
            );
            let path = planner.shortest(&map, from, to);
            match expected[to.index()] {
                None => assert_eq!(path, Err(PlanError::NoWay)),
                Some(moves) if usize::from(moves) > HORIZON => assert_eq!(path, Err(PlanError::TooLong)),
                Some(moves) => {
                    let path = path.unwrap();
                    assert_eq!(path.len(), usize::from(moves));
                    assert!(path.is_open(&map));
                    assert!(path.cells(&map).eq(by_distance(&map, from, to)));
                }
            }
            outcomes[path.map_or_else(|error| 1 + usize::from(error == PlanError::TooLong), |_| 0)] += 1;
        }
        assert!(outcomes[0] > 100 && outcomes[1] > 10, "{outcomes:?}");
    }
}
