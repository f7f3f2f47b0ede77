//! The log by RTT: defmt frames in the memory, where a debug probe reads them.
//!
//! The logger is that of the crate `defmt-rtt`. It never waits for the probe, as the robot would
//! stand still with its motors on when one is pulled: what is not read in time is written over, and
//! the decoder says which frames it cannot read.

#[cfg(target_arch = "arm")]
use super::arm::reset;
#[cfg(target_arch = "riscv32")]
use super::risc_v::reset;
use core::sync::atomic::{AtomicBool, Ordering};
use defmt_rtt as _;

/// Rounds of a loop for a probe to read the last frames before a restart: some 60 ms at 16 MHz.
const READING: u32 = 1_000_000;

static HAS_FAILED: AtomicBool = AtomicBool::new(false);

/// Prepares to log a failure. One that occurs while another is logged restarts the robot at once:
/// the logger refuses a frame within a frame by a panic.
pub(super) fn abandon() {
    // There is one core, and a chip without atomic swaps has loads and stores.
    if HAS_FAILED.load(Ordering::Relaxed) {
        reset();
    }
    HAS_FAILED.store(true, Ordering::Relaxed);
}

/// Gives a probe the time to read the log. There is no waiting for it: there may be none.
pub(super) fn flush() {
    (0..READING).for_each(|_| core::hint::spin_loop());
}
