//! Obstacles that come and go: what a robot has gathered for and against them.
//!
//! Evidence is a log-likelihood ratio, in sixteenths of a nat. Every robot announces its own sums;
//! the team's belief about a cell is the prior plus the sum over all members, so nothing is counted
//! twice, and a lost frame does no harm. What a robot no longer sees yields to what the others have
//! seen since.

use crate::bounded::up_to;
use crate::grid::Cell;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The most cells about which a robot announces evidence.
pub const MAX_EVIDENCE: usize = 4;

/// The most cells about which a robot remembers evidence.
pub const MAX_OBSTACLES: usize = 16;

/// ln P(blocked) / P(free) of a cell that no robot has looked at, in sixteenths of a nat.
const PRIOR: i16 = -32;

/// What one look says, in sixteenths of a nat.
const LOOK: i8 = 48;

/// The largest sum of one robot, in sixteenths of a nat, so that a few looks can turn it round.
const CAP: i8 = 64;

/// The weight with which a robot claims a cell on which it may be itself: more than any look.
const CLAIM: i8 = i8::MAX;

/// A robot's evidence that a cell is blocked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CellEvidence {
    /// The cell.
    pub cell: Cell,
    /// The log-likelihood ratio in sixteenths of a nat; positive speaks for an obstacle. Above 64
    /// it is no evidence but a claim: the robot may be there itself, and no teammate is to enter.
    pub weight: i8,
}

/// The evidence that a robot announces, in the order of the cells.
pub type Announced = Vec<CellEvidence, MAX_EVIDENCE>;

/// What a robot has gathered about one cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Known {
    cell: Cell,
    weight: i8,
    /// Whether the robot looks at it now.
    is_in_view: bool,
}

/// What a robot has gathered about obstacles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Obstacles {
    /// In the order in which the cells were first seen; none has the weight zero.
    seen: Vec<Known, MAX_OBSTACLES>,
    /// Counts the ticks since the last forgetting.
    ticks: u16,
}

impl Obstacles {
    pub(super) const NONE: Self = Self { seen: Vec::new(), ticks: 0 };

    /// Counts one look at a cell. Without room the cell about which there is least evidence, the
    /// oldest of equals, is forgotten.
    pub(super) fn look(&mut self, cell: Cell, is_blocked: bool) {
        let weight = if is_blocked { LOOK } else { -LOOK };
        match self.seen.iter_mut().find(|known| known.cell == cell) {
            Some(known) => {
                known.weight = known.weight.saturating_add(weight).clamp(-CAP, CAP);
                known.is_in_view = true;
            }
            None => self.remember(Known { cell, weight, is_in_view: true }),
        }
        self.drop_empty();
    }

    /// Gives up what is not in view where the team knows better. Call it once in every tick, after
    /// all looks; `told` gives what each teammate says of a cell.
    ///
    /// A robot's own word is a veto on all plans through a cell. So an obstacle yields that is none
    /// by the evidence of all, and one that a teammate is sure to have seen free, whatever others
    /// say that see it as little as this robot: they may be where they cannot see it go. A free
    /// cell yields to a teammate that has found it blocked if all policies were `vetoed`: the team
    /// would stand because of what one robot sees and the others outvote.
    pub(super) fn yield_to<I: Iterator<Item = i8> + Clone>(
        &mut self,
        told: impl Fn(Cell) -> I,
        vetoed: bool,
    ) {
        for known in &mut self.seen {
            let told = told(known.cell);
            let add = |sum: i16, weight: i8| sum.saturating_add(weight.into());
            let is_blocked_for_all = is_blocked(told.clone().fold(known.weight.into(), add));
            let is_outdated = if known.weight > 0 {
                let is_sure = |weight: i8| is_blocked(-i16::from(weight));
                told.clone().any(|weight| is_sure(weight) || weight < 0 && !is_blocked_for_all)
            } else {
                vetoed && told.clone().any(|weight| is_blocked(weight.into()))
            };
            if is_outdated && !known.is_in_view {
                known.weight = 0;
            }
            known.is_in_view = false;
        }
        self.drop_empty();
    }

