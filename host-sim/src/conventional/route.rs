//! Paths past the teammates: Policy Construct of the paper's figure 8.

use super::teammate::{Rank, Teammate};
use iibt_core::actions::HORIZON;
use iibt_core::grid::{Cell, Map, Move, Path, Planner, TimedPlanner, first_conflict};

/// The planners and their arenas.
#[derive(Clone, Debug)]
pub(super) struct Router<const S: usize, const W: usize> {
    pub(super) planner: Planner<S>,
    timed: TimedPlanner<W>,
}

/// A request for a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct RouteRequest {
    /// The robot's rank.
    pub(super) rank: Rank,
    /// The robot's cell.
    pub(super) from: Cell,
    /// The way-point to visit first, if any.
    pub(super) via: Option<Cell>,
    /// The goal.
    pub(super) goal: Cell,
    /// The least number of moves after which to arrive.
    pub(super) pace: usize,
}

/// The ticks that a teammate with the right of way is assumed to wait for a robot that moves out of
/// its way.
const PATIENCE: usize = 2;

impl<const S: usize, const W: usize> Router<S, W> {
    pub(super) const fn new() -> Self {
        Self { planner: Planner::new(), timed: TimedPlanner::new() }
    }

    /// Returns a path for a request, or `None` when the map has none.
    ///
    /// The first path that exists of these: clear of all teammates; clear of all if those with the
    /// right of way wait a little; clear of those with the right of way; clear of those that will
    /// not leave; clear of the obstacles only.
    pub(super) fn construct(
        &mut self,
        map: &Map<W>,
        team: &[Teammate],
        request: RouteRequest,
    ) -> Option<Path> {
        let own = request.rank;
        let standing = |mate: &Teammate| mate.is_standing(own);
        let polite = others(map, team, own, standing, 0);
        let waited_for = others(map, team, own, standing, PATIENCE);
        let firm = others(map, team, own, |mate| mate.is_stuck(own), 0);
        [polite, waited_for, firm]
            .iter()
            .find_map(|others| self.past(map, others, request))
            .or_else(|| {
                let stuck =
                    team.iter().filter(|mate| mate.is_stuck(own)).flat_map(|mate| mate.stands_in(map));
                self.shortest(&map.avoiding(stuck.filter(|&cell| cell != request.from)), request)
            })
            .or_else(|| self.shortest(map, request))
    }

    /// A path in space and time past teammates that follow theirs, with at least `pace` moves.
    fn past(&mut self, map: &Map<W>, others: &[Path], request: RouteRequest) -> Option<Path> {
        let Some(via) = request.via else {
            return self.there(map, others, request.from, request.goal, request.pace);
        };
        let first = self.there(map, others, request.from, via, 0)?;
        let after: Vec<Path> = others.iter().map(|other| other.rest(map, first.len())).collect();
        let second = self.there(map, &after, via, request.goal, request.pace.saturating_sub(first.len()))?;
        first.then(&second)
    }

    fn there(&mut self, map: &Map<W>, others: &[Path], from: Cell, to: Cell, pace: usize) -> Option<Path> {
        let sweep = self.timed.sweep(map, from, others);
        let arrival = (pace..=HORIZON).find(|&arrival| sweep.arrives(to, arrival))?;
        sweep.path_to(to, arrival)
    }

    fn shortest(&mut self, map: &Map<W>, request: RouteRequest) -> Option<Path> {
        let Some(via) = request.via else {
            return self.planner.shortest(map, request.from, request.goal).ok();
        };
        let first = self.planner.shortest(map, request.from, via).ok()?;
        first.then(&self.planner.shortest(map, via, request.goal).ok()?)
    }
}

/// Whether a path conflicts with a teammate that has the right of way, or leads through one that
/// stands.
pub(super) fn is_in_the_way<const W: usize>(map: &Map<W>, team: &[Teammate], own: Rank, path: &Path) -> bool {
    let others = others(map, team, own, |mate| mate.is_standing(own), 0);
    others.iter().any(|other| first_conflict(map, path, other).is_some())
}

