//! Dead reckoning: a localiser from finished moves.

use crate::hardware::{Drive, Localiser};
use core::sync::atomic::{AtomicU16, Ordering};
use iibt_core::grid::{Cell, Map, Move};

/// The position of a robot from a cell in which it was placed and its finished moves.
///
/// It has no sensor, so its error never shrinks: for short missions, simulation, and robots whose
/// drive corrects itself (a line follower). It hears of moves by lending itself to the drive:
/// [`DeadReckoning::count`] wraps the drive, and a shared reference is the [`Localiser`]. A move
/// counts once the drive has been asked and says it no longer moves.
///
/// It knows only what it was told and has counted. A restart loses the count, and a move that was
/// stopped halfway ends at an unknown place. From then on it reads `None`, until the robot is
/// [placed](Self::place) by an operator or a sensor that sees it. A robot without a reading stands,
/// and says nothing to its team.
///
/// ```
/// use firmware::adapters::DeadReckoning;
/// use firmware::hardware::{Drive, Localiser};
/// use iibt_core::grid::{Cell, Map, Move, words};
///
/// /// A drive that finishes every move at once.
/// struct Prompt;
/// impl Drive for Prompt {
///     fn go(&mut self, _: Move) {}
///     fn is_moving(&mut self) -> bool {
///         false
///     }
///     fn stop(&mut self) {}
/// }
///
/// let map = Map::<{ words(3, 3) }>::new(3, 3)?;
/// let position = DeadReckoning::placed(map, Cell(4));
/// let mut drive = position.count(Prompt);
/// drive.go(Move::Right);
/// assert!(!drive.is_moving());
/// assert_eq!((&position).locate(), Some(Cell(5)));
///
/// let position = DeadReckoning::unknown(map); // the robot has restarted
/// assert_eq!((&position).locate(), None);
/// position.place(Cell(5))?; // an operator sees it there
/// assert_eq!((&position).locate(), Some(Cell(5)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "odometry")]
#[derive(Debug)]
pub struct DeadReckoning<const W: usize> {
    map: Map<W>,
    /// The number of the cell, or [`UNKNOWN`]: atomic, so that drive and localiser may go to a task
    /// together.
    here: AtomicU16,
}

/// The number of no cell: maps have fewer cells.
const UNKNOWN: u16 = u16::MAX;

/// The cell in which a robot is to be placed is not one of its map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[error("cell {} is not one of the map, which has {cells}", .cell.0)]
pub struct OutsideMap {
    /// The cell.
    pub cell: Cell,
    /// The cells of the map.
    pub cells: usize,
}

/// A drive whose finished moves a [`DeadReckoning`] counts.
#[derive(Debug)]
pub struct Counted<'a, D, const W: usize> {
    drive: D,
    reckoning: &'a DeadReckoning<W>,
    pending: Option<Move>,
}

impl<const W: usize> DeadReckoning<W> {
    /// Creates the localiser of a robot that stands on `cell`, by what an operator says. Only the
    /// map's border is used, not its obstacles.
    #[must_use]
    pub const fn placed(map: Map<W>, cell: Cell) -> Self {
        Self { map, here: AtomicU16::new(cell.0) }
    }

    /// Creates the localiser of a robot that may be anywhere, as after a restart.
    #[must_use]
    pub const fn unknown(map: Map<W>) -> Self {
        Self { map, here: AtomicU16::new(UNKNOWN) }
    }

    /// Creates the localiser of a robot that starts: [placed](Self::placed) on its mission's start
    /// if this is the [first start](crate::page::Page::is_first_start) of its mission, and
    /// [unknown](Self::unknown) at every other.
    #[must_use]
    pub const fn at_boot(map: Map<W>, start: Cell, is_first_start: bool) -> Self {
        if is_first_start { Self::placed(map, start) } else { Self::unknown(map) }
    }

    /// Places the robot, which stands, on the cell where an operator or a sensor sees it.
    ///
    /// # Errors
    /// [`OutsideMap`]; the position is as it was.
    pub fn place(&self, cell: Cell) -> Result<(), OutsideMap> {
        let cells = self.map.len();
        if cell.index() >= cells {
            return Err(OutsideMap { cell, cells });
        }
        self.here.store(cell.0, Ordering::Relaxed);
        Ok(())
    }

    fn here(&self) -> Option<Cell> {
        Some(Cell(self.here.load(Ordering::Relaxed))).filter(|here| here.0 != UNKNOWN)
    }