    /// Moves all evidence one sixteenth of a nat towards zero every `period` ticks; never for a
    /// period of zero.
    pub(super) fn forget(&mut self, period: u16) {
        self.ticks = self.ticks.saturating_add(1);
        if period == 0 || self.ticks < period {
            return;
        }
        self.ticks = 0;
        self.seen.iter_mut().for_each(|known| known.weight -= known.weight.signum());
        self.drop_empty();
    }

    /// Returns what to announce of a robot that claims these cells, on which it may be.
    #[must_use]
    pub(super) fn with_claims(&self, cells: &[Cell]) -> Self {
        let mut with = self.clone();
        for &cell in cells {
            with.keep(|known| known.cell != cell);
            with.remember(Known { cell, weight: CLAIM, is_in_view: false });
        }
        with
    }

    /// Returns the evidence to announce where there is room for all that a message can have.
    #[cfg(test)]
    fn announced(&self) -> Announced {
        self.strongest(MAX_EVIDENCE)
    }

    /// Returns the evidence to announce about at most `most` cells: the strongest, in the order of
    /// the cells; the newest of equals.
    #[must_use]
    pub(super) fn strongest(&self, most: usize) -> Announced {
        let strength = |known: &Known| known.weight.unsigned_abs();
        let is_stronger = |at: usize, known: &Known, rival: (usize, &Known)| {
            (strength(rival.1), rival.0) > (strength(known), at)
        };
        let rank = |at: usize, known: &Known| {
            self.seen.iter().enumerate().filter(|&rival| is_stronger(at, known, rival)).count()
        };
        let chosen = || self.seen.iter().enumerate().filter(|&(at, known)| rank(at, known) < most);
        let mut announced = Announced::new();
        let mut next = chosen().map(|(_, known)| *known).min_by_key(|known| known.cell);
        while let Some(known) = next {
            // There is room: no more are asked for.
            let _ = announced.push(CellEvidence { cell: known.cell, weight: known.weight });
            let rest = chosen().map(|(_, other)| *other).filter(|other| other.cell > known.cell);
            next = rest.min_by_key(|other| other.cell);
        }
        announced
    }

    /// Returns the cells that this robot takes for blocked by its own evidence.
    pub(super) fn blocked(&self) -> impl Iterator<Item = Cell> + Clone + '_ {
        self.seen.iter().filter(|known| is_blocked(known.weight.into())).map(|known| known.cell)
    }

    /// The cells for which there is more evidence of an obstacle than against one, enough to
    /// believe it or not: those that are worth another look.
    pub(super) fn suspected(&self) -> impl Iterator<Item = Cell> + '_ {
        self.seen.iter().filter(|known| known.weight > 0).map(|known| known.cell)
    }

    /// Whether this robot takes the cell for blocked by its own evidence.
    pub(super) fn is_blocked(&self, cell: Cell) -> bool {
        self.blocked().any(|blocked| blocked == cell)
    }

    fn remember(&mut self, new: Known) {
        if self.seen.is_full() {
            let weakest = self.seen.iter().min_by_key(|known| known.weight.unsigned_abs()).copied();
            self.keep(|known| Some(*known) != weakest);
        }
        // There is room now.
        let _ = self.seen.push(new);
    }

    fn drop_empty(&mut self) {
        self.keep(|known| known.weight != 0);
    }

    /// Keeps some, in their order. `Vec::retain` would link a function for overlapping copies, of
    /// over a kilobyte on the smallest chips.
    fn keep(&mut self, is_kept: impl Fn(&Known) -> bool) {
        self.seen = up_to(self.seen.iter().copied().filter(is_kept));
    }
}

/// Returns whether a cell counts as blocked after all the evidence of the members.
#[must_use]
pub(super) const fn is_blocked(evidence: i16) -> bool {
    evidence.saturating_add(PRIOR) > 0
}

