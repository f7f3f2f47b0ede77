//! The path that a robot follows: its next move, and what lies on it.

use super::super::policies::moves_of;
use super::super::report::steps_after;
use super::{Fact, Navigation};
use crate::grid::{Cell, Move, Path};
use crate::team::rounds::{JointPolicies, Teammates};

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    Navigation<'_, S, W, L, M, K>
{
    /// The path that the robot follows, and the moves made of it.
    pub(in crate::navigation) fn course(&self) -> Option<(&Path, u16)> {
        let rounds = self.rounds.as_ref()?;
        let path = self.on_map()?.path(rounds.protocol().policy()?, self.member.robot())?;
        Some((path, rounds.protocol().step()))
    }

    /// Line 32: begins the next move of the path, if it is the robot's turn.
    pub(in crate::navigation) fn follow(&mut self) {
        let next = self.next_cell().filter(|_| self.waiting.is_none());
        let (Some((step, to)), Some(here)) = (next, self.standing()) else { return };
        if self.mates_in_view.contains(to) {
            // It is this robot's turn only since this tick, and so what is there is no teammate.
            self.obstacles.look(to, true);
        }
        // Whatever the team says of a cell, its robot does not run into what it sees there.
        if !self.seen.contains(to) && !self.is_blocked(to) {
            self.command = Some(step);
            self.localisation.begin(step);
            self.under_way = Some((here, to));
        }
    }

    /// The next move and where it leads, if it is the robot's turn.
    pub(super) fn may_enter(&self, teammates: &Teammates<'_, Fact<W>, K>) -> Option<(Move, Cell)> {
        let (rounds, list) = self.rounds.as_ref().zip(self.on_map())?;
        self.next_cell().filter(|_| rounds.may_move(teammates, &list))
    }

    /// The next move of the path and where it leads, if the robot is where the path says.
    fn next_cell(&self) -> Option<(Move, Cell)> {
        let (path, moves) = self.course()?;
        let list = self.on_map()?;
        let policy = self.rounds.as_ref()?.protocol().policy()?;
        let (at, step) = list.next_move(policy, self.robot(), moves)?;
        let map = &self.mission.map;
        (self.standing() == Some(path.cell_at(map, at))).then(|| (step, path.cell_at(map, at + 1)))
    }

    /// Whether the robot stands where its path says, or is between two cells of it.
    pub(in crate::navigation) fn is_on_course(&self) -> bool {
        let (Some((path, moves)), Some(here)) = (self.course(), self.standing()) else { return true };
        here == self.cell_after(path, moves)
    }

    /// Whether all moves are made.
    pub(in crate::navigation) fn is_complete(&self) -> bool {
        self.course().is_some_and(|(path, moves)| moves >= moves_of(path))
    }

    fn cell_after(&self, path: &Path, moves: u16) -> Cell {
        path.cell_at(&self.mission.map, steps_after(path, moves))
    }

    /// Whether a cell that the robot takes for blocked is on what is left of any member's path.
    pub(in crate::navigation) fn is_plan_blocked(&self) -> bool {
        let (Some(rounds), Some(list)) = (&self.rounds, self.on_map()) else { return false };
        let Some(policy) = rounds.protocol().policy() else { return false };
        if self.obstacles.blocked().next().is_none() {
            return false;
        }
        let own = self.robot();
        list.view.iter().any(|robot| {
            let step = if robot == own { rounds.protocol().step() } else { 0 };
            let rest = list.claim(policy, robot, step).0;
            self.obstacles.blocked().any(|cell| rest.contains(cell))
        })
    }

    /// Line 35: stands.
    pub(in crate::navigation) const fn stand(&mut self) {
        self.command = None;
    }
}
