//! Several different paths to one goal, among which a robot chooses.
//!
//! The penalty method known from road networks (see Bader et al., Alternative Route Graphs in Road
//! Networks, 2011): the cells of every way found become dearer by one, and the next search finds
//! what is cheapest now. Since penalties only grow, they drive the search off a way that it cannot
//! vary in small.

use super::{Cell, CellSet, Map, Path, PlanError, Planner};
use heapless::Vec;

/// The variety of alternatives: how different, and how long at most.
#[doc(alias = "k shortest paths")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Variety {
    /// The most moves that an alternative has beyond the shortest path.
    pub slack: u8,
    /// The least share of an alternative's interior cells, in per cent, that are new against each
    /// of the other paths. The interior is all of a path but its start and its goal. Above 100
    /// nothing differs enough.
    pub new_percent: u8,
}

/// Searches per wanted path before giving up.
const ATTEMPTS: usize = 4;

impl<const S: usize> Planner<S> {
    /// Up to `K` paths to one goal: first a shortest one, then others as `variety` wants them, in
    /// the order in which rising penalties turn them up. None has a wait; none passes a cell twice.
    ///
    /// Fewer than `K` come back when the map has no more of them or the search does not find them:
    /// it gives up after `4 K` attempts, which also bounds the cost to that many times
    /// [`shortest`](Self::shortest).
    ///
    /// # Errors
    /// Every [`PlanError`], for the same reasons as [`shortest`](Self::shortest).
    ///
    /// ```
    /// use iibt_core::grid::{Cell, Map, Planner, Variety, words};
    ///
    /// let map = Map::<{ words(7, 7) }>::new(7, 7)?;
    /// let mut planner = Planner::<49>::new();
    /// let paths = planner.alternatives::<_, 3>(&map, Cell(28), Cell(26), Variety::default())?;
    /// assert_eq!(paths.len(), 3);
    /// assert_eq!(paths[0].len(), 6); // a shortest one comes first
    /// assert!(paths.iter().all(|path| path.end(&map) == Cell(26) && path.len() <= 10));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn alternatives<const W: usize, const K: usize>(
        &mut self,
        map: &Map<W>,
        from: Cell,
        to: Cell,
        variety: Variety,
    ) -> Result<Vec<Path, K>, PlanError> {
        const { assert!(K > 0, "the shortest path needs a place") }
        let mut path = self.shortest(map, from, to)?;
        let longest = path.len() + usize::from(variety.slack);
        let mut kept = Vec::new();
        for _ in 0..ATTEMPTS * K {
            let interior: CellSet<W> = path.interior(map);
            let differs = |other: &Path| variety.differs(&interior, &other.interior(map));
            if path.len() <= longest && kept.iter().all(differs) {
                let _ = kept.push(path); // there is room until the next line
            }
            if kept.is_full() {
                break;
            }
            self.penalise(&interior);
            let Ok(next) = self.cheapest(map, from, to, longest as u16) else { break };
            path = next;
        }
        Ok(kept)
    }
}

impl Variety {
    /// Whether enough of the interior of one path is new against that of another.
    fn differs<const W: usize>(self, interior: &CellSet<W>, other: &CellSet<W>) -> bool {
        let new = interior.without(other).len();
        new > 0 && 100 * new >= usize::from(self.new_percent) * interior.len()
    }
}