/// Returns whether a weight is no evidence but a claim of the robot that announces it.
#[must_use]
pub(super) const fn is_claim(weight: i8) -> bool {
    weight > CAP
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blocked(obstacles: &Obstacles) -> std::vec::Vec<u16> {
        obstacles.blocked().map(|cell| cell.0).collect()
    }

    #[test]
    fn an_obstacle_is_believed_at_first_sight_and_given_up_after_a_look_or_two() {
        let mut obstacles = Obstacles::default();
        obstacles.look(Cell(5), true);
        assert_eq!(blocked(&obstacles), [5]);
        obstacles.look(Cell(5), true);
        obstacles.look(Cell(5), false);
        assert_eq!(blocked(&obstacles), []);
        let weight = obstacles.announced()[0].weight;
        obstacles.look(Cell(5), false);
        assert!(obstacles.announced()[0].weight < weight && obstacles.announced()[0].weight < 0);
    }

    #[test]
    fn no_sum_outgrows_the_cap() {
        let mut obstacles = Obstacles::default();
        (0..100).for_each(|_| obstacles.look(Cell(5), true));
        assert_eq!(obstacles.announced()[0].weight, CAP);
        (0..100).for_each(|_| obstacles.look(Cell(5), false));
        assert_eq!(obstacles.announced()[0].weight, -CAP);
    }

    #[test]
    fn evidence_is_forgotten_at_its_rate_or_never() {
        let mut obstacles = Obstacles::default();
        obstacles.look(Cell(5), true);
        (0..1000).for_each(|_| obstacles.forget(0));
        assert_eq!(blocked(&obstacles), [5]);
        (0..3 * (LOOK - 32) as u16).for_each(|_| obstacles.forget(3));
        assert_eq!((blocked(&obstacles), obstacles.announced().len()), (std::vec![], 1));
        (0..3 * 32).for_each(|_| obstacles.forget(3));
        assert_eq!(obstacles, Obstacles { ticks: obstacles.ticks, ..Obstacles::default() });
    }

    #[test]
    fn the_strongest_are_announced_and_the_weakest_forgotten_first() {
        let mut obstacles = Obstacles::default();
        for cell in 0..MAX_OBSTACLES as u16 {
            obstacles.look(Cell(cell), true);
        }
        for cell in [2, 9, 4, 12] {
            obstacles.look(Cell(cell), true);
        }
        let announced = obstacles.announced();
        assert!(announced.iter().map(|known| known.cell.0).eq([2, 4, 9, 12]));
        assert!(obstacles.strongest(2).iter().map(|known| known.cell.0).eq([9, 12]));
        obstacles.look(Cell(90), true);
        let blocked = blocked(&obstacles);
        assert!(!blocked.contains(&0) && blocked.contains(&90));
    }

    /// What a robot announces after it has looked at cell 5, and teammates say this of it in the
    /// ticks after.
    fn after(is_blocked: bool, ticks: &[&[i8]], vetoed: bool) -> Option<i8> {
        let mut obstacles = Obstacles::default();
        (0..2).for_each(|_| obstacles.look(Cell(5), is_blocked));
        ticks.iter().for_each(|told| obstacles.yield_to(|_| told.iter().copied(), vetoed));
        obstacles.announced().first().map(|known| known.weight)
    }

    #[test]
    fn an_obstacle_out_of_view_yields_once_the_team_counts_the_cell_as_free() {
        assert_eq!(after(true, &[&[-64], &[]], false), Some(CAP), "it was in view");
        assert_eq!(after(true, &[&[-64], &[-64]], false), None);
        assert_eq!(after(true, &[&[], &[-20], &[-20, 48]], false), Some(CAP), "all together it is blocked");
        assert_eq!(after(true, &[&[], &[64, -48, 64]], false), None, "one has seen it free");
        assert_eq!(after(true, &[&[], &[64, -32, 64]], false), Some(CAP), "it is not sure");
        assert_eq!(after(true, &[&[], &[], &[]], true), Some(CAP), "nobody says anything else");
    }

    #[test]
    fn a_free_cell_out_of_view_yields_where_all_policies_were_vetoed() {
        assert_eq!(after(false, &[&[], &[64], &[64]], false), Some(-CAP));
        assert_eq!(after(false, &[&[64], &[]], true), Some(-CAP), "it was in view");
        assert_eq!(after(false, &[&[64], &[-64, 64]], true), None);
        assert_eq!(after(false, &[&[], &[32]], true), Some(-CAP), "that makes no obstacle");
    }

    #[test]
    fn members_outvote_each_other() {
        assert!(is_blocked(48) && !is_blocked(32) && !is_blocked(64 - 48));
    }
}
