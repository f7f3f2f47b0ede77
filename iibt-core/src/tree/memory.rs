//! The memory of a tree between two ticks.

use super::kinds::sealed::Extra;
use super::kinds::{Basic, Kinds};
use super::status::Status;

/// The memory of a tree with `N` nodes of the set `K`: one [`NodeMemory`] for each.
///
/// All nodes are idle at first, and again after every tick that ended in success or failure.
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Full, Halt, Leaves, Memory, Status, Tree};
///
/// static WORK: Tree<&str, 3> = iibt_core::tree! { Sequence { Action("fetch"), Action("carry") } };
///
/// struct Robot { holds: bool }
///
/// impl Leaves<&str> for Robot {
///     fn condition(&mut self, _: &&str, _: Instant) -> bool { self.holds }
///     fn on_start(&mut self, leaf: &&str, _: Instant) -> Status {
///         self.holds = *leaf == "fetch";
///         if self.holds { Status::Success } else { Status::Running }
///     }
///     fn on_running(&mut self, _: &&str, _: Instant) -> Status { Status::Success }
///     fn on_halted(&mut self, _: &&str, _: Instant) -> Halt { Halt::Done }
/// }
///
/// // Two robots share one tree; each has its own memory.
/// let (mut first, mut second) = (Memory::new(), Memory::new());
/// let mut robot = Robot { holds: false };
/// assert_eq!(WORK.tick(&mut first, &mut robot, Instant(0)).status, Status::Running);
/// assert!(first.is_running(0) && first.is_running(2) && !first.is_running(1));
/// assert!(second.is_idle());
/// let mut other = Robot { holds: false };
/// assert_eq!(WORK.tick(&mut second, &mut other, Instant(0)).status, Status::Running);
///
/// assert_eq!(WORK.tick(&mut first, &mut robot, Instant(1)).status, Status::Success);
/// assert!(first.is_idle() && !second.is_idle());
/// assert_eq!((Memory::<21>::BYTES, Memory::<21, Full>::BYTES), (84, 168));
/// ```
#[doc(alias = "state")]
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Memory<const N: usize, K: Kinds = Basic> {
    pub(super) cells: [NodeMemory<K>; N],
}

impl<const N: usize, K: Kinds> Memory<N, K> {
    /// The number of bytes of RAM.
    pub const BYTES: usize = size_of::<Self>();

    /// Creates the memory of a tree of which no node is running.
    #[must_use]
    pub const fn new() -> Self {
        Self { cells: [NodeMemory::NEW; N] }
    }

    /// Whether no node is running or stopping.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.cells.iter().all(|cell| cell.is_idle())
    }

    /// Whether the node in row `node` of the table is running; `false` past its end.
    #[must_use]
    pub fn is_running(&self, node: u16) -> bool {
        self.cells.get(usize::from(node)).is_some_and(|cell| cell.is_running())
    }
}

impl<const N: usize, K: Kinds> AsRef<[NodeMemory<K>]> for Memory<N, K> {
    fn as_ref(&self) -> &[NodeMemory<K>] {
        &self.cells
    }
}

impl<const N: usize, K: Kinds> AsMut<[NodeMemory<K>]> for Memory<N, K> {
    fn as_mut(&mut self) -> &mut [NodeMemory<K>] {
        &mut self.cells
    }
}

impl<const N: usize, K: Kinds> Default for Memory<N, K> {
    fn default() -> Self {
        Self::new()
    }
}

/// The memory of one node: 4 bytes in the basic set, 8 in the full one.
///
/// ```
/// use iibt_core::tree::{Basic, Full, NodeMemory};
///
/// let memory = vec![NodeMemory::<Full>::NEW; 21];
/// assert!(memory.iter().all(NodeMemory::is_idle) && !memory.iter().any(NodeMemory::is_running));
/// assert_eq!((size_of::<NodeMemory<Basic>>(), size_of::<NodeMemory<Full>>()), (4, 8));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct NodeMemory<K: Kinds> {
    pub(super) slot: Slot,
    pub(super) extra: K::Extra,
}

impl<K: Kinds> NodeMemory<K> {
    /// The memory of a node that was never ticked.
    pub const NEW: Self = Self { slot: Slot::IDLE, extra: K::Extra::ZERO };

    /// Whether the node is running.
    #[must_use]
    pub const fn is_running(&self) -> bool {
        self.slot.is_running()
    }

    /// Whether the node is neither running nor still stopping.
    #[must_use]
    pub const fn is_idle(&self) -> bool {
        !self.slot.is_running() && !self.slot.is_stopping()
    }
}

impl<K: Kinds> PartialEq for NodeMemory<K> {
    fn eq(&self, other: &Self) -> bool {
        self.slot == other.slot && self.extra == other.extra
    }
}

impl<K: Kinds> Eq for NodeMemory<K> {}

/// The memory that every node has.
///
/// | bits | what |
/// |---|---|
/// | 0 | it is running |
/// | 1 | it has finished, and its parent does not tick it again |
/// | 2 | something of its kind: a delay has passed, a rate is kept, the child was running before |
/// | 3 | an action that was told to stop and has not stopped |
/// | 4-5 | the code of the status with which a node that runs once has finished |
/// | 7 | of the root: some action has not stopped |
/// | 8-15 | a composite: how many of its first children were skipped, one after the other |
/// | 18-31 | an inner node: how many rows lie between it and the child that it waits for |
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot(u32);

