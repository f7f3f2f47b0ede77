//! Progress: whether the readings of the localiser follow the moves of the robot.
//!
//! A move that fails leaves the robot where it was, and its readings too. So does a localiser that
//! has frozen, but then the robot has moved and does not know. From the first move that no reading
//! follows, the robot is in doubt: it reckons where it would be if every move since had been made,
//! and claims the cells up to there, as well as the one that its localiser names. It repeats the
//! move where that is safe from both places, until a live localiser is unlikely; then it is stuck.
//! A reading that follows a move ends the doubt.

use super::obstacles::{CellEvidence, MAX_EVIDENCE};
use crate::grid::{Cell, CellSet, Map, Move};
use heapless::Vec;

/// The moves into walls that a robot in doubt may have made.
const MOST_BUMPS: u8 = 3;

/// The probability that a live localiser shows no progress below which the robot is stuck: that of
/// three failures in a row of a drive that fails once in ten moves.
const UNLIKELY: f32 = 1.5e-3;

/// The ticks for which a move waits that could lead to where a teammate may come, before the robot
/// is stuck.
const PATIENCE: u8 = 6;

/// The ticks after which a robot in doubt that has nothing else to do tries another move.
const FIRST_REST: u16 = 20;

/// The most ticks between two tries; each rest is twice as long as the one before.
const LONGEST_REST: u16 = 1280;

/// The weight with which a cell is claimed: more than two teammates can say against it.
const CLAIM: i8 = i8::MAX;

/// A move from one cell to another of which no reading has told where it led.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    pub(super) from: Cell,
    pub(super) to: Cell,
    pub(super) step: Move,
    /// Whether it is one of the plan.
    pub(super) is_planned: bool,
}

/// Whether the readings of the localiser follow the moves of the robot.
#[derive(Clone, Debug)]
pub(super) struct Progress {
    /// The cell on which the robot last was sure to stand.
    here: Option<Cell>,
    doubt: Option<Doubt>,
}

/// What a robot knows that may have a frozen localiser.
#[derive(Clone, Debug)]
struct Doubt {
    /// Where it is if every move was made.
    reckoned: Cell,
    /// The cells on which it may be, beside the one that the localiser names.
    trail: Vec<Cell, MAX_EVIDENCE>,
    /// The chance that a move fails, as it was known before the first one that no reading followed.
    slip: Option<f32>,
    /// The probability that so many moves fail in a row.
    odds: f32,
    /// The moves into walls, if every other move was made.
    bumps: u8,
    /// The ticks for which a move has waited for teammates.
    held: u8,
    /// The ticks until another move is tried.
    rest: u16,
    last_rest: u16,
}

/// What limits the moves of a robot in doubt.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits<'a, const W: usize, F: Fn(Cell) -> bool> {
    pub(super) map: &'a Map<W>,
    /// Whether the robot takes a cell for blocked.
    pub(super) is_blocked: F,
    /// The cells to which teammates may come.
    pub(super) closed: &'a CellSet<W>,
}

impl Progress {
    /// Of a robot that has not yet known where it stands.
    pub(super) const NONE: Self = Self { here: None, doubt: None };

    /// Takes in where the robot stands by its localiser, and the move that it has made before, of
    /// which `slip` was the chance to fail by what was known then.
    pub(super) fn settle<const W: usize>(
        &mut self,
        map: &Map<W>,
        here: Cell,
        passage: Option<Passage>,
        slip: f32,
        is_blocked: impl Fn(Cell) -> bool,
    ) {
        let Some(last) = self.here.replace(here) else { return };
        let has_moved = passage.is_some_and(|passage| passage.to == here);
        let is_explained = passage.is_some_and(|passage| passage.from == here && is_blocked(passage.to));
        match (&mut self.doubt, passage) {
            (doubt, _) if has_moved => *doubt = None,
            // It was carried, or its localiser is wrong.
            (None, None) if here != last => self.doubt = Some(Doubt::new(last)),
            (None, Some(passage)) if !is_explained => {
                let mut doubt = Doubt::new(passage.to);
                if here == passage.from {
                    (doubt.slip, doubt.odds) = (Some(slip), slip);
                } else {
                    doubt.claim(passage.from);
                }
                self.doubt = Some(doubt);
            }
            (Some(doubt), Some(passage)) => doubt.go(map, passage.step, slip, is_blocked),
            // The localiser has come back to where the robot reckons to be.
            (Some(doubt), None) if here != last && doubt.reckoned == here => self.doubt = None,
            (Some(doubt), None) if here != last => doubt.claim(last),
            (None | Some(_), _) => {}
        }
    }

    /// Counts a tick.
    pub(super) fn pass(&mut self) {
        if let Some(doubt) = &mut self.doubt {
            doubt.rest = doubt.rest.saturating_sub(1);
        }
    }

    /// Where the robot is if every move was made, while it is in doubt.
    pub(super) fn reckoned(&self) -> Option<Cell> {
        self.doubt.as_ref().map(|doubt| doubt.reckoned)
    }

