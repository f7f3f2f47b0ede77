//! Joint policies that are combined from paths given by hand.

use super::fact::Fact;
use super::mission::Mission;
use super::policies::{Members, TeamPlan};
use crate::bounded::up_to;
use crate::grid::joint::Arrival;
use crate::grid::{Cell, CellSet, Map, Path};
use crate::team::{MAX_TEAM, RobotId};
use heapless::Vec;

/// The most combinations that are looked at, and the most paths of one robot.
const MOST: u16 = 4096;

/// The combinations of the members' listed paths, one after another: the path of the last member
/// changes first.
#[derive(Clone, Debug)]
pub(super) struct Combinations {
    /// The place of each member's path in its list.
    places: [u16; MAX_TEAM],
    looked_at: u16,
}

impl Combinations {
    pub(super) const fn new() -> Self {
        Self { places: [0; MAX_TEAM], looked_at: 0 }
    }

    /// Looks at the next combination of open paths, and makes the plan of it in `plan`:
    /// `Some(false)` when it is no plan without conflicts to goals, `None` when there are no more.
    /// With `rests`, what is left of a path from any of its cells is a path as well.
    ///
    /// Cost: that of looking for conflicts once.
    pub(super) fn next<const W: usize>(
        &mut self,
        mission: &Mission<'_, W>,
        members: &Members<'_, W>,
        closed: &CellSet<W>,
        rests: bool,
        plan: &mut TeamPlan,
    ) -> Option<bool> {
        if self.looked_at == MOST || !self.turn(mission, members, closed, rests) {
            return None;
        }
        self.looked_at += 1;
        let chosen = |((robot, _), place): ((RobotId, &Fact<W>), u16)| {
            list(mission, robot).get(usize::from(place)).copied()
        };
        let mut paths: Vec<Path, MAX_TEAM> = up_to(members.iter().zip(self.places).filter_map(chosen));
        for (path, fact) in paths.iter_mut().zip(members.facts()) {
            if path.start != fact.anchor {
                *path = from(path, fact.anchor, &mission.map, rests)?;
            }
        }
        let are_goals = members
            .iter()
            .zip(&paths)
            .all(|((robot, _), path)| mission.is_goal_of(members.view, robot, path.end(&mission.map)));
        Some(plan.set(&paths, arrival(&paths)) && are_goals && plan.conflict(&mission.map).is_none())
    }

    /// Goes on to the next combination, or to the first one; returns whether there is one.
    fn turn<const W: usize>(
        &mut self,
        mission: &Mission<'_, W>,
        members: &Members<'_, W>,
        closed: &CellSet<W>,
        rests: bool,
    ) -> bool {
        let is_first = self.looked_at == 0;
        for index in (0..members.iter().count()).rev() {
            let Some(((robot, fact), place)) = members.iter().zip(&mut self.places).nth(index) else {
                return false;
            };
            let left_of = |path: &Path| from(path, fact.anchor, &mission.map, rests);
            let is_open = |&(index, path): &(usize, &Path)| {
                // Most robots are where their paths begin: those are not copied.
                let rest = if path.start == fact.anchor { None } else { left_of(path) };
                let Some(left) = rest.as_ref().or((path.start == fact.anchor).then_some(path)) else {
                    return false;
                };
                let mut earlier = list(mission, robot).iter().take(if rests { index } else { 0 });
                left.is_open(&mission.map)
                    && left.cells(&mission.map).skip(1).all(|cell| !closed.contains(cell))
                    && earlier.all(|other| left_of(other).as_ref() != Some(left))
            };
            let open_from =
                |first| list(mission, robot).iter().take(MOST.into()).enumerate().skip(first).find(is_open);
            let next = if is_first { None } else { open_from(usize::from(*place) + 1) };
            let Some((found, _)) = next.or_else(|| open_from(0)) else { return false };
            *place = found as u16;
            if next.is_some() {
                return true;
            }
        }
        is_first && mission.paths.is_some()
    }
}

/// What is left of a path for a robot on a cell: all of it where it begins there, and with `rests`
/// what comes after the cell.
fn from<const W: usize>(path: &Path, at: Cell, map: &Map<W>, rests: bool) -> Option<Path> {
    if path.start == at {
        return Some(*path);
    }
    let done = path.cells(map).position(|cell| cell == at).filter(|_| rests)?;
    Some(path.rest(map, done))
}

/// The paths given by hand for a robot.
fn list<'m, const W: usize>(mission: &Mission<'m, W>, robot: RobotId) -> &'m [Path] {
    mission.paths.unwrap_or_default().get(robot.index()).copied().unwrap_or_default()
}

