//! Time since the start, counted by the SysTick interrupt.

use crate::hardware::Clock;
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_rt::exception;
use iibt_core::time::Instant;
use stm32f4xx_hal::time::Hertz;

static NOW: AtomicU32 = AtomicU32::new(0);

/// A [`Clock`] of one tick per millisecond.
///
/// QEMU 7.2 runs SysTick at the 168 MHz of the chip's PLL, whatever the program selects: there, seven to
/// ten of these milliseconds pass in one.
#[derive(Clone, Copy, Debug)]
pub struct Milliseconds(());

impl Milliseconds {
    pub(super) fn start(mut timer: SYST, core: Hertz) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(core.to_kHz() - 1);
        timer.clear_current();
        timer.enable_counter();
        timer.enable_interrupt();
        Self(())
    }
}

impl Clock for Milliseconds {
    fn now(&mut self) -> Instant {
        Instant(NOW.load(Ordering::Relaxed))
    }
}

#[exception]
fn SysTick() {
    NOW.fetch_add(1, Ordering::Relaxed);
}

defmt::timestamp!("{=u32:ms}", NOW.load(Ordering::Relaxed));
