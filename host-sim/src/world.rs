//! The world as it is, whatever the robots believe: where they stand and what blocks their way.

use crate::scenario::{Floor, Obstacle, Scenario, When};
use iibt_core::grid::{Cell, Move};

/// The truth of a flight.
#[derive(Debug)]
pub(crate) struct World {
    known: Floor,
    floor: Floor,
    cells: Vec<Cell>,
    to_come: Vec<Obstacle>,
    due: Vec<Cell>,
}

impl World {
    pub(crate) fn new(scenario: &Scenario) -> Self {
        Self {
            known: scenario.map,
            floor: scenario.map,
            cells: scenario.robots.iter().map(|robot| robot.start).collect(),
            to_come: scenario.obstacles.clone(),
            due: Vec::new(),
        }
    }

    /// Where the robots stand.
    pub(crate) fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// Free and blocked cells as they are now.
    pub(crate) fn floor(&self) -> &Floor {
        &self.floor
    }

    /// Lets the obstacles of this tick appear, those on robots excepted: they appear when the robot has gone.
    pub(crate) fn begin(&mut self, tick: u32) -> Vec<Cell> {
        let cells = &self.cells;
        let is_due = |obstacle: &mut Obstacle| match obstacle.when {
            When::Tick(at) => at <= tick,
            When::Reached(robot, at) => cells.get(robot) == Some(&at),
        };
        self.due.extend(self.to_come.extract_if(.., is_due).map(|obstacle| obstacle.cell));
        let appearing: Vec<_> = self.due.extract_if(.., |cell| !cells.contains(cell)).collect();
        appearing.into_iter().filter(|&cell| self.floor.block(cell)).collect()
    }

    /// The obstacles not on the map within `view` cells of a robot, diagonals included.
    pub(crate) fn in_view(&self, robot: usize, view: u16) -> impl Iterator<Item = Cell> + '_ {
        let here = self.cells[robot];
        let appeared = move |&cell: &Cell| self.known.is_free(cell) && !self.floor.is_free(cell);
        let near = move |&cell: &Cell| self.distance(here, cell) <= view;
        (0..self.floor.len() as u16).map(Cell).filter(near).filter(appeared)
    }

    /// Carries out one command of every robot, all at once; a robot that runs into something stays.
    pub(crate) fn carry_out(&mut self, commands: &[Move]) {
        for (cell, &step) in self.cells.iter_mut().zip(commands) {
            let next = self.floor.neighbour(*cell, step);
            if self.floor.is_free(next) {
                *cell = next;
            }
        }
    }

    fn distance(&self, one: Cell, other: Cell) -> u16 {
        let width = self.floor.width();
        let rows = (one.0 / width).abs_diff(other.0 / width);
        let columns = (one.0 % width).abs_diff(other.0 % width);
        rows.max(columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn world(events: &str) -> World {
        let text = format!("title = 't'\nmap = '''\n1..\n.#.\nG.2\n...\n'''\ngoals = [6, 11]\n{events}");
        World::new(&Scenario::parse("test", &text.replace('G', ".")).unwrap())
    }

    #[test]
    fn moves_are_made_at_once_and_obstacles_stop_them() {
        let mut world = world("");
        world.carry_out(&[Move::Right, Move::Up]);
        assert_eq!(world.cells(), [Cell(1), Cell(5)]);
        world.carry_out(&[Move::Down, Move::Left]);
        assert_eq!(world.cells(), [Cell(1), Cell(5)], "4 is blocked");
        world.carry_out(&[Move::Up, Move::Right]);
        assert_eq!(world.cells(), [Cell(1), Cell(5)], "the border is closed");
    }

    #[test]
    fn an_obstacle_waits_for_its_tick_and_for_a_free_cell() {
        let mut world = world("[[event]]\ntick = 1\nblock = 1\n[[event]]\ntick = 2\nblock = 3");
        assert_eq!(world.begin(0), []);
        world.carry_out(&[Move::Right, Move::Wait]);
        assert_eq!(world.begin(1), [], "a robot stands there");
        world.carry_out(&[Move::Left, Move::Wait]);
        assert_eq!(world.begin(2), [Cell(1), Cell(3)]);
        assert!(!world.floor().is_free(Cell(1)));
        assert_eq!(world.begin(3), []);
    }

    #[test]
    fn an_obstacle_waits_for_a_robot() {
        let mut world = world("[[event]]\nrobot = 'R2'\nat = 5\nblock = 1");
        assert_eq!(world.begin(0), []);
        world.carry_out(&[Move::Wait, Move::Up]);
        assert_eq!(world.begin(1), [Cell(1)]);
    }

    #[test]
    fn only_what_the_map_does_not_show_is_in_view() {
        let mut world = world("[[event]]\ntick = 0\nblock = 1\n[[event]]\ntick = 0\nblock = 7");
        world.begin(0);
        let seen = |robot, view| world.in_view(robot, view).collect::<Vec<_>>();
        assert_eq!(seen(0, 1), [Cell(1)]);
        assert_eq!(seen(1, 1), [Cell(7)]);
        assert_eq!(seen(0, 2), [Cell(1), Cell(7)]);
    }
}