impl Default for Variety {
    /// Up to four moves longer, half of the interior new.
    fn default() -> Self {
        Self { slack: 4, new_percent: 50 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::pictures::{Random, assert_picture, drawn, marked, paper, picture};
    use super::*;

    /// Up to `K` alternatives from `S` to `G` are exactly these, in this order.
    #[track_caller]
    fn check<const K: usize>(rows: &[&str], variety: Variety, expected: &[&[&str]]) {
        let map = drawn(rows);
        let mut planner = Planner::<1024>::new();
        let paths: Vec<Path, K> =
            planner.alternatives(&map, marked(rows, 'S'), marked(rows, 'G'), variety).unwrap();
        for (path, expected) in paths.iter().zip(expected) {
            assert_picture(&picture(&map, path), expected);
        }
        assert_eq!(paths.len(), expected.len());
    }

    const WIDE: Variety = Variety { slack: 4, new_percent: 50 };

    #[test]
    fn goes_around_both_sides_of_an_obstacle() {
        let rows = [
            ".....", //
            "S.#.G", //
            ".....",
        ];
        check::<4>(
            &rows,
            Variety { slack: 0, new_percent: 50 },
            &[
                &["1234.", "0.#56", "....."], //
                &[".....", "0.#.6", "12345"],
            ],
        );
    }

    #[test]
    fn a_corridor_has_one_way() {
        check::<4>(&["S...G"], WIDE, &[&["01234"]]);
        check::<4>(&["SG"], WIDE, &[&["01"]]);
    }

    #[test]
    fn one_place_is_for_the_shortest() {
        check::<1>(&["S.G", "..."], WIDE, &[&["012", "..."]]);
    }

    #[test]
    fn a_detour_is_as_long_as_the_slack_allows() {
        let rows = [
            "S.G", //
            ".#.", //
            "...",
        ];
        check::<3>(&rows, Variety { slack: 3, ..WIDE }, &[&["012", ".#.", "..."]]);
        check::<3>(&rows, Variety { slack: 4, ..WIDE }, &[&["012", ".#.", "..."], &["0.6", "1#5", "234"]]);
    }

    /// Of the 7 interior cells of the way below, 3 are new against the way above: 42.9 %.
    #[test]
    fn differs_in_the_share_that_is_asked_for() {
        let rows = [
            "##...##", //
            "S..#..G", //
            "##...##",
        ];
        let above = ["##345##", "012#678", "##...##"];
        let below = ["##...##", "012#678", "##345##"];
        check::<2>(&rows, Variety { slack: 0, new_percent: 42 }, &[&above, &below]);
        check::<2>(&rows, Variety { slack: 0, new_percent: 43 }, &[&above]);
    }

    /// The cells of the paths on the paper's grid.
    fn numbers(obstacles: &[u16], from: u16, to: u16) -> std::vec::Vec<std::vec::Vec<u16>> {
        let map = paper(obstacles);
        let paths: Vec<Path, 4> =
            Planner::<49>::new().alternatives(&map, Cell(from), Cell(to), WIDE).unwrap();
        paths.iter().map(|path| path.cells(&map).map(|cell| cell.0).collect()).collect()
    }

    /// The first experiment's paths A (second here), B (fourth) and C are among them.
    #[test]
    fn reaches_both_goals_of_the_papers_grid_in_several_ways() {
        assert_eq!(
            numbers(&[], 28, 24),
            [
                &[28, 21, 22, 23, 24][..],
                &[28, 29, 30, 31, 24],
                &[28, 21, 14, 15, 16, 17, 24],
                &[28, 35, 36, 37, 38, 31, 24],
            ]
        );
        assert_eq!(
            numbers(&[], 28, 26),
            [
                &[28, 21, 22, 23, 24, 25, 26][..],
                &[28, 29, 30, 31, 32, 33, 26],
                &[28, 21, 14, 15, 16, 17, 18, 19, 26],
                &[28, 35, 36, 37, 38, 39, 40, 33, 26],
            ]
        );
    }

    /// The detour of the second experiment, 29 22 15 16 17 24, is the third here.
    #[test]
    fn goes_around_the_papers_obstacles() {
        assert_eq!(
            numbers(&[30], 29, 24),
            [
                &[29, 22, 23, 24][..],
                &[29, 36, 37, 38, 31, 24],
                &[29, 22, 15, 16, 17, 24],
                &[29, 28, 21, 14, 15, 16, 17, 24],
            ]
        );
        for (obstacle, from, to) in [(30, 29, 26), (23, 21, 24), (23, 21, 32)] {
            let paths = numbers(&[obstacle], from, to);
            assert_eq!(paths.len(), 4);
            assert!(paths.concat().iter().all(|&cell| cell != obstacle));
        }
    }

    #[test]
    fn keeps_its_promises_on_random_maps() {
        let mut random = Random(77);
        let mut planner = Planner::<400>::new();
        let mut several = 0;
        for _ in 0..300 {
            let map: Map<13> = random.map(20, 20, 20);
            let (from, to) = (random.cell(&map), random.cell(&map));
            let variety = Variety { slack: random.below(9) as u8, new_percent: random.below(101) as u8 };
            let Ok(shortest) = planner.shortest(&map, from, to) else { continue };
            let paths: Vec<Path, 6> = planner.alternatives(&map, from, to, variety).unwrap();
            assert_eq!(paths.first(), Some(&shortest));
            for (index, path) in paths.iter().enumerate() {
                assert!(path.is_open(&map) && path.end(&map) == to);
                assert!(path.len() <= shortest.len() + usize::from(variety.slack));
                for other in &paths[..index] {
                    let cells: std::vec::Vec<Cell> = path.cells(&map).collect();
                    let interior = &cells[1..cells.len() - 1];
                    let new = interior.iter().filter(|&&cell| other.cells(&map).all(|theirs| theirs != cell));
                    assert!(100 * new.count() >= usize::from(variety.new_percent) * interior.len());
                }
            }
            several += usize::from(paths.len() > 1);
            assert_eq!(planner.shortest(&map, from, to), Ok(shortest), "penalties are gone");
        }
        assert!(several > 100, "{several}");
    }

    #[test]
    fn fails_for_the_reasons_of_the_shortest_path() {
        let fails = |rows: &[&str]| {
            let mut planner = Planner::<1024>::new();
            let paths =
                planner.alternatives::<32, 3>(&drawn(rows), marked(rows, 'S'), marked(rows, 'G'), WIDE);
            paths.unwrap_err()
        };
        assert_eq!(fails(&["S#G"]), PlanError::NoWay);
        let map = paper(&[26]);
        let blocked = Planner::<49>::new().alternatives::<2, 3>(&map, Cell(28), Cell(26), WIDE);
        assert_eq!(blocked, Err(PlanError::GoalBlocked));
    }
}
