//! Freshness: how long a teammate's message can be relied on.
//!
//! Age has two limits: past the first, wait for the peer; past the second, do without it.

use crate::time::Duration;
use core::num::NonZero;

/// The freshness of a teammate's last message.
#[doc(alias = "liveness")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Freshness {
    /// Heard at most `fresh_for` ago.
    Fresh,
    /// Heard at most `lost_after` ago: wait for a newer message.
    Stale,
    /// Heard longer ago: continue without the teammate.
    Lost,
    /// Not heard since this robot started.
    Unheard,
}

/// The ages at which a message stops being fresh and its sender is lost.
///
/// ```
/// use iibt_core::team::{Freshness, Limits, LimitsError};
/// use iibt_core::time::Duration;
///
/// let limits = Limits::for_beacons(Duration(100))?; // a frame every 100 ms
/// assert_eq!(limits.freshness(Duration(800)), Freshness::Fresh);
/// assert_eq!(limits.freshness(Duration(801)), Freshness::Stale);
/// assert_eq!(limits.freshness(Duration(1601)), Freshness::Lost);
/// assert_eq!(Limits::new(Duration(9), Duration(8)), Err(LimitsError::Order));
/// # Ok::<(), LimitsError>(())
/// ```
#[doc(alias = "heartbeat")]
#[doc(alias = "failure detector")]
#[doc(alias = "timeout")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Limits {
    fresh_for: Duration,
    lost_after: Duration,
}

/// The reason why limits are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LimitsError {
    /// Lost before it stops being fresh.
    #[error("lost before it stops being fresh")]
    Order,
    /// Longer than [`Limits::LONGEST`].
    #[error("a limit is longer than {} ticks", Limits::LONGEST.0)]
    TooLong,
}

impl Limits {
    /// The longest limit.
    pub const LONGEST: Duration = Duration(1 << 30);

    /// The number of beacons that may be missed in a row before a message is stale: with 30 % of
    /// the frames lost, that happens once in 15,000 times.
    pub const FRESH_BEACONS: u32 = 8;

    /// Limits with two ages: fresh up to and including `fresh_for`, lost after `lost_after`.
    ///
    /// # Errors
    /// [`LimitsError`] when `lost_after` is shorter than `fresh_for` or longer than
    /// [`Limits::LONGEST`].
    pub const fn new(fresh_for: Duration, lost_after: Duration) -> Result<Self, LimitsError> {
        if lost_after.0 < fresh_for.0 {
            return Err(LimitsError::Order);
        }
        if lost_after.0 > Self::LONGEST.0 {
            return Err(LimitsError::TooLong);
        }
        Ok(Self { fresh_for, lost_after })
    }

    /// The limits for robots that send once every `period`: fresh for [`Limits::FRESH_BEACONS`] of
    /// them, lost after twice as many.
    ///
    /// # Errors
    /// [`LimitsError::TooLong`] when that is longer than [`Limits::LONGEST`].
    pub const fn for_beacons(period: Duration) -> Result<Self, LimitsError> {
        let fresh_for = period.0.saturating_mul(Self::FRESH_BEACONS);
        Self::new(Duration(fresh_for), Duration(fresh_for.saturating_mul(2)))
    }

    /// The limits for a period that is never too long: up to 65 seconds on a clock of milliseconds.
    #[must_use]
    pub const fn every(period: NonZero<u16>) -> Self {
        let fresh_for = period.get() as u32 * Self::FRESH_BEACONS;
        Self { fresh_for: Duration(fresh_for), lost_after: Duration(2 * fresh_for) }
    }

    /// The age up to and including which a message is fresh.
    #[must_use]
    pub const fn fresh_for(&self) -> Duration {
        self.fresh_for
    }

    /// The age after which its sender is lost.
    #[must_use]
    pub const fn lost_after(&self) -> Duration {
        self.lost_after
    }

    /// The freshness of a message of this age: never [`Freshness::Unheard`].
    #[must_use]
    pub const fn freshness(&self, age: Duration) -> Freshness {
        if age.0 > self.lost_after.0 {
            Freshness::Lost
        } else if age.0 > self.fresh_for.0 {
            Freshness::Stale
        } else {
            Freshness::Fresh
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_impossible_limits() {
        let limits = |fresh, lost| Limits::new(Duration(fresh), Duration(lost));
        assert!(limits(5, 5).is_ok());
        assert!(limits(6, 1 << 30).is_ok());
        assert_eq!(limits(6, 5), Err(LimitsError::Order));
        assert_eq!(limits(6, (1 << 30) + 1), Err(LimitsError::TooLong));
        assert_eq!(Limits::for_beacons(Duration(100)), limits(800, 1600));
        for period in [1, 100, u16::MAX] {
            let every = Limits::every(NonZero::new(period).unwrap());
            assert_eq!(Limits::for_beacons(Duration(period.into())), Ok(every));
        }
        assert_eq!(Limits::for_beacons(Duration(u32::MAX)), Err(LimitsError::TooLong));
    }
}
