//! A robot whose battery is low: it leaves the team, drives to its charger, and comes back.
//!
//! A robot that leaves opens a round and says that it is away. Nobody can choose in that round before its opener
//! has, and that one does not choose; so once every teammate has acknowledged the round, all of them stand where they
//! joined it until there is a newer one, and the robot alone may move, around the cells they stand in. It stops and
//! joins when a teammate opens a newer round, and then leaves anew. Others that are low wait until it is back. When
//! it is charged it opens the next round, and the team decides from where everybody stands.

use super::{Navigation, intentions};
use crate::grid::{Cell, Move};
use crate::iibt::Task;
use crate::team::Status;

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    /// Where this robot charges, if there is such a place.
    #[must_use]
    pub fn charger(&self) -> Option<Cell> {
        self.mission.chargers.get(self.robot.index()).copied().flatten()
    }

    /// What the robot does, as its teammates are told.
    #[must_use]
    pub const fn status(&self) -> Status {
        if self.recharging { Status::Away } else { self.agreement.status() }
    }

    /// One tick of a robot whose battery is low, in the place of the inference node's. Without a charger it stands
    /// still; so it does while no way leads to its charger past the obstacles it knows and the teammates, who wait.
    pub fn recharge(&mut self) {
        self.recharging = true;
        self.observe();
        self.update();
        let (Some(here), Some(charger)) = (self.here(), self.charger()) else { return };
        if self.agreement.has_floor(intentions(&self.roster)) {
            self.command = self.way_to(here, charger);
            self.commanded = self.command;
        } else if !self.agreement.is_away() && !self.agreement.is_floor_taken(intentions(&self.roster)) {
            self.leave(here);
        }
    }

    /// The first move of a shortest way past the obstacles in mind and the teammates that stand still.
    fn way_to(&mut self, here: Cell, charger: Cell) -> Option<Move> {
        let teammates = intentions(&self.roster).map(|peer| peer.path.start);
        let map = self.mission.map.avoiding(self.hazards.iter().copied().chain(teammates));
        self.generator.first_move(&map, here, charger)
    }
}
