//! Time since the start, in milliseconds.

use core::sync::atomic::{AtomicU32, Ordering};
use iibt_core::time::Instant;

static NOW: AtomicU32 = AtomicU32::new(0);

/// Counts a millisecond. The interrupt of a board's timer calls this.
pub fn count_millisecond() {
    // There is one writer, and a chip without atomic additions has loads and stores.
    NOW.store(NOW.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
}

/// The milliseconds that were counted.
#[must_use]
pub fn now() -> Instant {
    Instant(NOW.load(Ordering::Relaxed))
}

defmt::timestamp!("{=u32:ms}", now().0);