    /// Whether the robot makes no progress, and stands until a reading follows a move.
    pub(super) fn is_stuck(&self) -> bool {
        let is_stuck =
            |doubt: &Doubt| doubt.odds < UNLIKELY || doubt.bumps >= MOST_BUMPS || doubt.held >= PATIENCE;
        self.doubt.as_ref().is_some_and(is_stuck)
    }

    /// The claims of a robot in doubt on the cells on which it may be, for its teammates.
    pub(super) fn claims(&self) -> impl Iterator<Item = CellEvidence> + Clone + '_ {
        let cells = self.doubt.iter().flat_map(|doubt| doubt.trail.iter());
        let cells = cells.filter(|&&cell| self.here != Some(cell));
        cells.map(|&cell| CellEvidence { cell, weight: CLAIM })
    }

    /// Whether the robot may make a move of its plan: from where it may be, that does not lead to
    /// where a teammate may come. Counts the ticks for which it may not.
    pub(super) fn allows<const W: usize>(
        &mut self,
        step: Move,
        limits: &Limits<'_, W, impl Fn(Cell) -> bool>,
    ) -> bool {
        let here = self.here;
        let Some(doubt) = &mut self.doubt else { return true };
        let to = doubt.next(limits.map, step, &limits.is_blocked);
        let allows = to.is_none_or(|to| here == Some(to) || doubt.may_enter(to, limits.closed));
        doubt.held = if allows { 0 } else { doubt.held.saturating_add(1) };
        if doubt.held == PATIENCE {
            doubt.rest = 0;
        }
        allows
    }

    /// The move to try now, to see whether a reading follows it: one that ends in a free cell from
    /// where the localiser says that the robot is, and from where it reckons to be in a claimed cell,
    /// else in a free one, else in a wall.
    pub(super) fn trial<const W: usize>(
        &mut self,
        limits: &Limits<'_, W, impl Fn(Cell) -> bool>,
    ) -> Option<(Move, Cell)> {
        let here = self.here?;
        let doubt = self.doubt.as_mut().filter(|doubt| doubt.rest == 0)?;
        let leads = |step: Move| {
            let to = limits.map.neighbour(here, step);
            let is_free = to != here && limits.map.is_free(to) && !(limits.is_blocked)(to);
            if !is_free || limits.closed.contains(to) {
                return None;
            }
            let rank = match doubt.next(limits.map, step, &limits.is_blocked) {
                Some(reckoned) if here == reckoned => 0,
                Some(reckoned) if !doubt.may_enter(reckoned, limits.closed) => return None,
                Some(reckoned) => u8::from(!doubt.trail.contains(&reckoned)),
                None if doubt.bumps < MOST_BUMPS => 2,
                None => return None,
            };
            Some((rank, step, to))
        };
        let (_, step, to) = Move::ALL.into_iter().filter_map(leads).min_by_key(|&(rank, ..)| rank)?;
        doubt.last_rest = doubt.last_rest.saturating_mul(2).min(LONGEST_REST);
        doubt.rest = doubt.last_rest;
        Some((step, to))
    }
}

impl Doubt {
    /// Of a robot that may be on a cell that its localiser does not name.
    fn new(reckoned: Cell) -> Self {
        let mut new = Self {
            reckoned,
            trail: Vec::new(),
            slip: None,
            odds: 1.0,
            bumps: 0,
            held: 0,
            rest: FIRST_REST,
            last_rest: FIRST_REST,
        };
        new.claim(reckoned);
        new
    }

    /// Takes in a move that no reading has followed.
    fn go<const W: usize>(&mut self, map: &Map<W>, step: Move, slip: f32, is_blocked: impl Fn(Cell) -> bool) {
        self.odds *= *self.slip.get_or_insert(slip);
        self.rest = self.rest.max(self.last_rest);
        match self.next(map, step, is_blocked) {
            Some(to) => {
                self.reckoned = to;
                self.claim(to);
            }
            None => self.bumps = self.bumps.saturating_add(1),
        }
    }

    /// Where a move leads from the reckoned cell; `None` into a wall.
    fn next<const W: usize>(
        &self,
        map: &Map<W>,
        step: Move,
        is_blocked: impl Fn(Cell) -> bool,
    ) -> Option<Cell> {
        let to = map.neighbour(self.reckoned, step);
        (to != self.reckoned && map.is_free(to) && !is_blocked(to)).then_some(to)
    }

    /// Whether the robot may come to a cell. Not even to one that it claims, if teammates may: two
    /// of them can have seen it free.
    fn may_enter<const W: usize>(&self, cell: Cell, closed: &CellSet<W>) -> bool {
        !closed.contains(cell) && (self.trail.contains(&cell) || !self.trail.is_full())
    }

