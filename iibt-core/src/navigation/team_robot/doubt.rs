//! The moves of a robot in doubt: it may be on another cell than its localiser names.

use super::super::policies::moves_of;
use super::super::progress::{Passage, destination};
use super::super::{Fact, Intention};
use super::Navigation;
use crate::grid::{Cell, Move};
use crate::team::rounds::{JointPolicies, Teammates};

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    Navigation<'_, S, W, L, M, K>
{
    /// Whether the readings of the robot do not follow its moves: it stands until they do.
    pub(in crate::navigation) fn is_stuck(&self) -> bool {
        self.progress.is_stuck()
    }

    /// Whether no reading has followed its last move.
    pub(in crate::navigation) fn is_in_doubt(&self) -> bool {
        self.progress.reckoned().is_some()
    }

    /// Whether the robot has told its team that it stands.
    pub(in crate::navigation) fn has_told_that_it_is_stuck(&self) -> bool {
        self.announced().is_some_and(|fact| fact.purpose == super::Purpose::Stand)
    }

    /// Finds out which move a robot in doubt may make now: the next one of its plan; where that has
    /// long not been safe, or there is none, another one. A choice that becomes known later in this
    /// tick counts from the next one on.
    pub(super) fn mind_doubt(&mut self, teammates: &Teammates<'_, Fact<W>, K>) {
        (self.is_held, self.trial) = (self.is_in_doubt(), None);
        let may_go = self.is_held && !self.has_twin && self.has_decided();
        let Some(here) = self.standing().filter(|_| may_go) else { return };
        let is_stuck = self.is_stuck();
        match self.may_enter(teammates) {
            Some((step, _)) if !is_stuck && self.risk(step, teammates).is_some() => self.is_held = false,
            // Where its claims cut it off it has nothing to do, but for itself.
            None if !is_stuck && !self.is_complete() => {}
            _ if self.progress.wait() => {
                self.trial = self.safest(here, teammates);
                self.progress.note_trial(self.trial.is_some());
            }
            _ => {}
        }
    }

    /// Begins the move that is to be tried in the place of the plan's, unless a round has begun
    /// since.
    pub(in crate::navigation) fn try_move(&mut self) {
        if let Some(trial) = self.trial.take().filter(|_| self.has_decided()) {
            self.begin(trial);
        }
    }

    pub(super) fn begin(&mut self, passage: Passage) {
        self.command = Some(passage.step);
        self.localisation.begin(passage.step);
        self.under_way = Some(passage);
    }

    pub(super) fn has_decided(&self) -> bool {
        self.rounds.as_ref().is_some_and(|rounds| rounds.protocol().has_decided())
    }

    /// The move with the least risk, of those that lead to a free cell from where the localiser
    /// says that the robot is.
    fn safest(&self, here: Cell, teammates: &Teammates<'_, Fact<W>, K>) -> Option<Passage> {
        let trial = |step| {
            let to = destination(&self.mission.map, &self.obstacles, here, step)?;
            let is_safe = !self.seen.contains(to) && !self.may_be_teammate(to, teammates);
            let risk = self.risk(step, teammates).filter(|_| is_safe)?;
            Some((risk, Passage { to, step, is_planned: false }))
        };
        let trials = Move::ALL.into_iter().filter_map(trial);
        trials.min_by_key(|&(risk, _)| risk).map(|(_, passage)| passage)
    }

    /// How much a move risks if every move before it was made: nothing if the robot stays on cells
    /// that it claims, more if it comes to a free one, most if it runs into a wall. `None`: too
    /// much.
    #[inline(never)]
    fn risk(&self, step: Move, teammates: &Teammates<'_, Fact<W>, K>) -> Option<u8> {
        let reckoned = self.progress.reckoned()?;
        let Some(to) = destination(&self.mission.map, &self.obstacles, reckoned, step) else {
            return Some(2).filter(|_| self.progress.may_bump());
        };
        let trail = self.progress.trail();
        if trail.contains(&to) || self.localisation.position().0 == to {
            return Some(0);
        }
        let has_room = self.member.team() == 1 || trail.len() < Intention::<W, K>::PLACES;
        let is_free = || !self.may_be_teammate(to, teammates) || self.comes_first(to, teammates);
        Some(1).filter(|_| has_room && !self.seen.contains(to) && is_free())
    }

    /// Whether the robot is to come to a cell by its plan, and all teammates that come there before
    /// have left it: the others wait for its report.
    fn comes_first(&self, cell: Cell, teammates: &Teammates<'_, Fact<W>, K>) -> bool {
        let (Some(rounds), Some(list)) = (&self.rounds, self.on_map()) else { return false };
        let protocol = rounds.protocol();
        let (Some(policy), Some(digest)) = (protocol.policy(), protocol.digest()) else { return false };
        let Some((path, step)) = self.course() else { return false };
        let (map, own) = (&self.mission.map, self.robot());
        let enters = |moves: &u16| {
            list.next_move(policy, own, *moves).is_some_and(|(at, _)| path.cell_at(map, at + 1) == cell)
        };
        let Some(moves) = (step..moves_of(path)).find(enters) else { return false };
        list.view.without(own).iter().all(|robot| {
            let answer = teammates.get(robot).map(|heard| &heard.message.answer);
            let answer = answer.filter(|answer| answer.digest() == Some(digest));
            answer.is_some_and(|answer| list.is_clear(policy, own, moves, robot, answer.step()))
        })
    }
}
