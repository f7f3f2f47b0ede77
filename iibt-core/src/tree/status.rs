//! What comes of a tick, and of a halt.

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
