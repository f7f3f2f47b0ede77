//! A NOR flash in memory, with its rules, whose power can be cut anywhere.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use host_sim::Random;

/// A flash that writes `WRITE` bytes and erases `ERASE` bytes at once.
///
/// A word is written once after it was erased; otherwise the test fails. A write or an erasure that
/// is cut off leaves the bits that it was about to change in any state, and a part whose erasure
/// was cut off must be erased again before it is written, even if it reads as erased.
#[derive(Clone, Debug)]
pub struct PoweredFlash<const WRITE: usize, const ERASE: usize> {
    /// What the cells hold.
    pub bytes: Vec<u8>,
    /// Whether each word may not be written.
    spent: Vec<bool>,
    /// The operations until the power is cut; `None` for never.
    pub power: Option<u32>,
    /// Whether writes are ignored without an error.
    pub is_stuck: bool,
    /// The number of erased parts so far.
    pub erasures: u32,
    random: Random,
}

impl<const WRITE: usize, const ERASE: usize> PoweredFlash<WRITE, ERASE> {
    /// An erased flash of `parts` parts.
    #[must_use]
    pub fn erased(parts: usize, seed: u64) -> Self {
        Self {
            bytes: vec![0xff; parts * ERASE],
            spent: vec![false; parts * ERASE / WRITE],
            power: None,
            is_stuck: false,
            erasures: 0,
            random: Random::new(seed),
        }
    }

    /// Draws the bits that operations leave when they are cut off from another seed.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.random = Random::new(seed);
        self
    }

    /// Takes the power of one operation, if there is some left.
    fn has_power(&mut self) -> bool {
        match &mut self.power {
            Some(0) => false,
            Some(left) => {
                *left -= 1;
                true
            }
            None => true,
        }
    }

    /// Bits of which each is set with a chance that differs from call to call.
    fn some_bits(&mut self) -> u8 {
        let (a, b) = (self.random.bits() as u8, self.random.bits() as u8);
        match self.random.below(5) {
            0 => 0,
            1 => a & b,
            2 => a,
            3 => a | b,
            _ => 0xff,
        }
    }
}

impl<const WRITE: usize, const ERASE: usize> ErrorType for PoweredFlash<WRITE, ERASE> {
    type Error = NorFlashErrorKind;
}

impl<const WRITE: usize, const ERASE: usize> ReadNorFlash for PoweredFlash<WRITE, ERASE> {
    const READ_SIZE: usize = WRITE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        if self.power == Some(0) {
            return Err(NorFlashErrorKind::Other);
        }
        bytes.copy_from_slice(&self.bytes[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl<const WRITE: usize, const ERASE: usize> NorFlash for PoweredFlash<WRITE, ERASE> {
    const WRITE_SIZE: usize = WRITE;
    const ERASE_SIZE: usize = ERASE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to)?;
        for begin in (from as usize..to as usize).step_by(ERASE) {
            if !self.has_power() {
                for at in begin..begin + ERASE {
                    self.bytes[at] |= self.some_bits();
                    self.spent[at / WRITE] = true;
                }
                return Err(NorFlashErrorKind::Other);
            }
            self.bytes[begin..begin + ERASE].fill(0xff);
            self.spent[begin / WRITE..(begin + ERASE) / WRITE].fill(false);
            self.erasures += 1;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        if self.is_stuck {
            return Ok(());
        }
        for (at, word) in (offset as usize..).step_by(WRITE).zip(bytes.chunks(WRITE)) {
            let has_power = self.has_power();
            assert!(!self.spent[at / WRITE], "the word at {at:#x} was not erased");
            for (at, byte) in (at..).zip(word) {
                self.bytes[at] &= if has_power { *byte } else { byte | self.some_bits() };
            }
            self.spent[at / WRITE] = has_power || self.bytes[at..at + WRITE].iter().any(|&byte| byte != 0xff);
            if !has_power {
                return Err(NorFlashErrorKind::Other);
            }
        }
        Ok(())
    }
}
