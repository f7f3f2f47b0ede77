//! The log of a tree by ticks: the changes of each tick that differ from those of the tick before.

use super::log::StatusChange;
use super::status::Status;
use crate::time::Instant;
use core::fmt;

/// A change of a node's status, without its time; 4 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeChange {
    /// The node's row in the table, from zero.
    pub node: u16,
    /// The status after; `None` is idle.
    pub to: Option<Status>,
}

/// A log of ticks, of which each has room for `N` changes.
///
/// Most ticks change the same nodes as the tick before: a condition is asked and holds. Only a tick
/// that changes others is an entry. The entries are numbered from one, so that a missing one shows.
/// Changes for which there is no room are counted. Recording costs a few instructions a change, and
/// memory for 8 bytes a change.
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Halt, Leaves, Memory, Status, StatusChange, TickLog, Tree};
///
/// static GUARDED: Tree<bool, 3> = iibt_core::tree! {
///     ReactiveSequence { Condition(true), Action(false) }
/// };
///
/// struct Lamp { log: TickLog<4>, ticks: u8 }
///
/// impl Leaves<bool> for Lamp {
///     fn condition(&mut self, _: &bool, _: Instant) -> bool { true }
///     fn on_running(&mut self, _: &bool, _: Instant) -> Status {
///         self.ticks += 1;
///         if self.ticks == 5 { Status::Success } else { Status::Running }
///     }
///     fn on_halted(&mut self, _: &bool, _: Instant) -> Halt { Halt::Done }
///     fn transition(&mut self, change: StatusChange) { self.log.record(change); }
/// }
///
/// let (mut lamp, mut memory) = (Lamp { log: TickLog::new(), ticks: 0 }, Memory::new());
/// let entries: Vec<String> = (0..5)
///     .filter_map(|tick| {
///         GUARDED.tick(&mut memory, &mut lamp, Instant(100 * tick));
///         lamp.log.end_tick(Instant(100 * tick));
///         lamp.log.entry().map(|entry| entry.to_string())
///     })
///     .collect();
/// // The third tick and the fourth are like the second.
/// let expected =
///     ["tree 1 at 0 ms: 1:S 2:R 0:R", "tree 2 at 100 ms: 1:S", "tree 3 at 400 ms: 1:S 2:S 0:S"];
/// assert_eq!(entries, expected);
/// ```
#[doc(alias("trace", "change log"))]
#[derive(Clone, Debug)]
pub struct TickLog<const N: usize> {
    now: Changes<N>,
    last: Changes<N>,
    time: Instant,
    entries: u32,
    is_entry: bool,
}

/// The changes of a tick.
#[derive(Clone, Copy, Debug)]
struct Changes<const N: usize> {
    records: [NodeChange; N],
    len: usize,
    dropped: u16,
}

impl<const N: usize> TickLog<N> {
    /// Creates an empty log; one without room fails the build.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(N > 0, "a tick has room for at least one change") }
        Self { now: Changes::NONE, last: Changes::NONE, time: Instant(0), entries: 0, is_entry: false }
    }

    /// Adds a change of the tick that goes on.
    pub fn record(&mut self, change: StatusChange) {
        self.now.push(NodeChange { node: change.node, to: change.to });
    }

    /// Ends the tick.
    pub fn end_tick(&mut self, now: Instant) {
        self.is_entry = self.entries == 0 || !self.now.is_like(&self.last);
        if self.is_entry {
            self.entries = self.entries.saturating_add(1);
            self.time = now;
            self.last = self.now;
        }
        self.now.clear();
    }

    /// Returns the entry of the last tick; `None` when it changed the same as the one before.
    #[must_use]
    pub fn entry(&self) -> Option<TickEntry<'_>> {
        let Changes { dropped, .. } = self.last;
        let entry = TickEntry { number: self.entries, time: self.time, changes: self.last.list(), dropped };
        self.is_entry.then_some(entry)
    }
}

impl<const N: usize> Default for TickLog<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Changes<N> {
    const NONE: Self = Self { records: [NodeChange { node: 0, to: None }; N], len: 0, dropped: 0 };

