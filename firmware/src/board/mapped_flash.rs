//! A flash that the chip reads like memory, without a driver that writes it.

use crate::Storage;
use crate::page::Slots;
use core::ptr;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_read};

/// The flash of a board that reads its page, and counts no starts: its page gives the epoch.
#[derive(Debug)]
pub struct MappedFlash {
    begin: usize,
    capacity: usize,
}

/// The flash from an address on, with the page of the robot at these offsets.
///
/// # Safety
/// The `capacity` bytes from `begin` on can be read at any time.
#[expect(unsafe_code, reason = "only the board knows where its flash lies")]
#[must_use]
pub const unsafe fn mapped(begin: usize, capacity: usize, page: Slots) -> Storage<MappedFlash> {
    Storage { flash: MappedFlash { begin, capacity }, page, counter: None }
}

impl ErrorType for MappedFlash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for MappedFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        for (at, byte) in (self.begin + offset as usize..).zip(bytes) {
            // SAFETY: the address is inside the flash, as the caller of `mapped` has promised.
            #[expect(unsafe_code, reason = "the flash is read where it lies")]
            unsafe {
                *byte = ptr::read_volatile(at as *const u8);
            }
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.capacity
    }
}

/// Nothing is written.
impl NorFlash for MappedFlash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = 4096;

    fn erase(&mut self, _: u32, _: u32) -> Result<(), NorFlashErrorKind> {
        Err(NorFlashErrorKind::Other)
    }

    fn write(&mut self, _: u32, _: &[u8]) -> Result<(), NorFlashErrorKind> {
        Err(NorFlashErrorKind::Other)
    }
}
