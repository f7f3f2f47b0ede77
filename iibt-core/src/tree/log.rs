//! The log of status changes, for a host to replay.

use super::status::Status;
use crate::time::Instant;

/// A change of a node's status; 8 bytes.
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Status, StatusChange};
///
/// let (time, to) = (Instant(1002), Some(Status::Success));
/// let transition = StatusChange { time, node: 4, from: Some(Status::Running), to };
/// // 2 ms are 2000 us, 0x07D0; BehaviorTree.CPP numbers the same node 5.
/// assert_eq!(transition.btlog(Instant(1000)), [0xD0, 0x07, 0, 0, 0, 0, 5, 0, 2]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StatusChange {
    /// The time of the tick or halt.
    pub time: Instant,
    /// The node's row in the table, from zero: the unique identifier of BehaviorTree.CPP less one.
    pub node: u16,
    /// The status before; `None` is idle.
    pub from: Option<Status>,
    /// The status after; `None` is idle.
    pub to: Option<Status>,
}

impl StatusChange {
    /// The record of BehaviorTree.CPP's `.btlog` files.
    ///
    /// It has 6 bytes of microseconds since `start` and 2 of the unique identifier, least
    /// significant first, and the code of the status.
    ///
    /// Times count as milliseconds; the file can tell 49 days apart.
    #[must_use]
    pub const fn btlog(&self, start: Instant) -> [u8; 9] {
        let [a, b, c, d, e, f, ..] = (self.time.0.wrapping_sub(start.0) as u64 * 1000).to_le_bytes();
        let [low, high] = self.node.wrapping_add(1).to_le_bytes();
        let status = match self.to {
            Some(status) => status as u8,
            None => 0,
        };
        [a, b, c, d, e, f, low, high, status]
    }
}

/// A ring buffer of the last `N` transitions, for instance between the tree and a serial port.
///
/// Adding a transition never waits. When the buffer is full, the oldest is dropped and counted.
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Halt, Leaves, Log, Memory, Status, StatusChange, Tree};
///
/// static OPEN: Tree<(), 2> = iibt_core::tree! { Inverter { Condition(()) } };
///
/// struct Door { log: Log<8> }
///
/// impl Leaves<()> for Door {
///     fn condition(&mut self, _: &(), _: Instant) -> bool { false }
///     fn on_start(&mut self, _: &(), _: Instant) -> Status { Status::Success }
///     fn on_running(&mut self, _: &(), _: Instant) -> Status { Status::Success }
///     fn on_halted(&mut self, _: &(), _: Instant) -> Halt { Halt::Done }
///     fn transition(&mut self, transition: StatusChange) { self.log.push(transition); }
/// }
///
/// let mut door = Door { log: Log::new() };
/// OPEN.tick(&mut Memory::new(), &mut door, Instant(7));
/// assert_eq!((door.log.len(), door.log.lost()), (2, 0));
/// let child = door.log.pop().unwrap();
/// assert_eq!((child.node, child.from, child.to), (1, None, Some(Status::Failure)));
/// let parent = door.log.pop().unwrap();
/// assert_eq!((parent.node, parent.from, parent.to), (0, None, Some(Status::Success)));
/// assert!(door.log.is_empty() && door.log.pop().is_none());
///
/// let mut short = Log::<1>::new();
/// short.push(child);
/// short.push(parent);
/// assert_eq!((short.lost(), short.pop()), (1, Some(parent)));
/// ```
#[doc(alias("trace", "ring buffer", "btlog"))]
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Log<const N: usize> {
    records: [StatusChange; N],
    first: usize,
    len: usize,
    lost: u32,
}

impl<const N: usize> Log<N> {
    /// Creates an empty log; one without room fails the build.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(N > 0, "a transition log has room for at least one record") }
        const NOTHING: StatusChange = StatusChange { time: Instant(0), node: 0, from: None, to: None };
        Self { records: [NOTHING; N], first: 0, len: 0, lost: 0 }
    }

    /// Adds a transition.
    pub fn push(&mut self, transition: StatusChange) {
        if self.len == N {
            self.first = wrapped::<N>(self.first + 1);
            self.lost = self.lost.saturating_add(1);
        } else {
            self.len += 1;
        }
        if let Some(record) = self.records.get_mut(wrapped::<N>(self.first + self.len - 1)) {
            *record = transition;
        }
    }

    /// Removes and returns the oldest transition.
    pub fn pop(&mut self) -> Option<StatusChange> {
        self.len = self.len.checked_sub(1)?;
        let record = self.records.get(self.first).copied();
        self.first = wrapped::<N>(self.first + 1);
        record
    }

    /// The number of transitions in the log.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether the log holds no transition.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The number of transitions that were dropped since the log was created.
    #[must_use]
    pub const fn lost(&self) -> u32 {
        self.lost
    }
}

impl<const N: usize> Default for Log<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// `at`, which is less than 2 N, in a ring of N.
const fn wrapped<const N: usize>(at: usize) -> usize {
    if at < N { at } else { at - N }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(time: u32) -> StatusChange {
        StatusChange { time: Instant(time), node: 2, from: None, to: Some(Status::Success) }
    }

    #[test]
    fn a_full_log_drops_the_oldest_and_counts_it() {
        let mut log = Log::<3>::new();
        for time in 0..5 {
            log.push(at(time));
        }
        assert_eq!((log.len(), log.lost()), (3, 2));
        assert_eq!(log.pop(), Some(at(2)));
        log.push(at(5));
        assert_eq!(
            [log.pop(), log.pop(), log.pop(), log.pop()],
            [Some(at(3)), Some(at(4)), Some(at(5)), None]
        );
        assert!(log.is_empty() && log.lost() == 2);
    }

    #[test]
    fn a_record_has_the_layout_of_the_file_of_behavior_tree_cpp() {
        let record = at(0x0001_0000).btlog(Instant(0xFFFF_FFFF));
        // 65537 ms across the wrap are 65537000 us, 0x03E8_03E8; unique identifiers begin at 1.
        assert_eq!(record, [0xE8, 0x03, 0xE8, 0x03, 0, 0, 3, 0, 2]);
    }

    #[test]
    fn a_transition_takes_eight_bytes() {
        assert_eq!(size_of::<StatusChange>(), 8);
    }
}
