//! Whether a mission can be solved at all, by a search over all joint states.
//!
//! One robot moves at a time, into a free cell. That reaches the same joint states as moves at once
//! in which no robot enters a cell that another leaves in the same step: such moves can be made one
//! after the other.

use super::DrawnMission;
use iibt_core::grid::Cell;
use std::collections::HashSet;

/// The most joint states that are searched.
pub(super) const MOST: usize = 1_000_000;

/// A search over the joint states of a mission.
pub(super) struct JointSearch<'m> {
    mission: &'m DrawnMission,
    open: Vec<Vec<Cell>>,
    seen: HashSet<Vec<Cell>>,
}

impl<'m> JointSearch<'m> {
    /// A search that has not begun.
    pub(super) fn over(mission: &'m DrawnMission) -> Self {
        let mut search = Self { mission, open: Vec::new(), seen: HashSet::new() };
        search.reach(mission.starts.clone());
        search
    }

    /// Whether some sequence of moves accomplishes the mission; `None` when there are too many
    /// states.
    pub(super) fn solves(&mut self) -> Option<bool> {
        while let Some(state) = self.open.pop() {
            if self.mission.is_done(&state) {
                return Some(true);
            }
            if self.seen.len() > MOST {
                return None;
            }
            self.expand(&state);
        }
        Some(false)
    }

    fn expand(&mut self, state: &[Cell]) {
        for (robot, &from) in state.iter().enumerate() {
            for (_, to) in self.mission.map.free_neighbours(from).filter(|(_, to)| !state.contains(to)) {
                let mut next = state.to_vec();
                next[robot] = to;
                self.reach(next);
            }
        }
    }

    /// Notes a state; robots without goals of their own can be exchanged.
    fn reach(&mut self, mut state: Vec<Cell>) {
        if !self.mission.is_owned {
            state.sort_unstable();
        }
        if self.seen.insert(state.clone()) {
            self.open.push(state);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Floor;

    fn solves(rows: &[&str], starts: &[u16], goals: &[u16], is_owned: bool) -> bool {
        let drawn = rows.concat();
        let mut map = Floor::new(rows[0].len() as u16, rows.len() as u16).expect("small");
        drawn.match_indices('#').for_each(|(cell, _)| _ = map.block(Cell(cell as u16)));
        let cells = |cells: &[u16]| cells.iter().copied().map(Cell).collect();
        let mission = DrawnMission { map, starts: cells(starts), goals: cells(goals), is_owned };
        JointSearch::over(&mission).solves().expect("few states")
    }

    #[test]
    fn robots_pass_each_other_where_there_is_room_and_only_there() {
        assert!(!solves(&["...."], &[0, 3], &[3, 0], true));
        assert!(solves(&["...."], &[0, 3], &[3, 0], false));
        assert!(solves(&["....", "#.##"], &[0, 3], &[3, 0], true));
        assert!(!solves(&["..", ".."], &[0, 1, 2, 3], &[1, 3, 0, 2], true), "nobody follows in a ring");
        assert!(solves(&["..", ".."], &[0, 1, 3], &[1, 3, 2], true), "one cell is free to turn");
        assert!(!solves(&["..", ".."], &[0, 1, 3], &[1, 0, 3], true), "the order in a ring stays");
        assert!(!solves(&[".#."], &[0], &[2], false));
    }
}
