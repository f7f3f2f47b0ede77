//! The upper half of the chip's flash, for what outlives a restart: the page and the boot counter.
//!
//! The driver of the HAL panics where a read is out of bounds or the flash stays locked, so this is
//! a smaller one without a panic. While a sector is erased, up to two seconds, the chip stands
//! still: do it before the robot moves.

use crate::page::Slots;
use crate::{BootCounter, Storage};
use core::ptr;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use stm32f4xx_hal::pac::FLASH;
use stm32f4xx_hal::pac::flash::cr::PSIZE;

/// Where the flash begins in memory.
const BEGIN: usize = 0x0800_0000;

/// The bytes of the flash.
const CAPACITY: usize = 1 << 20;

/// The bytes of a sector, from sector 5 on.
const SECTOR: u32 = 0x2_0000;

/// The first offset that may be erased and written: below lie the image's sectors, by `memory.x`.
const DATA: u32 = 0x8_0000;

/// The flash of the chip; it is written from sector 8 on.
pub struct Flash {
    registers: FLASH,
}

impl Flash {
    /// The flash with the page in sectors 8 and 9, and the count of starts in sectors 10 and 11.
    pub(super) fn storage(registers: FLASH) -> Storage<Self> {
        // A reset locks the controller. QEMU 7.2 has none, and reads as zero there: what it cannot
        // write it cannot count.
        let can_write = registers.cr().read().lock().bit_is_set();
        let counter = can_write.then_some(BootCounter::STM32F405);
        Storage { flash: Self { registers }, page: Slots::STM32F405, counter }
    }

    /// Does `work` with the controller unlocked; returns whether all went well.
    fn unlocked(&mut self, work: impl FnOnce(&FLASH)) -> Result<(), NorFlashErrorKind> {
        let registers = &self.registers;
        for key in [0x4567_0123, 0xcdef_89ab] {
            // SAFETY: these are the keys of the reference manual, RM0090, section 3.6.1.
            #[expect(unsafe_code, reason = "the peripheral crate has no safe call for it")]
            registers.keyr().write(|w| unsafe { w.key().bits(key) });
        }
        // What an earlier operation has left is cleared by writing ones.
        registers.sr().modify(|read, w| {
            // SAFETY: the bits are those that were read.
            #[expect(unsafe_code, reason = "the peripheral crate has no safe call for it")]
            unsafe {
                w.bits(read.bits())
            }
        });
        work(registers);
        self.wait();
        let status = self.registers.sr().read();
        let has_failed = status.pgserr().bit()
            || status.pgperr().bit()
            || status.pgaerr().bit()
            || status.wrperr().bit()
            || status.operr().bit()
            || self.registers.cr().read().lock().bit();
        self.registers.cr().modify(|_, w| w.pg().clear_bit().ser().clear_bit().lock().set_bit());
        self.forget_cached();
        if has_failed { Err(NorFlashErrorKind::Other) } else { Ok(()) }
    }

    fn wait(&self) {
        while self.registers.sr().read().bsy().bit() {}
    }

    /// Empties the data cache, which may hold what was there before. It must be off for that.
    fn forget_cached(&self) {
        let is_on = self.registers.acr().read().dcen().bit();
        self.registers.acr().modify(|_, w| w.dcen().clear_bit());
        self.registers.acr().modify(|_, w| w.dcrst().set_bit());
        self.registers.acr().modify(|_, w| w.dcrst().clear_bit());
        self.registers.acr().modify(|_, w| w.dcen().bit(is_on));
    }
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        for (at, byte) in (BEGIN + offset as usize..).zip(bytes) {
            // SAFETY: the address is inside the flash, which can be read at any time.
            #[expect(unsafe_code, reason = "the flash is read where it lies")]
            unsafe {
                *byte = ptr::read_volatile(at as *const u8);
            }
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        CAPACITY
    }
}

/// A byte at once, which every supply voltage of the chip allows.
impl NorFlash for Flash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = SECTOR as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        if from < DATA {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        for offset in (from..to).step_by(SECTOR as usize) {
            // Sector 5 is the first one of this size, after as much as one of them.
            let sector = (offset / SECTOR + 4) as u8;
            self.unlocked(|registers| {
                registers.cr().modify(|_, w| {
                    // SAFETY: the chip has sectors 0 to 11.
                    #[expect(unsafe_code, reason = "the peripheral crate has no safe call for it")]
                    unsafe {
                        w.snb().bits(sector);
                    }
                    w.psize().variant(PSIZE::Psize8).pg().clear_bit().ser().set_bit()
                });
                registers.cr().modify(|_, w| w.strt().set_bit());
            })?;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        if offset < DATA {
            return Err(NorFlashErrorKind::OutOfBounds);
        }
        self.unlocked(|registers| {
            registers.cr().modify(|_, w| w.psize().variant(PSIZE::Psize8).ser().clear_bit().pg().set_bit());
            for (at, byte) in (BEGIN + offset as usize..).zip(bytes) {
                // SAFETY: the address is inside the upper half of the flash, where no code and no
                // variable lies; the controller takes the byte or reports an error.
                #[expect(unsafe_code, reason = "the flash is written where it lies")]
                unsafe {
                    ptr::write_volatile(at as *mut u8, *byte);
                }
                while registers.sr().read().bsy().bit() {}
            }
        })
    }
}
