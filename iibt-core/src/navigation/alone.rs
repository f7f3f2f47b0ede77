//! A robot that drives alone: to its charger, or out of the way of a teammate that is on its way there.
//!
//! A robot that leaves the team opens a round and says that it is away. Nobody can choose in that round before its opener
//! has, and that one does not choose; so once every teammate has acknowledged the round, all of them stand where they
//! joined it until there is a newer one, and the robot alone may move, around the cells they stand in. It stops and
//! joins when a teammate opens a newer round, and then leaves anew. Others that are low wait until it is back.
//!
//! A robot that has no way to its charger says so by naming no goal. Then teammates may leave in its place: one that is low
//! and has a way, or one that stands on the shortest way there is, which steps aside. When a robot is charged, or has
//! stepped aside, it opens the next round, and the team decides from where everybody stands. Where nobody can make
//! room, all wait.

use super::{Cause, GridPercept, Intention, Navigation, Stage, intentions};
use crate::grid::{Cell, CellSet, Path};
use crate::team::Peers;

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    /// Where this robot charges, if there is such a place.
    #[must_use]
    pub fn charger(&self) -> Option<Cell> {
        self.mission.chargers.get(self.robot.index()).copied().flatten()
    }

    /// What the robot does, as its teammates are told.
    #[must_use]
    pub const fn stage(&self) -> Stage {
        if self.alone { Stage::Away } else { self.agreement.stage() }
    }

    /// One tick of a robot whose battery is low, in the place of the inference node's. Without a charger it stands
    /// still; so it does while no way leads to its charger past the obstacles it knows and the teammates.
    pub fn recharge(&mut self, percept: &GridPercept, peers: Peers<'_, Intention>) {
        self.look_after_itself(percept, peers);
        let (Some(here), Some(charger)) = (self.here(), self.charger()) else { return };
        if !self.agreement.is_away() {
            self.aside = if self.way_to(here, charger, peers).is_none() {
                self.room_to_make(here, peers)
            } else {
                None
            };
        }
        self.aside = self.aside.filter(|&aside| aside != here);
        self.drive(here, self.aside.unwrap_or(charger), Cause::Battery, peers);
    }

    /// One tick of a robot that steps out of the way of a teammate that cannot get to its charger, in the place of the
    /// inference node's; returns whether it does.
    pub fn step_aside(&mut self, percept: &GridPercept, peers: Peers<'_, Intention>) -> bool {
        self.percept.moving = percept.moving;
        if !self.agreement.is_away() {
            self.aside = self.here().and_then(|here| self.room_to_make(here, peers));
        }
        let Some(aside) = self.aside else { return false };
        self.look_after_itself(percept, peers);
        if let Some(here) = self.here() {
            if here == aside {
                // The next tick finds the robot away for no reason, and has it come back.
                self.aside = None;
            } else {
                self.drive(here, aside, Cause::Room, peers);
            }
        }
        true
    }

    /// Takes in what was sensed, as a robot that takes no part in the team's decisions.
    fn look_after_itself(&mut self, percept: &GridPercept, peers: Peers<'_, Intention>) {
        self.perceive(percept, peers);
        self.alone = true;
        self.track();
        self.keep_up(peers);
        if self.has_arrived() {
            self.agreement.arrive();
        }
    }

    /// Drives on if all teammates have acknowledged that this robot is away, or else leaves if it may.
    fn drive(&mut self, here: Cell, to: Cell, cause: Cause, peers: Peers<'_, Intention>) {
        if self.agreement.has_floor(intentions(peers)) {
            let way = self.way_to(here, to, peers);
            self.agreement.aim(way.map(|_| to));
            self.command = way.and_then(|way| way.moves().next());
            self.commanded = self.command;
        } else if self.may_leave(here, to, peers) {
            self.leave(here, cause);
            self.agreement.aim(Some(to));
        }
    }

    /// Whether it is not away yet, and no teammate is that has a way; past one that has none, it needs a way itself.
    fn may_leave(&mut self, here: Cell, to: Cell, peers: Peers<'_, Intention>) -> bool {
        let away = self.agreement.teammate_away(intentions(peers)).map(|peer| peer.message.goal);
        match away {
            _ if self.agreement.is_away() => false,
            None => true,
            Some(goal) => goal.is_none() && self.way_to(here, to, peers).is_some(),
        }
    }

    /// A shortest way past the obstacles in mind and the teammates that stand still.
    fn way_to(&mut self, here: Cell, to: Cell, peers: Peers<'_, Intention>) -> Option<Path> {
        let teammates = intentions(peers).map(|peer| peer.message.path.start);
        let map = self.mission.map.avoiding(self.hazards.iter().copied().chain(teammates));
        self.generator.way(&map, here, to)
    }

    /// The nearest cell off the shortest way of a teammate that cannot get to its charger, if this robot is on it.
    fn room_to_make(&mut self, here: Cell, peers: Peers<'_, Intention>) -> Option<Cell> {
        let away = self.agreement.teammate_away(intentions(peers))?;
        let stuck = (away.message.path.start, away.sender.index(), away.message.goal);
        let (start, robot, None) = stuck else { return None };
        let charger = self.mission.chargers.get(robot).copied().flatten()?;
        let open = self.mission.map.avoiding(self.hazards.iter().copied());
        let way: CellSet<W> = self.generator.way(&open, start, charger)?.cells(&open).collect();
        let teammates = intentions(peers).map(|peer| peer.message.path.start);
        let map = open.avoiding(teammates);
        if way.contains(here) { self.generator.nearest(&map, here, &way) } else { None }
    }
}
