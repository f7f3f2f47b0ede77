//! Progress: whether the readings of the localiser follow the moves of the robot.
//!
//! A move that fails leaves the robot where it was, and its readings too. So does a localiser that
//! has frozen, but then the robot has moved and does not know. From the first move that no reading
//! follows until one does, the robot is in doubt: it may be on the cell that its localiser names,
//! or on the one to which its moves lead. It claims both, with the cells between them, and makes a
//! move only where that is safe from both.
//!
//! A worn drive cannot be told from a frozen localiser by the length of the row: a drive may be
//! worn to any degree. But it wears in the direction in which its robot moves, and a localiser
//! freezes in all. So a robot that cannot go on by its plan tries another direction, and stands
//! once moves in two directions have failed that would both fail once in a thousand times.

use super::obstacles::{MAX_EVIDENCE, Obstacles};
use crate::grid::{Cell, Map, Move};
use heapless::Vec;

/// The moves into walls that a robot in doubt may have made.
const MOST_BUMPS: u8 = 3;

/// The probability, by what is known of the drive, below which so many failures are not its own.
const UNLIKELY: f32 = 1e-3;

/// The ticks for which the plan's move is put off before another move is tried.
const FIRST_REST: u16 = 4;

/// The most ticks between two tries; each rest is twice as long as the one before.
const LONGEST_REST: u16 = 1024;

/// A move to another cell of which no reading has told where it led.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
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
    /// The most moves in a row that have failed before one was made: what the drive may do again.
    longest_row: u8,
    /// The cell from which the robot has come to this one, if that was not planned.
    left: Option<Cell>,
    doubt: Option<Doubt>,
}

/// What a robot knows whose localiser may have frozen.
#[derive(Clone, Debug)]
struct Doubt {
    /// Where it is if every move was made.
    reckoned: Cell,
    /// The cells from the one that the localiser names to there.
    trail: Vec<Cell, MAX_EVIDENCE>,
    first: Move,
    /// Whether there were moves in more than one direction.
    has_turned: bool,
    /// The probability that the drive has failed to make all these moves.
    odds: f32,
    moves: u8,
    /// The moves into walls, if every other move was made.
    bumps: u8,
    /// Whether no move was safe to try.
    is_cornered: bool,
    /// The ticks until another move is tried.
    rest: u16,
    last_rest: u16,
}

/// Where a move leads; `None` into a wall or a known obstacle.
pub(super) fn destination<const W: usize>(
    map: &Map<W>,
    obstacles: &Obstacles,
    from: Cell,
    step: Move,
) -> Option<Cell> {
    let to = map.neighbour(from, step);
    (to != from && map.is_free(to) && !obstacles.is_blocked(to)).then_some(to)
}

impl Progress {
    /// Of a robot that has not yet known where it stands.
    pub(super) const NONE: Self = Self { here: None, longest_row: 0, left: None, doubt: None };

    /// Takes in where the robot stands by its localiser, and the move that it has made before, of
    /// which `slip` was the chance to fail by what was known then. `leads` gives the destination of
    /// a move.
    pub(super) fn settle(
        &mut self,
        here: Cell,
        passage: Option<Passage>,
        slip: f32,
        leads: impl FnOnce(Cell, Move) -> Option<Cell>,
    ) {
        let last = self.here.replace(here);
        if last != Some(here) {
            let (doubt, made) = (self.doubt.take(), passage.filter(|passage| passage.to == here));
            let row = doubt.filter(|_| made.is_some()).map_or(0, |doubt| doubt.moves);
            self.longest_row = self.longest_row.max(row);
            self.left = last.filter(|_| made.is_some_and(|passage| !passage.is_planned));
            return;
        }
        let Some(Passage { step, .. }) = passage else { return };
        let to = leads(self.reckoned().unwrap_or(here), step);
        // A robot that was sure where it is knows why it did not get on: an obstacle is ahead.
        if self.doubt.is_some() || to.is_some() {
            let doubt = self.doubt.get_or_insert(Doubt::new(here, step));
            doubt.go(here, to, step, slip);
        }
    }

