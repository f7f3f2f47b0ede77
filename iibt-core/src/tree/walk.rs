//! Ticking and halting.
//!
//! The walk goes down the table and comes back along the parents, so it needs no stack. It ends
//! whatever the memory holds, because each node it enters lies in a later row than the one before.

use super::leaves::{Leaves, Status};
use super::memory::Slot;
use super::node::Node;
use super::table::Row;
use crate::time::Instant;
use core::hint::cold_path;
use core::ops::ControlFlow::{self, Break, Continue};

/// Ticks the tree in `rows`, each node at most once.
pub(super) fn tick<L, V>(rows: &[Row<L>], slots: &mut [Slot], leaves: &mut V, now: Instant) -> Status
where
    V: Leaves<L> + ?Sized,
{
    // One length for both spares the walk every other bounds check.
    let Some(slots) = slots.get_mut(..rows.len()) else { return Status::Failure };
    let mut walk = Walk { rows, slots, leaves, now };
    let mut at = 0;
    loop {
        at = match walk.enter(at) {
            Continue(child) => child,
            Break(Status::Running) => return walk.suspend(at),
            Break(status) => match walk.finish(at, status) {
                Continue(sibling) => sibling,
                Break(status) => return status,
            },
        };
    }
}

/// Halts what is running among the node in row `top` and its descendants.
#[inline(never)]
pub(super) fn halt<L, V>(rows: &[Row<L>], slots: &mut [Slot], leaves: &mut V, now: Instant, top: usize)
where
    V: Leaves<L> + ?Sized,
{
    for at in top..rows.len() {
        let (Some(row), Some(slot)) = (rows.get(at), slots.get_mut(at)) else { return };
        if at > top && usize::from(row.parent) < top {
            return;
        }
        let before = core::mem::replace(slot, Slot::IDLE);
        if before.is_running() {
            if let Node::Action(leaf) | Node::Inference(leaf) = &row.node {
                leaves.on_halted(leaf, now);
            }
            report(leaves, at, before, None);
        }
    }
}

struct Walk<'a, L, V: ?Sized> {
    rows: &'a [Row<L>],
    slots: &'a mut [Slot],
    leaves: &'a mut V,
    now: Instant,
}

impl<L, V: Leaves<L> + ?Sized> Walk<'_, L, V> {
    /// Ticks the node in row `at`: its status if it is a leaf, else the row of the child to enter first.
    #[inline]
    fn enter(&mut self, at: usize) -> ControlFlow<Status, usize> {
        let (Some(row), Some(slot)) = (self.rows.get(at), self.slots.get_mut(at)) else {
            return Break(Status::Failure); // only with the memory of another tree
        };
        let (before, status) = match &row.node {
            Node::Sequence(_) | Node::Fallback(_) => return Continue(slot.child(at)),
            Node::ReactiveSequence(_) | Node::ReactiveFallback(_) | Node::Inverter => {
                return Continue(at.wrapping_add(1));
            }
            Node::Condition(leaf) => (Slot::IDLE, self.leaves.condition(leaf, self.now).into()),
            Node::Action(leaf) | Node::Inference(leaf) => {
                let before = *slot;
                let status = if before.is_running() {
                    self.leaves.on_running(leaf, self.now)
                } else {
                    self.leaves.on_start(leaf, self.now)
                };
                *slot = if status == Status::Running { Slot::RUNNING_LEAF } else { Slot::IDLE };
                (before, status)
            }
        };
        report(self.leaves, at, before, Some(status));
        Break(status)
    }

    /// Takes the success or failure of the node in row `at` to its parent, and on from there to the next
    /// node to enter, or to the status of the root.
    #[inline]
    fn finish(&mut self, mut at: usize, mut status: Status) -> ControlFlow<Status, usize> {
        let rows = self.rows;
        while let Some(child) = rows.get(at) {
            if child.next_on == status {
                return Continue(usize::from(child.next));
            }
            let parent = usize::from(child.parent);
            let Some(row) = rows.get(parent) else { break };
            if matches!(row.node, Node::Inverter) {
                cold_path(); // keeps this a branch: most parents are none
                status = inverted(status);
            }
            self.settle(parent, at, Slot::IDLE, status);
            at = parent;
        }
        Break(status)
    }

    /// Leaves all nodes above the node in row `at` waiting for it.
    #[inline]
    fn suspend(&mut self, mut at: usize) -> Status {
        let rows = self.rows;
        while let Some(child) = rows.get(at) {
            let parent = usize::from(child.parent);
            self.settle(parent, at, Slot::waiting(parent, at), Status::Running);
            at = parent;
        }
        Status::Running
    }

    /// Ends the tick of the inner node in row `parent`, which ticked the child in row `child` last and
    /// keeps `after` in mind. A later child that it was waiting for is halted.
    #[inline]
    fn settle(&mut self, parent: usize, child: usize, after: Slot, status: Status) {
        let Some(slot) = self.slots.get_mut(parent) else { return };
        let before = *slot;
        if before.is_running() || after.is_running() {
            *slot = after;
        }
        if before.is_running() && before.child(parent) > child {
            halt(self.rows, self.slots, self.leaves, self.now, before.child(parent));
        }
        report(self.leaves, parent, before, Some(status));
    }
}

