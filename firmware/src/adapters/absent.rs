//! Sensors that a robot does not have.

use crate::hardware::{Battery, Localiser, Scanner};
use iibt_core::grid::Cell;

/// A sensor that is not there: no position, nothing in view, and a charge that is always full.
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