    fn push(&mut self, change: NodeChange) {
        match self.records.get_mut(self.len) {
            Some(record) => {
                *record = change;
                self.len += 1;
            }
            None => self.dropped = self.dropped.saturating_add(1),
        }
    }

    fn clear(&mut self) {
        (self.len, self.dropped) = (0, 0);
    }

    fn list(&self) -> &[NodeChange] {
        self.records.get(..self.len).unwrap_or(&[])
    }

    fn is_like(&self, other: &Self) -> bool {
        self.list() == other.list() && self.dropped == other.dropped
    }
}

/// An entry of a [`TickLog`]. Its text is the line that `host-sim tree replay` reads: the number,
/// the time, and each node with a letter for its status; S success, F failure, R running, K
/// skipped, I idle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickEntry<'l> {
    /// Its number, from one.
    pub number: u32,
    /// The time of the tick.
    pub time: Instant,
    /// The changes in their order.
    pub changes: &'l [NodeChange],
    /// How many more there were, without room.
    pub dropped: u16,
}

impl NodeChange {
    /// The letter of the status in the text of an entry.
    const fn letter(self) -> char {
        match self.to {
            Some(Status::Success) => 'S',
            Some(Status::Failure) => 'F',
            Some(Status::Running) => 'R',
            Some(Status::Skipped) => 'K',
            None => 'I',
        }
    }
}

impl fmt::Display for TickEntry<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tree {} at {} ms:", self.number, self.time.0)?;
        for change in self.changes {
            write!(f, " {}:{}", change.node, change.letter())?;
        }
        if self.dropped > 0 { write!(f, " and {} more", self.dropped) } else { Ok(()) }
    }
}

/// The same text; 5 bytes a change.
#[cfg(feature = "defmt")]
impl defmt::Format for TickEntry<'_> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "tree {=u32} at {=u32} ms:", self.number, self.time.0);
        for change in self.changes {
            defmt::write!(f, " {=u16}:{=char}", change.node, change.letter());
        }
        if self.dropped > 0 {
            defmt::write!(f, " and {=u16} more", self.dropped);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::{String, ToString};

    fn tick<const N: usize>(log: &mut TickLog<N>, time: u32, changes: &[(u16, Option<Status>)]) -> String {
        for &(node, to) in changes {
            log.record(StatusChange { time: Instant(time), node, from: None, to });
        }
        log.end_tick(Instant(time));
        log.entry().map_or_else(String::new, |entry| entry.to_string())
    }

    #[test]
    fn a_tick_like_the_one_before_is_no_entry() {
        let (mut log, run, done) = (TickLog::<4>::new(), Some(Status::Running), Some(Status::Success));
        assert_eq!(tick(&mut log, 0, &[(1, run), (0, run)]), "tree 1 at 0 ms: 1:R 0:R");
        assert_eq!(tick(&mut log, 10, &[]), "tree 2 at 10 ms:");
        assert_eq!(tick(&mut log, 20, &[]), "");
        assert_eq!(tick(&mut log, 30, &[(1, done), (0, done)]), "tree 3 at 30 ms: 1:S 0:S");
        assert_eq!(tick(&mut log, 40, &[(1, done), (0, done)]), "");
        assert_eq!(tick(&mut log, 50, &[(1, None), (0, Some(Status::Skipped))]), "tree 4 at 50 ms: 1:I 0:K");
    }

    #[test]
    fn a_first_tick_that_changes_nothing_is_an_entry() {
        assert_eq!(tick(&mut TickLog::<1>::new(), 7, &[]), "tree 1 at 7 ms:");
    }

    #[test]
    fn changes_without_room_are_counted_and_told() {
        let (mut log, failed) = (TickLog::<2>::new(), Some(Status::Failure));
        let changes = [(3, failed), (2, failed), (1, failed), (0, failed)];
        assert_eq!(tick(&mut log, 0, &changes), "tree 1 at 0 ms: 3:F 2:F and 2 more");
        assert_eq!(tick(&mut log, 1, &changes[..3]), "tree 2 at 1 ms: 3:F 2:F and 1 more");
    }
}
