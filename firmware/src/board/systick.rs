//! Milliseconds from the core's own timer.

use super::clock::{count_millisecond, now};
use crate::hardware::Clock;
use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_rt::exception;
use iibt_core::time::Instant;

/// A [`Clock`] of one tick per millisecond.
///
/// QEMU 7.2 runs SysTick at the 168 MHz of the STM32F405's PLL, whatever the program selects:
/// there, seven to ten of these milliseconds pass in one.
#[derive(Clone, Copy, Debug)]
pub struct Milliseconds {
    cycles_per_tick: u32,
}

impl Milliseconds {
    /// Starts the timer of a core of this many kHz.
    #[must_use]
    pub fn start(mut timer: SYST, core_khz: u32) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(core_khz.saturating_sub(1));
        timer.clear_current();
        timer.enable_counter();
        timer.enable_interrupt();
        Self { cycles_per_tick: core_khz }
    }

    /// Cycles of the timer's clock since the start, modulo 2^32: the core's own on hardware. For
    /// differences only.
    #[must_use]
    pub fn cycles(self) -> u32 {
        loop {
            let before = now();
            let counted = self.cycles_per_tick.wrapping_sub(SYST::get_current());
            if now() == before {
                return before.0.wrapping_mul(self.cycles_per_tick).wrapping_add(counted);
            }
        }
    }
}

impl Clock for Milliseconds {
    fn now(&mut self) -> Instant {
        now()
    }
}

#[exception]
fn SysTick() {
    count_millisecond();
}
