//! The flash of a board, and what lies where in it.

use crate::page::{Origin, Page, Refused, Slots, TreeReader};
use crate::{BootCounter, EpochError};
use embedded_storage::nor_flash::NorFlash;

/// The flash of a board with the page of its robot and the count of its starts.
#[derive(Debug)]
pub struct Storage<F> {
    /// The flash.
    pub flash: F,
    /// Where the copies of the page lie.
    pub page: Slots,
    /// Where starts are counted; `None` on a board that cannot write its flash.
    pub counter: Option<BootCounter>,
}

impl<F: NorFlash> Storage<F> {
    /// Reads the page; see [`Page::load`].
    ///
    /// # Errors
    /// [`Refused`].
    pub fn load<const S: usize, const W: usize, const P: usize>(
        &mut self,
        page: &mut Page<S, W, P>,
    ) -> Result<Origin, Refused> {
        page.load(&mut self.flash, self.page)
    }

    /// Reads the page of a robot with a table task; see [`Page::load_task`].
    ///
    /// # Errors
    /// [`Refused`].
    pub fn load_task<const S: usize, const W: usize, const P: usize, L: Copy, const T: usize>(
        &mut self,
        page: &mut Page<S, W, P>,
        tree: &mut TreeReader<'_, L, T>,
    ) -> Result<Origin, Refused> {
        page.load_task(&mut self.flash, self.page, tree)
    }

    /// Takes the epoch of this start: counted, and at least the page's. A board that cannot count
    /// has that of its page, and who loads the page counts.
    ///
    /// # Errors
    /// [`EpochError`]: the robot must not take part.
    pub fn epoch(&mut self, of_page: u32) -> Result<u32, EpochError> {
        match self.counter {
            Some(counter) => counter.count(&mut self.flash, of_page),
            None if of_page > 0 => Ok(of_page),
            None => Err(EpochError::NotCounted),
        }
    }
}
