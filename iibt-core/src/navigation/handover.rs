//! Way-points that go back to the team: those of teammates that are left out or have started again.
//!
//! Every robot announces the way-points that it has yet to visit, and remembers what each teammate
//! has announced last. Those of a lost robot are taken over by the members in turn, without a
//! message of their own: the robot that takes one over announces it, and the others hear that.
//! Members that have heard different announcements may visit one twice, and lose none: every cell
//! of the map has room for a way-point that is left behind.

use super::errands::MAX_WAYPOINTS;
use crate::bounded::up_to;
use crate::grid::{Cell, CellSet};
use crate::team::rounds::View;
use crate::team::{MAX_TEAM, RobotId};
use heapless::Vec;

/// The way-points that a robot has yet to visit, in their order.
pub type PendingWaypoints = Vec<Cell, MAX_WAYPOINTS, u8>;

/// The most way-points that a message names: those that its robot has yet to visit, and the one of
/// its fact, where the robot may have been since.
const MOST_NAMED: usize = MAX_WAYPOINTS + 1;

/// The ticks that each robot in turn has for taking a way-point over and announcing it: five losses
/// in a row are rare at 30 %.
const TURN: u8 = 5;

/// The ticks after which a robot that could not take a way-point over tries again.
const REST: u8 = 20;

/// What teammates have yet to visit, and what lost ones have left behind, on maps of up to `S`
/// cells in `W` words.
#[derive(Clone, Debug)]
pub(super) struct Handover<const S: usize, const W: usize> {
    heard: [Announcement; MAX_TEAM],
    /// The way-points that no robot is known to visit.
    left: CellSet<W>,
    /// When this robot takes over the way-point in each of these cells.
    turns: [Turn; S],
}

/// What a teammate has announced last, as a member.
#[derive(Clone, Debug)]
struct Announcement {
    epoch: u32,
    pending: Vec<Cell, MOST_NAMED, u8>,
}

/// When a robot takes over a way-point that was left behind.
#[derive(Clone, Copy, Debug)]
struct Turn {
    /// The way-point's place among those of its robot: they begin with different members.
    place: u8,
    /// The ticks since it was left.
    ticks: u8,
    /// The ticks until this robot tries again, at least one; zero if it has not tried yet.
    rest: u8,
}

/// The members of a round, as far as it matters who takes a way-point over.
#[derive(Clone, Copy, Debug)]
pub(super) struct Takers {
    pub(super) own: RobotId,
    pub(super) view: View,
    /// Those that have no errand.
    pub(super) free: View,
}

impl Takers {
    /// How many robots come before this one for a way-point: those without an errand come first,
    /// one after the other, each with another way-point.
    fn turn(self, place: u8) -> usize {
        let others = self.view.difference(self.free).place(self.own);
        match (self.free.place(self.own), self.free.len()) {
            (Some(own), count) => {
                let first = usize::from(place).checked_rem(count).unwrap_or(0);
                (own + count - first).checked_rem(count).unwrap_or(0)
            }
            (None, count) => count + others.unwrap_or(0),
        }
    }
}

impl Turn {
    /// Counts a tick; returns whether the robot is to take the way-point over now.
    fn pass(&mut self, takers: Takers) -> bool {
        self.rest = self.rest.saturating_sub(1).max(self.rest.min(1));
        let has_turn = || usize::from(self.ticks / TURN) >= takers.turn(self.place);
        let is_due = self.rest == 1 || (self.rest == 0 && has_turn());
        self.ticks = self.ticks.saturating_add(1);
        self.rest = if is_due { REST } else { self.rest };
        is_due
    }
}

impl<const S: usize, const W: usize> Handover<S, W> {
    /// Nothing was announced, and nothing is left.
    pub(super) const NONE: Self = Self {
        heard: [const { Announcement { epoch: 0, pending: Vec::new() } }; MAX_TEAM],
        left: CellSet::EMPTY,
        turns: [Turn { place: 0, ticks: 0, rest: 0 }; S],
    };

    /// Takes in the way-points that a teammate announces. Only a member is believed: what it
    /// announced before it was left out, or before it started again, is left behind.
    pub(super) fn hear(
        &mut self,
        is_member: bool,
        robot: RobotId,
        epoch: u32,
        pending: impl Iterator<Item = Cell> + Clone,
    ) {
        let Some(heard) = self.heard.get_mut(robot.index()) else { return };
        let is_new_life = is_member && heard.epoch != epoch;
        let lost = if is_new_life || !is_member { core::mem::take(&mut heard.pending) } else { Vec::new() };
        // Nearly all messages name what the one before has named.
        if is_member && (is_new_life || !pending.clone().eq(heard.pending.iter().copied())) {
            *heard = Announcement { epoch, pending: up_to(pending) };
        }
        for (place, &cell) in (0..).zip(&lost) {
            self.leave(cell, place);
        }
    }

    fn leave(&mut self, cell: Cell, place: u8) {
        if let Some(turn) = self.turns.get_mut(cell.index())
            && self.left.insert(cell)
        {
            *turn = Turn { place, ticks: 0, rest: 0 };
        }
    }

    /// Whether a member has announced that it visits the cell.
    pub(super) fn is_announced(&self, cell: Cell) -> bool {
        self.heard.iter().any(|heard| heard.pending.contains(&cell))
    }

    /// Forgets what a member visits, or this robot.
    pub(super) fn settle(&mut self, own: &[Cell]) {
        let announced = self.heard.iter().flat_map(|heard| &heard.pending);
        self.left = self.left.without(&own.iter().chain(announced).copied().collect());
    }

