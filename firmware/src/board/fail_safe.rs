//! The end of a program that fails: the motors are stopped, the reason is kept and logged, and the
//! chip is reset.

#[cfg(target_arch = "arm")]
use super::arm::{reset, sleep};
use super::clock::now;
use super::log;
#[cfg(target_arch = "riscv32")]
use super::risc_v::{reset, sleep};
use super::shared::Shared;
use crate::fail_safe::{Deadline, EARLY, Failure, FailureRecord, MOST_FAILURES, Watchdog};
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicU32, Ordering};
use iibt_core::time::Duration;

#[expect(unsafe_code, reason = "a place that only the linker knows")]
// SAFETY: the memory map reserves the words there for nothing else, and any words are a record.
unsafe extern "C" {
    /// The memory that a reset leaves as it is; see the memory maps in `firmware/boards`.
    safe static _failure_record: FailureRecord;
}

static DEADLINE: Deadline = Deadline::new();

/// The failures in a row before this start.
static FAILURES: AtomicU32 = AtomicU32::new(0);

/// What stops the motors.
static CUT: Shared<Option<fn()>> = Shared::new(None);

/// Within how many milliseconds the main loop of a robot has to come round: some ticks of the
/// controller, and less than the hardware watchdog waits.
pub const LATEST: Duration = Duration(500);

/// How long the hardware watchdog waits: longer than it takes to send a full log, 178 ms.
const WATCHDOG: Duration = Duration(600);

/// Tells the board what stops its motors, whatever the program does after it, and logs why the last
/// run ended. `by_watchdog` says whether the hardware watchdog has reset the chip.
///
/// `cut` is called from interrupts and faults, in the middle of anything: it writes registers that
/// the drive does not, and only a reset undoes it.
pub fn begin(cut: fn(), by_watchdog: bool) {
    CUT.with(|slot| *slot = Some(cut));
    if let Some((failure, in_a_row)) = _failure_record.take(by_watchdog) {
        FAILURES.store(in_a_row, Ordering::Relaxed);
        defmt::error!("restarted after {}", failure);
    }
}

/// A watch over the main loop of a program, which has to [`feed`](Self::feed) it.
///
/// A loop that is late has its motors stopped by the interrupt that counts milliseconds, and the
/// robot is restarted. Where not even that interrupt runs, the hardware watchdog resets the chip.
#[derive(Debug)]
pub struct Guard<W>(W);

impl<W: Watchdog> Guard<W> {
    /// Watches from now on a loop that comes round every `limit` milliseconds.
    ///
    /// It does not return after [`MOST_FAILURES`] failures in a row, each within [`EARLY`] of a
    /// start: the robot stands until the chip is reset by hand.
    pub fn start(mut watchdog: W, limit: Duration) -> Self {
        let failures = FAILURES.load(Ordering::Relaxed);
        if failures >= MOST_FAILURES {
            defmt::error!("stands: failed {=u32} times in a row", failures);
            stay(watchdog);
        }
        watchdog.start(WATCHDOG);
        DEADLINE.watch(limit, now());
        Self(watchdog)
    }

    /// Tells that the loop has come round.
    pub fn feed(&mut self) {
        DEADLINE.feed(now());
        self.0.feed();
    }
}

/// Stays where it is, with the motors off, until the chip is reset. A watchdog that outlives a
/// restart is fed.
pub(super) fn stay(mut watchdog: impl Watchdog) -> ! {
    stop_motors();
    loop {
        watchdog.feed();
        sleep();
    }
}

/// Ends the program if its loop is late. The interrupt that counts milliseconds calls this.
pub(super) fn check_deadline() {
    if now().0 == EARLY.0 {
        _failure_record.settle();
    }
    if let Some(failure) = DEADLINE.check(now()) {
        fail(failure, || {});
    }
}

/// Stops the motors, keeps the reason, logs it as `tell` does, and restarts the robot.
pub(super) fn fail(failure: Failure, tell: impl FnOnce()) -> ! {
    stop_motors();
    _failure_record.put(failure);
    log::abandon();
    tell();
    defmt::error!("fails: {}", failure);
    restart()
}

/// Sends the rest of the log and resets the chip, with the motors stopped.
pub fn restart() -> ! {
    stop_motors();
    log::flush();
    reset()
}

/// Stops the motors until the chip is reset.
pub fn stop_motors() {
    if let Some(Some(cut)) = CUT.with(|cut| *cut) {
        cut();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let line = info.location().map_or(0, |location| location.line());
    fail(Failure::Panic { line }, || defmt::error!("{}", defmt::Display2Format(info)))
}
