//! Reading a copy of a page value by value, through a window.

use super::{Fault, MAX_PAGE, PageError};
use embedded_storage::nor_flash::ReadNorFlash;

/// The bytes read at once: a multiple of the `READ_SIZE` of every flash.
const WINDOW: u32 = 64;

type Window = [u8; WINDOW as usize];

/// A flash of any type, so that the reader is there once.
pub(super) trait Windows {
    /// Reads a window; returns whether the flash could be read.
    fn read_window(&mut self, offset: u32, window: &mut Window) -> bool;
}

impl<F: ReadNorFlash> Windows for F {
    fn read_window(&mut self, offset: u32, window: &mut Window) -> bool {
        self.read(offset, window).is_ok()
    }
}

/// The bytes of a copy from where the reader is to the end of what it reads.
///
/// The first fault stays: from then on every value reads as zero, and nothing is left to read. So a
/// reader goes on to its end, and asks [`outcome`](Self::outcome) once.
pub(super) struct Source<'f> {
    flash: &'f mut dyn Windows,
    start: u32,
    at: u32,
    end: u32,
    /// Where the last value began.
    value: u32,
    window: Window,
    filled: Option<u32>,
    outcome: Result<(), PageError>,
}

impl<'f> Source<'f> {
    /// The copy at an offset of the flash.
    pub(super) const fn new(flash: &'f mut dyn Windows, start: u32) -> Self {
        let window = [0; WINDOW as usize];
        Self { flash, start, at: 0, end: MAX_PAGE, value: 0, window, filled: None, outcome: Ok(()) }
    }

    pub(super) const fn at(&self) -> u32 {
        self.at
    }

    /// Goes on from `at` and reads no further than `end`.
    pub(super) const fn read_from(&mut self, at: u32, end: u32) {
        (self.at, self.end) = (at, end);
    }

    pub(super) const fn is_at_end(&self) -> bool {
        self.at >= self.end || self.outcome.is_err()
    }

    /// Whether all was well.
    ///
    /// # Errors
    /// The first fault.
    pub(super) const fn outcome(&self) -> Result<(), PageError> {
        self.outcome
    }

    /// Notes a fault at this byte, unless there was one before.
    #[inline(never)]
    pub(super) fn refuse(&mut self, at: u32, fault: Fault) {
        self.outcome = self.outcome.and(Err(PageError { at, fault }));
    }

    /// Notes a fault at the last value, by its name, unless it satisfies its condition.
    pub(super) fn require(&mut self, name: &'static str, is_valid: bool) {
        if !is_valid {
            self.refuse(self.value, Fault::Value(name));
        }
    }

    fn byte(&mut self) -> u8 {
        if self.is_at_end() {
            self.refuse(self.at, Fault::Short);
            return 0;
        }
        let begin = self.at - self.at % WINDOW;
        if self.filled != Some(begin) {
            if !self.flash.read_window(self.start.saturating_add(begin), &mut self.window) {
                self.refuse(self.at, Fault::Unreadable);
                return 0;
            }
            self.filled = Some(begin);
        }
        let byte = self.window.get((self.at % WINDOW) as usize).copied().unwrap_or(0);
        self.at += 1;
        byte
    }

    /// A number of up to four bytes.
    #[inline(never)]
    fn number(&mut self, bytes: u32) -> u32 {
        self.value = self.at;
        let number = (0..bytes).fold(0, |number, place| number | u32::from(self.byte()) << (8 * place));
        if self.outcome.is_ok() { number } else { 0 }
    }

    pub(super) fn u8(&mut self) -> u8 {
        self.number(1) as u8
    }

    pub(super) fn u16(&mut self) -> u16 {
        self.number(2) as u16
    }

    pub(super) fn u32(&mut self) -> u32 {
        self.number(4)
    }

    pub(super) fn f32(&mut self) -> f32 {
        f32::from_bits(self.number(4))
    }
}
