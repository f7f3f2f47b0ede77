//! Driving alone under mutual exclusion: to a charger, or out of the way of a teammate that drives
//! to its own.
//!
//! A robot requests mutual exclusion by opening a round in which it announces that it is away. Its
//! opener does not choose, so no robot can choose in that round. Once every teammate has granted
//! the request, all of them stand where they joined the round until there is a newer one. The robot
//! alone moves, around the cells they stand in. When a teammate opens a newer round, the robot
//! stops, joins, and requests again. Other robots with a low battery wait until it is back.
//!
//! A robot without a way to its charger announces no target. Then a teammate may request in its
//! place: one that is low and has a way, or one that stands on the blocked robot's shortest way and
//! steps aside. When a robot is charged, or has stepped aside, it opens the next round, and the
//! team decides from its current positions. If no robot can make room, all wait.

use super::{Cause, GridPercept, Intention, Navigation, Stage, intentions};
use crate::grid::{Cell, CellSet, Path};
use crate::team::Peers;

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    /// Returns the robot's charging cell, if it has one.
    #[must_use]
    pub fn charger(&self) -> Option<Cell> {
        self.mission.chargers.get(self.robot.index()).copied().flatten()
    }

    /// Returns the announced stage of the robot.
    #[must_use]
    pub const fn stage(&self) -> Stage {
        if self.alone { Stage::Away } else { self.agreement.stage() }
    }

    /// Runs one tick of a robot with a low battery, in place of the inference node's tick.
    ///
    /// The robot stands still without a charger, and while no way leads to it past the obstacles it
    /// knows and the teammates.
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

    /// Runs one tick of a robot that steps aside for a teammate on its way to a charger, in place
    /// of the inference node's tick. Returns whether it does.
    pub fn step_aside(&mut self, percept: &GridPercept, peers: Peers<'_, Intention>) -> bool {
        self.percept.moving = percept.moving;
        if !self.agreement.is_away() {
            self.aside = self.here().and_then(|here| self.room_to_make(here, peers));
        }
        let Some(aside) = self.aside else { return false };
        self.look_after_itself(percept, peers);
        if let Some(here) = self.here() {
            if here == aside {
                // The next tick finds the robot away without a reason and brings it back.
                self.aside = None;
            } else {
                self.drive(here, aside, Cause::Room, peers);
            }
        }
        true
    }

    /// Takes in what was sensed without taking part in the team's decisions.
    fn look_after_itself(&mut self, percept: &GridPercept, peers: Peers<'_, Intention>) {
        self.perceive(percept, peers);
        self.alone = true;
        self.track();
        self.follow_agreement(peers);
        if self.has_arrived() {
            self.agreement.arrive();
        }
    }

    /// Drives on if all teammates have granted mutual exclusion, or else requests it if it may.
    fn drive(&mut self, here: Cell, to: Cell, cause: Cause, peers: Peers<'_, Intention>) {
        if self.agreement.is_granted(intentions(peers)) {
            let way = self.way_to(here, to, peers);
            self.agreement.set_target(way.map(|_| to));
            self.command = way.and_then(|way| way.moves().next());
            self.commanded = self.command;
        } else if self.may_leave(here, to, peers) {
            self.leave(here, cause);
            self.agreement.set_target(Some(to));
        }
    }

    /// Returns whether the robot may request: it has not yet, and no teammate that has a way has.
    /// Where a teammate without a way has, this robot needs a way itself.
    fn may_leave(&mut self, here: Cell, to: Cell, peers: Peers<'_, Intention>) -> bool {
        let away = self.agreement.teammate_away(intentions(peers)).map(|peer| peer.message.goal);
        match away {
            _ if self.agreement.is_away() => false,
            None => true,
            Some(goal) => goal.is_none() && self.way_to(here, to, peers).is_some(),
        }
    }

    /// Returns a shortest way past the known obstacles and the teammates, which stand still.
    fn way_to(&mut self, here: Cell, to: Cell, peers: Peers<'_, Intention>) -> Option<Path> {
        let teammates = intentions(peers).map(|peer| peer.message.path.start);
        let map = self.mission.map.avoiding(self.hazards.iter().copied().chain(teammates));
        self.generator.way(&map, here, to)
    }

    /// Returns the nearest cell off the shortest way of a blocked teammate, if this robot is on
    /// that way.
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
