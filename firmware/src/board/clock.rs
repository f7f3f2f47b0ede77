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
/// QEMU 7.2 runs SysTick at the 168 MHz of the chip's PLL, whatever the program selects: there,
/// seven to ten of these milliseconds pass in one.
#[derive(Clone, Copy, Debug)]
pub struct Milliseconds {
    cycles_per_tick: u32,
}

impl Milliseconds {
    pub(super) fn start(mut timer: SYST, core: Hertz) -> Self {
        let cycles_per_tick = core.to_kHz();
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(cycles_per_tick - 1);
        timer.clear_current();
        timer.enable_counter();
        timer.enable_interrupt();
        Self { cycles_per_tick }
    }

    /// Cycles of the timer's clock since the start, modulo 2^32: the core's own on hardware. For
    /// differences only.
    #[must_use]
    pub fn cycles(self) -> u32 {
        loop {
            let before = NOW.load(Ordering::Relaxed);
            let counted = self.cycles_per_tick.wrapping_sub(SYST::get_current());
            if NOW.load(Ordering::Relaxed) == before {
                return before.wrapping_mul(self.cycles_per_tick).wrapping_add(counted);
            }
        }
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
