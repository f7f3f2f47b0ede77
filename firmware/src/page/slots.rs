//! The two copies of a page: which of them counts, and how a new one is written.

use super::source::{Source, Windows};
use super::{CHECKSUM, Fault, HEADER, MAGIC, MAX_PAGE, PageError, Refused, StoreError, VERSION};
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// Where the two copies of a page lie: offsets in the flash, each at the begin of a part that can
/// be erased by itself, with room for [`MAX_PAGE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slots {
    /// The offset of the first copy.
    pub first: u32,
    /// The offset of the second copy.
    pub second: u32,
}

/// One of the two copies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Which {
    /// The first.
    First,
    /// The second.
    Second,
}

impl core::fmt::Display for Which {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::First => "first",
            Self::Second => "second",
        })
    }
}

/// The copy that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Origin {
    /// The copy.
    pub which: Which,
    /// Its generation.
    pub generation: u32,
    /// What is wrong with the other copy, if it is not whole: for the log.
    pub other: Option<PageError>,
}

/// A copy that is whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Whole {
    pub(super) generation: u32,
    /// The length without the checksum.
    pub(super) length: u32,
    checksum: u32,
}

impl Slots {
    /// Those of the STM32F405: sectors 8 and 9 of its flash, of 128 KiB each.
    pub const STM32F405: Self = Self { first: 0x8_0000, second: 0xa_0000 };

    /// Those of the nRF51822: the last two pages of the first 64 KiB of its flash, of 1 KiB each. A
    /// page is no longer there.
    pub const NRF51822: Self = Self { first: 0xf800, second: 0xfc00 };

    /// Those of the nRF52840: the last four pages of its flash, of 4 KiB each.
    pub const NRF52840: Self = Self { first: 0xf_c000, second: 0xf_e000 };

    /// Those of an RP2040 with 2 MiB of flash: its last four sectors, of 4 KiB each.
    pub const RP2040: Self = Self { first: 0x1f_c000, second: 0x1f_e000 };

    /// Those of an ESP32-C3 with 4 MiB of flash: the first four sectors of its last 64 KiB, of 4
    /// KiB each.
    pub const ESP32C3: Self = Self { first: 0x3f_0000, second: 0x3f_2000 };

    /// Returns the copy that counts: the newer of those that are whole.
    pub(super) fn choose(self, flash: &mut dyn Windows) -> Result<(Origin, u32, Whole), Refused> {
        let first = examine(flash, self.first);
        let second = examine(flash, self.second);
        let (which, whole, other) = match (first, second) {
            (Err(first), Err(second)) => return Err(Refused::Both { first, second }),
            (Ok(a), Ok(b)) if a.generation == b.generation && a != b => {
                return Err(Refused::Ambiguous(a.generation));
            }
            (Ok(a), Ok(b)) if b.generation > a.generation => (Which::Second, b, None),
            (Ok(a), other) => (Which::First, a, other.err()),
            (Err(other), Ok(b)) => (Which::Second, b, Some(other)),
        };
        let start = if which == Which::First { self.first } else { self.second };
        Ok((Origin { which, generation: whole.generation, other }, start, whole))
    }
}

/// Reads a copy as a whole: whether it is one, and its checksum.
fn examine(flash: &mut dyn Windows, start: u32) -> Result<Whole, PageError> {
    let mut source = Source::new(flash, start);
    let magic = source.u32();
    if magic != u32::from_le_bytes(MAGIC) {
        // Erased cells read as ones, on some chips and in QEMU as zeros.
        let is_blank = magic == u32::MAX || magic == 0;
        source.refuse(0, if is_blank { Fault::Blank } else { Fault::Magic });
    }
    let version = source.u8();
    if version != VERSION {
        source.refuse(4, Fault::Version(version));
    }
    source.read_from(HEADER - 8, HEADER);
    let (generation, length) = (source.u32(), source.u32());
    if !(HEADER + 4..=MAX_PAGE).contains(&length) {
        source.refuse(HEADER - 4, Fault::Length(length));
    }
    let length = length.saturating_sub(4);
    source.read_from(0, length);
    let mut digest = CHECKSUM.digest();
    while !source.is_at_end() {
        digest.update(&[source.u8()]);
    }
    source.read_from(length, length.saturating_add(4));
    let checksum = source.u32();
    if digest.finalize() != checksum {
        source.refuse(length, Fault::Checksum);
    }
    source.outcome().map(|()| Whole { generation, length, checksum })
}