    /// The cell from which the robot has come to this one, if that was not planned.
    pub(super) const fn left(&self) -> Option<Cell> {
        self.left
    }

    /// Where the robot is if every move was made, while it is in doubt.
    pub(super) fn reckoned(&self) -> Option<Cell> {
        self.doubt.as_ref().map(|doubt| doubt.reckoned)
    }

    /// Whether the robot makes no progress, and stands until a reading follows a move.
    pub(super) fn is_stuck(&self) -> bool {
        let is_stuck = |doubt: &Doubt| doubt.is_cornered || doubt.has_turned && doubt.odds < UNLIKELY;
        self.doubt.as_ref().is_some_and(is_stuck)
    }

    /// The cells on which the robot may be, beside the one that its localiser names.
    pub(super) fn trail(&self) -> &[Cell] {
        self.doubt.as_ref().map_or(&[], |doubt| &doubt.trail)
    }

    /// Whether the robot may move into a wall: seldom, unless its drive has failed as often before.
    pub(super) fn may_bump(&self) -> bool {
        let most = self.longest_row.saturating_mul(2).max(MOST_BUMPS);
        self.doubt.as_ref().is_none_or(|doubt| doubt.bumps < most)
    }

    /// Counts a tick in which the plan's move is put off; returns whether to try another.
    pub(super) fn wait(&mut self) -> bool {
        let Some(doubt) = &mut self.doubt else { return false };
        doubt.rest = doubt.rest.saturating_sub(1);
        doubt.rest == 0
    }

    /// Notes whether there is a safe move to try. Without one the robot is stuck, until a reading
    /// follows a move.
    pub(super) fn note_trial(&mut self, is_found: bool) {
        let Some(doubt) = &mut self.doubt else { return };
        doubt.is_cornered |= !is_found;
        if is_found {
            doubt.last_rest = doubt.last_rest.saturating_mul(2).min(LONGEST_REST);
            doubt.rest = doubt.last_rest;
        }
    }
}

impl Doubt {
    fn new(here: Cell, first: Move) -> Self {
        Self {
            reckoned: here,
            trail: Vec::new(),
            first,
            has_turned: false,
            odds: 1.0,
            moves: 0,
            bumps: 0,
            is_cornered: false,
            rest: FIRST_REST,
            last_rest: FIRST_REST,
        }
    }

