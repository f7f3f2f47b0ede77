//! What a robot does when its program fails, apart from the chip that it runs on: the reason that
//! outlives the reset, and the deadline of the main loop.

use crate::adapters::Absent;
use core::sync::atomic::{AtomicU32, Ordering};
use iibt_core::time::{Duration, Instant};

/// What ended the last run of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// A panic in this line of a file; the log has its name.
    Panic {
        /// The line.
        line: u32,
    },
    /// A fault of the processor.
    Fault {
        /// The address of the instruction.
        at: u32,
    },
    /// The stack ran out.
    StackOverflow,
    /// The main loop had not come round by its deadline.
    Late {
        /// Milliseconds since it last did.
        after: u32,
    },
    /// The hardware watchdog was not fed: the interrupts were off, or the clock stood still.
    Watchdog,
}

impl Failure {
    const fn words(self) -> [u32; 2] {
        match self {
            Self::Panic { line } => [1, line],
            Self::Fault { at } => [2, at],
            Self::StackOverflow => [3, 0],
            Self::Late { after } => [4, after],
            Self::Watchdog => [5, 0],
        }
    }

    const fn of(words: [u32; 2]) -> Option<Self> {
        Some(match words {
            [1, line] => Self::Panic { line },
            [2, at] => Self::Fault { at },
            [3, 0] => Self::StackOverflow,
            [4, after] => Self::Late { after },
            [5, 0] => Self::Watchdog,
            _ => return None,
        })
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for Failure {
    fn format(&self, f: defmt::Formatter<'_>) {
        match self {
            Self::Panic { line } => defmt::write!(f, "a panic in line {=u32}", line),
            Self::Fault { at } => defmt::write!(f, "a fault at {=u32:#010x}", at),
            Self::StackOverflow => defmt::write!(f, "a stack overflow"),
            Self::Late { after } => defmt::write!(f, "a main loop that was late, by now {=u32} ms", after),
            Self::Watchdog => defmt::write!(f, "a reset by the watchdog"),
        }
    }
}

/// The failures in a row after which a robot stands in place of starting again, so that one that
/// fails at each start does not drive in jerks.
pub const MOST_FAILURES: u32 = 5;

/// The time from the start within which a failure is in a row with the one before.
pub const EARLY: Duration = Duration(60_000);

/// Memory for a [`Failure`] and the failures in a row, which neither a reset nor the start of the
/// program writes to.
///
/// What it holds when the power comes on is no failure: the last word has to fit the others.
///
/// ```
/// use firmware::fail_safe::{Failure, FailureRecord};
///
/// static RECORD: FailureRecord = FailureRecord::new(); // the linker's, in an image
///
/// RECORD.put(Failure::Late { after: 120 });
/// assert_eq!(RECORD.take(false), Some((Failure::Late { after: 120 }, 1))); // after the reset
/// RECORD.put(Failure::StackOverflow);
/// assert_eq!(RECORD.take(false), Some((Failure::StackOverflow, 2))); // the second in a row
/// assert_eq!(RECORD.take(false), None); // the chip was reset by hand
/// ```
#[derive(Debug, Default)]
#[repr(C)]
pub struct FailureRecord([AtomicU32; 4]);

impl FailureRecord {
    /// A record of no failure.
    #[must_use]
    pub const fn new() -> Self {
        Self([const { AtomicU32::new(0) }; 4])
    }

    /// Keeps a failure in the place of any other, and counts it.
    pub fn put(&self, failure: Failure) {
        let (_, in_a_row) = self.read();
        self.write(failure.words(), in_a_row.saturating_add(1));
    }

    /// Returns the failure of the last run, with the number of failures in a row, and forgets all
    /// but that number. `by_watchdog` says whether the watchdog has reset the chip: a run that
    /// ended so has kept no reason.
    pub fn take(&self, by_watchdog: bool) -> Option<(Failure, u32)> {
        let (failure, in_a_row) = self.read();
        let unkept = || by_watchdog.then(|| (Failure::Watchdog, in_a_row.saturating_add(1)));
        let taken = failure.map(|failure| (failure, in_a_row)).or_else(unkept);
        self.write([0; 2], taken.map_or(0, |(_, in_a_row)| in_a_row));
        taken
    }

    /// Forgets the failures so far: the program has run for [`EARLY`].
    pub fn settle(&self) {
        self.write([0; 2], 0);
    }

    /// The failure, if there is one, and the number of those in a row.
    fn read(&self) -> (Option<Failure>, u32) {
        let [kind, detail, in_a_row, kept] = self.0.each_ref().map(|word| word.load(Ordering::Relaxed));
        if kept == check([kind, detail, in_a_row]) {
            (Failure::of([kind, detail]), in_a_row)
        } else {
            (None, 0)
        }
    }

    fn write(&self, [kind, detail]: [u32; 2], in_a_row: u32) {
        self.store([kind, detail, in_a_row, check([kind, detail, in_a_row])]);
    }

    fn store(&self, words: [u32; 4]) {
        self.0.iter().zip(words).for_each(|(to, word)| to.store(word, Ordering::Relaxed));
    }
}

/// Differs in many bits for words that differ in one: the multipliers are odd.
const fn check([kind, detail, in_a_row]: [u32; 3]) -> u32 {
    let mixed = kind.wrapping_mul(0x9e37_79b1) ^ detail.rotate_left(16).wrapping_mul(0x85eb_ca77);
    let mixed = mixed ^ in_a_row.rotate_left(8).wrapping_mul(0xc2b2_ae3d);
    !(mixed ^ mixed >> 15)
}

/// The deadline of a main loop, which a timer's interrupt watches.
#[derive(Debug, Default)]
pub struct Deadline {
    /// When the loop last came round.
    fed: AtomicU32,
    /// Zero where nothing is watched.
    limit: AtomicU32,
}

impl Deadline {
    /// A deadline that is not watched.
    #[must_use]
    pub const fn new() -> Self {
        Self { fed: AtomicU32::new(0), limit: AtomicU32::new(0) }
    }

    /// From `now` on, the loop has to come round every `limit`, which is not zero.
    pub fn watch(&self, limit: Duration, now: Instant) {
        self.feed(now);
        self.limit.store(limit.0, Ordering::Relaxed);
    }

    /// The loop has come round.
    pub fn feed(&self, now: Instant) {
        self.fed.store(now.0, Ordering::Relaxed);
    }

    /// Returns the failure of a loop that is late at `now`.
    pub fn check(&self, now: Instant) -> Option<Failure> {
        let limit = self.limit.load(Ordering::Relaxed);
        let after = now.since(Instant(self.fed.load(Ordering::Relaxed))).0;
        (limit > 0 && after > limit).then_some(Failure::Late { after })
    }
}

/// A timer of the chip that resets it when it is not fed.
pub trait Watchdog {
    /// Starts it: from now on it has to be fed every `limit` milliseconds.
    fn start(&mut self, limit: Duration);

    /// Puts the reset off by the limit.
    fn feed(&mut self);
}

/// A chip without a watchdog.
impl Watchdog for Absent {
    fn start(&mut self, _: Duration) {}
    fn feed(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Failure; 5] = [
        Failure::Panic { line: 33 },
        Failure::Fault { at: 0x0800_1234 },
        Failure::StackOverflow,
        Failure::Late { after: u32::MAX },
        Failure::Watchdog,
    ];

    #[test]
    fn a_failure_is_told_once_after_the_reset() {
        let record = FailureRecord::new();
        assert_eq!(record.take(false), None);
        for failure in ALL {
            record.put(failure);
            assert_eq!([record.take(false), record.take(false)], [Some((failure, 1)), None]);
        }
    }

    #[test]
    fn failures_in_a_row_are_counted_until_a_run_lasts_or_somebody_resets_the_chip() {
        let record = FailureRecord::new();
        for (number, failure) in (1..).zip(ALL) {
            let by_watchdog = failure == Failure::Watchdog;
            if !by_watchdog {
                record.put(failure);
            }
            assert_eq!(record.take(by_watchdog), Some((failure, number)));
        }
        record.settle();
        record.put(Failure::StackOverflow);
        assert_eq!(record.take(false), Some((Failure::StackOverflow, 1)), "it has run for a while");
        record.put(Failure::StackOverflow);
        assert_eq!(record.take(true), Some((Failure::StackOverflow, 2)), "the reason that was kept");
        assert_eq!(record.take(false), None, "somebody has reset the chip");
        assert_eq!(record.take(true), Some((Failure::Watchdog, 1)));
    }

    #[test]
    fn memory_with_any_bit_changed_holds_no_failure() {
        for failure in ALL {
            for bit in 0..128 {
                let record = FailureRecord::new();
                record.put(failure);
                record.0[bit / 32].fetch_xor(1 << (bit % 32), Ordering::Relaxed);
                assert_eq!(record.take(false), None, "{failure:?}, bit {bit}");
            }
        }
    }

    #[test]
    fn memory_of_a_chip_that_was_switched_on_holds_no_failure() {
        for fill in [0, u32::MAX, 0x5555_5555, 0xaaaa_aaaa, 0xcccc_cccc, 1, 5] {
            let record = FailureRecord::new();
            record.store([fill; 4]);
            assert_eq!(record.take(false), None, "{fill:#x}");
            record.store([fill; 4]);
            record.put(Failure::StackOverflow);
            assert_eq!(record.take(false), Some((Failure::StackOverflow, 1)), "{fill:#x}");
        }
    }

    #[test]
    fn a_loop_is_late_after_its_limit_and_not_at_it() {
        let deadline = Deadline::new();
        assert_eq!(deadline.check(Instant(9_000_000)), None, "nothing is watched");
        deadline.watch(Duration(100), Instant(u32::MAX - 50));
        assert_eq!(deadline.check(Instant(49)), None);
        assert_eq!(deadline.check(Instant(50)), Some(Failure::Late { after: 101 }));
        deadline.feed(Instant(50));
        assert_eq!(deadline.check(Instant(150)), None);
        assert_eq!(deadline.check(Instant(151)), Some(Failure::Late { after: 101 }));
    }
}