/// Stores a page that is newer than what the flash has: first in the place of the copy that does
/// not count, then in that of the other.
///
/// When the power is cut, the flash has the page before or the new one, and once the first copy is
/// written, the new one.
///
/// # Errors
/// [`StoreError`]. What was there before still counts, but for [`StoreError::Unwritable`] and
/// [`StoreError::Unverified`] in the second copy, where the new page counts.
pub fn store<F: NorFlash>(flash: &mut F, slots: Slots, page: &[u8]) -> Result<(), StoreError> {
    let new = examine(&mut Bytes(page), 0).map_err(StoreError::Page)?;
    let order = match slots.choose(flash) {
        Ok((Origin { generation, .. }, ..)) | Err(Refused::Ambiguous(generation))
            if generation >= new.generation =>
        {
            return Err(StoreError::NotNewer(generation));
        }
        Ok((Origin { which: Which::First, .. }, ..)) => [slots.second, slots.first],
        _ => [slots.first, slots.second],
    };
    for start in order {
        clear(flash, start)?;
        write(flash, start, page)?;
        match examine(flash, start) {
            Ok(written) if written == new => {}
            Ok(_) => return Err(StoreError::Unverified(PageError { at: 0, fault: Fault::Checksum })),
            Err(error) => return Err(StoreError::Unverified(error)),
        }
    }
    Ok(())
}

/// Erases both copies, and with them the keys.
///
/// # Errors
/// [`StoreError::Unwritable`].
pub fn erase<F: NorFlash>(flash: &mut F, slots: Slots) -> Result<(), StoreError> {
    clear(flash, slots.first)?;
    clear(flash, slots.second)
}

fn clear<F: NorFlash>(flash: &mut F, start: u32) -> Result<(), StoreError> {
    let length = (MAX_PAGE as usize).next_multiple_of(F::ERASE_SIZE.max(1));
    flash.erase(start, start.saturating_add(length as u32)).map_err(|_| StoreError::Unwritable)
}

/// Writes a page in pieces of a multiple of the flash's `WRITE_SIZE`; what is missing in the last
/// one stays erased.
fn write<F: NorFlash>(flash: &mut F, start: u32, page: &[u8]) -> Result<(), StoreError> {
    const PIECE: usize = 64;
    const { assert!(PIECE.is_multiple_of(F::WRITE_SIZE), "a write of a flash is 1 to 64 bytes") }
    let mut at = start;
    for bytes in page.chunks(PIECE) {
        let mut piece = [u8::MAX; PIECE];
        piece.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
        let length = bytes.len().next_multiple_of(F::WRITE_SIZE.max(1));
        let whole = piece.get(..length).ok_or(StoreError::Unwritable)?;
        flash.write(at, whole).map_err(|_| StoreError::Unwritable)?;
        at = at.saturating_add(length as u32);
    }
    Ok(())
}

/// Bytes in memory, read as a flash: erased after their end.
pub(super) struct Bytes<'b>(pub(super) &'b [u8]);

impl ErrorType for Bytes<'_> {
    type Error = core::convert::Infallible;
}

impl ReadNorFlash for Bytes<'_> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        let from = self.0.get(offset as usize..).unwrap_or(&[]);
        bytes.fill(u8::MAX);
        bytes.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
        Ok(())
    }

    fn capacity(&self) -> usize {
        MAX_PAGE as usize
    }
}