    /// Takes in a move that no reading has followed.
    fn go(&mut self, here: Cell, to: Option<Cell>, step: Move, slip: f32) {
        self.odds *= slip;
        self.has_turned |= step != self.first;
        self.moves = self.moves.saturating_add(1);
        let Some(to) = to else {
            self.bumps = self.bumps.saturating_add(1);
            return;
        };
        self.reckoned = to;
        if to != here && !self.trail.contains(&to) {
            // A robot with teammates enters no cell that it has no room to claim.
            let _ = self.trail.push(to);
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

    /// A robot on cell 5 makes these moves, of which each fails with a probability of its own; its
    /// localiser goes on naming cell 5.
    fn go(progress: &mut Progress, moves: &[(Move, f32)]) {
        for &(step, slip) in moves {
            let to = map().neighbour(Cell(5), step);
            let passage = Passage { to, step, is_planned: true };
            let leads = |from, step| destination(&map(), &Obstacles::NONE, from, step);
            progress.settle(Cell(5), Some(passage), slip, leads);
        }
    }

    fn frozen(moves: &[(Move, f32)]) -> Progress {
        let mut progress = Progress::NONE;
        progress.settle(Cell(5), None, SLIP, |_, _| None);
        go(&mut progress, moves);
        progress
    }

    /// A reading follows the robot's move to the right.
    fn get_on(progress: &mut Progress) {
        let passage = Passage { to: Cell(6), step: Move::Right, is_planned: true };
        progress.settle(Cell(6), Some(passage), SLIP, |_, _| None);
        progress.settle(Cell(5), None, SLIP, |_, _| None);
    }

    #[test]
    fn the_robot_may_be_anywhere_from_its_reading_to_where_its_moves_lead() {
        let right = [(Move::Right, SLIP); 6];
        for (moves, trail) in [(0, &[][..]), (1, &[6]), (2, &[6, 7]), (4, &[6, 7, 8, 9]), (6, &[6, 7, 8, 9])]
        {
            let progress = frozen(&right[..moves]);
            assert!(progress.trail().iter().map(|cell| cell.0).eq(trail.iter().copied()), "{moves}");
            assert_eq!(progress.reckoned(), trail.last().map(|&cell| Cell(cell)));
        }
    }

    #[test]
    fn a_row_in_one_direction_is_a_worn_drive_and_one_in_two_directions_is_not() {
        assert!(!frozen(&[(Move::Right, SLIP); 20]).is_stuck());
        assert!(!frozen(&[(Move::Right, SLIP), (Move::Left, SLIP)]).is_stuck(), "once in four hundred times");
        assert!(frozen(&[(Move::Right, SLIP), (Move::Right, 0.1), (Move::Left, SLIP)]).is_stuck());
    }

    #[test]
    fn a_drive_that_is_known_to_fail_is_given_more_moves() {
        let turns = [(Move::Right, 0.5), (Move::Down, 0.5)].repeat(5);
        assert!(!frozen(&turns[..9]).is_stuck() && frozen(&turns).is_stuck(), "1 of 1,024");
    }

    #[test]
    fn a_reading_that_follows_ends_the_doubt() {
        let mut progress = frozen(&[(Move::Right, SLIP), (Move::Left, SLIP), (Move::Left, SLIP)]);
        assert!(progress.is_stuck());
        get_on(&mut progress);
        assert!(!progress.is_stuck() && progress.reckoned().is_none() && progress.trail().is_empty());
    }

    #[test]
    fn a_robot_runs_into_walls_three_times_or_twice_as_often_as_its_drive_has_failed_before() {
        let bumps = |progress: &mut Progress| {
            let mut bump =
                |_: &i32| progress.may_bump().then(|| go(progress, &[(Move::Left, SLIP)])).is_some();
            (0..50).take_while(|count| bump(count)).count()
        };
        let mut sound = frozen(&[(Move::Up, SLIP)]);
        assert_eq!(bumps(&mut sound), 3);
        let mut worn = frozen(&[(Move::Right, SLIP); 4]);
        get_on(&mut worn);
        go(&mut worn, &[(Move::Up, SLIP)]);
        assert_eq!(bumps(&mut worn), 8);
        let mut carried = frozen(&[(Move::Right, SLIP); 4]);
        carried.settle(Cell(12), None, SLIP, |_, _| None);
        carried.settle(Cell(5), None, SLIP, |_, _| None);
        go(&mut carried, &[(Move::Up, SLIP)]);
        assert_eq!(bumps(&mut carried), 3, "no reading has followed a move");
    }

    #[test]
    fn an_obstacle_ahead_explains_a_move_that_failed() {
        let mut progress = frozen(&[]);
        let passage = Passage { to: Cell(6), step: Move::Right, is_planned: true };
        progress.settle(Cell(5), Some(passage), SLIP, |_, _| None);
        assert_eq!(progress.reckoned(), None);
    }

    #[test]
    fn moves_are_tried_after_a_rest_twice_as_long_each_time_and_without_one_the_robot_is_stuck() {
        let mut progress = frozen(&[(Move::Right, SLIP)]);
        for rest in [4, 8, 16] {
            assert_eq!((1..100).find(|_| progress.wait()), Some(rest));
            progress.note_trial(true);
            assert!(!progress.is_stuck());
        }
        assert_eq!((1..100).find(|_| progress.wait()), Some(32));
        progress.note_trial(false);
        assert!(progress.is_stuck() && progress.wait(), "it looks for one in every tick");
        progress.note_trial(true);
        assert!(progress.is_stuck() && !progress.wait(), "no reading has followed yet");
    }
}
