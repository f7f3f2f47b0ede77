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
        if let Some(step) = self.commanded.take() {
            self.belief.predict(&self.tracking, step.code());
            self.belief.mix(&before, Self::SLIP);
            self.waited = step == Move::Wait;
        }
        self.belief.mix(&self.mission.belief(), Self::DOUBT);
        if let Some(reading) = self.percept.reading {
            self.surprise = self.belief.update(&self.sensor, reading.index());
        }
    }

    /// Follows the team's agreement as far as the robot's place and the teammates' intentions carry it.
    pub(super) fn keep_up(&mut self) {
        let Some(here) = self.here() else { return };
        let waited = core::mem::take(&mut self.waited);
        if self.agreement.advance(&self.mission.map, here, waited) {
            self.vain_rounds = 0;
        }
        if self.agreement.join(here, intentions(&self.roster)) {
            self.count_round();
        }
        self.agreement.agree(intentions(&self.roster));
        let lost = self.agreement.place(&self.mission.map) != here;
        if lost || self.agreement.is_contradicted(intentions(&self.roster)) {
            self.open_round(here);
        }
    }

    /// Calls the team to another decision, in which this robot chooses first.
    pub(super) fn open_round(&mut self, here: Cell) {
        self.agreement.open(here);
        self.count_round();
    }

    fn count_round(&mut self) {
        self.stopping = false;
        self.vain_rounds = self.vain_rounds.saturating_add(1);
    }
}
