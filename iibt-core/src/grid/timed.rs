//! Paths in space and time: to a goal at an agreed step, past teammates that move.
//!
//! Let `b(k)` be the cells of the teammates at step `k`; a teammate stays on its last cell for ever
//! after. The three conflicts of [`first_conflict`](super::first_conflict) between a robot that
//! goes from `u` at step `k` to `v` at step `k + 1` and its teammates are excluded when neither `u`
//! nor `v` is in `b(k)` or `b(k + 1)`. Together over all steps: at step `k` the robot must be off
//! `b(k - 1)`, `b(k)` and `b(k + 1)`. So one set of cells per step says it all, and the cells that
//! the robot can have reached are
//!
//! ```text
//! reached(0)     = { start }                               \ b(0) \ b(1)
//! reached(k + 1) = { cells one move or a wait away from reached(k) } \ b(k) \ b(k + 1) \ b(k + 2)
//! ```

use super::spread::Spread;
use super::{Cell, CellSet, Map, Move, Path};
use crate::actions::HORIZON;

/// The arena of the planner: one set of cells per step, `4 * W * (HORIZON + 1)` bytes.
///
/// ```
/// use iibt_core::grid::{Cell, Map, Path, TimedPlanner, words};
///
/// let map = Map::<{ words(7, 7) }>::new(7, 7).unwrap();
/// let teammate = Path::through(&map, &[30, 31, 24, 25].map(Cell)).unwrap();
/// let teammates = [teammate];
/// let mut planner = TimedPlanner::new();
/// let sweep = planner.sweep(&map, Cell(28), &teammates);
/// assert_eq!(sweep.earliest(Cell(24)), Some(4));
/// assert!(sweep.path_to(Cell(24), 6).is_some_and(|path| path.len() == 6));
/// assert_eq!(sweep.earliest(Cell(25)), None); // the teammate stays there
/// ```
#[doc(alias = "cooperative A*")]
#[doc(alias = "space-time A*")]
#[doc(alias = "MAPF")]
#[doc(alias = "reservation table")]
#[doc(alias = "prioritized planning")]
#[derive(Clone, Debug)]
pub struct TimedPlanner<const W: usize> {
    layers: [CellSet<W>; HORIZON + 1],
}

/// All the paths from one start past one set of teammates: serves every goal and every step of
/// arrival.
#[derive(Clone, Copy, Debug)]
pub struct Sweep<'a, const W: usize> {
    map: &'a Map<W>,
    from: Cell,
    teammates: &'a [Path],
    reached: &'a [CellSet<W>; HORIZON + 1],
}

impl<const W: usize> TimedPlanner<W> {
    /// A planner for any map of `W` words.
    #[must_use]
    pub const fn new() -> Self {
        Self { layers: [CellSet::EMPTY; HORIZON + 1] }
    }

    /// Finds where a robot on `from` can be at each step, while its teammates follow their paths,
    /// which all begin now ([`Path::rest`] cuts off what is done; [`Path::at`] is a teammate that
    /// stays).
    ///
    /// From a blocked cell, or one that a teammate is on or about to enter, there are no paths at
    /// all.
    ///
    /// Cost: linear in `W (HORIZON + 1)`, and one pass over each teammate's path.
    pub fn sweep<'a>(&'a mut self, map: &'a Map<W>, from: Cell, teammates: &'a [Path]) -> Sweep<'a, W> {
        self.place(map, teammates);
        let spread = Spread::over(map);
        let mut candidates = map.free_cells().intersection(&[from].into_iter().collect());
        let mut before = CellSet::EMPTY;
        for step in 0..=HORIZON {
            let now = self.layer(step);
            let taken = before.union(&now).union(&self.layer(step + 1));
            let reached = candidates.without(&taken);
            candidates = spread.from(&reached);
            before = now;
            if let Some(layer) = self.layers.get_mut(step) {
                *layer = reached;
            }
        }
        Sweep { map, from, teammates, reached: &self.layers }
    }

    /// Fills the layers with the cells of the teammates.
    fn place(&mut self, map: &Map<W>, teammates: &[Path]) {
        self.layers.fill(CellSet::EMPTY);
        for path in teammates {
            for (layer, cell) in self.layers.iter_mut().zip(path.timeline(map)) {
                layer.insert(cell);
            }
        }
    }

    fn layer(&self, step: usize) -> CellSet<W> {
        self.layers.get(step).copied().unwrap_or(CellSet::EMPTY)
    }
}

