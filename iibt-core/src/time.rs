//! Instants and durations as integer ticks of the caller's clock.
//!
//! The core owns no clock: every call that depends on time takes an [`Instant`]. What a tick lasts
//! is the caller's choice (the firmware counts milliseconds, the simulator its own steps). The
//! counter may wrap: two instants compare correctly while they are less than 2^31 ticks apart,
//! which is 24 days at 1 kHz.

#[cfg(feature = "inference")]
use serde::{Deserialize, Serialize};

/// A point in time, in ticks since an arbitrary start; wraps at 2^32.
///
/// ```
/// use iibt_core::time::{Duration, Instant};
///
/// let start = Instant(u32::MAX - 1); // the counter wraps two ticks later
/// let deadline = start.after(Duration(5));
/// assert_eq!(deadline, Instant(3));
/// assert!(!Instant(2).has_reached(deadline) && Instant(4).has_reached(deadline));
/// assert_eq!(Instant(4).since(start), Duration(6));
/// assert_eq!(start.since(Instant(4)), Duration(0)); // that is in the future
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "inference", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Instant(pub u32);

/// A length of time in ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "inference", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Duration(pub u32);

impl Instant {
    /// The time passed since `earlier`; zero when `earlier` lies in the future.
    #[must_use]
    pub const fn since(self, earlier: Self) -> Duration {
        let difference = self.0.wrapping_sub(earlier.0);
        Duration(if difference > u32::MAX / 2 { 0 } else { difference })
    }

    /// This instant moved forward by `duration`.
    #[must_use]
    pub const fn after(self, duration: Duration) -> Self {
        Self(self.0.wrapping_add(duration.0))
    }

    /// Whether `deadline` is now or lies in the past.
    #[must_use]
    pub const fn has_reached(self, deadline: Self) -> bool {
        self.0.wrapping_sub(deadline.0) <= u32::MAX / 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_passes_across_the_wrap() {
        let before = Instant(u32::MAX - 4);
        let after = before.after(Duration(10));
        assert_eq!(after, Instant(5));
        assert_eq!(after.since(before), Duration(10));
        assert!(after.has_reached(before));
        assert!(!before.has_reached(after));
    }

    #[test]
    fn the_future_is_no_time_ago() {
        assert_eq!(Instant(3).since(Instant(9)), Duration(0));
    }
}
