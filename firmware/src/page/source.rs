//! Reading a copy of a page byte by byte, through a window.

use super::{Fault, MAX_PAGE, PageError};
use embedded_storage::nor_flash::ReadNorFlash;

/// The bytes read at once: a multiple of the `READ_SIZE` of every flash.
const WINDOW: u32 = 64;

/// The bytes of a copy from where the reader is to the end of what it reads.
pub(super) struct Source<'f, F> {
    flash: &'f mut F,
    start: u32,
    at: u32,
    end: u32,
    window: [u8; WINDOW as usize],
    filled: Option<u32>,
}

impl<'f, F: ReadNorFlash> Source<'f, F> {
    /// The copy at an offset of the flash.
    pub(super) const fn new(flash: &'f mut F, start: u32) -> Self {
        Self { flash, start, at: 0, end: MAX_PAGE, window: [0; WINDOW as usize], filled: None }
    }

    pub(super) const fn at(&self) -> u32 {
        self.at
    }

    /// Goes on from `at` and reads no further than `end`.
    pub(super) const fn read_from(&mut self, at: u32, end: u32) {
        (self.at, self.end) = (at, end);
    }

    pub(super) const fn is_at_end(&self) -> bool {
        self.at >= self.end
    }

    pub(super) const fn error(&self, fault: Fault) -> PageError {
        PageError { at: self.at, fault }
    }

    pub(super) fn u8(&mut self) -> Result<u8, PageError> {
        if self.is_at_end() {
            return Err(self.error(Fault::Short));
        }
        let begin = self.at - self.at % WINDOW;
        if self.filled != Some(begin) {
            let read = self.flash.read(self.start.saturating_add(begin), &mut self.window);
            read.map_err(|_| PageError { at: self.at, fault: Fault::Unreadable })?;
            self.filled = Some(begin);
        }
        let byte = self.window.get((self.at % WINDOW) as usize).copied().unwrap_or(0);
        self.at += 1;
        Ok(byte)
    }

    pub(super) fn bytes<const N: usize>(&mut self) -> Result<[u8; N], PageError> {
        let mut bytes = [0; N];
        for byte in &mut bytes {
            *byte = self.u8()?;
        }
        Ok(bytes)
    }

    pub(super) fn u16(&mut self) -> Result<u16, PageError> {
        Ok(u16::from_le_bytes(self.bytes()?))
    }

    pub(super) fn u32(&mut self) -> Result<u32, PageError> {
        Ok(u32::from_le_bytes(self.bytes()?))
    }

    pub(super) fn f32(&mut self) -> Result<f32, PageError> {
        Ok(f32::from_bits(self.u32()?))
    }

    /// A value that must satisfy a condition, with its name.
    pub(super) fn valid<T: Copy>(
        &mut self,
        name: &'static str,
        read: impl FnOnce(&mut Self) -> Result<T, PageError>,
        is_valid: impl FnOnce(T) -> bool,
    ) -> Result<T, PageError> {
        let at = self.at;
        let value = read(self)?;
        if is_valid(value) { Ok(value) } else { Err(PageError { at, fault: Fault::Value(name) }) }
    }
}