/// Robots whose paths end in the same step can wait for each other.
fn arrival(paths: &[Path]) -> Arrival {
    let mut moving = paths.iter().filter(|path| !path.is_empty());
    let steps = moving.next().map_or(0, Path::len);
    let is_even = moving.all(|path| path.len() == steps);
    if is_even { Arrival::Together } else { Arrival::Staggered }
}

#[cfg(test)]
mod tests {
    use super::super::fact::Fact;
    use super::*;
    use crate::grid::{Cell, Map};
    use crate::team::rounds::View;

    fn map() -> Map<1> {
        Map::new(5, 3).unwrap()
    }

    fn through(cells: &[u16]) -> Path {
        let cells: std::vec::Vec<Cell> = cells.iter().copied().map(Cell).collect();
        Path::through(&map(), &cells).unwrap()
    }

    #[test]
    fn combines_open_paths_in_order() {
        let first = [through(&[0, 1, 2]), through(&[0, 5, 6, 7, 2]), through(&[3, 2]), through(&[0, 1, 1])];
        let second = [through(&[12, 7, 2]), through(&[12, 13])];
        let lists: [&[Path]; 2] = [&first, &second];
        let starts = [Cell(0), Cell(12)];
        let goals = [Cell(2), Cell(13)];
        let mission = Mission { paths: Some(&lists), ..Mission::new(map(), &starts, &goals) };
        let facts = starts.map(|anchor| Fact { anchor, ..Fact::default() });
        let members = Members::new(View::full(2), |robot| facts.get(robot.index()));
        let look = |closed: &CellSet<1>| {
            let mut combinations = Combinations::new();
            let mut seen = std::vec::Vec::new();
            let mut plan = TeamPlan::standing([]).unwrap();
            while let Some(is_plan) = combinations.next(&mission, &members, closed, false, &mut plan) {
                seen.push(if is_plan { plan.paths().to_vec() } else { std::vec![] });
            }
            seen
        };
        // Both to cell 2, and the fourth path of the first robot, to no goal, with either.
        let whole: [std::vec::Vec<Path>; 6] = [
            std::vec![],
            std::vec![first[0], second[1]],
            std::vec![],
            std::vec![first[1], second[1]],
            std::vec![],
            std::vec![],
        ];
        assert_eq!(look(&CellSet::EMPTY), whole);
        let closed = [Cell(1), Cell(7)].into_iter().collect();
        assert_eq!(
            look(&closed),
            std::vec::Vec::<std::vec::Vec<Path>>::new(),
            "no path of the first is open"
        );
        let closed = [Cell(6)].into_iter().collect();
        assert_eq!(look(&closed).len(), 4);
    }

    #[test]
    fn what_is_left_of_paths_is_combined_once_from_where_the_members_stand() {
        // From cell 1 on, the first and the third are one.
        let first = [through(&[0, 1, 2]), through(&[0, 1, 6, 7, 2]), through(&[5, 0, 1, 2])];
        let second = [through(&[10, 11, 12])];
        let lists: [&[Path]; 2] = [&first, &second];
        let starts = [Cell(0), Cell(10)];
        let goals = [Cell(2), Cell(12)];
        let mission = Mission { paths: Some(&lists), ..Mission::new(map(), &starts, &goals) };
        let look = |anchors: [u16; 2], closed: &[u16]| {
            let facts = anchors.map(|anchor| Fact { anchor: Cell(anchor), ..Fact::default() });
            let members = Members::new(View::full(2), |robot| facts.get(robot.index()));
            let closed: CellSet<1> = closed.iter().copied().map(Cell).collect();
            let mut combinations = Combinations::new();
            let mut plan = TeamPlan::standing([]).unwrap();
            let next = || {
                let is_plan = combinations.next(&mission, &members, &closed, true, &mut plan)?;
                Some(is_plan.then(|| plan.paths().to_vec()))
            };
            core::iter::from_fn(next).flatten().collect::<std::vec::Vec<_>>()
        };
        let left = [through(&[1, 2]), through(&[1, 6, 7, 2])].map(|own| std::vec![own, through(&[11, 12])]);
        assert_eq!(look([1, 11], &[]), left);
        assert_eq!(look([1, 11], &[2, 7]), std::vec::Vec::<std::vec::Vec<Path>>::new());
        assert_eq!(look([2, 12], &[]), [[Path::at(Cell(2)), Path::at(Cell(12))]], "at the ends");
        assert_eq!(look([3, 11], &[]).len(), 0, "on no path");
    }
}
