//! The timers of a tree as BehaviorTree.CPP sees them: one that goes off wakes the tree.
//!
//! There, `tickOnce` goes through the tree once more if a timer has gone off since the last tick
//! and the tree is still running; a wake-up that found no use waits for the next tick. Traces show
//! it, so a dry run does the same. On a robot it is of no use: the tick that a deadline asks for
//! has come already.

use iibt_core::time::{Duration, Instant};
use iibt_core::tree::{Node, Status, StatusChange};

/// The timers of a table's rows.
pub(super) struct Timers {
    timers: Vec<Timer>,
    now: Instant,
    /// Whether a timer has gone off since [`take`](Self::take) was last called.
    pending: bool,
}

#[derive(Clone, Copy)]
struct Timer {
    /// Its duration; `None` for a row that has no timer.
    length: Option<Duration>,
    started: Option<Instant>,
}

impl Timers {
    pub(super) fn new(rows: &[Node<u16>]) -> Self {
        let timers = rows.iter().map(|row| Timer { length: length(row), started: None });
        Self { timers: timers.collect(), now: Instant(0), pending: false }
    }

    /// Advances the time to `now`.
    pub(super) fn advance(&mut self, now: Instant) {
        self.now = now;
        for timer in &mut self.timers {
            if let (Some(length), Some(started)) = (timer.length, timer.started)
                && now.has_reached(started.after(length))
            {
                timer.started = None;
                self.pending = true;
            }
        }
    }

    /// Returns whether a timer has gone off since the last call.
    pub(super) fn take(&mut self) -> bool {
        std::mem::take(&mut self.pending)
    }

    /// A timer runs from when its node begins to run until it goes off or the node ends.
    pub(super) fn note(&mut self, transition: &StatusChange) {
        if let Some(timer) = self.timers.get_mut(usize::from(transition.node)) {
            timer.started = (transition.to == Some(Status::Running)).then_some(self.now);
        }
    }
}

fn length(row: &Node<u16>) -> Option<Duration> {
    match row {
        Node::Sleep(length) | Node::Delay(length) | Node::Timeout(length) if length.get() > 0 => {
            Some(Duration(length.get()))
        }
        _ => None,
    }
}
