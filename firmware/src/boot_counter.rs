//! The count of a robot's starts in its flash: its epoch.
//!
//! Two parts of the flash are filled with entries, one for each start. An entry is the count and
//! its complement, so one that a cut-off write or erasure has left is never taken for another:
//! writing clears bits and erasing sets them, and either leaves a pair of equal bits. When a part
//! is full, the other is erased. The greatest count counts, wherever it is.
//!
//! The epoch is taken when it is written and reads back, and not before: a robot whose count cannot
//! be written must not take part.

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use thiserror::Error;

/// The bytes of a count and its complement.
const COUNT: u32 = 8;

/// The bytes read at once, and the largest write of a flash.
const WINDOW: u32 = 64;

/// Where the starts of a robot are counted: two parts of a flash of `length` bytes each, which is a
/// multiple of its `ERASE_SIZE`.
///
/// A part of 4 KiB with writes of up to 8 bytes has 512 entries, so it is erased once in 1,024
/// starts.
///
/// ```
/// use firmware::{BootCounter, EpochError};
/// # use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
/// # struct Flash([u8; 256]);
/// # impl ErrorType for Flash { type Error = core::convert::Infallible; }
/// # impl ReadNorFlash for Flash {
/// #     const READ_SIZE: usize = 1;
/// #     fn read(&mut self, at: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
/// #         bytes.copy_from_slice(&self.0[at as usize..][..bytes.len()]); Ok(())
/// #     }
/// #     fn capacity(&self) -> usize { 256 }
/// # }
/// # impl NorFlash for Flash {
/// #     const WRITE_SIZE: usize = 4;
/// #     const ERASE_SIZE: usize = 128;
/// #     fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
/// #         self.0[from as usize..to as usize].fill(0xff); Ok(())
/// #     }
/// #     fn write(&mut self, at: u32, bytes: &[u8]) -> Result<(), Self::Error> {
/// #         self.0[at as usize..][..bytes.len()].copy_from_slice(bytes); Ok(())
/// #     }
/// # }
/// # let mut flash = Flash([0xff; 256]);
/// const COUNTER: BootCounter = BootCounter { first: 0, second: 128, length: 128 };
///
/// assert_eq!(COUNTER.count(&mut flash, 0)?, 1); // the first start
/// assert_eq!(COUNTER.count(&mut flash, 0)?, 2);
/// assert_eq!(COUNTER.count(&mut flash, 40)?, 40); // the page says that 39 were taken
/// assert_eq!(COUNTER.count(&mut flash, 40)?, 41);
/// # Ok::<(), EpochError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[doc(alias = "boot count")]
#[doc(alias = "wear levelling")]
pub struct BootCounter {
    /// The offset of the first part.
    pub first: u32,
    /// The offset of the second part.
    pub second: u32,
    /// The bytes of each part.
    pub length: u32,
}

/// Why a start has no epoch: the robot must not take part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EpochError {
    /// The flash cannot be read.
    #[error("the flash of the boot counter cannot be read")]
    Unreadable,
    /// The flash cannot be erased or written, or reads otherwise than it was written.
    #[error("the flash of the boot counter cannot be written")]
    Unwritable,
    /// Both parts are written, but with no count: erase them, and give a page with an epoch above
    /// those taken.
    #[error("the flash of the boot counter has no count")]
    Lost,
    /// All epochs are used.
    #[error("all epochs are used")]
    Exhausted,
    /// This board cannot count, and the page gives no epoch.
    #[error("this board cannot count its starts, and its page gives no epoch")]
    NotCounted,
}

/// What a part has.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    /// The greatest count.
    newest: Option<u32>,
    /// The entries written without a count, since the greatest one.
    torn: u32,
    /// The entries up to and with the last one that is written.
    used: u32,
}

impl BootCounter {
    /// That of the STM32F405: sectors 10 and 11 of its flash, of 128 KiB each.
    pub const STM32F405: Self = Self { first: 0xc_0000, second: 0xe_0000, length: 0x2_0000 };

    /// That of an ESP32-C3 with 4 MiB of flash: the two sectors of 4 KiB after its page.
    pub const ESP32C3: Self = Self { first: 0x3f_4000, second: 0x3f_5000, length: 0x1000 };

