//! Way-points: cells that a robot is told to visit on its way to a goal (π_points in the paper's
//! table 2).
//!
//! A plan whose path leaves out a way-point is not executed: its precondition IsArrived(points)
//! does not hold. f_L then raises the preference for the way-points above all goals. New candidates
//! lead over the cells that are preferred above all goals, as they lead around cells of negative
//! preference.

use super::Navigation;
use super::world::GOAL;
use crate::bounded::up_to;
use crate::grid::{Cell, Map, Path};
use crate::inference::Preference;
use heapless::Vec;

/// The most way-points of a robot.
pub const MAX_WAYPOINTS: usize = 4;

/// Why a robot refuses a way-point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum VisitError {
    /// The cell is outside the map, blocked on it, or a known obstacle.
    Blocked(Cell),
    /// The robot already has [`MAX_WAYPOINTS`] to visit.
    TooMany,
}

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    /// Adds a way-point to visit before the goal, after those the robot already has. A robot that
    /// is on its way opens a round for another decision.
    ///
    /// A way-point with a known obstacle is skipped.
    ///
    /// # Errors
    /// [`VisitError`] when the cell cannot be visited or there are too many; nothing has changed
    /// then.
    pub fn visit(&mut self, cell: Cell) -> Result<(), VisitError> {
        if !self.mission.map.is_free(cell) || self.hazards.contains(&cell) {
            return Err(VisitError::Blocked(cell));
        }
        self.waypoints.push(cell).map_err(|_| VisitError::TooMany)
    }

    /// Returns the way-points that are still to be visited, the next one first.
    #[must_use]
    pub fn waypoints(&self) -> &[Cell] {
        &self.waypoints
    }

    /// Returns the way-points without a known obstacle.
    pub(super) fn open_waypoints(&self) -> impl Iterator<Item = Cell> + Clone {
        self.waypoints.iter().copied().filter(|cell| !self.hazards.contains(cell))
    }

    /// Removes the next way-point if the robot is on it.
    pub(super) fn tick_off(&mut self, here: Cell) {
        let hazards = &self.hazards;
        let mut is_next = true;
        self.waypoints.retain(|cell| {
            let is_open = !hazards.contains(cell);
            is_next &= !is_open || *cell == here;
            !(is_open && is_next)
        });
    }

    /// Raises the preference for the open way-points that are not raised yet by `amount`.
    pub(super) fn want_waypoints(&self, preference: &mut Preference<S>, amount: f32) {
        let wanted = self.via(preference);
        let missing: Vec<Cell, MAX_WAYPOINTS> =
            up_to(self.open_waypoints().filter(|cell| !wanted.contains(cell)));
        for (index, cell) in missing.iter().enumerate() {
            if !missing.iter().take(index).any(|before| before == cell) {
                // Every cell of the map is an outcome.
                let _ = preference.raise(cell.index(), amount);
            }
        }
    }

    /// Returns the open way-points that are preferred above all goals: the way-points of
    /// candidates.
    pub(super) fn via(&self, preference: &Preference<S>) -> Vec<Cell, MAX_WAYPOINTS> {
        up_to(
            self.open_waypoints()
                .filter(|cell| preference.get(cell.index()).is_some_and(|worth| worth > GOAL)),
        )
    }

    /// Returns whether the rest of a path leads over all open way-points.
    pub(super) fn visits_all(&self, path: &Path, done: usize) -> bool {
        leads_over(&self.mission.map, path, done, self.open_waypoints())
    }
}

/// Returns whether the rest of a path, after `done` moves, leads over these cells in their order.
pub(super) fn leads_over<const W: usize>(
    map: &Map<W>,
    path: &Path,
    done: usize,
    mut points: impl Iterator<Item = Cell>,
) -> bool {
    let mut cells = path.cells(map).skip(done).peekable();
    points.all(|point| {
        while cells.next_if(|&cell| cell != point).is_some() {}
        cells.peek().is_some()
    })
}

impl core::fmt::Display for VisitError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Blocked(cell) => {
                write!(f, "the way-point p{} is outside the map or blocked", cell.0)
            }
            Self::TooMany => write!(f, "a robot has at most {MAX_WAYPOINTS} way-points"),
        }
    }
}

impl core::error::Error for VisitError {}

#[cfg(test)]
mod tests {
    use super::super::{GridPercept, Mission, NavigationPlan, OBSTACLE, VISITED};
    use super::*;
    use crate::iibt::{InferenceNode, Literal, Task};
    use crate::navigation::Stage;
    use crate::navigation::testing::{member, roster};
    use crate::time::Duration;

    type Robot<'m> = Navigation<'m, 49, 2, 8>;

    const STARTS: [Cell; 1] = [Cell(28)];
    const GOALS: [Cell; 2] = [Cell(24), Cell(26)];

