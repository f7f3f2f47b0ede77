//! The leaves of a tree, which the caller provides.

use super::log::StatusChange;
use super::status::{Halt, Status};
use crate::time::Instant;

/// The leaves of a tree, each named by a value of `L`, which the caller provides.
///
/// The type that implements it is the blackboard: leaves share its fields.
///
/// ```
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Halt, Leaves, Memory, Status, Tree};
///
/// #[derive(Clone, Copy, Debug, PartialEq)]
/// enum Skill { SeesBall, Grasp }
///
/// /// What the leaves share, and what they were asked.
/// #[derive(Default)]
/// struct Arm { ball: bool, calls: Vec<&'static str> }
///
/// impl Leaves<Skill> for Arm {
///     fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
///         assert_eq!(*leaf, Skill::SeesBall);
///         self.ball
///     }
///     fn on_start(&mut self, leaf: &Skill, _: Instant) -> Status {
///         assert_eq!(*leaf, Skill::Grasp);
///         self.calls.push("close the hand");
///         Status::Running
///     }
///     fn on_running(&mut self, _: &Skill, _: Instant) -> Status {
///         self.calls.push("is it closed?");
///         Status::Running
///     }
///     fn on_halted(&mut self, _: &Skill, _: Instant) -> Halt {
///         self.calls.push("open the hand");
///         Halt::Done
///     }
/// }
///
/// static GRASP: Tree<Skill, 3> = iibt_core::tree! {
///     ReactiveSequence { Condition(Skill::SeesBall), Action(Skill::Grasp) }
/// };
///
/// let (mut arm, mut memory) = (Arm { ball: true, ..Arm::default() }, Memory::new());
/// GRASP.tick(&mut memory, &mut arm, Instant(0));
/// GRASP.tick(&mut memory, &mut arm, Instant(10));
/// arm.ball = false;
/// let tick = GRASP.tick(&mut memory, &mut arm, Instant(20));
/// assert_eq!(tick.status, Status::Failure);
/// assert_eq!(arm.calls, ["close the hand", "is it closed?", "open the hand"]);
/// ```
///
/// # The contract of an action
/// The life of an action (and of an inference node) is one [`on_start`](Self::on_start), then one
/// [`on_running`](Self::on_running) at each later tick while it returns [`Status::Running`]. It
/// ends with any other status or, when it is interrupted, with exactly one
/// [`on_halted`](Self::on_halted). An action that is not running is never told to halt. Several
/// actions that are halted together are told depth first, from left to right. Whatever ended it,
/// the next call is `on_start` again.
///
/// An action may need several ticks to stop: then `on_halted` answers [`Halt::Pending`], and each
/// later tick begins with one [`on_halting`](Self::on_halting) until that answers [`Halt::Done`].
/// While any action is still stopping, nothing else is ticked: the tree, or in the tick that
/// interrupted it the node that would have been next, counts as running.
///
/// Within one pass over the tree a leaf is called at most once, unless a node above it is made to
/// repeat it.
#[doc(alias("blackboard", "ports", "skills", "callbacks"))]
pub trait Leaves<L> {
    /// Whether a condition holds now.
    fn condition(&mut self, leaf: &L, now: Instant) -> bool;

    /// Starts an action: its first tick, by default like every later one.
    #[doc(alias("onStart", "initialise", "setup"))]
    fn on_start(&mut self, leaf: &L, now: Instant) -> Status {
        self.on_running(leaf, now)
    }

    /// Continues an action that returned [`Status::Running`] when it was last ticked.
    #[doc(alias("onRunning", "update"))]
    fn on_running(&mut self, leaf: &L, now: Instant) -> Status;

    /// Stops an action that returned [`Status::Running`] when it was last ticked.
    #[doc(alias("onHalted", "terminate", "cleanup"))]
    fn on_halted(&mut self, leaf: &L, now: Instant) -> Halt;

    /// Continues to stop an action that has answered [`Halt::Pending`] so far. [`Halt`] has an
    /// example.
    fn on_halting(&mut self, leaf: &L, now: Instant) -> Halt {
        let _ = (leaf, now);
        Halt::Done
    }

    /// The child that a [`Switch`](super::Node::Switch) ticks: its cases count from 0, and every
    /// number past the last case stands for the default.
    ///
    /// ```
    /// # use iibt_core::time::Instant;
    /// use iibt_core::tree::{Full, Halt, Leaves, Memory, Status, Tree};
    ///
    /// static GEAR: Tree<&str, 4, Full> = iibt_core::tree! {
    ///     Switch("gear") { Action("crawl"), Action("walk"), Action("stop") }
    /// };
    ///
    /// struct Robot { gear: usize }
    ///
    /// impl Leaves<&str> for Robot {
    ///     fn case(&mut self, _: &&str, _: Instant) -> usize { self.gear }
    ///     // the other four
    /// #     fn condition(&mut self, _: &&str, _: Instant) -> bool { false }
    /// #     fn on_start(&mut self, _: &&str, _: Instant) -> Status { Status::Running }
    /// #     fn on_running(&mut self, _: &&str, _: Instant) -> Status { Status::Running }
    /// #     fn on_halted(&mut self, _: &&str, _: Instant) -> Halt { Halt::Done }
    /// }
    ///
    /// let (mut robot, mut memory) = (Robot { gear: 1 }, Memory::new());
    /// GEAR.tick(&mut memory, &mut robot, Instant(0));
    /// assert_eq!(GEAR.running(&memory), Some(&"walk"));
    /// robot.gear = 99;
    /// GEAR.tick(&mut memory, &mut robot, Instant(1));
    /// assert_eq!(GEAR.running(&memory), Some(&"stop"), "the last child is the default");
    /// ```
    fn case(&mut self, leaf: &L, now: Instant) -> usize {
        let _ = (leaf, now);
        usize::MAX
    }