/// The paths to avoid: those of teammates with the right of way, each delayed by a number of waits,
/// and the cells of teammates that stand.
fn others<const W: usize>(
    map: &Map<W>,
    team: &[Teammate],
    own: Rank,
    stands: impl Fn(&Teammate) -> bool,
    waits: usize,
) -> Vec<Path> {
    let mut paths = Vec::with_capacity(2 * team.len());
    for mate in team {
        if stands(mate) {
            paths.extend(mate.stands_in(map).map(Path::at));
        } else if mate.rank() < own {
            paths.push(later(&mate.rest, waits));
        }
    }
    paths
}

/// A path delayed by waits, as many as fit.
fn later(path: &Path, waits: usize) -> Path {
    let mut later = Path::at(path.start);
    for step in std::iter::repeat_n(Move::Wait, waits).chain(path.moves()) {
        if later.push(step).is_err() {
            break;
        }
    }
    later
}

#[cfg(test)]
mod tests {
    use super::*;
    use iibt_core::navigation::Stage;

    type Small = Router<49, 2>;

    fn map() -> Map<2> {
        Map::new(7, 7).unwrap()
    }

    fn request(from: u16, goal: u16, pace: usize) -> RouteRequest {
        RouteRequest {
            rank: Rank::new(1, Stage::Agreed),
            from: Cell(from),
            via: None,
            goal: Cell(goal),
            pace,
        }
    }

    fn cells(path: Option<Path>) -> Vec<u16> {
        path.map_or(Vec::new(), |path| path.cells(&map()).map(|cell| cell.0).collect())
    }

    fn mate(robot: usize, cells: &[u16], stage: Stage) -> Teammate {
        let cells: Vec<Cell> = cells.iter().copied().map(Cell).collect();
        let rest = Path::through(&map(), &cells).unwrap();
        Teammate { rest, stage, age: Some(1), goal: Some(cells[0]), ..Teammate::unheard(robot, cells[0]) }
    }

    #[test]
    fn waits_are_made_late_so_as_to_arrive_in_step() {
        let path = Small::new().construct(&map(), &[], request(28, 30, 4));
        assert_eq!(cells(path), [28, 29, 29, 29, 30]);
    }

    #[test]
    fn a_way_point_is_visited_first() {
        let wanted = RouteRequest { via: Some(Cell(21)), ..request(28, 29, 0) };
        assert_eq!(cells(Small::new().construct(&map(), &[], wanted)), [28, 21, 22, 29]);
    }

    #[test]
    fn keeps_clear_of_who_has_the_right_of_way_only() {
        let crossing = [29, 22, 15];
        let clear = |robot, own: &[u16]| {
            let team = [mate(robot, &crossing, Stage::Agreed)];
            let path = Path::through(&map(), &own.iter().copied().map(Cell).collect::<Vec<_>>()).unwrap();
            !is_in_the_way(&map(), &team, Rank::new(1, Stage::Agreed), &path)
        };
        assert!(!clear(0, &[21, 22]) && clear(2, &[21, 22]));
        let team = [mate(0, &crossing, Stage::Agreed)];
        let path = Small::new().construct(&map(), &team, request(21, 23, 0)).unwrap();
        assert!(!is_in_the_way(&map(), &team, Rank::new(1, Stage::Agreed), &path));
    }

    #[test]
    fn goes_around_who_stands_and_through_nothing_else() {
        let stands = [mate(2, &[29], Stage::Away)];
        assert_eq!(cells(Small::new().construct(&map(), &stands, request(28, 30, 0))).len(), 5);
        let walled = map().avoiding([Cell(23), Cell(29), Cell(31), Cell(37)]);
        assert_eq!(Small::new().construct(&walled, &[], request(28, 30, 0)), None);
    }
}
