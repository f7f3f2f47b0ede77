//! Where the robot is and how far it has come: the belief, the obstacles in mind, and its place in the team's
//! plan.

use super::world::OWN;
use super::{Cause, Intention, Navigation, intentions};
use crate::bounded::up_to;
use crate::grid::{Cell, Move, Path};
use crate::inference::{Beliefs, Evidence};
use crate::team::Peers;

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    pub(super) fn has_arrived(&self) -> bool {
        let end = self.agreement.path().end(&self.mission.map);
        let stands = self.agreement.is_complete() && self.here() == Some(end);
        stands && self.mission.goals.contains(&end) && self.open_waypoints().next().is_none()
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

    /// Takes an obstacle in view into mind, if need be in the place of the oldest.
    pub(super) fn see(&mut self, hazard: Cell) {
        if self.is_news(hazard) && self.hazards.is_full() {
            self.hazards = up_to(self.hazards.iter().skip(1).copied());
        }
        self.remember(hazard);
    }

    /// Takes an obstacle that a teammate found into mind, while there is room.
    pub(super) fn remember(&mut self, hazard: Cell) {
        if self.is_news(hazard) {
            // What there is no room for it learns again when it comes into view.
            let _ = self.hazards.push(hazard);
        }
    }

    fn is_news(&self, hazard: Cell) -> bool {
        let new = self.mission.map.is_free(hazard) && !self.hazards.contains(&hazard);
        new && self.position().0 != hazard
    }

    /// q(s) after the last command and the new reading.
    pub(super) fn track(&mut self) {
        if self.percept.moving {
            return;
        }
        let mut left = None;
        let step = self.commanded.take();
        if let Some(step) = step {
            let here = self.position().0;
            self.motion.begin(here, step);
            left = Some(here).filter(|_| step != Move::Wait);
        }
        // The first reading after a move may be from before it: whether the move failed, the next one tells.
        let reading = self.percept.reading.filter(|&reading| left != Some(reading));
        let (belief, surprise) = (&mut self.belief, &mut self.surprise);
        self.decision.world().with_own_model(|model| {
            if let Some(step) = step {
                let before = *belief;
                let _ = belief.predict(model, &[Some(step.code())]);
                belief.mix(&before, Self::SLIP);
            }
            if let Ok(prior) = Beliefs::try_prior(model) {
                belief.mix(&prior, Self::DOUBT);
            }
            if let Some(reading) = reading {
                *surprise = belief.observe(model, OWN, Evidence::Outcome(reading.index()));
            }
        });
    }

    /// Follows the team's agreement as far as the robot's place and the teammates' intentions carry it.
    pub(super) fn keep_up(&mut self, peers: Peers<'_, Intention>) {
        let Some(here) = self.here() else { return self.keep_up_on_the_way() };
        self.learn(here);
        self.tick_off(here);
        self.agreement.stand(here);
        let begun = core::mem::take(&mut self.begun);
        if self.agreement.advance(&self.mission.map, self.mission.paces(), here, begun) {
            self.vain_rounds = 0;
        }
        if self.agreement.join(here, intentions(peers)) {
            self.count_round();
        }
        self.agreement.agree(intentions(peers));
        if self.agreement.give_way(intentions(peers)) {
            self.vain_rounds = 0;
        }
        if let Some(cause) = self.trouble(here, peers) {
            self.open_round(here, cause);
        }
    }

    /// Counts a step that a slow robot makes with the others while it is between two cells.
    fn keep_up_on_the_way(&mut self) {
        if self.percept.moving && self.agreement.advance_on_the_way(self.begun) {
            (self.begun, self.vain_rounds) = (false, 0);
        }
    }

    /// Why the agreement cannot go on as it is.
    fn trouble(&self, here: Cell, peers: Peers<'_, Intention>) -> Option<Cause> {
        if !self.agreement.is_on_course(&self.mission.map, self.mission.paces(), here) {
            Some(Cause::Position)
        } else if self.agreement.is_contradicted(intentions(peers)) {
            Some(Cause::Outdated)
        } else if self.agreement.is_away() && !self.alone {
            Some(Cause::Charged)
        } else {
            None
        }
    }

    /// Calls the team to another decision, in which this robot chooses first.
    pub(super) fn open_round(&mut self, here: Cell, cause: Cause) {
        self.agreement.open(here);
        self.count_round();
        self.cause = Some(cause);
    }

    /// Opens a round in which nobody decides, to drive alone.
    pub(super) fn leave(&mut self, here: Cell, cause: Cause) {
        self.agreement.leave(here);
        self.count_round();
        self.vain_rounds = 0;
        self.cause = Some(cause);
    }

    fn count_round(&mut self) {
        self.cause = None;
        self.vain_rounds = self.vain_rounds.saturating_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{GridPercept, MAX_KNOWN_HAZARDS, Mission};
    use super::*;
    use crate::grid::Map;
    use crate::iibt::Task;
    use crate::navigation::testing::{member, roster};
    use crate::team::{Envelope, RobotId, Stamp};
    use std::vec::Vec;

    #[test]
    fn what_is_in_view_replaces_the_oldest_obstacle_and_what_is_told_does_not() {
        let starts = [Cell(0), Cell(48)];
        let mission = Mission::new(Map::<2>::new(7, 7).unwrap(), &starts, &[Cell(24), Cell(26)]);
        let mut robot = Navigation::<49, 2, 4>::new(&mission, member(0, 2), 1).unwrap();
        let teammate = Navigation::<49, 2, 4>::new(&mission, member(1, 2), 1).unwrap();
        let last = MAX_KNOWN_HAZARDS as u16 + 4;
        for cell in (1..=last).map(Cell) {
            let percept = GridPercept { hazards: [cell].into_iter().collect(), ..GridPercept::default() };
            robot.observe(&percept, roster(2).at(Default::default()));
        }
        let in_mind: Vec<Cell> = (5..=last).map(Cell).collect();
        assert_eq!(robot.hazards(), in_mind);

        let message = Intention { hazards: [Cell(40)].into_iter().collect(), ..teammate.intention() };
        let mut roster = roster(2);
        let told = Envelope { sender: RobotId(1), stamp: Stamp::default(), message };
        roster.hear(told, Default::default()).unwrap();
        robot.observe(&GridPercept::default(), roster.at(Default::default()));
        assert_eq!(robot.hazards(), in_mind);
    }

    #[test]
    fn between_two_cells_a_robot_is_nowhere_and_keeps_its_move_in_mind() {
        let starts = [Cell(0)];
        let mission = Mission::new(Map::<2>::new(7, 7).unwrap(), &starts, &[Cell(24)]);
        let mut robot = Navigation::<49, 2, 4>::new(&mission, member(0, 1), 1).unwrap();
        let sense = |robot: &mut Navigation<'_, 49, 2, 4>, moving, cell| {
            let percept = GridPercept { moving, reading: Some(Cell(cell)), ..GridPercept::default() };
            robot.perceive(&percept, roster(1).at(Default::default()));
            robot.track();
            robot.here()
        };
        assert_eq!(sense(&mut robot, false, 0), Some(Cell(0)));
        robot.see(Cell(0));
        assert_eq!(robot.hazards(), [], "where it stands itself is no obstacle");
        robot.commanded = Some(Move::Right);
        assert_eq!(sense(&mut robot, true, 48), None);
        assert_eq!(sense(&mut robot, true, 48), None);
        assert_eq!(sense(&mut robot, false, 1), Some(Cell(1)));
    }
}