impl<const W: usize> Default for TimedPlanner<W> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const W: usize> Sweep<'_, W> {
    /// Whether a path arrives at the goal with move number `step` and can stay there.
    ///
    /// To arrive is to enter the goal with the last move; it may have crossed the goal before. A
    /// robot that starts on its goal and can stay there all the time arrives at every step.
    #[must_use]
    pub fn arrives(&self, goal: Cell, step: usize) -> bool {
        self.clear_since(goal).is_some_and(|clear| clear <= step) && self.enters(goal, step)
    }

    /// The first step at which a path arrives at the goal, or `None` when none does within the
    /// horizon.
    #[must_use]
    pub fn earliest(&self, goal: Cell) -> Option<usize> {
        (self.clear_since(goal)?..=HORIZON).find(|&step| self.enters(goal, step))
    }

    /// A path of exactly `arrival` moves that [arrives](Self::arrives) at the goal with the last of
    /// them, without a conflict with any teammate; `None` when there is none.
    ///
    /// Of several, it is the one that moves early and waits late, chosen from the goal backwards:
    /// the robot stays as long as it can on every cell but the goal, and comes there from the
    /// neighbour on which it can have been waiting since the earliest step; of several such, by the
    /// move with the lowest code. Without teammates that is a shortest path with the waits before
    /// its last move.
    ///
    /// Cost: at most `4 arrival²` lookups of a bit.
    #[must_use]
    pub fn path_to(&self, goal: Cell, arrival: usize) -> Option<Path> {
        if self.arrives(goal, arrival) { self.trace(goal, arrival) } else { None }
    }

    /// A path that is on a reached cell with its last move.
    fn trace(&self, goal: Cell, arrival: usize) -> Option<Path> {
        let stays = self.stays(goal, arrival);
        let mut moves = [Move::Wait; HORIZON];
        let mut here = goal;
        for (step, slot) in moves.get_mut(..arrival)?.iter_mut().enumerate().rev() {
            let last = step + 1 == arrival && !stays;
            if last || !self.is_reached(here, step) {
                (*slot, here) = self.move_into(here, step)?;
            }
        }
        let mut path = Path::at(self.from);
        for &step in moves.get(..arrival)? {
            path.push(step).ok()?;
        }
        Some(path)
    }

    /// The first step from which on no teammate is on the cell; `None` when one stays there.
    fn clear_since(&self, cell: Cell) -> Option<usize> {
        let mut clear = 0;
        for path in self.teammates {
            let last = path.cells(self.map).enumerate().filter(|&(_, theirs)| theirs == cell).last();
            match last {
                Some((step, _)) if step == path.len() => return None,
                Some((step, _)) => clear = clear.max(step + 1),
                None => {}
            }
        }
        Some(clear)
    }

    /// Whether the robot can come to the goal with move number `step`, or has been there all the
    /// time.
    fn enters(&self, goal: Cell, step: usize) -> bool {
        self.is_reached(goal, step)
            && (self.stays(goal, step)
                || step.checked_sub(1).is_some_and(|k| self.move_into(goal, k).is_some()))
    }

    /// Whether the robot starts on the goal and can stay there up to `step`.
    fn stays(&self, goal: Cell, step: usize) -> bool {
        goal == self.from && self.waits_since(goal, step) == 0
    }

    /// The best move that leads to a cell at step `step + 1`, and where from.
    fn move_into(&self, cell: Cell, step: usize) -> Option<(Move, Cell)> {
        let neighbours = self.map.free_neighbours(cell).map(|(_, from)| from);
        let reached = neighbours.filter(|&from| self.is_reached(from, step));
        let moves = reached.filter_map(|from| Some((self.map.move_between(from, cell)?, from)));
        moves.min_by_key(|&(step_in, from)| (self.waits_since(from, step), step_in.code()))
    }

    /// The first step of the unbroken stay on a reached cell that lasts to `step`.
    fn waits_since(&self, cell: Cell, step: usize) -> usize {
        let before = (0..step).rev().take_while(|&earlier| self.is_reached(cell, earlier));
        before.last().unwrap_or(step)
    }

    fn is_reached(&self, cell: Cell, step: usize) -> bool {
        self.reached.get(step).is_some_and(|cells| cells.contains(cell))
    }
}

#[cfg(test)]
mod tests {
    use super::super::first_conflict;
    use super::super::pictures::{Random, assert_picture, drawn, frames, moving, paper, picture};
    use super::*;
    use std::vec::Vec;

    fn plan(walls: &[&str], teammates: &[Path], from: u16, goal: u16, arrival: usize) -> Option<Path> {
        TimedPlanner::new().sweep(&drawn(walls), Cell(from), teammates).path_to(Cell(goal), arrival)
    }