    fn claim(&mut self, cell: Cell) {
        if !self.trail.contains(&cell) {
            // Without room it is not entered.
            let _ = self.trail.push(cell);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLIP: f32 = 0.05;

    fn map() -> Map<1> {
        Map::drawn(".....\n.....\n.....").unwrap()
    }

    fn passage(from: u16, step: Move) -> Passage {
        Passage { from: Cell(from), to: map().neighbour(Cell(from), step), step, is_planned: true }
    }

    /// A robot on cell 5 whose localiser names that cell after each of these moves.
    fn frozen(steps: &[Move]) -> Progress {
        let mut progress = Progress::NONE;
        progress.settle(&map(), Cell(5), None, SLIP, |_| false);
        for &step in steps {
            progress.settle(&map(), Cell(5), Some(passage(5, step)), SLIP, |_| false);
        }
        progress
    }

    fn claimed(progress: &Progress) -> std::vec::Vec<u16> {
        progress.claims().map(|claim| claim.cell.0).collect()
    }

    fn allows(progress: &mut Progress, step: Move, closed: &[u16]) -> bool {
        let closed = closed.iter().copied().map(Cell).collect();
        progress.allows(step, &Limits { map: &map(), is_blocked: |_| false, closed: &closed })
    }

    fn trial(progress: &mut Progress, closed: &[u16]) -> Option<(Move, Cell)> {
        let closed = closed.iter().copied().map(Cell).collect();
        progress.trial(&Limits { map: &map(), is_blocked: |_| false, closed: &closed })
    }

    #[test]
    fn a_robot_whose_readings_do_not_follow_claims_where_it_may_be_and_stops_at_the_third_move() {
        for (moves, cells) in [(0, &[][..]), (1, &[6]), (2, &[6, 7]), (3, &[6, 7, 8])] {
            let progress = frozen(&[Move::Right; 3][..moves]);
            assert_eq!((claimed(&progress), progress.is_stuck()), (cells.to_vec(), moves == 3));
        }
    }

    #[test]
    fn a_reading_that_follows_a_move_ends_the_doubt() {
        let mut progress = frozen(&[Move::Right; 3]);
        progress.settle(&map(), Cell(6), Some(passage(5, Move::Right)), SLIP, |_| false);
        assert!(!progress.is_stuck() && progress.reckoned().is_none());
    }

    #[test]
    fn a_localiser_that_comes_back_to_the_reckoned_cell_is_believed_and_another_jump_is_not() {
        let mut progress = frozen(&[Move::Right; 3]);
        progress.settle(&map(), Cell(12), None, 1.0, |_| false);
        assert_eq!(claimed(&progress), [6, 7, 8, 5], "it may be where it was before");
        progress.settle(&map(), Cell(8), None, 1.0, |_| false);
        assert_eq!(claimed(&progress), []);
        progress.settle(&map(), Cell(2), None, 1.0, |_| false);
        assert_eq!((claimed(&progress), progress.is_stuck()), (std::vec![8], false));
    }

    #[test]
    fn an_obstacle_ahead_explains_a_move_that_failed() {
        let mut progress = frozen(&[]);
        progress.settle(&map(), Cell(5), Some(passage(5, Move::Right)), SLIP, |cell| cell == Cell(6));
        assert_eq!(progress.reckoned(), None);
    }

    #[test]
    fn a_drive_that_is_known_to_fail_is_given_more_moves_but_not_into_walls() {
        let mut progress = frozen(&[]);
        for (moves, is_stuck) in [(1, false), (2, false), (3, false), (6, false), (7, true)] {
            while progress.doubt.as_ref().map_or(0, |doubt| doubt.bumps + doubt.trail.len() as u8) < moves {
                progress.settle(&map(), Cell(5), Some(passage(5, Move::Right)), 0.8, |_| false);
            }
            assert_eq!(progress.is_stuck(), is_stuck, "after {moves}: four to the wall, three into it");
        }
    }

    #[test]
    fn a_move_waits_where_it_could_lead_to_a_teammate_and_the_robot_is_stuck_if_that_lasts() {
        let mut progress = frozen(&[Move::Right]);
        assert!(allows(&mut progress, Move::Right, &[6]), "a teammate on the own path waits for it");
        for tick in 0..PATIENCE {
            assert!(!progress.is_stuck(), "{tick}");
            assert!(!allows(&mut progress, Move::Right, &[7]));
        }
        assert!(progress.is_stuck());
        assert!(allows(&mut progress, Move::Right, &[]) && !progress.is_stuck());
    }

    #[test]
    fn a_trial_is_safe_from_both_places_and_rests_twice_as_long_each_time() {
        let mut progress = frozen(&[Move::Right; 3]);
        let wait = |progress: &mut Progress, closed: &[u16]| {
            let rested = (1..5_000).find(|_| {
                progress.pass();
                progress.doubt.as_ref().is_some_and(|doubt| doubt.rest == 0)
            });
            (rested, trial(progress, closed))
        };
        // On 5 or on 8: a move to the right would lead to 9, one to the left from 5 into the wall.
        assert_eq!(wait(&mut progress, &[9, 0, 3, 10, 13]), (Some(20), None));
        assert_eq!(trial(&mut progress, &[0, 3, 10, 13]), Some((Move::Right, Cell(6))));
        progress.settle(&map(), Cell(5), Some(passage(5, Move::Right)), SLIP, |_| false);
        let into_wall = (Some(40), Some((Move::Right, Cell(6))));
        assert_eq!(wait(&mut progress, &[0, 3, 10, 13]), into_wall, "up and down are not free");
    }
}
