//! What a tick comes to, and a halt.

use crate::time::Instant;

/// The outcome of ticking a node. The codes are those of BehaviorTree.CPP, where 0 is idle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Status {
    /// It is not finished and wants the next tick.
    Running = 1,
    /// It has reached what it is for.
    Success = 2,
    /// It cannot reach what it is for.
    Failure = 3,
    /// It does not apply now: its parent goes on as if it were not there.
    Skipped = 4,
}

impl Status {
    /// Which of a row's links follows: 0 after a success, 1 after a failure, more after the others.
    pub(super) const fn end(self) -> usize {
        (self as usize).wrapping_sub(Self::Success as usize)
    }

    /// The status with this [`end`](Self::end).
    pub(super) const fn of_end(end: usize) -> Self {
        match end {
            0 => Self::Success,
            1 => Self::Failure,
            2 => Self::Skipped,
            _ => Self::Running,
        }
    }

    /// Success for failure and failure for success; the others as they are.
    pub(super) const fn inverted(self) -> Self {
        match self {
            Self::Success => Self::Failure,
            Self::Failure => Self::Success,
            other => other,
        }
    }
}

impl From<bool> for Status {
    /// Success for `true`, failure for `false`.
    fn from(holds: bool) -> Self {
        if holds { Self::Success } else { Self::Failure }
    }
}

/// Whether something that was told to stop has stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Halt {
    /// It has.
    Done,
    /// Not yet: it wants to be asked again at the next tick.
    Pending,
}

/// What a tick came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tick {
    /// The status of the root.
    pub status: Status,
    /// When the next tick can change something.
    pub next: Next,
}

/// When ticking again can change something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Next {
    /// At once: a node has yielded, or an action is still stopping.
    Now,
    /// At this time a timer of the tree, or an action that knows when, is due; an event may come before.
    At(Instant),
    /// When a leaf has something new to say; the tree waits for no time.
    Event,
}
