//! What the caller provides: the leaves of a tree.

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
}

impl From<bool> for Status {
    /// Success for `true`, failure for `false`.
    fn from(holds: bool) -> Self {
        if holds { Self::Success } else { Self::Failure }
    }
}

/// The leaves of a tree, each named by a value of `L`.
///
/// The life of an action (and of an inference node) is one [`on_start`](Self::on_start), then one
/// [`on_running`](Self::on_running) at each later tick while it returns [`Status::Running`]. It ends either with
/// [`Status::Success`] or [`Status::Failure`] or, when it is interrupted, with exactly one
/// [`on_halted`](Self::on_halted). Several actions that are halted together are told depth first, from left
/// to right. Whatever ended it, the next call is `on_start` again.
///
/// Within one tick a leaf is called at most once, and either ticked or halted.
pub trait Leaves<L> {
    /// Whether a condition holds now.
    fn condition(&mut self, leaf: &L, now: Instant) -> bool;

    /// Starts an action: its first tick.
    fn on_start(&mut self, leaf: &L, now: Instant) -> Status;

    /// Continues an action that returned [`Status::Running`] when it was last ticked.
    fn on_running(&mut self, leaf: &L, now: Instant) -> Status;

    /// Stops an action that returned [`Status::Running`] when it was last ticked. It must be quick: it
    /// cannot refuse and is not asked again.
    fn on_halted(&mut self, leaf: &L, now: Instant);

    /// Is told when a node begins, ends or is halted; `None` stands for idle.
    ///
    /// `node` is its row in the table, from zero (BehaviorTree.CPP's unique identifier less one). `from`
    /// is idle or running. A node that has finished is idle from then on without being mentioned again. Nodes
    /// are reported as they return, children before parents; halted ones in the order of the table.
    /// The empty default costs nothing.
    fn transition(&mut self, node: u16, from: Option<Status>, to: Option<Status>) {
        let _ = (node, from, to);
    }
}
