//! What a robot keeps of its tree's ticks for the log.

use iibt_core::time::Instant;
use iibt_core::tree::StatusChange;
#[cfg(feature = "explain")]
use iibt_core::tree::{TickEntry, TickLog};

/// The changes of a tick that are logged; the tree of a navigator has fewer nodes.
#[cfg(feature = "explain")]
const CHANGES: usize = 8;

/// The log of a tree's ticks. Without the feature `explain` it holds nothing and costs nothing.
#[derive(Clone, Debug)]
pub(crate) struct TreeTrace {
    #[cfg(feature = "explain")]
    log: TickLog<CHANGES>,
}

impl TreeTrace {
    pub(crate) const fn new() -> Self {
        Self {
            #[cfg(feature = "explain")]
            log: TickLog::new(),
        }
    }
}

#[cfg(feature = "explain")]
impl TreeTrace {
    pub(crate) fn record(&mut self, change: StatusChange) {
        self.log.record(change);
    }

    pub(crate) fn end_tick(&mut self, now: Instant) {
        self.log.end_tick(now);
    }

    pub(crate) fn entry(&self) -> Option<TickEntry<'_>> {
        self.log.entry()
    }
}

#[cfg(not(feature = "explain"))]
impl TreeTrace {
    pub(crate) const fn record(&mut self, _: StatusChange) {}

    pub(crate) const fn end_tick(&mut self, _: Instant) {}
}
