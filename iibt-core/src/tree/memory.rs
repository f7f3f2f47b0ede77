//! What a tree remembers between two ticks.

/// The memory of a tree with `N` nodes: two bytes for each.
///
/// All nodes are idle at first, and again after every tick that ended in success or failure.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Memory<const N: usize> {
    pub(super) slots: [Slot; N],
}

impl<const N: usize> Memory<N> {
    /// The memory of a tree of which no node is running.
    #[must_use]
    pub const fn new() -> Self {
        Self { slots: [Slot::IDLE; N] }
    }

    /// Whether no node is running.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.slots.iter().all(|slot| !slot.is_running())
    }

    /// Whether the node in row `node` of the table is running; `false` past its end.
    #[must_use]
    pub fn is_running(&self, node: u16) -> bool {
        self.slots.get(usize::from(node)).is_some_and(|slot| slot.is_running())
    }
}

impl<const N: usize> Default for Memory<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// The memory of one node: bit 0 says whether it is running, the bits above it, for an inner node,
/// how many rows lie between it and the child that it waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Slot(u16);

impl Slot {
    pub(super) const IDLE: Self = Self(0);
    pub(super) const RUNNING_LEAF: Self = Self(1);

    /// A node in row `parent` that waits for its child in row `child`, both rows of one table.
    pub(super) const fn waiting(parent: usize, child: usize) -> Self {
        let between = child.wrapping_sub(parent).wrapping_sub(1);
        Self((between << 1) as u16 | 1)
    }

    pub(super) const fn is_running(self) -> bool {
        self.0 & 1 != 0
    }

    /// The row of the child that the inner node in row `parent` waits for, its first child if none.
    pub(super) const fn child(self, parent: usize) -> usize {
        parent.wrapping_add(1).wrapping_add(self.0 as usize >> 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_two_bytes_a_node() {
        assert_eq!(size_of::<Memory<1>>(), 2);
        assert_eq!(size_of::<Memory<21>>(), 42);
    }

    #[test]
    fn remembers_the_farthest_child_of_the_largest_table() {
        assert_eq!(Slot::waiting(0, 32767).child(0), 32767);
        assert_eq!(Slot::waiting(7, 9).child(7), 9);
        assert_eq!(Slot::IDLE.child(7), 8);
    }

    #[test]
    fn rows_past_the_end_do_not_run() {
        let memory = Memory { slots: [Slot::RUNNING_LEAF; 2] };
        assert!(memory.is_running(1) && !memory.is_running(2) && !memory.is_idle());
    }
}
