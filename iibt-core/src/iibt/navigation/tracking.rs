//! Where the robot is and how far it has come: the belief, the obstacles in mind, and its place in the team's
//! plan.

use super::{Navigation, intentions};
use crate::grid::{Cell, Move, Path};

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    pub(super) fn has_arrived(&self) -> bool {
        let end = self.agreement.path().end(&self.mission.map);
        self.agreement.is_complete() && self.here() == Some(end) && self.mission.goals.contains(&end)
    }

    /// The cell the robot stands in, if it stands still and is sure of it.
    pub(super) fn here(&self) -> Option<Cell> {
        let (cell, probability) = self.position();
        (!self.percept.moving && probability >= Self::CONFIDENCE).then_some(cell)
    }

    /// Whether the rest of a path leads into an obstacle that is in mind.
    pub(super) fn meets_hazard(&self, path: &Path, done: usize) -> bool {
        self.hazards_on(path, done).next().is_some()
    }

    pub(super) fn hazards_on<'a>(&'a self, path: &'a Path, done: usize) -> impl Iterator<Item = Cell> + 'a {
        path.cells(&self.mission.map).skip(done + 1).filter(|cell| self.hazards.contains(cell))
    }

    pub(super) fn remember(&mut self, hazard: Cell) {
        let new = self.mission.map.is_free(hazard) && !self.hazards.contains(&hazard);
        if new && self.position().0 != hazard {
            // Beyond what it can keep in mind, the robot learns of an obstacle again when it sees it.
            let _ = self.hazards.push(hazard);
        }
    }

    /// q(s) after the last command and the new reading.
    pub(super) fn track(&mut self) {
        if self.percept.moving {
            return;
        }
        let before = self.belief;
        if let Some(step) = self.commanded {
            self.belief.predict(&self.tracking, step.code());
            self.belief.mix(&before, Self::SLIP);
        }
        self.belief.mix(&self.mission.belief(), Self::DOUBT);
        if let Some(reading) = self.percept.reading {
            self.surprise = self.belief.update(&self.sensor, reading.index());
        }
    }

    /// Follows the team's agreement as far as the robot's place and the teammates' intentions carry it.
    pub(super) fn keep_up(&mut self) {
        let waited = self.commanded == Some(Move::Wait);
        let Some(here) = self.here() else { return };
        self.commanded = None;
        let peers = intentions(&self.roster);
        let before = self.agreement.step();
        self.agreement.advance(&self.mission.map, here, waited);
        if self.agreement.step() != before {
            self.objections = 0;
        }
        if self.agreement.join(here, peers.clone()) {
            self.stopping = false;
        }
        self.agreement.agree(peers.clone());
        if self.agreement.is_contradicted(peers) {
            self.agreement.open(here);
        }
    }
}
