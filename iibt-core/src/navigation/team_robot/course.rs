//! The path that a robot follows: its next move, and what lies on it.

use super::super::policies::moves_of;
use super::super::progress::Passage;
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

    /// Line 32: begins the next move of the path, if it is the robot's turn; in its place the one
    /// that a robot in doubt tries.
    pub(in crate::navigation) fn follow(&mut self) {
        if self.is_held {
            return self.try_move();
        }
        let next = self.next_cell().filter(|_| self.waiting.is_none());
        let Some((step, to)) = next else { return };
        if self.mates_in_view.contains(to) {
            // It is this robot's turn only since this tick, and so what is there is no teammate.
            self.obstacles.look(to, true);
        }
        // Whatever the team says of a cell, its robot does not run into what it sees there.
        if !self.seen.contains(to) && !self.is_blocked(to) {
            self.begin(Passage { to, step, is_planned: !self.is_beside_its_path() });
        }
    }

    /// The next move and where it leads, if it is the robot's turn.
    pub(super) fn may_enter(&self, teammates: &Teammates<'_, Fact<W>, K>) -> Option<(Move, Cell)> {
        let (rounds, list) = self.rounds.as_ref().zip(self.on_map())?;
        self.next_cell().filter(|_| rounds.may_move(teammates, &list))
    }

    /// The next move of the path and where it leads, if the robot is where the path says, or the
    /// way back there from the cell beside it on which it has tried its drive.
    fn next_cell(&self) -> Option<(Move, Cell)> {
        let (path, moves) = self.course()?;
        let list = self.on_map()?;
        let policy = self.rounds.as_ref()?.protocol().policy()?;
        let (at, step) = list.next_move(policy, self.robot(), moves)?;
        let map = &self.mission.map;
        let (here, from) = (self.standing()?, path.cell_at(map, at));
        if here == from {
            return Some((step, path.cell_at(map, at + 1)));
        }
        let leads_back = |step: &Move| map.neighbour(here, *step) == from;
        let back = Move::ALL.into_iter().find(leads_back).filter(|_| self.progress.left() == Some(from));
        back.map(|step| (step, from))
    }

    /// Whether the robot stands where its path says, or beside it with a move back, or is between
    /// two cells of it.
    pub(in crate::navigation) fn is_on_course(&self) -> bool {
        !self.is_beside_its_path() || self.next_cell().is_some()
    }

    fn is_beside_its_path(&self) -> bool {
        let (Some((path, moves)), Some(here)) = (self.course(), self.standing()) else { return false };
        here != self.cell_after(path, moves)
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
