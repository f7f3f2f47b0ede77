//! What a robot senses and hears: where it is, what is in its view, and what is left to visit.

use super::super::claim::Cells;
use super::super::{Fact, GridPercept, Intention, Purpose};
use super::Navigation;
use crate::grid::{Cell, CellSet};
use crate::team::rounds::{Answer, RoundMessage, Rounds, Teammates, Timing, View};
use crate::team::{Freshness, MAX_TEAM, Peers, RobotId};

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    Navigation<'_, S, W, L, M, K>
{
    /// Lines 5 and 6: takes in what was sensed and heard.
    pub(in crate::navigation) fn take_in(
        &mut self,
        percept: &GridPercept,
        peers: Peers<'_, Intention<W, K>>,
    ) {
        (self.command, self.left, self.waiting) = (None, self.budget, None);
        self.moving = percept.moving;
        self.waypoints.pass(self.busy(&Teammates::from(peers)));
        self.locate(percept.reading);
        self.look(percept, peers);
        if let Some(here) = self.standing() {
            let obstacles = &self.obstacles;
            self.waypoints.tick_off(here, |cell| obstacles.is_blocked(cell));
            if self.rounds.is_none() {
                let fact = self.fact(here, self.purpose());
                let number = self.mission_id();
                self.rounds = Some(Rounds::new(self.member, self.epoch, number, fact, Timing::DEFAULT));
            }
        }
        self.attend(peers);
    }

    /// The members of the round that have errands, by their newest messages, and all that are left
    /// out.
    pub(super) fn busy(&self, teammates: &Teammates<'_, Fact<W>, K>) -> View {
        let team = View::full(self.member.team()).without(self.robot());
        let view = self.rounds.as_ref().map_or(team, |rounds| rounds.proposal().view);
        let is_busy = |robot: &RobotId| {
            let purpose = teammates.get(*robot).map(|heard| heard.message.fact.purpose);
            !view.contains(*robot) || matches!(purpose, Some(Purpose::Visit(_) | Purpose::Charge(_)))
        };
        team.iter().filter(is_busy).collect()
    }

    fn locate(&mut self, reading: Option<Cell>) {
        if self.moving {
            return;
        }
        let map = &self.mission.map;
        self.localisation.update(map, reading);
        let Some(here) = self.localisation.here() else { return };
        let obstacles = &self.obstacles;
        self.localisation.learn(map, here, |cell| obstacles.is_blocked(cell));
        if let Some((from, to)) = self.under_way.take()
            && here == to
            && from != to
            && let Some(rounds) = &mut self.rounds
        {
            rounds.protocol_mut().advance();
        }
    }

    /// Takes in what is in view.
    fn look(&mut self, percept: &GridPercept, peers: Peers<'_, Intention<W, K>>) {
        self.mates_in_view = CellSet::EMPTY;
        if !percept.hazards.is_empty() {
            self.look_at_hazards(percept, peers);
        }
        for &cell in percept.clear.iter().filter(|&&cell| self.watched.contains(cell)) {
            self.obstacles.look(cell, false);
        }
        self.obstacles.forget(self.mission.forgets);
        let view = self.rounds.as_ref().map_or(View::full(MAX_TEAM), |rounds| rounds.proposal().view);
        let members = peers.iter().filter(|peer| view.contains(peer.envelope().sender));
        let told = members.flat_map(|peer| peer.message().as_ref().fact.evidence.iter());
        let of = |cell| told.clone().filter(move |known| known.cell == cell).map(|known| known.weight);
        let is_vetoed = self.rounds.as_ref().is_some_and(|rounds| rounds.protocol().is_vetoed());
        self.obstacles.yield_to(of, is_vetoed);
        let told = peers.iter().flat_map(|peer| peer.message().as_ref().fact.evidence.iter());
        let told = told.filter(|known| known.weight > 0).map(|known| known.cell);
        self.watched = told.chain(self.obstacles.suspected()).collect();
    }

    /// Where a teammate may be, it may be the teammate that is seen; but not in the cell that the
    /// plan lets this robot enter now.
    fn look_at_hazards(&mut self, percept: &GridPercept, peers: Peers<'_, Intention<W, K>>) {
        let mates = self.places_of_teammates(peers);
        let entering = self.may_enter(&Teammates::from(peers)).map(|(_, to)| to);
        let own = self.localisation.position().0;
        let is_seen = |&&cell: &&Cell| self.mission.map.is_free(cell) && cell != own;
        let may_be_mate = |cell: Cell| mates.contains(cell) && entering != Some(cell);
        let seen = || percept.hazards.iter().filter(is_seen).copied();
        self.mates_in_view = seen().filter(|&cell| may_be_mate(cell)).collect();
        seen().filter(|&cell| !may_be_mate(cell)).for_each(|cell| self.obstacles.look(cell, true));
    }

    /// The cells that teammates may be on now. Who was left out, or has not heard a teammate for a
    /// while and so may have been, knows nothing of its plans.
    fn places_of_teammates(&self, peers: Peers<'_, Intention<W, K>>) -> CellSet<W> {
        let teammates = Teammates::from(peers);
        let (own, round) = (self.robot(), self.rounds.as_ref().map_or(0, |rounds| rounds.proposal().round));
        let is_left_out = teammates.iter().any(|(_, heard)| {
            let proposal = &heard.message.proposal;
            proposal.round >= round && !proposal.view.contains(own)
        });
        if is_left_out {
            return self.mission.map.free_cells();
        }
        let others = (0..).map(RobotId).zip(self.mission.starts).filter(|&(robot, _)| robot != own);
        let places = others.map(|(robot, &start)| match teammates.get(robot) {
            Some(heard) => self.place_of(robot, heard.message, peers.freshness(robot) == Freshness::Fresh),
            None => [start].into_iter().collect(),
        });
        places.fold(CellSet::EMPTY, |all, place| all.union(&place))
    }

    /// The cells that a teammate may be on: what is left of all paths that it may follow. It may be
    /// anywhere if it follows a plan of which this robot does not know the list, or may have begun
    /// to follow one since this robot gave its first scores.
    fn place_of(&self, robot: RobotId, message: &RoundMessage<Fact<W>, K>, is_fresh: bool) -> CellSet<W> {
        let Some(rounds) = &self.rounds else { return [message.fact.anchor].into_iter().collect() };
        let protocol = rounds.protocol();
        let is_member = rounds.proposal().view.contains(robot);
        let is_unknown = !is_fresh || !message.proposal.view.contains(self.robot());
        let has_begun = protocol.digest().is_some() || matches!(message.answer, Answer::Decided { .. });
        match protocol.reach(robot) {
            _ if is_member && is_unknown => self.mission.map.free_cells(),
            Some(Cells(reach)) => *reach,
            None if has_begun => self.mission.map.free_cells(),
            None => [message.fact.anchor].into_iter().collect(),
        }
    }
}
