//! QEMU's machine `virt` for RISC-V, a board that only the emulator has: the image of the chips on
//! another instruction set, without a floating-point unit.
//!
//! | part | what |
//! |---|---|
//! | UART at 0x1000_0000, source 10 of the interrupt controller | the link to the teammates |
//! | semihosting | the log, as defmt frames |
//! | 0x8020_0000 | the page, which the emulator loads |
//! | nothing | motors, which take their time all the same, battery, LED, watchdog |

use super::clock::{count_millisecond, now};
use super::{Board, Disturbed, Line, LogPort, MappedFlash, Port, begin, mapped};
use crate::adapters::{Absent, Chassis, DifferentialDrive};
use crate::hardware;
use crate::page::Slots;
use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, Ordering::Relaxed};
use iibt_core::time::Instant;
use riscv::interrupt::Interrupt;
use riscv::register::mie;
use semihosting::sys::arm_compat::sys_writec;

/// The link to the teammates.
pub type TeamLink = &'static Line<Uart>;

/// The drive of motors that are not there.
pub type Motors = DifferentialDrive<Absent, Absent, Milliseconds>;

/// The battery gauge.
pub type Gauge = Absent;

/// The memory that the page is loaded into.
pub type Flash = MappedFlash;

/// The status LED.
pub type StatusLed = Absent;

/// The watchdog.
pub type ChipWatchdog = Absent;

/// The first register of a peripheral.
const SOFTWARE_INTERRUPT: usize = 0x0200_0000;
const TIMER_COMPARE: usize = 0x0200_4000;
const TIMER: usize = 0x0200_bff8;
const INTERRUPT_PRIORITY: usize = 0x0c00_0000;
const INTERRUPT_ENABLE: usize = 0x0c00_2000;
const INTERRUPT_CLAIM: usize = 0x0c20_0004;
const FINISHER: usize = 0x0010_0000;
const UART: usize = 0x1000_0000;

/// Cycles of the timer in a millisecond.
const KHZ: u32 = 10_000;

fn register(address: usize) -> &'static AtomicU32 {
    // SAFETY: the constants above are the addresses of registers, of which loads and stores are all
    // that is done.
    #[expect(unsafe_code, reason = "there is no HAL for the machine")]
    unsafe {
        AtomicU32::from_ptr(address as *mut u32)
    }
}

impl Board {
    /// Starts the clock, the log and the link; `None` the second time.
    #[must_use]
    pub fn take(chassis: Chassis) -> Option<Self> {
        static IS_TAKEN: AtomicBool = AtomicBool::new(false);
        if IS_TAKEN.load(Relaxed) {
            return None;
        }
        IS_TAKEN.store(true, Relaxed);
        let clock = Milliseconds;
        clock.await_next();
        LOG.start(Console);
        begin(|| {}, false);
        let link = LINK.start(Uart::start());
        // SAFETY: the handlers are below, and there is no critical section to break.
        #[expect(unsafe_code, reason = "interrupts are enabled for the first time")]
        unsafe {
            mie::set_msoft();
            mie::set_mtimer();
            mie::set_mext();
            riscv::interrupt::enable();
        }
        let drive = DifferentialDrive::new(Absent, Absent, clock, chassis);
        // SAFETY: the machine has RAM there that the image leaves to the page.
        #[expect(unsafe_code, reason = "the page is read where it lies")]
        let storage = unsafe { mapped(0x8020_0000, 0x4000, Slots { first: 0, second: 0x2000 }) };
        Some(Self { link, drive, clock, battery: Absent, storage, led: Absent, watchdog: Absent })
    }
}

/// Waits for an interrupt.
pub(super) fn wait() {
    riscv::asm::wfi();
}

/// A stack that has overflowed is not told from other faults.
pub(super) const fn has_overflowed_stack() -> bool {
    false
}

