//! What a robot is to visit: what it was told, and what it takes over from lost teammates.

use super::super::handover::{Handover, PendingWaypoints, Takers};
use super::super::{Fact, Intention, Purpose, VisitError};
use super::Navigation;
use crate::bounded::up_to;
use crate::grid::Cell;
use crate::team::rounds::{Teammates, View};
use crate::team::{Peers, RobotId};

impl<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>
    Navigation<'_, S, W, L, M, K>
{
    /// Tells the robot to visit a cell before it goes to a goal, after those it was told before.
    ///
    /// A way-point to which the team finds no plan is [put off](super::super::Report::put_off): the
    /// robot goes on with the rest, and the team tries again after 20 ticks, then 40, up to 1,280,
    /// or as soon as a teammate that had an errand too is done with it.
    ///
    /// # Errors
    /// [`VisitError`] when the cell is blocked or no way of the map leads there, or when the robot
    /// has enough to visit or no planner.
    pub fn visit(&mut self, cell: Cell) -> Result<(), VisitError> {
        if !Self::PLANS {
            return Err(VisitError::NoPlanner);
        }
        let map = &self.mission.map;
        if !map.is_free(cell) || self.is_blocked(cell) {
            return Err(VisitError::Blocked(cell));
        }
        if !map.connected(self.localisation.position().0).contains(cell) {
            return Err(VisitError::Unreachable(cell));
        }
        self.waypoints.push(cell)
    }

    /// Returns the way-points to visit, the next one first.
    #[must_use]
    pub fn waypoints(&self) -> &[Cell] {
        self.waypoints.all()
    }

    /// Returns the first way-point that is put off.
    pub(in crate::navigation) fn first_put_off(&self) -> Option<Cell> {
        self.waypoints.first_put_off()
    }

    /// Returns the first way-point that waits because an obstacle is on it.
    pub(in crate::navigation) fn first_obstructed(&self) -> Option<Cell> {
        self.waypoints.first_blocked(|cell| self.is_blocked(cell))
    }

    /// Returns the way-points of lost teammates that no member has taken over: it may not have had
    /// the time, or no member can get there.
    pub fn left_behind(&self) -> impl Iterator<Item = Cell> + '_ {
        self.handover.left()
    }

    /// Whether the robot may still have to visit a way-point of a lost teammate.
    pub(in crate::navigation) fn may_take_over(&self) -> bool {
        self.handover.is_open()
    }

    /// The members of the round that have errands, by their newest messages, and all that are left
    /// out.
    pub(super) fn busy(&self, teammates: &Teammates<'_, Fact<W>, K>) -> View {
        let team = View::full(self.member.team()).without(self.robot());
        let view = self.rounds.as_ref().map_or(team, |rounds| rounds.proposal().view);
        let is_busy = |robot: &RobotId| {
            let heard = teammates.get(*robot).filter(|_| self.has_answered(*robot));
            let purpose = heard.map(|heard| heard.message.fact.purpose);
            let has_errand = matches!(purpose, Some(Purpose::Visit(_) | Purpose::Charge(_)));
            !view.contains(*robot) || (Self::PLANS && has_errand)
        };
        team.iter().filter(is_busy).collect()
    }

    /// Takes over way-points of teammates that are lost, or gives up those that a member has taken
    /// over from this robot while it was left out.
    pub(super) fn hand_over(
        &mut self,
        peers: Peers<'_, Intention<W, K>>,
        teammates: &Teammates<'_, Fact<W>, K>,
    ) {
        let Some(rounds) = &self.rounds else { return };
        let (own, view) = (self.robot(), rounds.proposal().view);
        // A recording of a teammate leaves nothing behind.
        for peer in peers.iter().filter(|peer| rounds.protocol().has_answered(peer.sender())) {
            let (sender, said) = (peer.sender(), peer.message());
            self.handover.hear(view.contains(sender), sender, peer.envelope().stamp.epoch, named(said));
        }
        if !view.contains(own) {
            let handover = &self.handover;
            self.waypoints.give_up(|cell| handover.is_announced(cell));
        } else if self.handover.left().next().is_some() && rounds.protocol().has_decided() {
            let busy = self.busy(teammates);
            let busy = if self.purpose() == Purpose::Goal { busy } else { busy.with(own) };
            self.take_over(Takers { own, view, free: view.difference(busy) });
        }
    }

    fn take_over(&mut self, takers: Takers) {
        let mut handover = core::mem::replace(&mut self.handover, Handover::NONE);
        handover.settle(self.waypoints.all());
        handover.pass(takers, |cell| !self.is_in_wall(cell) && self.visit(cell).is_ok());
        self.handover = handover;
    }

    /// Whether a robot that is left out may be on the cell.
    fn is_in_wall(&self, cell: Cell) -> bool {
        let proposal = self.rounds.as_ref().map(|rounds| rounds.proposal());
        let mut walls = proposal.into_iter().flat_map(|proposal| proposal.left_out(self.member.team()));
        walls.any(|(_, wall)| wall.0.contains(cell))
    }

    /// The way-points to announce beside a fact: those that it does not name, as far as there is
    /// room.
    pub(super) fn pending(&self, fact: &Fact<W>) -> PendingWaypoints {
        if !Self::PLANS {
            return PendingWaypoints::new();
        }
        let others = self.waypoints.all().iter().copied().filter(|&cell| fact.purpose.cell() != Some(cell));
        up_to(others.take(Intention::<W, K>::room(fact)))
    }
}

/// The way-points that a robot has yet to visit, by what it announces.
fn named<const W: usize, const K: usize>(said: &Intention<W, K>) -> impl Iterator<Item = Cell> + Clone {
    let visit = match said.rounds.fact.purpose {
        Purpose::Visit(cell) => Some(cell),
        Purpose::Goal | Purpose::Charge(_) | Purpose::Stand => None,
    };
    visit.into_iter().chain(said.waypoints.iter().copied())
}
