//! Dead reckoning: a localiser from finished moves.

use crate::hardware::{Drive, Localiser};
use core::sync::atomic::{AtomicU16, Ordering};
use iibt_core::grid::{Cell, Map, Move};

/// The position of a robot from its start and its finished moves.
///
/// It has no sensor, so its error never shrinks: for short missions, simulation, and robots whose
/// drive corrects itself (a line follower). It hears of moves by lending itself to the drive:
/// [`DeadReckoning::count`] wraps the drive, and a shared reference is the [`Localiser`]. A move
/// counts once the drive has been asked and says it no longer moves; a move that was stopped does
/// not count.
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
/// let position = DeadReckoning::new(map, Cell(4));
/// let mut drive = position.count(Prompt);
/// drive.go(Move::Right);
/// assert!(!drive.is_moving());
/// assert_eq!((&position).locate(), Some(Cell(5)));
/// # Ok::<(), iibt_core::grid::MapError>(())
/// ```
#[doc(alias = "odometry")]
#[derive(Debug)]
pub struct DeadReckoning<const W: usize> {
    map: Map<W>,
    /// The number of the cell: atomic, so that drive and localiser may go to a task together.
    here: AtomicU16,
}

/// A drive whose finished moves a [`DeadReckoning`] counts.
#[derive(Debug)]
pub struct Counted<'a, D, const W: usize> {
    drive: D,
    reckoning: &'a DeadReckoning<W>,
    pending: Option<Move>,
}

impl<const W: usize> DeadReckoning<W> {
    /// Creates the localiser of a robot at `start`. Only the map's border is used, not its
    /// obstacles.
    #[must_use]
    pub const fn new(map: Map<W>, start: Cell) -> Self {
        Self { map, here: AtomicU16::new(start.0) }
    }

    fn here(&self) -> Cell {
        Cell(self.here.load(Ordering::Relaxed))
    }

    /// Wraps a drive so that its finished moves are counted here.
    pub const fn count<D>(&self, drive: D) -> Counted<'_, D, W> {
        Counted { drive, reckoning: self, pending: None }
    }
}

impl<const W: usize> Localiser for &DeadReckoning<W> {
    fn locate(&mut self) -> Option<Cell> {
        Some(self.here())
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
            let DeadReckoning { map, here } = self.reckoning;
            here.store(map.neighbour(self.reckoning.here(), step).0, Ordering::Relaxed);
        }
        moving
    }

    fn stop(&mut self) {
        self.drive.stop();
        self.pending = None;
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
        DeadReckoning::new(Map::new(3, 3).unwrap(), Cell(4))
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
    fn forgets_a_move_that_was_stopped() {
        let reckoning = reckoning();
        let mut drive = reckoning.count(Slow(1, 0));
        drive.go(Move::Up);
        drive.stop();
        assert!(!drive.is_moving());
        assert_eq!((&reckoning).locate(), Some(Cell(4)));
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