/// Resets the machine.
pub(super) fn reset() -> ! {
    register(FINISHER).store(0x7777, Relaxed);
    loop {
        core::hint::spin_loop();
    }
}

static LOG: LogPort<Console> = LogPort::new();
static LINK: Line<Uart> = Line::new();

#[riscv_rt::core_interrupt(Interrupt::MachineSoft)]
fn log() {
    register(SOFTWARE_INTERRUPT).store(0, Relaxed);
    LOG.serve();
}

#[riscv_rt::core_interrupt(Interrupt::MachineTimer)]
fn millisecond() {
    Milliseconds.await_next();
    count_millisecond();
}

#[riscv_rt::core_interrupt(Interrupt::MachineExternal)]
fn uart() {
    let source = register(INTERRUPT_CLAIM).load(Relaxed);
    LINK.serve();
    register(INTERRUPT_CLAIM).store(source, Relaxed);
}

/// A clock of one tick per millisecond.
#[derive(Clone, Copy, Debug)]
pub struct Milliseconds;

impl Milliseconds {
    /// Cycles of the timer, of a tenth of a microsecond, modulo 2^32. For differences only.
    #[must_use]
    pub fn cycles(self) -> u32 {
        register(TIMER).load(Relaxed)
    }

    /// Has the timer interrupt in a millisecond.
    fn await_next(self) {
        let [low, high] = [0, 4].map(|half| register(TIMER + half).load(Relaxed));
        let (next, wraps) = low.overflowing_add(KHZ);
        // In this order the deadline lies at no time in the past.
        register(TIMER_COMPARE + 4).store(u32::MAX, Relaxed);
        register(TIMER_COMPARE).store(next, Relaxed);
        register(TIMER_COMPARE + 4).store(high.wrapping_add(u32::from(wraps)), Relaxed);
    }
}

impl hardware::Clock for Milliseconds {
    fn now(&mut self) -> Instant {
        now()
    }
}

/// The port of the log.
pub struct Console;

impl Port for Console {
    fn read(&mut self) -> Option<Result<u8, Disturbed>> {
        None
    }

    fn has_room(&mut self) -> bool {
        true
    }

    fn write(&mut self, byte: u8) {
        sys_writec(byte);
    }

    fn ask_for_room(&mut self, _: bool) {}

    fn pend(&mut self) {
        register(SOFTWARE_INTERRUPT).store(1, Relaxed);
    }
}

/// The port of the link, a 16550.
pub struct Uart;

impl Uart {
    /// Begins to receive: both queues are on, and a received byte interrupts.
    fn start() -> Self {
        Self::register(2).store(1, Relaxed);
        Self::register(1).store(1, Relaxed);
        register(INTERRUPT_PRIORITY + 4 * 10).store(1, Relaxed);
        register(INTERRUPT_ENABLE).store(1 << 10, Relaxed);
        Self
    }

    fn register(number: usize) -> &'static AtomicU8 {
        // SAFETY: as for the others; these are bytes.
        #[expect(unsafe_code, reason = "there is no HAL for the machine")]
        unsafe {
            AtomicU8::from_ptr((UART + number) as *mut u8)
        }
    }
}

impl Port for Uart {
    fn read(&mut self) -> Option<Result<u8, Disturbed>> {
        let status = Self::register(5).load(Relaxed);
        (status & 1 != 0).then(|| {
            let byte = Self::register(0).load(Relaxed);
            if status & 0b1_1110 == 0 { Ok(byte) } else { Err(Disturbed) }
        })
    }

    fn has_room(&mut self) -> bool {
        Self::register(5).load(Relaxed) & 0x20 != 0
    }

    fn write(&mut self, byte: u8) {
        Self::register(0).store(byte, Relaxed);
    }

    fn ask_for_room(&mut self, asks: bool) {
        Self::register(1).store(if asks { 0b11 } else { 0b01 }, Relaxed);
    }

    fn pend(&mut self) {
        self.ask_for_room(true);
    }
}