#[inline]
fn report<L, V: Leaves<L> + ?Sized>(leaves: &mut V, at: usize, before: Slot, to: Option<Status>) {
    let from = before.is_running().then_some(Status::Running);
    if from != to {
        leaves.transition(at as u16, from, to);
    }
}

const fn inverted(status: Status) -> Status {
    match status {
        Status::Running => Status::Running,
        Status::Success => Status::Failure,
        Status::Failure => Status::Success,
    }
}

#[cfg(test)]
mod tests {
    use super::super::script::{Script, play};
    use crate::time::Instant;
    use crate::tree;
    use crate::tree::{Leaves, Memory, Status, Tree};
    use std::vec::Vec;

    /// The pre-emption test of the survey of behavior-tree libraries.
    #[test]
    fn a_failing_guard_halts_what_runs_behind_it() {
        play(
            tree! { ReactiveSequence { Condition('g'), Sequence { Action('a'), Action('b') } } },
            "g=SFS a=S b=R",
            &["g:S a:S b:R => Running", "g:F halt(b) => Failure", "g:S a:S b:R => Running"],
        );
    }

    #[test]
    fn a_sequence_ends_with_its_first_failure() {
        let tree = tree! { Sequence { Action('a'), Action('b'), Action('c') } };
        play(tree, "a=S b=F c=S", &["a:S b:F => Failure", "a:S b:F => Failure"]);
        play(tree, "a=S b=S c=S", &["a:S b:S c:S => Success"]);
    }

    #[test]
    fn a_fallback_ends_with_its_first_success() {
        let tree = tree! { Fallback { Action('a'), Action('b'), Action('c') } };
        play(tree, "a=F b=S c=S", &["a:F b:S => Success", "a:F b:S => Success"]);
        play(tree, "a=F b=F c=F", &["a:F b:F c:F => Failure"]);
    }

    #[test]
    fn memory_nodes_resume_at_the_running_child() {
        play(
            tree! { Sequence { Action('a'), Action('b'), Action('c') } },
            "a=S b=RRS c=RF",
            &[
                "a:S b:R => Running",
                "b:R => Running",
                "b:S c:R => Running",
                "c:F => Failure",
                "a:S b:S c:F => Failure",
            ],
        );
        play(
            tree! { Fallback { Action('a'), Action('b'), Action('c') } },
            "a=F b=RF c=RS",
            &["a:F b:R => Running", "b:F c:R => Running", "c:S => Success", "a:F b:F c:S => Success"],
        );
    }

    #[test]
    fn memory_nodes_resume_through_every_level() {
        play(
            tree! { Sequence { Action('a'), Fallback { Action('b'), Sequence { Action('c'), Action('d') } }, Action('e') } },
            "a=S b=F c=S d=RS e=S",
            &["a:S b:F c:S d:R => Running", "d:S e:S => Success", "a:S b:F c:S d:S e:S => Success"],
        );
    }

    #[test]
    fn reactive_nodes_start_again_from_the_first_child() {
        play(
            tree! { ReactiveSequence { Condition('g'), Action('a'), Action('b') } },
            "g=S a=S b=RS",
            &["g:S a:S b:R => Running", "g:S a:S b:S => Success"],
        );
        play(
            tree! { ReactiveFallback { Condition('g'), Action('a'), Action('b') } },
            "g=F a=F b=RF",
            &["g:F a:F b:R => Running", "g:F a:F b:F => Failure"],
        );
    }

    #[test]
    fn a_reactive_node_halts_the_child_that_another_displaces() {
        play(
            tree! { ReactiveSequence { Action('a'), Action('b') } },
            "a=SRS b=R",
            &["a:S b:R => Running", "a:R halt(b) => Running", "a:S b:R => Running"],
        );
        play(
            tree! { ReactiveFallback { Action('a'), Action('b') } },
            "a=FRFS b=R",
            &[
                "a:F b:R => Running",
                "a:R halt(b) => Running",
                "a:F b:R => Running",
                "a:S halt(b) => Success",
                "a:S => Success",
            ],
        );
    }

    #[test]
    fn a_child_that_ends_while_another_starts_to_run_is_not_halted() {
        play(
            tree! { ReactiveSequence { Action('a'), Action('b') } },
            "a=RS b=R",
            &["a:R => Running", "a:S b:R => Running", "a:S b:R => Running"],
        );
    }

    #[test]
    fn nested_reactive_nodes_halt_a_leaf_once() {
        play(
            tree! {
                ReactiveFallback {
                    ReactiveSequence { Condition('g'), Condition('h') },
                    ReactiveSequence { Condition('k'), Sequence { Action('a'), Inverter { Action('b') } } },
                }
            },
            "g=FSF h=S k=SSF a=S b=R",
            &[
                "g:F k:S a:S b:R => Running",
                "g:S h:S halt(b) => Success",
                "g:F k:S a:S b:R => Running",
                "g:F k:F halt(b) => Failure",
            ],
        );
    }

