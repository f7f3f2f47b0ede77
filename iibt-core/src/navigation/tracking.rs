//! Tracking: the belief over the robot's position, the obstacles it remembers, and its progress in
//! the team's plan.

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

    /// Returns the cell the robot stands in, if it stands still and the belief is confident.
    pub(super) fn here(&self) -> Option<Cell> {
        let (cell, probability) = self.position();
        (!self.percept.moving && probability >= Self::CONFIDENCE).then_some(cell)
    }

    /// Returns whether the rest of a path leads into a remembered obstacle.
    pub(super) fn meets_hazard(&self, path: &Path, done: usize) -> bool {
        self.hazards_on(path, done).next().is_some()
    }

    pub(super) fn hazards_on<'a>(&'a self, path: &'a Path, done: usize) -> impl Iterator<Item = Cell> + 'a {
        path.cells(&self.mission.map).skip(done + 1).filter(|cell| self.hazards.contains(cell))
    }

    /// Remembers an observed obstacle, evicting the oldest when full.
    pub(super) fn remember_observed(&mut self, hazard: Cell) {
        if self.is_news(hazard) && self.hazards.is_full() {
            self.hazards = up_to(self.hazards.iter().skip(1).copied());
        }
        self.remember(hazard);
    }

    /// Remembers an obstacle that a teammate reports, while there is room.
    pub(super) fn remember(&mut self, hazard: Cell) {
        if self.is_news(hazard) {
            // An obstacle without room is observed again when it comes into view.
            let _ = self.hazards.push(hazard);
        }
    }

    fn is_news(&self, hazard: Cell) -> bool {
        let new = self.mission.map.is_free(hazard) && !self.hazards.contains(&hazard);
        new && self.position().0 != hazard
    }

    /// Updates q(s) with the last command and the new reading.
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
        // The first reading after a move may be from before it: whether the move failed, the next
        // one tells.
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

    /// Advances the agreement as far as the robot's position and the teammates' intentions allow.
    pub(super) fn follow_agreement(&mut self, peers: Peers<'_, Intention>) {
        let Some(here) = self.here() else { return self.advance_between_cells() };
        self.learn(here);
        self.tick_off(here);
        self.agreement.set_position(here);
        let begun = core::mem::take(&mut self.begun);
        if self.agreement.advance(&self.mission.map, self.mission.paces(), here, begun) {
            self.failed_rounds = 0;
        }
        if self.agreement.join(here, intentions(peers)) {
            self.count_round();
        }
        self.agreement.agree(intentions(peers));
        if self.agreement.grant(intentions(peers)) {
            self.failed_rounds = 0;
        }
        if let Some(cause) = self.trouble(here, peers) {
            self.open_round(here, cause);
        }
    }

    /// Counts a step of a slow robot that is between two cells.
    fn advance_between_cells(&mut self) {
        if self.percept.moving && self.agreement.advance_on_the_way(self.begun) {
            (self.begun, self.failed_rounds) = (false, 0);
        }
    }

    /// Returns why the current plan cannot go on, if so.
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

    /// Opens a round for another decision, in which this robot chooses first.
    pub(super) fn open_round(&mut self, here: Cell, cause: Cause) {
        self.agreement.open(here);
        self.count_round();
        self.cause = Some(cause);
    }

    /// Requests mutual exclusion to drive alone.
    pub(super) fn leave(&mut self, here: Cell, cause: Cause) {
        self.agreement.leave(here);
        self.count_round();
        self.failed_rounds = 0;
        self.cause = Some(cause);
    }

    fn count_round(&mut self) {
        self.cause = None;
        self.failed_rounds = self.failed_rounds.saturating_add(1);
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
        robot.remember_observed(Cell(0));
        assert_eq!(robot.hazards(), [], "where it stands itself is no obstacle");
        robot.commanded = Some(Move::Right);
        assert_eq!(sense(&mut robot, true, 48), None);
        assert_eq!(sense(&mut robot, true, 48), None);
        assert_eq!(sense(&mut robot, false, 1), Some(Cell(1)));
    }
}
