//! The results of a tick and of a halt.

use crate::time::Instant;

/// The outcome of ticking a node. The codes are those of BehaviorTree.CPP, where 0 is idle.
///
/// ```
/// use iibt_core::tree::Status;
///
/// assert_eq!(Status::from(true), Status::Success);
/// assert_eq!(Status::from(false), Status::Failure);
/// assert_eq!([Status::Running as u8, Status::Skipped as u8], [1, 4]);
/// ```
#[doc(alias("result", "NodeStatus", "outcome"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Status {
    /// The node is not finished and wants the next tick.
    Running = 1,
    /// The node has reached its goal.
    Success = 2,
    /// The node cannot reach its goal.
    Failure = 3,
    /// The node does not apply now: its parent goes on as if it were not there.
    Skipped = 4,
}

impl Status {
    /// The index of the row's link that follows: 0 after a success, 1 after a failure, more after
    /// the others.
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

/// Whether an action, or a tree, that was told to stop has stopped.
///
/// An action that needs several ticks to stop answers [`Halt::Pending`] until it has. Until then
/// nothing else is ticked.
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Full, Halt, Leaves, Memory, Next, Status, Tree};
///
/// static DRIVE: Tree<(), 1, Full> = iibt_core::tree! { Action(()) };
///
/// struct Wheels { speed: u8 }
///
/// impl Leaves<()> for Wheels {
///     fn condition(&mut self, _: &(), _: Instant) -> bool { false }
///     fn on_start(&mut self, _: &(), _: Instant) -> Status { self.speed = 3; Status::Running }
///     fn on_running(&mut self, _: &(), _: Instant) -> Status { Status::Running }
///     fn on_halted(&mut self, leaf: &(), now: Instant) -> Halt { self.on_halting(leaf, now) }
///     fn on_halting(&mut self, _: &(), _: Instant) -> Halt {
///         self.speed -= 1;
///         if self.speed == 0 { Halt::Done } else { Halt::Pending }
///     }
/// }
///
/// let (mut wheels, mut memory) = (Wheels { speed: 0 }, Memory::new());
/// DRIVE.tick(&mut memory, &mut wheels, Instant(0));
/// assert_eq!(DRIVE.halt(&mut memory, &mut wheels, Instant(1)), Halt::Pending);
/// let tick = DRIVE.tick(&mut memory, &mut wheels, Instant(2));
/// assert_eq!((tick.status, tick.next), (Status::Running, Next::Now), "it still rolls");
/// assert_eq!(DRIVE.halt(&mut memory, &mut wheels, Instant(3)), Halt::Done);
/// assert_eq!(wheels.speed, 0);
/// ```
#[doc(alias("preempt", "interrupt", "abort", "cancel"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Halt {
    /// The action has stopped.
    Done,
    /// The action has not stopped and is asked again at the next tick.
    Pending,
}

/// The result of a tick of a whole tree.
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Full, Halt, Leaves, Memory, Next, Status, Tick, Tree};
///
/// static BLINK: Tree<bool, 4, Full> = iibt_core::tree! {
///     Sequence { Action(true), Sleep(250), Action(false) }
/// };
///
/// struct Light(bool);
///
/// impl Leaves<bool> for Light {
///     fn condition(&mut self, _: &bool, _: Instant) -> bool { self.0 }
///     fn on_start(&mut self, on: &bool, _: Instant) -> Status { self.0 = *on; Status::Success }
///     fn on_running(&mut self, _: &bool, _: Instant) -> Status { Status::Success }
///     fn on_halted(&mut self, _: &bool, _: Instant) -> Halt { Halt::Done }
/// }
///
/// let (mut light, mut memory) = (Light(false), Memory::new());
/// let tick = BLINK.tick(&mut memory, &mut light, Instant(1000));
/// assert_eq!(tick, Tick { status: Status::Running, next: Next::At(Instant(1250)) });
/// assert!(light.0);
/// let tick = BLINK.tick(&mut memory, &mut light, Instant(1250));
/// assert_eq!(tick, Tick { status: Status::Success, next: Next::Event });
/// assert!(!light.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tick {
    /// The status of the root.
    pub status: Status,
    /// The earliest tick that can change something.
    pub next: Next,
}

/// The time until the next tick can change something, for a controller that sleeps.
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::Next;
///
/// fn milliseconds_to_sleep(next: Next, now: Instant) -> Option<u32> {
///     match next {
///         Next::Now => Some(0),
///         Next::At(due) => Some(due.since(now).0),
///         Next::Event => None, // until an interrupt
///     }
/// }
///
/// assert_eq!(milliseconds_to_sleep(Next::At(Instant(250)), Instant(100)), Some(150));
/// assert_eq!(milliseconds_to_sleep(Next::Now, Instant(100)), Some(0));
/// assert_eq!(milliseconds_to_sleep(Next::Event, Instant(100)), None);
/// ```
#[doc(alias("sleep", "wake up", "deadline"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Next {
    /// At once: a node has yielded, or an action is still stopping.
    Now,
    /// At this time a timer of the tree, or an action that knows when, is due; an event may come
    /// before.
    At(Instant),
    /// After an event that changes what a leaf returns; the tree waits for no time.
    Event,
}