    /// Counts a start, and returns its epoch: at least `least`, and greater than all before.
    ///
    /// Reads both parts, writes one entry and reads that again; a full part costs an erasure.
    ///
    /// # Errors
    /// [`EpochError`]. No epoch was taken then.
    pub fn count<F: NorFlash>(self, flash: &mut F, least: u32) -> Result<u32, EpochError> {
        let [first, second] =
            [part::<F>(flash, self.first, self.length)?, part::<F>(flash, self.second, self.length)?];
        let is_second = second.newest > first.newest;
        let (at, active, other) =
            if is_second { (self.second, second, first) } else { (self.first, first, second) };
        if active.newest.is_none() && other.used > 0 {
            return Err(EpochError::Lost);
        }
        // An entry that cannot be read any more may be an epoch that was taken.
        let torn = active.torn + if other.newest.is_none() { other.torn } else { 0 };
        let before = active.newest.unwrap_or(0).saturating_add(torn);
        let epoch = before.saturating_add(1).max(least);
        if epoch == u32::MAX {
            return Err(EpochError::Exhausted);
        }
        let place = if active.used < self.length / entry::<F>() {
            at + active.used * entry::<F>()
        } else {
            let other = if is_second { self.first } else { self.second };
            flash.erase(other, other.saturating_add(self.length)).map_err(|_| EpochError::Unwritable)?;
            other
        };
        write(flash, place, epoch)?;
        Ok(epoch)
    }
}

/// The bytes between two entries: a count, or what the flash writes at once if that is more.
const fn entry<F: NorFlash>() -> u32 {
    const {
        assert!(
            (WINDOW as usize).is_multiple_of(F::WRITE_SIZE),
            "a write of a flash is 1 to 64 bytes, a power of two"
        );
        if F::WRITE_SIZE > COUNT as usize { F::WRITE_SIZE as u32 } else { COUNT }
    }
}

/// Reads a part of the flash.
fn part<F: NorFlash>(flash: &mut F, start: u32, length: u32) -> Result<Part, EpochError> {
    let mut part = Part::default();
    let mut window = [0; WINDOW as usize];
    for begin in (0..length).step_by(WINDOW as usize) {
        flash.read(start.saturating_add(begin), &mut window).map_err(|_| EpochError::Unreadable)?;
        for (number, bytes) in (begin / entry::<F>()..).zip(window.chunks_exact(entry::<F>() as usize)) {
            if bytes.iter().all(|&byte| byte == u8::MAX) {
                continue;
            }
            part.used = number.saturating_add(1);
            match count_in(bytes) {
                Some(count) if part.newest < Some(count) => (part.newest, part.torn) = (Some(count), 0),
                Some(_) => {}
                None => part.torn = part.torn.saturating_add(1),
            }
        }
    }
    Ok(part)
}

/// The count of an entry, if it has one.
fn count_in(entry: &[u8]) -> Option<u32> {
    let (count, rest) = entry.split_first_chunk::<4>()?;
    let (complement, _) = rest.split_first_chunk::<4>()?;
    let count = u32::from_le_bytes(*count);
    (u32::from_le_bytes(*complement) == !count).then_some(count)
}

/// Writes an entry and reads it again.
fn write<F: NorFlash>(flash: &mut F, place: u32, count: u32) -> Result<(), EpochError> {
    let mut bytes = [u8::MAX; WINDOW as usize];
    let pair = u64::from(count) | u64::from(!count) << 32;
    bytes.iter_mut().zip(pair.to_le_bytes()).for_each(|(to, from)| *to = from);
    let bytes = bytes.get(..entry::<F>() as usize).unwrap_or(&[]);
    flash.write(place, bytes).map_err(|_| EpochError::Unwritable)?;
    let begin = place - place % WINDOW;
    let mut window = [0; WINDOW as usize];
    ReadNorFlash::read(flash, begin, &mut window).map_err(|_| EpochError::Unreadable)?;
    let written = window.get((place % WINDOW) as usize..).and_then(count_in);
    if written == Some(count) { Ok(()) } else { Err(EpochError::Unwritable) }
}
