//! Rooms along a corridor, and a board that tells which of them serves.

use super::prior::skewed;
use super::sketch::{Sketch, UnknownSketch, map_of};
use crate::draws::{one, some, within};
use crate::random::Random;
use iibt_core::grid::Cell;

/// The rows of the map: rooms, doors, the corridor's two, doors, rooms.
const HEIGHT: u16 = 6;

/// The rows of the corridor.
const CORRIDOR: [u16; 2] = [2, 3];

/// A mission with so many robots, of which `need` have to stand in the right room.
///
/// A room has as many cells as robots are needed, and all are goals.
pub(super) fn sketch(random: &mut Random, robots: usize, need: usize) -> Option<Sketch> {
    let count = within(random, &(3..=5));
    let mut plan = Rooms { width: within(random, &(9..=16)) as u16, size: need as u16, rooms: Vec::new() };
    for _ in 0..count {
        let room = one(random, &plan.possible())?;
        plan.rooms.push(room);
    }
    plan.rooms.sort_unstable();
    let board = one(random, &plan.ends())?;
    let mut places = plan.corridor();
    places.retain(|&cell| cell != board);
    let starts = some(random, &places, robots)?;
    let groups: Vec<Vec<Cell>> = plan.rooms.iter().map(|room| plan.goals(room)).collect();
    let doors = plan.rooms.iter().map(|room| plan.door(room));
    let free: Vec<Cell> = plan.corridor().into_iter().chain(groups.concat()).chain(doors).collect();
    let map = map_of(plan.width, HEIGHT, &free)?;
    let unknown = UnknownSketch::serves(groups, skewed(random, count), Some(board));
    let subject = format!("one of {count} rooms serves, a board with lamps tells which");
    Some(Sketch::of_one_unknown(subject, map, starts, unknown))
}

/// Rooms of one row each on both sides of the corridor.
struct Rooms {
    width: u16,
    /// The cells of a room.
    size: u16,
    rooms: Vec<Room>,
}

/// A room, the door of which leads to its first cell.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Room {
    is_below: bool,
    column: u16,
}

impl Rooms {
    const fn cell(&self, row: u16, column: u16) -> Cell {
        Cell(row * self.width + column)
    }

    const fn door(&self, room: &Room) -> Cell {
        self.cell(if room.is_below { HEIGHT - 2 } else { 1 }, room.column)
    }

    fn goals(&self, room: &Room) -> Vec<Cell> {
        let row = if room.is_below { HEIGHT - 1 } else { 0 };
        (room.column..room.column + self.size).map(|column| self.cell(row, column)).collect()
    }

    fn corridor(&self) -> Vec<Cell> {
        CORRIDOR
            .into_iter()
            .flat_map(|row| (0..self.width).map(move |column| self.cell(row, column)))
            .collect()
    }

    /// The cells at both ends of the corridor.
    fn ends(&self) -> Vec<Cell> {
        CORRIDOR
            .into_iter()
            .flat_map(|row| [0, self.width - 1].map(|column| self.cell(row, column)))
            .collect()
    }

    /// The rooms that would touch none of those there are.
    fn possible(&self) -> Vec<Room> {
        let columns = 0..=self.width - self.size;
        let all = [false, true]
            .into_iter()
            .flat_map(|is_below| columns.clone().map(move |column| Room { is_below, column }));
        let touch = |one: Room, other: Room| {
            one.is_below == other.is_below && one.column.abs_diff(other.column) <= self.size
        };
        all.filter(|&one| !self.rooms.iter().any(|&other| touch(one, other))).collect()
    }
}