impl Slot {
    pub(super) const IDLE: Self = Self(0);
    /// Running, with nothing else to remember: a leaf, or a node that begins at its first child
    /// every time.
    pub(super) const RUNNING: Self = Self(1);
    pub(super) const STOPPING_LEAF: Self = Self(STOPPING);

    /// A node in row `parent` that waits for its child in row `child`, both rows of one table.
    pub(super) const fn waiting(parent: usize, child: usize) -> Self {
        Self((child.wrapping_sub(parent).wrapping_sub(1) as u32) << 18 | 1)
    }

    pub(super) const fn is_running(self) -> bool {
        self.0 & 1 != 0
    }

    /// The row of the child that the inner node in row `parent` waits for, its first child if none.
    #[inline(always)]
    pub(super) const fn child(self, parent: usize) -> usize {
        parent.wrapping_add(1).wrapping_add((self.0 >> 18) as usize)
    }

    /// The slot with the place alone.
    pub(super) const fn place(self) -> Self {
        Self(self.0 & PLACE)
    }

    pub(super) const fn skips(self) -> usize {
        (self.0 >> 8) as u8 as usize
    }

    pub(super) const fn with_skips(self, skips: usize) -> Self {
        Self(self.0 & !SKIPS | (skips as u32) << 8 & SKIPS)
    }

    pub(super) const fn is_done(self) -> bool {
        self.0 & DONE != 0
    }

    pub(super) const fn done(self) -> Self {
        Self(self.0 | DONE)
    }

    /// The code of the status that a node which runs once has kept; 0 if none.
    const fn kept(self) -> u32 {
        self.0 >> 4 & 3
    }

    /// The status with which a node that runs once has finished; `None` if it has not.
    pub(super) const fn kept_status(self) -> Option<Status> {
        match self.kept() {
            code if code == Status::Success as u32 => Some(Status::Success),
            code if code == Status::Failure as u32 => Some(Status::Failure),
            _ => None,
        }
    }

    pub(super) const fn keeping(code: u32) -> Self {
        Self((code & 3) << 4)
    }

    /// The slot with the kept status alone.
    pub(super) const fn only_kept(self) -> Self {
        Self::keeping(self.kept())
    }

    pub(super) const fn has_flag(self) -> bool {
        self.0 & FLAG != 0
    }

    pub(super) const fn with_flag(self, flag: bool) -> Self {
        if flag { Self(self.0 | FLAG) } else { Self(self.0 & !FLAG) }
    }

    pub(super) const fn with_running(self, running: bool) -> Self {
        Self(self.0 & !1 | running as u32)
    }

    pub(super) const fn is_stopping(self) -> bool {
        self.0 & STOPPING != 0
    }

    pub(super) const fn has_pending_halt(self) -> bool {
        self.0 & PENDING_HALT != 0
    }

    pub(super) const fn with_pending_halt(self, pending: bool) -> Self {
        if pending { Self(self.0 | PENDING_HALT) } else { Self(self.0 & !PENDING_HALT) }
    }
}

const DONE: u32 = 1 << 1;
const FLAG: u32 = 1 << 2;
const STOPPING: u32 = 1 << 3;
const PENDING_HALT: u32 = 1 << 7;
const SKIPS: u32 = 0xFF << 8;
const PLACE: u32 = 0x3FFF << 18;

#[cfg(test)]
mod tests {
    use super::super::Full;
    use super::*;

    #[test]
    fn takes_four_bytes_a_node_and_eight_in_the_full_set() {
        assert_eq!(Memory::<21>::BYTES, 84);
        assert_eq!(Memory::<21, Full>::BYTES, 168);
    }

    #[test]
    fn remembers_the_farthest_child_of_the_largest_table() {
        assert_eq!(Slot::waiting(0, 16383).child(0), 16383);
        assert_eq!(Slot::waiting(7, 9).child(7), 9);
        assert_eq!(Slot::IDLE.child(7), 8);
    }

    #[test]
    fn the_parts_of_a_slot_do_not_touch_each_other() {
        let full = Slot::waiting(0, 16383).with_skips(255).done().with_flag(true).with_pending_halt(true);
        assert_eq!((full.child(0), full.skips()), (16383, 255));
        assert!(full.is_running() && full.is_done() && full.has_flag() && full.has_pending_halt());
        assert!(!full.is_stopping() && full.kept() == 0);
        let less = full.with_running(false).with_skips(0).with_flag(false).with_pending_halt(false);
        assert_eq!(less, Slot::waiting(0, 16383).place().done());
        assert_eq!((Slot::keeping(3).kept(), Slot::keeping(3).done().only_kept()), (3, Slot::keeping(3)));
    }

    #[test]
    fn rows_past_the_end_do_not_run() {
        let running: NodeMemory<Full> = NodeMemory { slot: Slot::RUNNING, extra: 0 };
        let memory = Memory { cells: [running; 2] };
        assert!(memory.is_running(1) && !memory.is_running(2) && !memory.is_idle());
    }
}
