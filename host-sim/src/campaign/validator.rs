//! The validator: judges a flight from the robots' positions only.
//!
//! It knows the drawn map, the obstacles that appeared, and the cells of all robots after every
//! tick, all as plain numbers, and shares no code with the robots, their planner or the referee.

use crate::flight_event::FlightEvent;
use crate::record::Record;
use crate::scenario::Scenario;
use serde::Serialize;

/// A flight as its validator sees it. Cells are numbered row by row from the top left, from zero.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trace {
    /// The number of columns.
    pub width: usize,
    /// Whether each cell is blocked when the flight begins, row by row.
    pub blocked: Vec<bool>,
    /// The obstacles that appeared: the tick at whose beginning, and the cell.
    pub appeared: Vec<(usize, usize)>,
    /// The cells of all robots: at first, then after every tick.
    pub history: Vec<Vec<usize>>,
}

/// The counts of violations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Violations {
    /// Pairs of robots in the same cell, counted in every tick.
    pub shared: u32,
    /// Pairs of robots that exchanged their cells.
    pub swapped: u32,
    /// Cells that were entered although they were blocked, or do not exist.
    pub blocked: u32,
    /// Robots that came to a cell that is no neighbour of the one they left.
    pub jumps: u32,
}

impl Violations {
    /// Returns the number of all violations.
    #[must_use]
    pub const fn total(&self) -> u32 {
        self.shared + self.swapped + self.blocked + self.jumps
    }
}

impl Trace {
    /// Returns the trace of a flight of a scenario.
    #[must_use]
    pub fn of(scenario: &Scenario, record: &Record) -> Self {
        let cells = usize::from(record.width) * usize::from(record.height);
        let appeared = record.events.iter().filter_map(|timed| match timed.event {
            FlightEvent::Appeared { cell } => Some((timed.tick as usize, usize::from(cell.0))),
            _ => None,
        });
        Self {
            width: usize::from(record.width),
            blocked: (0..cells)
                .map(|cell| !scenario.map.is_free(iibt_core::grid::Cell(cell as u16)))
                .collect(),
            appeared: appeared.collect(),
            history: record
                .history
                .iter()
                .map(|cells| cells.iter().map(|cell| usize::from(cell.0)).collect())
                .collect(),
        }
    }

    /// Judges the flight.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut faults = Violations::default();
        for (tick, cells) in self.history.iter().enumerate() {
            faults.shared += count_shared(cells);
            if let Some(before) = tick.checked_sub(1).and_then(|before| self.history.get(before)) {
                self.judge_moves(tick - 1, before, cells, &mut faults);
            } else {
                faults.blocked += cells.iter().filter(|&&cell| self.is_blocked(0, cell)).count() as u32;
            }
        }
        faults
    }

    fn judge_moves(&self, tick: usize, before: &[usize], after: &[usize], faults: &mut Violations) {
        let moves: Vec<(usize, usize)> = before.iter().copied().zip(after.iter().copied()).collect();
        for (index, &(from, to)) in moves.iter().enumerate() {
            faults.jumps += u32::from(!self.is_step(from, to));
            faults.blocked += u32::from(from != to && self.is_blocked(tick, to));
            let others = moves.iter().take(index);
            faults.swapped +=
                others.filter(|&&(left, entered)| from != to && left == to && entered == from).count() as u32;
        }
    }

    fn is_step(&self, from: usize, to: usize) -> bool {
        let columns = (from % self.width).abs_diff(to % self.width);
        let rows = (from / self.width).abs_diff(to / self.width);
        columns + rows <= 1
    }

    /// Returns whether a cell is blocked in this tick.
    fn is_blocked(&self, tick: usize, cell: usize) -> bool {
        let stood_from_the_first = self.blocked.get(cell).copied().unwrap_or(true);
        stood_from_the_first || self.appeared.iter().any(|&(from, at)| at == cell && from <= tick)
    }
}

fn count_shared(cells: &[usize]) -> u32 {
    let later = |index: usize| cells.iter().skip(index + 1);
    cells
        .iter()
        .enumerate()
        .map(|(index, cell)| later(index).filter(|other| *other == cell).count() as u32)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flight over a 4 x 3 floor on which cell 5 is blocked and an obstacle appears in cell 6
    /// with tick 2.
    fn judged(history: &[&[usize]]) -> [u32; 4] {
        let mut blocked = vec![false; 12];
        blocked[5] = true;
        let history = history.iter().map(|cells| cells.to_vec()).collect();
        let faults = Trace { width: 4, blocked, appeared: vec![(2, 6)], history }.validate();
        [faults.shared, faults.swapped, faults.blocked, faults.jumps]
    }

    #[test]
    fn a_sound_flight_has_no_faults() {
        assert_eq!(judged(&[&[0, 2], &[1, 6], &[2, 7], &[2, 11], &[3, 11]]), [0; 4]);
    }

    #[test]
    fn every_fault_is_counted_where_it_happens() {
        assert_eq!(judged(&[&[0, 2], &[1, 1], &[1, 1]]), [2, 0, 0, 0]);
        assert_eq!(judged(&[&[0, 1, 9], &[1, 0, 9]]), [0, 1, 0, 0]);
        assert_eq!(judged(&[&[1], &[5]]), [0, 0, 1, 0]);
        assert_eq!(judged(&[&[7], &[6]]), [0, 0, 0, 0], "the obstacle appears later");
        assert_eq!(judged(&[&[7], &[7], &[7], &[6]]), [0, 0, 1, 0]);
        assert_eq!(judged(&[&[3], &[4]]), [0, 0, 0, 1], "from one border to the other");
        assert_eq!(judged(&[&[8], &[12]]), [0, 0, 1, 0], "over the border");
        assert_eq!(judged(&[&[5]]), [0, 0, 1, 0], "it starts in an obstacle");
        assert_eq!(judged(&[&[0, 0]]), [1, 0, 0, 0]);
    }
}
