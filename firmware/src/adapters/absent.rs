//! Parts that a robot does not have.

use super::Motor;
use crate::hardware::{Battery, Drive, Localiser, Scanner};
use iibt_core::grid::{Cell, Move};

/// A part that is not there: no position, nothing in view, a charge that is always full, and a
/// drive that is done with every move at once, for a board on a desk.
///
/// ```
/// use firmware::adapters::Absent;
/// use firmware::hardware::{Battery, Localiser, Scanner};
///
/// let mut none = Absent;
/// assert_eq!((none.locate(), none.scan(), none.charge()), (None, None, 100));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Absent;

impl Drive for Absent {
    fn go(&mut self, _: Move) {}
    fn is_moving(&mut self) -> bool {
        false
    }
    fn stop(&mut self) {}
}

/// A motor that is not there runs all the same: its moves take their time.
impl Motor for Absent {
    fn run(&mut self, _: u8, _: bool) -> bool {
        true
    }
}

impl Localiser for Absent {
    fn locate(&mut self) -> Option<Cell> {
        None
    }
}

impl Scanner for Absent {
    fn scan(&mut self) -> Option<Cell> {
        None
    }
}

impl Battery for Absent {
    fn charge(&mut self) -> u8 {
        100
    }
}
