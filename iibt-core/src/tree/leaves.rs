//! What the caller provides: the leaves of a tree.

use super::log::Transition;
use super::status::{Halt, Status};
use crate::time::Instant;

/// The leaves of a tree, each named by a value of `L`.
///
/// # The contract of an action
/// The life of an action (and of an inference node) is one [`on_start`](Self::on_start), then one
/// [`on_running`](Self::on_running) at each later tick while it returns [`Status::Running`]. It ends with any
/// other status or, when it is interrupted, with exactly one [`on_halted`](Self::on_halted). An action that is
/// not running is never told to halt. Several actions that are halted together are told depth first, from left to
/// right. Whatever ended it, the next call is `on_start` again.
///
/// An action may need several ticks to stop: then `on_halted` answers [`Halt::Pending`], and each later tick
/// begins with one [`on_halting`](Self::on_halting) until that answers [`Halt::Done`]. While any action is still
/// stopping, nothing else is ticked: the tree, or in the tick that interrupted it the node that would
/// have been next, counts as running.
///
/// Within one pass over the tree a leaf is called at most once, unless a node above it is made to repeat it.
pub trait Leaves<L> {
    /// Whether a condition holds now.
    fn condition(&mut self, leaf: &L, now: Instant) -> bool;

    /// Starts an action: its first tick.
    fn on_start(&mut self, leaf: &L, now: Instant) -> Status;

    /// Continues an action that returned [`Status::Running`] when it was last ticked.
    fn on_running(&mut self, leaf: &L, now: Instant) -> Status;

    /// Stops an action that returned [`Status::Running`] when it was last ticked.
    fn on_halted(&mut self, leaf: &L, now: Instant) -> Halt;

    /// Goes on stopping an action that has answered [`Halt::Pending`] so far.
    fn on_halting(&mut self, leaf: &L, now: Instant) -> Halt {
        let _ = (leaf, now);
        Halt::Done
    }

    /// Which child a [`Switch`](super::Node::Switch) ticks: its cases count from 0, and every number past the
    /// last case stands for the default.
    fn case(&mut self, leaf: &L, now: Instant) -> usize {
        let _ = (leaf, now);
        usize::MAX
    }

    /// When an action that is running wants its next tick, if no event announces that; asked after a tick
    /// of a tree of the [`Full`](super::Full) set.
    fn deadline(&mut self, leaf: &L, now: Instant) -> Option<Instant> {
        let _ = (leaf, now);
        None
    }

    /// Is told when a node begins, ends or is halted. The empty default costs nothing.
    ///
    /// `from` is idle or running. A node that has finished is idle from then on without being mentioned again.
    /// Nodes are reported as they return, children before parents; halted ones in the order of the table.
    fn transition(&mut self, transition: Transition) {
        let _ = transition;
    }
}
