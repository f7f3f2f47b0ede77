//! The learned reliability of the robot's own drive: how often each move fails.
//!
//! A failed move is repeated. The teammates that enter the cell later wait, and so do all at the
//! barrier before their last moves. A slip therefore does not lead off the path; it delays it. A
//! path is kept in time with the probability
//!
//! P(s_1 ... s_T as planned | π) = Π B(s_t | s_t-1, u_t) = Π (1 - slip(u_t)),
//!
//! which is its weight in the prior over policies, E. Learning does not trigger a decision: its
//! result counts in the next one. Teammates are modelled as moving without failure.

use super::Navigation;
use crate::grid::{Cell, Move, Path};
use crate::inference::learning::{Rates, SlipCounts};
use crate::math;

/// The moves, to wait being one that cannot fail.
pub(super) const MOVES: usize = Move::ALL.len();

/// ln B(s' | s, u) of every move that leads where it should.
pub(super) type Odds = [f32; MOVES];

/// The success odds of moves that never fail.
pub(super) const SURE: Odds = [0.0; MOVES];

/// The least log weight of a path, about one in three thousand. With the default precision it is
/// half of a goal's preference, so that a drive fault never makes a robot give up the goal that is
/// compatible with its teammates' plans.
const LEAST: f32 = -8.0;

/// The prior count of successes of every move.
const TRUST: f32 = 8.0;

/// The counts of a robot's moves, and the move that is under way.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    counts: SlipCounts<MOVES>,
    attempt: Option<(Cell, Move)>,
}

impl Motion {
    pub(super) fn new(rates: Rates) -> Self {
        Self { counts: SlipCounts::new(TRUST, rates), attempt: None }
    }

    /// Returns the failure probability of each move.
    pub(super) fn slips(&self) -> [f32; MOVES] {
        self.counts.slips()
    }

    /// Returns the log success odds, ln (1 - slip), of each move.
    pub(super) fn odds(&self) -> Odds {
        self.slips().map(|slip| math::ln(1.0 - slip).max(LEAST))
    }

    /// Records that a move from this cell is commanded.
    pub(super) const fn begin(&mut self, from: Cell, step: Move) {
        self.attempt = Some((from, step));
    }
}

/// Returns the log weight of a path from the success odds of its moves.
pub(super) fn ln_kept(odds: &Odds, path: &Path) -> f32 {
    let of = |step: Move| odds.get(usize::from(step.code())).copied().unwrap_or(0.0);
    path.moves().map(of).sum::<f32>().max(LEAST)
}

impl<const S: usize, const W: usize, const P: usize> Navigation<'_, S, W, P> {
    /// Counts the last move, once the robot is confident to be at `here`: a success where the move
    /// leads, a failure where it began. A move that ends elsewhere, or that an obstacle blocked,
    /// counts as neither.
    pub(super) fn learn(&mut self, here: Cell) {
        let Some((from, step)) = self.motion.attempt.take() else { return };
        let to = self.mission.map.neighbour(from, step);
        let counts = to != from && (here == to || here == from) && !self.hazards.contains(&to);
        if counts {
            self.motion.counts.learn(step.code(), here == to);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{GridPercept, Mission};
    use super::*;
    use crate::grid::Map;
    use crate::iibt::Task;
    use crate::navigation::testing::{member, roster};

    type Robot<'m> = Navigation<'m, 49, 2, 4>;

    fn robot<'m>(mission: &'m Mission<'m, 2>) -> Robot<'m> {
        Navigation::new(mission, member(0, 1), 1).unwrap()
    }

    fn read(robot: &mut Robot<'_>, reading: Option<u16>) {
        let percept = GridPercept { reading: reading.map(Cell), ..GridPercept::default() };
        robot.observe(&percept, roster(1).at(Default::default()));
    }

    fn command(robot: &mut Robot<'_>, step: Move) {
        robot.commanded = Some(step);
    }

    const STARTS: [Cell; 1] = [Cell(0)];
    const GOALS: [Cell; 1] = [Cell(24)];

    fn mission() -> Mission<'static, 2> {
        Mission::new(Map::new(7, 7).unwrap(), &STARTS, &GOALS)
    }

    #[test]
    fn a_move_counts_once_a_reading_confirms_where_it_led() {
        let mission = mission();
        let mut robot = robot(&mission);
        let right = |robot: &Robot<'_>| *robot.motion.counts.counts(Move::Right.code()).unwrap();
        read(&mut robot, Some(0));
        command(&mut robot, Move::Right);
        read(&mut robot, Some(0));
        assert_eq!(right(&robot), [TRUST, 0.0], "the first reading may be from before the move");
        read(&mut robot, None);
        assert_eq!(right(&robot), [TRUST, 0.0], "nothing was read");
        read(&mut robot, Some(0));
        assert_eq!(right(&robot), [TRUST, 1.0]);
        command(&mut robot, Move::Right);
        read(&mut robot, Some(1));
        assert!((right(&robot)[0] - TRUST - 1.0).abs() < 0.1 && right(&robot)[1] > 0.9);
        let learned = right(&robot);
        command(&mut robot, Move::Wait);
        read(&mut robot, Some(1));
        command(&mut robot, Move::Right);
        read(&mut robot, Some(40));
        read(&mut robot, Some(40));
        read(&mut robot, Some(40));
        assert_eq!(robot.here(), Some(Cell(40)));
        assert_eq!(right(&robot), learned, "a robot that is put elsewhere learns nothing of its drive");
        assert_eq!(robot.slips()[usize::from(Move::Wait.code())], 0.0);
    }

    #[test]
    fn an_obstacle_in_the_way_says_nothing_of_the_drive() {
        let mission = mission();
        let mut robot = robot(&mission);
        read(&mut robot, Some(0));
        command(&mut robot, Move::Right);
        robot.remember_observed(Cell(1));
        read(&mut robot, Some(0));
        read(&mut robot, Some(0));
        assert_eq!((robot.here(), robot.slips()), (Some(Cell(0)), [0.0; MOVES]));
    }

    #[test]
    fn a_path_weighs_as_much_as_the_chance_that_all_its_moves_are_made() {
        let mut odds = SURE;
        odds[usize::from(Move::Right.code())] = math::ln(0.5);
        let map = mission().map;
        let through = |cells: &[u16]| {
            let mut path = Path::at(Cell(cells[0]));
            for pair in cells.windows(2) {
                path.push(map.move_between(Cell(pair[0]), Cell(pair[1])).unwrap()).unwrap();
            }
            path
        };
        assert!((math::exp(ln_kept(&odds, &through(&[0, 1, 8, 9, 9]))) - 0.25).abs() < 1e-6);
        assert_eq!(ln_kept(&odds, &through(&[0, 7, 14])), 0.0);
        odds[usize::from(Move::Right.code())] = LEAST;
        assert_eq!(ln_kept(&odds, &through(&[0, 1, 2, 3])), LEAST);
    }

    #[test]
    fn a_drive_that_always_fails_keeps_its_odds_finite() {
        for rates in [Rates::DEFAULT, Rates::new(f32::MAX, 0.0), Rates::new(1.0, 1.0)] {
            let mut motion = Motion::new(rates);
            for _ in 0..100_000 {
                motion.counts.learn(0, false);
            }
            let odds = motion.odds();
            assert!((LEAST..0.0).contains(&odds[0]) && odds[1..] == [0.0; 4], "{odds:?}");
        }
    }
}