    /// The time at which an action that is running wants its next tick, if no event announces that.
    /// It is asked after a tick of a tree of the [`Full`](super::Full) set.
    ///
    /// ```
    /// # use iibt_core::time::Instant;
    /// use iibt_core::tree::{Full, Halt, Leaves, Memory, Next, Status, Tree};
    ///
    /// struct Motor;
    ///
    /// impl Leaves<()> for Motor {
    ///     fn deadline(&mut self, _: &(), now: Instant) -> Option<Instant> {
    ///         Some(Instant(now.0 + 30))
    ///     }
    ///     // the other four
    /// #     fn condition(&mut self, _: &(), _: Instant) -> bool { false }
    /// #     fn on_start(&mut self, _: &(), _: Instant) -> Status { Status::Running }
    /// #     fn on_running(&mut self, _: &(), _: Instant) -> Status { Status::Running }
    /// #     fn on_halted(&mut self, _: &(), _: Instant) -> Halt { Halt::Done }
    /// }
    ///
    /// static TURN: Tree<(), 2, Full> = iibt_core::tree! { Timeout(500) { Action(()) } };
    ///
    /// let tick = TURN.tick(&mut Memory::new(), &mut Motor, Instant(100));
    /// assert_eq!(tick.next, Next::At(Instant(130)), "earlier than the timeout at 600");
    /// ```
    fn deadline(&mut self, leaf: &L, now: Instant) -> Option<Instant> {
        let _ = (leaf, now);
        None
    }

    /// Reports that a node has started, ended or was halted. The empty default costs nothing.
    ///
    /// `from` is idle or running. A node that has finished is idle from then on without being
    /// mentioned again. Nodes are reported as they return, children before parents; halted ones in
    /// the order of the table. [`Log`](super::Log) keeps them.
    fn transition(&mut self, transition: StatusChange) {
        let _ = transition;
    }
}

impl<L, T: Leaves<L> + ?Sized> Leaves<L> for &mut T {
    fn condition(&mut self, leaf: &L, now: Instant) -> bool {
        (**self).condition(leaf, now)
    }

    fn on_start(&mut self, leaf: &L, now: Instant) -> Status {
        (**self).on_start(leaf, now)
    }

    fn on_running(&mut self, leaf: &L, now: Instant) -> Status {
        (**self).on_running(leaf, now)
    }

    fn on_halted(&mut self, leaf: &L, now: Instant) -> Halt {
        (**self).on_halted(leaf, now)
    }

    fn on_halting(&mut self, leaf: &L, now: Instant) -> Halt {
        (**self).on_halting(leaf, now)
    }

    fn case(&mut self, leaf: &L, now: Instant) -> usize {
        (**self).case(leaf, now)
    }

    fn deadline(&mut self, leaf: &L, now: Instant) -> Option<Instant> {
        (**self).deadline(leaf, now)
    }

    fn transition(&mut self, transition: StatusChange) {
        (**self).transition(transition);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Answers otherwise than every default does, and notes each call.
    #[derive(Default)]
    struct Other(Vec<&'static str>);

    impl Leaves<()> for Other {
        fn condition(&mut self, _: &(), _: Instant) -> bool {
            self.0.push("condition");
            true
        }

        fn on_start(&mut self, _: &(), _: Instant) -> Status {
            self.0.push("on_start");
            Status::Running
        }

        fn on_running(&mut self, _: &(), _: Instant) -> Status {
            self.0.push("on_running");
            Status::Failure
        }

        fn on_halted(&mut self, _: &(), _: Instant) -> Halt {
            self.0.push("on_halted");
            Halt::Pending
        }

        fn on_halting(&mut self, _: &(), _: Instant) -> Halt {
            self.0.push("on_halting");
            Halt::Pending
        }

        fn case(&mut self, _: &(), _: Instant) -> usize {
            self.0.push("case");
            3
        }

        fn deadline(&mut self, _: &(), now: Instant) -> Option<Instant> {
            self.0.push("deadline");
            Some(now)
        }

        fn transition(&mut self, _: StatusChange) {
            self.0.push("transition");
        }
    }

    fn call_all(mut leaves: impl Leaves<()>) {
        let now = Instant(7);
        assert!(leaves.condition(&(), now));
        assert_eq!(
            (leaves.on_start(&(), now), leaves.on_running(&(), now)),
            (Status::Running, Status::Failure)
        );
        assert_eq!((leaves.on_halted(&(), now), leaves.on_halting(&(), now)), (Halt::Pending, Halt::Pending));
        assert_eq!((leaves.case(&(), now), leaves.deadline(&(), now)), (3, Some(now)));
        leaves.transition(StatusChange { time: now, node: 0, from: None, to: None });
    }

    #[test]
    fn a_borrow_of_leaves_passes_every_call_on() {
        let mut other = Other::default();
        call_all(&mut other);
        let calls = [
            "condition",
            "on_start",
            "on_running",
            "on_halted",
            "on_halting",
            "case",
            "deadline",
            "transition",
        ];
        assert_eq!(other.0, calls);
    }
}