    #[test]
    fn a_halted_subtree_starts_afresh() {
        play(
            tree! { ReactiveSequence { Condition('g'), Sequence { Action('a'), Fallback { Action('b'), Action('c') } } } },
            "g=SFS a=S b=F c=R",
            &["g:S a:S b:F c:R => Running", "g:F halt(c) => Failure", "g:S a:S b:F c:R => Running"],
        );
    }

    #[test]
    fn an_inverter_exchanges_success_and_failure() {
        play(
            tree! { Inverter { Action('a') } },
            "a=SFRF",
            &["a:S => Failure", "a:F => Success", "a:R => Running", "a:F => Success"],
        );
    }

    #[test]
    fn a_tree_may_be_a_single_leaf() {
        play(tree! { Condition('g') }, "g=FS", &["g:F => Failure", "g:S => Success"]);
        play(tree! { Inference('i') }, "i=RS", &["i:R => Running", "i:S => Success"]);
    }

    #[test]
    fn an_inference_node_is_resumed_and_halted_like_an_action() {
        play(
            tree! { ReactiveSequence { Fallback { Condition('b'), Action('m') }, Inference('i') } },
            "b=SSFS m=R i=R",
            &["b:S i:R => Running", "b:S i:R => Running", "b:F m:R halt(i) => Running", "m:R => Running"],
        );
    }

    #[test]
    fn a_halt_from_outside_tells_only_what_is_running() {
        let tree = tree! { Sequence { Action('a'), ReactiveSequence { Condition('g'), Action('b') } } };
        let mut memory = Memory::new();
        let mut script = Script::new("a=S g=S b=R");
        tree.halt(&mut memory, &mut script, Instant(0));
        assert_eq!(script.trace("."), ".");
        assert_eq!(tree.tick(&mut memory, &mut script, Instant(0)), Status::Running);
        assert_eq!(script.trace("."), "a:S g:S b:R .");
        tree.halt(&mut memory, &mut script, Instant(1));
        tree.halt(&mut memory, &mut script, Instant(1));
        assert_eq!(script.trace("."), "halt(b) .");
        assert!(memory.is_idle());
        assert_eq!(tree.tick(&mut memory, &mut script, Instant(2)), Status::Running);
        assert_eq!(script.trace("."), "a:S g:S b:R .");
    }

    /// Notes transitions and the time of each call; its condition fails from time 7 on.
    #[derive(Default)]
    struct Observer {
        transitions: Vec<(u16, Option<Status>, Option<Status>)>,
        times: Vec<(&'static str, u32)>,
    }

    impl Leaves<()> for Observer {
        fn condition(&mut self, _: &(), now: Instant) -> bool {
            self.times.push(("condition", now.0));
            now.0 < 7
        }

        fn on_start(&mut self, _: &(), now: Instant) -> Status {
            self.times.push(("start", now.0));
            Status::Running
        }

        fn on_running(&mut self, _: &(), now: Instant) -> Status {
            self.times.push(("running", now.0));
            Status::Running
        }

        fn on_halted(&mut self, _: &(), now: Instant) {
            self.times.push(("halted", now.0));
        }

        fn transition(&mut self, node: u16, from: Option<Status>, to: Option<Status>) {
            self.transitions.push((node, from, to));
        }
    }

    static GUARDED: Tree<(), 4> = tree! { ReactiveSequence { Condition(()), Inverter { Action(()) } } };

    fn observe(times: &[u32]) -> Observer {
        let mut memory = Memory::new();
        let mut observer = Observer::default();
        for &now in times {
            GUARDED.tick(&mut memory, &mut observer, Instant(now));
        }
        observer
    }

    #[test]
    fn every_leaf_is_told_the_time() {
        assert_eq!(
            observe(&[5, 6, 7]).times,
            [
                ("condition", 5),
                ("start", 5),
                ("condition", 6),
                ("running", 6),
                ("condition", 7),
                ("halted", 7)
            ]
        );
    }

    #[test]
    fn changes_of_status_are_reported_children_first() {
        const IDLE: Option<Status> = None;
        const RUNNING: Option<Status> = Some(Status::Running);
        const SUCCESS: Option<Status> = Some(Status::Success);
        const FAILURE: Option<Status> = Some(Status::Failure);
        let first = [(1, IDLE, SUCCESS), (3, IDLE, RUNNING), (2, IDLE, RUNNING), (0, IDLE, RUNNING)];
        let second = [(1, IDLE, SUCCESS)];
        let third = [(1, IDLE, FAILURE), (2, RUNNING, IDLE), (3, RUNNING, IDLE), (0, RUNNING, FAILURE)];
        assert_eq!(observe(&[5]).transitions, first);
        assert_eq!(observe(&[5, 6]).transitions, [&first[..], &second].concat());
        assert_eq!(observe(&[5, 6, 7]).transitions, [&first[..], &second, &third].concat());
    }
}
