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

/// Memory for a [`Failure`] that neither a reset nor the start of the program writes to.
///
/// What it holds when the power comes on is no failure: the third word has to fit the first two.
///
/// ```
/// use firmware::fail_safe::{Failure, FailureRecord};
///
/// static RECORD: FailureRecord = FailureRecord::new(); // the linker's, in an image
///
/// RECORD.put(Failure::Late { after: 120 });
/// assert_eq!(RECORD.take(), Some(Failure::Late { after: 120 })); // after the reset
/// assert_eq!(RECORD.take(), None); // told once
/// ```
#[derive(Debug, Default)]
#[repr(C)]
pub struct FailureRecord([AtomicU32; 3]);

impl FailureRecord {
    /// A record of no failure.
    #[must_use]
    pub const fn new() -> Self {
        Self([const { AtomicU32::new(0) }; 3])
    }

    /// Keeps a failure in the place of any other.
    pub fn put(&self, failure: Failure) {
        let [kind, detail] = failure.words();
        self.store([kind, detail, check(kind, detail)]);
    }

    /// Returns the failure of the last run, and forgets it.
    pub fn take(&self) -> Option<Failure> {
        let [kind, detail, kept] = self.0.each_ref().map(|word| word.load(Ordering::Relaxed));
        self.store([0; 3]);
        Failure::of([kind, detail]).filter(|_| kept == check(kind, detail))
    }

    fn store(&self, words: [u32; 3]) {
        self.0.iter().zip(words).for_each(|(to, word)| to.store(word, Ordering::Relaxed));
    }
}

/// Differs in many bits for words that differ in one: the multipliers are odd.
const fn check(kind: u32, detail: u32) -> u32 {
    let mixed = kind.wrapping_mul(0x9e37_79b1) ^ detail.rotate_left(16).wrapping_mul(0x85eb_ca77);
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
        assert_eq!(record.take(), None);
        for failure in ALL {
            record.put(Failure::Watchdog);
            record.put(failure);
            assert_eq!([record.take(), record.take()], [Some(failure), None]);
        }
    }

    #[test]
    fn memory_with_any_bit_changed_holds_no_failure() {
        for failure in ALL {
            for bit in 0..96 {
                let record = FailureRecord::new();
                record.put(failure);
                record.0[bit / 32].fetch_xor(1 << (bit % 32), Ordering::Relaxed);
                assert_eq!(record.take(), None, "{failure:?}, bit {bit}");
            }
        }
    }

    #[test]
    fn memory_of_a_chip_that_was_switched_on_holds_no_failure() {
        for fill in [0, u32::MAX, 0x5555_5555, 0xaaaa_aaaa, 0xcccc_cccc, 1, 5] {
            let record = FailureRecord::new();
            record.store([fill; 3]);
            assert_eq!(record.take(), None, "{fill:#x}");
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