    fn mission() -> Mission<'static, 2> {
        Mission::new(Map::new(7, 7).unwrap(), &STARTS, &GOALS)
    }

    fn robot<'m>(mission: &'m Mission<'m, 2>) -> Robot<'m> {
        let mut robot = Navigation::new(mission, member(0, 1), 1).unwrap();
        read(&mut robot, 28);
        robot
    }

    fn reading(cell: u16) -> GridPercept {
        GridPercept { reading: Some(Cell(cell)), ..GridPercept::default() }
    }

    fn read(robot: &mut Robot<'_>, cell: u16) {
        robot.observe(&reading(cell), roster(1).at(Default::default()));
    }

    fn plan(robot: &mut Robot<'_>, preference: &Preference<49>) -> NavigationPlan {
        let roster = roster(1);
        let peers = roster.at(Default::default());
        let candidates = robot.candidates(preference, peers);
        robot.infer(&candidates, preference, peers).unwrap()
    }

    fn numbers(path: &Path) -> std::vec::Vec<u16> {
        path.cells(&mission().map).map(|cell| cell.0).collect()
    }

    #[test]
    fn a_cell_that_cannot_be_visited_is_refused_and_so_is_a_fifth_one() {
        let mut map = Map::new(7, 7).unwrap();
        map.block(Cell(3));
        let mission = Mission::new(map, &STARTS, &GOALS);
        let mut robot = robot(&mission);
        robot.remember_observed(Cell(10));
        for blocked in [3, 10, 49] {
            assert_eq!(robot.visit(Cell(blocked)), Err(VisitError::Blocked(Cell(blocked))));
        }
        for cell in [4, 5, 4, 6] {
            assert_eq!(robot.visit(Cell(cell)), Ok(()));
        }
        assert_eq!(robot.visit(Cell(7)), Err(VisitError::TooMany));
        assert_eq!(robot.waypoints(), [4, 5, 4, 6].map(Cell));
    }

    #[test]
    fn table_2_way_points_are_wanted_above_all_goals_and_the_paths_lead_over_them() {
        let mission = mission();
        let mut robot = robot(&mission);
        let mut wanted = robot.preference();
        robot.visit(Cell(4)).unwrap();
        robot.visit(Cell(24)).unwrap();
        let choice = plan(&mut robot, &wanted);
        let missing = Literal { variable: VISITED, value: true };
        assert_eq!(robot.unmet(choice, &None), Some(missing), "the first choice knows nothing of way-points");
        robot.raise(missing, &None, &mut wanted);
        robot.raise(missing, &None, &mut wanted);
        assert_eq!((wanted.get(4), wanted.get(24)), (Some(2.0), Some(3.0)), "max(C) + 1, once");
        let choice = plan(&mut robot, &wanted);
        assert_eq!(robot.unmet(choice, &None), None);
        for candidate in Robot::candidates(&robot) {
            let over = [4, 24].map(Cell).into_iter();
            assert!(leads_over(&mission.map, &candidate.path, 0, over), "{:?}", numbers(&candidate.path));
        }
    }

    #[test]
    fn the_robot_takes_a_path_over_its_way_points_in_their_order_and_ticks_them_off() {
        let mission = mission();
        let mut robot = robot(&mission);
        for cell in [39, 4, 4] {
            robot.visit(Cell(cell)).unwrap();
        }
        let mut node = InferenceNode::new(Duration(100));
        node.tick(&mut robot, &reading(28), roster(1).at(Default::default()), Default::default());
        assert_eq!(robot.agreement().stage(), Stage::Announced);
        let path = *robot.agreement().path();
        let order = [39, 4].map(|cell| numbers(&path).iter().position(|&at| at == cell));
        assert!(order[0].is_some() && order[0] < order[1], "{:?}", numbers(&path));
        let mut left = std::vec![];
        for cell in numbers(&path) {
            for _ in 0..3 {
                read(&mut robot, cell);
            }
            left.push(robot.waypoints().len());
            robot.commanded = path.moves().nth(left.len() - 1);
        }
        let at = |step: usize| left.get(step).copied();
        assert_eq!(
            (at(0), order[0].and_then(at), order[1].and_then(at)),
            (Some(3), Some(2), Some(0)),
            "{left:?}"
        );
    }

    #[test]
    fn a_way_point_under_an_obstacle_is_left_out() {
        let mission = mission();
        let mut robot = robot(&mission);
        robot.visit(Cell(4)).unwrap();
        robot.visit(Cell(5)).unwrap();
        robot.remember_observed(Cell(4));
        assert!(robot.open_waypoints().eq([Cell(5)]));
        robot.tick_off(Cell(5));
        assert_eq!(robot.waypoints(), [Cell(4)]);
        let wanted = robot.preference();
        let choice = plan(&mut robot, &wanted);
        assert!(robot.logic(choice).is(VISITED) && !robot.logic(choice).is(OBSTACLE));
    }

    #[test]
    fn cells_are_passed_in_order_or_not_at_all() {
        let map = Map::<2>::new(7, 7).unwrap();
        let path = Path::through(&map, &[28, 29, 29, 30, 31].map(Cell)).unwrap();
        let over = |done, points: &[u16]| leads_over(&map, &path, done, points.iter().copied().map(Cell));
        assert!(over(0, &[]) && over(0, &[28, 29, 29, 31]) && over(3, &[30, 31]) && over(9, &[]));
        assert!(!over(0, &[30, 29]) && !over(1, &[28]) && !over(0, &[31, 32]) && !over(9, &[31]));
    }
}