    /// Robot `a` goes to `goal` while `b` does as drawn, and arrives in the last of the expected
    /// frames.
    #[track_caller]
    fn check(walls: &[&str], teammate: &[&str], from: u16, goal: u16, expected: &[&str]) {
        let b = moving(teammate, 'b');
        let a = plan(walls, &[b], from, goal, expected.len() - 1).expect("a path");
        assert_picture(&frames(&drawn(walls), &[('b', b), ('a', a)]), expected);
    }

    #[test]
    fn waits_before_the_last_move_when_nothing_is_in_the_way() {
        let map = paper(&[]);
        let mut planner = TimedPlanner::new();
        let sweep = planner.sweep(&map, Cell(28), &[]);
        assert_eq!(sweep.earliest(Cell(24)), Some(4));
        let path = sweep.path_to(Cell(24), 7).unwrap();
        let blank = ".......";
        assert_picture(&picture(&map, &path), &[blank, blank, blank, "...7...", "0123...", blank, blank]);
    }

    #[test]
    fn waits_until_the_teammate_has_passed() {
        check(
            &[
                "..#", //
                "...", //
                "#.#",
            ],
            &["... ... .b.", "... .b. ...", ".b. ... ...", "b.. ... ..."],
            3,
            5,
            &[
                "..# a.. #b#", //
                "..# ab. #.#",
                ".b# a.. #.#",
                "b.# .a. #.#",
                "b.# ..a #.#",
            ],
        );
    }

    #[test]
    fn moves_into_a_niche_to_let_the_teammate_pass() {
        check(
            &[
                "......", //
                "##.###",
            ],
            &[
                "....b. ......",
                "....b. ......",
                "...b.. ......",
                "..b... ......",
                ".b.... ......",
                "b..... ......",
            ],
            1,
            5,
            &[
                ".a..b. ##.###", //
                "..a.b. ##.###",
                "...b.. ##a###",
                "..b... ##a###",
                ".b.... ##a###",
                "b.a... ##.###",
                "b..a.. ##.###",
                "b...a. ##.###",
                "b....a ##.###",
            ],
        );
    }

    #[test]
    fn follows_at_a_distance_of_one_cell() {
        check(
            &["....."],
            &[".b...", "..b..", "...b.", "....b"],
            0,
            3,
            &["ab...", "a.b..", ".a.b.", "..a.b", "...ab"],
        );
    }

    #[test]
    fn takes_one_set_of_cells_per_step() {
        assert_eq!(size_of::<TimedPlanner<2>>(), 520);
        assert_eq!(size_of::<TimedPlanner<32>>(), 8320);
    }

    #[test]
    fn one_start_serves_all_goals_and_all_steps() {
        let map = paper(&[30, 23]);
        let mut planner = TimedPlanner::new();
        let sweep = planner.sweep(&map, Cell(28), &[]);
        for goal in (0..49).map(Cell).filter(|&goal| map.is_free(goal) && goal != Cell(28)) {
            let earliest = sweep.earliest(goal).unwrap();
            for arrival in 0..=HORIZON {
                let path = sweep.path_to(goal, arrival);
                assert_eq!(path.is_some(), arrival >= earliest);
                assert_eq!(path.is_some(), sweep.arrives(goal, arrival));
                let Some(path) = path else { continue };
                assert!(path.is_open(&map) && path.end(&map) == goal && path.len() == arrival);
                let moves = path.moves().filter(|&step| step != Move::Wait).count();
                assert_eq!(moves, earliest, "no needless moves");
            }
            assert_eq!(sweep.path_to(goal, HORIZON + 1), None);
        }
    }

    #[test]
    fn does_not_swap_in_a_corridor() {
        let b = moving(&["...b", "..b.", ".b..", "b..."], 'b');
        for arrival in 0..=HORIZON {
            assert_eq!(plan(&["...."], &[b], 0, 3, arrival), None);
        }
    }

    #[test]
    fn does_not_follow_closely() {
        let b = moving(&[".b..", "..b.", "...b"], 'b');
        assert_eq!(plan(&["...."], &[b], 0, 1, 1), None);
        assert!(plan(&["...."], &[b], 0, 1, 2).is_some());
        assert_eq!(plan(&["...."], &[b], 0, 2, 2), None);
        assert!(plan(&["...."], &[b], 0, 2, 3).is_some());
    }

    #[test]
    fn is_not_followed_closely() {
        let b = moving(&["b...", ".b.."], 'b');
        assert_eq!(plan(&["...."], &[b], 1, 3, 2), None);
        let later = moving(&["b...", "b...", ".b.."], 'b');
        assert!(plan(&["...."], &[later], 1, 3, 2).is_some());
    }

