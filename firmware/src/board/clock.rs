//! Time since the start, in milliseconds.

use super::fail_safe::check_deadline;
use super::shared::Shared;
use core::future::poll_fn;
use core::sync::atomic::{AtomicU32, Ordering};
use core::task::{Poll, Waker};
use iibt_core::time::Instant;

static NOW: AtomicU32 = AtomicU32::new(0);

/// The task that waits for the next millisecond.
static WAITING: Shared<Option<Waker>> = Shared::new(None);

/// Counts a millisecond, and restarts a robot whose main loop is late. The interrupt of a board's
/// timer calls this.
pub fn count_millisecond() {
    // There is one writer, and a chip without atomic additions has loads and stores.
    NOW.store(NOW.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
    if let Some(waker) = WAITING.with(Option::take).flatten() {
        waker.wake();
    }
    check_deadline();
}

/// The milliseconds that were counted.
#[must_use]
pub fn now() -> Instant {
    Instant(NOW.load(Ordering::Relaxed))
}

/// Waits for the next millisecond. One task at a time is woken.
pub async fn next_millisecond() {
    let since = now();
    poll_fn(|context| {
        WAITING.with(|waiting| *waiting = Some(context.waker().clone()));
        if now() == since { Poll::Pending } else { Poll::Ready(()) }
    })
    .await;
}

defmt::timestamp!("{=u32:ms}", now().0);