    /// Counts a tick in which all members follow a plan, and takes over the way-points whose turn
    /// it is, in the order that they had: `take` returns whether the robot will visit the cell.
    pub(super) fn pass(&mut self, takers: Takers, mut take: impl FnMut(Cell) -> bool) {
        let left = self.left;
        for place in 0..MOST_NAMED as u8 {
            for cell in left.iter() {
                let turn = self.turns.get_mut(cell.index()).filter(|turn| turn.place == place);
                if turn.is_some_and(|turn| turn.pass(takers)) && take(cell) {
                    self.left.remove(cell);
                }
            }
        }
    }

    /// The way-points that no member has taken over.
    pub(super) fn left(&self) -> impl Iterator<Item = Cell> + '_ {
        self.left.iter()
    }

    /// Whether this robot may still take one over.
    pub(super) fn is_open(&self) -> bool {
        let mut turns = self.left.iter().filter_map(|cell| self.turns.get(cell.index()));
        turns.any(|turn| turn.rest == 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: View = View::full(4).without(RobotId(3));

    /// On maps of 64 cells.
    type Handover = super::Handover<64, 2>;

    fn pending(cells: &[u16]) -> impl Iterator<Item = Cell> + Clone {
        cells.iter().copied().map(Cell)
    }

    /// What robot 0, 1 or 2 knows after robot 3 has announced these cells, and was left out.
    fn after(cells: &[u16]) -> Handover {
        let mut handover = Handover::NONE;
        handover.hear(true, RobotId(3), 1, pending(cells));
        handover.hear(false, RobotId(3), 1, pending(&[60]));
        handover
    }

    fn left(handover: &Handover) -> std::vec::Vec<u16> {
        handover.left().map(|cell| cell.0).collect()
    }

    /// The ticks after which a robot takes each way-point over, if it hears nothing.
    fn taken(handover: &mut Handover, takers: Takers) -> std::vec::Vec<(u16, u16)> {
        let mut taken = std::vec::Vec::new();
        for tick in 0..100 {
            handover.pass(takers, |cell| {
                taken.push((tick, cell.0));
                true
            });
        }
        taken
    }

    #[test]
    fn each_member_begins_with_another_way_point_and_those_without_an_errand_come_first() {
        let free: View = [RobotId(0), RobotId(2)].into_iter().collect();
        let by = |own| taken(&mut after(&[7, 8, 9]), Takers { own: RobotId(own), view: VIEW, free });
        assert_eq!(by(0), [(0, 7), (0, 9), (5, 8)]);
        assert_eq!(by(2), [(0, 8), (5, 7), (5, 9)]);
        assert_eq!(by(1), [(10, 7), (10, 8), (10, 9)], "it has an errand");
        let alone = Takers { own: RobotId(1), view: VIEW, free: View::EMPTY };
        assert_eq!(taken(&mut after(&[7]), alone), [(5, 7)]);
    }

    #[test]
    fn what_a_member_visits_is_left_to_it_and_what_it_has_visited_stays_done() {
        let mut handover = after(&[7, 8, 9]);
        handover.hear(true, RobotId(1), 1, pending(&[8]));
        handover.settle(&[Cell(9)]);
        assert_eq!(left(&handover), [7]);
        handover.hear(true, RobotId(1), 1, pending(&[]));
        handover.hear(false, RobotId(3), 1, pending(&[7, 8, 9]));
        assert_eq!(left(&handover), [7], "who is left out announces nothing to the team");
        handover.hear(true, RobotId(3), 1, pending(&[7]));
        handover.settle(&[]);
        assert!(left(&handover).is_empty(), "it is back and goes there itself");
    }

    #[test]
    fn a_robot_that_has_started_again_leaves_what_it_had_announced_before() {
        let mut handover = Handover::NONE;
        handover.hear(true, RobotId(1), 4, pending(&[7]));
        handover.hear(true, RobotId(1), 5, pending(&[]));
        handover.hear(true, RobotId(1), 5, pending(&[]));
        assert_eq!(left(&handover), [7]);
    }

    #[test]
    fn one_that_cannot_be_taken_over_stays_by_name_and_is_tried_again() {
        let (mut handover, mut tries) = (after(&[7]), std::vec::Vec::new());
        let takers = Takers { own: RobotId(0), view: VIEW, free: VIEW };
        assert!(handover.is_open());
        for tick in 0..50 {
            handover.pass(takers, |_| {
                tries.push(tick);
                false
            });
            assert!(!handover.is_open() && left(&handover) == [7]);
        }
        assert_eq!(tries, [0, 19, 38]);
    }
    /// More than the members of a quorum leave out with: robots are lost, come back with other
    /// way-points, and are lost again, while those before lie where no member gets.
    #[test]
    fn every_way_point_of_a_map_can_be_left_behind() {
        let mut handover = Handover::NONE;
        let cells: std::vec::Vec<u16> = (0..64).collect();
        for (epoch, told) in (1..).zip(cells.chunks(MOST_NAMED)) {
            handover.hear(true, RobotId(3), epoch, pending(told));
            handover.hear(false, RobotId(3), epoch, pending(&[]));
        }
        assert_eq!(left(&handover), cells);
        let (mut tried, takers) = (std::vec::Vec::new(), Takers { own: RobotId(0), view: VIEW, free: VIEW });
        for _ in 0..4 * TURN {
            handover.pass(takers, |cell| {
                tried.push(cell.0);
                false
            });
        }
        tried.sort_unstable();
        tried.dedup();
        assert_eq!(tried, cells, "and is tried");
        assert!(!handover.is_open());
    }
}