    #[test]
    fn does_not_stop_where_a_teammate_passes_later() {
        let b = moving(&["... b..", "... b..", "... .b.", "... ..b"], 'b');
        let earliest = |goal| {
            let map = drawn(&["...", "..."]);
            TimedPlanner::new().sweep(&map, Cell(0), &[b]).earliest(Cell(goal))
        };
        assert_eq!([1, 2, 3, 4, 5].map(earliest), [Some(1), Some(2), Some(3), Some(4), None]);
    }

    #[test]
    fn stays_on_its_goal_or_comes_back_to_it() {
        let stay = plan(&["..."], &[], 1, 1, 3);
        assert_eq!(stay.map(|path| path.moves().collect::<Vec<_>>()), Some(std::vec![Move::Wait; 3]));
        check(
            &["...", "#.#"],
            &["..b ...", "..b ...", ".b. ...", "b.. ..."],
            1,
            1,
            &[".ab #.#", "..b #a#", ".b. #a#", "b.. #a#", "ba. #.#"],
        );
    }

    #[test]
    fn has_no_path_from_or_to_where_no_robot_can_be() {
        let corridor = ["..#."];
        assert_eq!(plan(&corridor, &[], 2, 1, 1), None);
        assert_eq!(plan(&corridor, &[], 0, 2, 2), None);
        assert_eq!(plan(&corridor, &[], 0, 3, 9), None);
        assert_eq!(plan(&corridor, &[], 4, 1, 1), None);
        assert_eq!(plan(&corridor, &[], 0, u16::MAX, 1), None);
        assert_eq!(plan(&corridor, &[Path::at(Cell(0))], 0, 1, 1), None);
        assert!(plan(&corridor, &[Path::at(Cell(u16::MAX))], 0, 1, 1).is_some());
    }

    /// Every path of at most `left` more moves, shown to `visit`.
    fn every_path(map: &Map<1>, path: Path, left: usize, visit: &mut impl FnMut(&Path)) {
        visit(&path);
        if left == 0 {
            return;
        }
        for step in Move::ALL {
            let mut longer = path;
            longer.push(step).unwrap();
            if longer.is_open(map) {
                every_path(map, longer, left - 1, visit);
            }
        }
    }

    fn arrives_at_the_end(map: &Map<1>, path: &Path) -> bool {
        path.moves().last().is_none_or(|step| step != Move::Wait)
            || path.cells(map).all(|cell| cell == path.start)
    }

    fn random_path(random: &mut Random, map: &Map<1>, longest: usize) -> Path {
        let mut path = Path::at(random.cell(map));
        for _ in 0..random.below(longest + 1) {
            let mut longer = path;
            longer.push(Move::ALL[random.below(5)]).unwrap();
            path = if longer.is_open(map) { longer } else { path };
        }
        path
    }

    /// The definition, by exhaustion: a path exists if and only if some sequence of moves is one.
    #[test]
    fn finds_a_path_exactly_when_there_is_one() {
        const LAST: usize = 5;
        let mut random = Random(2024);
        let mut planner = TimedPlanner::new();
        let (mut found, mut missing) = (0, 0);
        for _ in 0..150 {
            let (width, height) = (1 + random.below(4) as u16, 1 + random.below(4) as u16);
            let map: Map<1> = random.map(width, height, 20);
            let from = random.cell(&map);
            let teammates: Vec<Path> =
                (0..random.below(3)).map(|_| random_path(&mut random, &map, 7)).collect();
            let clear =
                |path: &Path| teammates.iter().all(|theirs| first_conflict(&map, path, theirs).is_none());
            let mut possible = [[false; 16]; LAST + 1];
            if map.is_free(from) {
                every_path(&map, Path::at(from), LAST, &mut |path| {
                    if arrives_at_the_end(&map, path) && clear(path) {
                        possible[path.len()][path.end(&map).index()] = true;
                    }
                });
            }
            let sweep = planner.sweep(&map, from, &teammates);
            for (arrival, goals) in possible.iter().enumerate() {
                for goal in (0..map.len() as u16).map(Cell) {
                    let path = sweep.path_to(goal, arrival);
                    assert_eq!(
                        path.is_some(),
                        goals[goal.index()],
                        "{map:?} {from:?} {goal:?} {teammates:?}"
                    );
                    let Some(path) = path else {
                        missing += 1;
                        continue;
                    };
                    found += 1;
                    assert!((path.start, path.end(&map), path.len()) == (from, goal, arrival));
                    assert!(path.is_open(&map) && arrives_at_the_end(&map, &path) && clear(&path));
                }
            }
            for goal in (0..map.len() as u16).map(Cell) {
                let first = possible.iter().position(|goals| goals[goal.index()]);
                assert_eq!(sweep.earliest(goal).filter(|&step| step <= LAST), first);
            }
        }
        assert!(found > 500 && missing > 500, "{found} found, {missing} missing");
    }
}
