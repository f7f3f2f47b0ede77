//! Way-points that go back to the team: those of teammates that are left out or have started again.
//!
//! Every robot announces the way-points that it has yet to visit, and remembers what each teammate
//! has announced last. Those of a lost robot are taken over by the members in turn, without a
//! message of their own: the robot that takes one over announces it, and the others hear that.
//! Members that have heard different announcements may visit one twice, and lose none.

use super::errands::MAX_WAYPOINTS;
use crate::grid::Cell;
use crate::team::rounds::{MAX_LEFT_OUT, View};
use crate::team::{MAX_TEAM, RobotId};
use heapless::Vec;

/// The way-points that a robot has yet to visit, in their order.
pub type PendingWaypoints = Vec<Cell, MAX_WAYPOINTS, u8>;

/// The most way-points that are left behind at once: those of as many robots as a quorum leaves
/// out.
const MOST: usize = MAX_LEFT_OUT * MAX_WAYPOINTS;

/// The ticks that each robot in turn has for taking a way-point over and announcing it: five losses
/// in a row are rare at 30 %.
const TURN: u8 = 5;

/// The ticks after which a robot that could not take a way-point over tries again.
const REST: u8 = 20;

/// What teammates have yet to visit, and what lost ones have left behind.
#[derive(Clone, Debug)]
pub(super) struct Handover {
    heard: [Announcement; MAX_TEAM],
    left: Vec<LeftBehind, MOST, u8>,
}

/// What a teammate has announced last, as a member.
#[derive(Clone, Debug)]
struct Announcement {
    epoch: u32,
    pending: PendingWaypoints,
}

/// A way-point that no robot is known to visit.
#[derive(Clone, Copy, Debug)]
struct LeftBehind {
    cell: Cell,
    /// Its place among those of its robot: they begin with different members.
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

impl Handover {
    /// Nothing was announced, and nothing is left.
    pub(super) const NONE: Self = Self {
        heard: [const { Announcement { epoch: 0, pending: Vec::new() } }; MAX_TEAM],
        left: Vec::new(),
    };

    /// Takes in what a teammate announces. Only a member is believed: what it announced before it
    /// was left out, or before it started again, is left behind.
    pub(super) fn hear(&mut self, is_member: bool, robot: RobotId, epoch: u32, pending: PendingWaypoints) {
        let Some(heard) = self.heard.get_mut(robot.index()) else { return };
        let is_new_life = is_member && heard.epoch != epoch;
        let lost = if is_new_life || !is_member { core::mem::take(&mut heard.pending) } else { Vec::new() };
        if is_member {
            *heard = Announcement { epoch, pending };
        }
        for (place, cell) in (0..).zip(lost) {
            if self.left().all(|other| other != cell) {
                let _ = self.left.push(LeftBehind { cell, place, ticks: 0, rest: 0 });
            }
        }
    }

    /// Whether a member has announced that it visits the cell.
    pub(super) fn is_announced(&self, cell: Cell) -> bool {
        self.heard.iter().any(|heard| heard.pending.contains(&cell))
    }

    /// Forgets what a member visits, or this robot.
    pub(super) fn settle(&mut self, own: &[Cell]) {
        let heard = &self.heard;
        let is_taken =
            |cell: &Cell| own.contains(cell) || heard.iter().any(|heard| heard.pending.contains(cell));
        self.left.retain(|left| !is_taken(&left.cell));
    }

    /// Counts a tick in which all members follow a plan, and takes over the way-points whose turn
    /// it is: `take` returns whether the robot will visit the cell.
    pub(super) fn pass(&mut self, takers: Takers, mut take: impl FnMut(Cell) -> bool) {
        self.left.retain_mut(|left| {
            left.rest = left.rest.saturating_sub(1).max(left.rest.min(1));
            let has_turn = || usize::from(left.ticks / TURN) >= takers.turn(left.place);
            let is_due = left.rest == 1 || (left.rest == 0 && has_turn());
            left.ticks = left.ticks.saturating_add(1);
            left.rest = if is_due { REST } else { left.rest };
            !(is_due && take(left.cell))
        });
    }

    /// The way-points that no member has taken over.
    pub(super) fn left(&self) -> impl Iterator<Item = Cell> + '_ {
        self.left.iter().map(|left| left.cell)
    }

    /// Whether this robot may still take one over.
    pub(super) fn is_open(&self) -> bool {
        self.left.iter().any(|left| left.rest == 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: View = View::full(4).without(RobotId(3));

    fn pending(cells: &[u16]) -> PendingWaypoints {
        cells.iter().copied().map(Cell).collect()
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
}