    /// Counts a finished move.
    fn advance(&self, step: Move) {
        if let Some(here) = self.here() {
            self.here.store(self.map.neighbour(here, step).0, Ordering::Relaxed);
        }
    }

    /// Notes that the robot stands between two cells, at an unknown place.
    fn lose(&self) {
        self.here.store(UNKNOWN, Ordering::Relaxed);
    }

    /// Wraps a drive so that its finished moves are counted here.
    pub const fn count<D>(&self, drive: D) -> Counted<'_, D, W> {
        Counted { drive, reckoning: self, pending: None }
    }
}

impl<const W: usize> Localiser for &DeadReckoning<W> {
    fn locate(&mut self) -> Option<Cell> {
        self.here()
    }
}

impl<D: Drive, const W: usize> Drive for Counted<'_, D, W> {
    fn go(&mut self, step: Move) {
        self.drive.go(step);
        self.pending = Some(step);
    }

    fn is_moving(&mut self) -> bool {
        let moving = self.drive.is_moving();
        if !moving && let Some(step) = self.pending.take() {
            self.reckoning.advance(step);
        }
        moving
    }

    fn stop(&mut self) {
        let was_moving = self.is_moving();
        self.drive.stop();
        if was_moving && self.pending.take().is_some_and(|step| step != Move::Wait) {
            self.reckoning.lose();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive that needs as many questions for a move as its number says.
    struct Slow(u32, u32);

    impl Drive for Slow {
        fn go(&mut self, _: Move) {
            self.1 = self.0;
        }
        fn is_moving(&mut self) -> bool {
            let moving = self.1 > 0;
            self.1 = self.1.saturating_sub(1);
            moving
        }
        fn stop(&mut self) {
            self.1 = 0;
        }
    }

    fn reckoning() -> DeadReckoning<1> {
        DeadReckoning::placed(Map::new(3, 3).unwrap(), Cell(4))
    }

    #[test]
    fn counts_a_move_when_it_is_finished() {
        let reckoning = reckoning();
        let mut drive = reckoning.count(Slow(1, 0));
        drive.go(Move::Right);
        assert!(drive.is_moving());
        assert_eq!((&reckoning).locate(), Some(Cell(4)));
        assert!(!drive.is_moving());
        assert!(!drive.is_moving());
        assert_eq!((&reckoning).locate(), Some(Cell(5)));
    }

    #[test]
    fn a_move_that_was_stopped_halfway_leaves_it_unknown_until_it_is_placed() {
        let reckoning = reckoning();
        let mut drive = reckoning.count(Slow(1, 0));
        drive.go(Move::Up);
        drive.stop();
        assert!(!drive.is_moving());
        assert_eq!((&reckoning).locate(), None);
        drive.go(Move::Up);
        assert!(drive.is_moving() && !drive.is_moving());
        assert_eq!((&reckoning).locate(), None, "a move from nowhere leads nowhere");
        assert_eq!(reckoning.place(Cell(9)), Err(OutsideMap { cell: Cell(9), cells: 9 }));
        assert_eq!((&reckoning).locate(), None);
        reckoning.place(Cell(1)).expect("the map has it");
        assert_eq!((&reckoning).locate(), Some(Cell(1)));
    }

    #[test]
    fn stopping_a_robot_that_stands_or_waits_loses_nothing() {
        let reckoning = reckoning();
        let mut drive = reckoning.count(Slow(1, 0));
        drive.stop();
        assert_eq!((&reckoning).locate(), Some(Cell(4)));
        drive.go(Move::Right);
        assert!(drive.is_moving());
        drive.stop();
        assert_eq!((&reckoning).locate(), Some(Cell(5)), "the move had just been finished");
        drive.go(Move::Wait);
        drive.stop();
        assert_eq!((&reckoning).locate(), Some(Cell(5)));
    }

    #[test]
    fn only_the_first_start_is_at_the_start_of_the_mission() {
        let map = Map::<1>::new(3, 3).unwrap();
        assert_eq!((&DeadReckoning::at_boot(map, Cell(4), true)).locate(), Some(Cell(4)));
        assert_eq!((&DeadReckoning::at_boot(map, Cell(4), false)).locate(), None);
    }

    #[test]
    fn stays_on_the_map() {
        let reckoning = reckoning();
        let mut drive = reckoning.count(Slow(0, 0));
        for _ in 0..5 {
            drive.go(Move::Down);
            assert!(!drive.is_moving());
        }
        assert_eq!((&reckoning).locate(), Some(Cell(7)));
    }
}
