//! One walk of a tree's table for every set of kinds.
//!
//! It goes down the table and comes back along the [links](super::row), so it needs no stack. It
//! asks each node's rules what they decide, and does it. It ends whatever the memory holds: a node
//! is entered again in the same pass only when a count has grown or a child that was running no
//! longer is.
//!
//! A set leaves its kinds out at compile time: in the basic set no branch of another kind is left,
//! and a sequence or fallback that was not running is passed on the way up by a look at its memory.

use super::context::TickContext;
use super::kinds::Kinds;
use super::kinds::sealed::Extra;
use super::leaves::Leaves;
use super::memory::Slot;
use super::node::Node;
use super::row::{NONE, Row, UP};
use super::status::{Halt, Next, Status, Tick};
use super::visit::{Step, Visit, VisitEffect, VisitOutcome};

/// The link where there is no node.
const NO_NODE: usize = usize::MAX;

impl<L, V: Leaves<L> + ?Sized, K: Kinds> TickContext<'_, L, V, K> {
    /// Ticks the tree, in one pass.
    #[inline(always)]
    pub(super) fn tick(&mut self) -> Tick {
        if K::FULL { self.full_tick() } else { Tick { status: self.pass(), next: Next::Event } }
    }

    #[inline(never)]
    fn full_tick(&mut self) -> Tick {
        if self.has_pending_halt() && self.go_on_halting() == Halt::Pending {
            return Tick { status: Status::Running, next: Next::Now };
        }
        (self.stopping, self.yielded) = (false, false);
        if K::COMPAT {
            self.halt_overdue();
        }
        let status = self.pass();
        self.note_pending_halt();
        let next = match status {
            _ if self.stopping => Next::Now,
            Status::Running if self.yielded => Next::Now,
            Status::Running => self.next_deadline(),
            _ => Next::Event,
        };
        Tick { status, next }
    }

    /// Ticks the tree until it no longer wants the next pass at once, `passes` times at the most.
    pub(super) fn tick_until_idle(&mut self, passes: u16) -> Tick {
        let mut result = self.tick();
        for _ in 1..passes {
            // An action that is still stopping is asked once a tick, not once a pass.
            if result.status != Status::Running || result.next != Next::Now || self.has_pending_halt() {
                break;
            }
            result = self.tick();
        }
        result
    }

    /// Walks through the tree once.
    ///
    /// One long function on purpose. With the three ways on as values that a shared end follows,
    /// T21 takes 796 instructions instead of 428.
    #[inline(never)]
    fn pass(&mut self) -> Status {
        let (rows, nodes) = (self.rows, self.rows.len().min(self.cells.len()));
        // `at` is the row of the node whose end `end` is; the basic set can do without.
        let (mut link, mut at, mut end) = (0, 0, 0);
        loop {
            if let (true, Some(row), Some(cell)) = (link < nodes, rows.get(link), self.cells.get(link)) {
                at = if K::FULL { link } else { 0 };
                end = match &row.node {
                    _ if K::FULL && self.stopping => Status::Running.end(),
                    Node::Condition(leaf) => self.condition(link, leaf),
                    Node::Action(leaf) | Node::Inference(leaf) => {
                        let Some(end) = self.act(link, leaf, cell.slot) else { return Status::Running };
                        end
                    }
                    node if !K::FULL || node.is_basic() => {
                        link = cell.slot.child(link);
                        continue;
                    }
                    _ => {
                        (link, end) = self.enter(at);
                        continue;
                    }
                };
                link = row.link(end, K::FULL);
                continue;
            }
            let up = link ^ usize::from(UP);
            let passes = up < nodes && self.cells.get(up).is_some_and(|cell| cell.slot == Slot::IDLE);
            if let (true, Some(row)) = (passes, rows.get(up)) {
                at = if K::FULL { up } else { 0 };
                self.report(up, Slot::IDLE, Some(Status::of_end(end)));
                link = row.link(end, K::FULL);
                continue;
            }
            let parent = if K::FULL { self.parent(at) } else { link & usize::from(NONE) };
            if parent >= nodes {
                return Status::of_end(end);
            }
            (link, end) = self.leave(parent, at, Status::of_end(end));
            at = if K::FULL { parent } else { 0 };
            if !K::FULL {
                end &= 1; // as it is: so the compiler knows, and spares a step at each link
            }
        }
    }

    #[inline(always)]
    fn condition(&mut self, at: usize, leaf: &L) -> usize {
        let end = usize::from(!self.leaves.condition(leaf, self.now));
        self.report(at, Slot::IDLE, Some(Status::of_end(end)));
        end
    }

    /// Ticks an action. In the basic set a running one ends the pass: `None`.
    #[inline(always)]
    fn act(&mut self, at: usize, leaf: &L, before: Slot) -> Option<usize> {
        let status = if before.is_running() {
            self.leaves.on_running(leaf, self.now)
        } else {
            self.leaves.on_start(leaf, self.now)
        };
        if !K::FULL && status == Status::Running {
            if !before.is_running() {
                self.suspend(at, before);
            }
            return None;
        }
        self.update(at, |_| if status == Status::Running { Slot::RUNNING } else { Slot::IDLE });
        self.report(at, before, Some(status));
        Some(if K::FULL { status.end() } else { usize::from(status == Status::Failure) })
    }

    /// Leaves the action in row `at` running, and all nodes above waiting for it.
    #[inline(never)]
    fn suspend(&mut self, mut at: usize, before: Slot) {
        self.halt(at + 1, 0);
        self.update(at, |_| Slot::RUNNING);
        self.report(at, before, Some(Status::Running));
        loop {
            let parent = self.parent(at);
            let (link, _) = self.leave(parent, at, Status::Running);
            if link == NO_NODE {
                break;
            }
            at = parent;
        }
    }

    fn parent(&self, at: usize) -> usize {
        self.rows.get(at).map_or(NO_NODE, Row::parent)
    }

    /// Passes the result of the node in row `child` to its parent in row `at`; returns the next row
    /// and its result.
    #[inline(never)]
    fn leave(&mut self, at: usize, child: usize, status: Status) -> (usize, usize) {
        self.ask(at, |visit| visit.child_returned(child, status))
    }

    /// Ticks a node beyond the basic set.
    #[inline(never)]
    fn enter(&mut self, at: usize) -> (usize, usize) {
        let runs = self.is_running(at + 1);
        let answer = match self.rows.get(at).map(Row::node) {
            Some(Node::Switch(_, leaf)) => self.leaves.case(leaf, self.now),
            // BehaviorTree.CPP does not ask again while the child runs.
            Some(Node::Precondition { condition, .. }) => {
                usize::from(K::COMPAT && runs || self.leaves.condition(condition, self.now))
            }
            _ => 0,
        };
        self.ask(at, |visit| visit.ticked(answer))
    }

    /// Carries out the decision of the node in row `at`; returns the next row, and the node's
    /// result if it has one.
    #[inline(always)]
    fn ask(&mut self, at: usize, decide: impl FnOnce(Visit<'_, L, K>) -> VisitOutcome) -> (usize, usize) {
        let (Some(row), Some(cell)) = (self.rows.get(at), self.cells.get(at)) else {
            return (NO_NODE, Status::Failure.end());
        };
        let before = cell.slot;
        let decision = decide(Visit::new(self.rows, self.cells, row, cell, at, self.now));
        match decision.effect {
            VisitEffect::Nothing => {}
            VisitEffect::Halt(first) => self.halt(first, at),
            VisitEffect::Done(child) => self.update(child, Slot::done),
            VisitEffect::Yield => self.yielded = true,
        }
        if let Some(cell) = self.cells.get_mut(at) {
            cell.slot = decision.slot;
            cell.extra = K::Extra::of(decision.extra);
        }
        match decision.step {
            Step::Enter(child) => (child, 0),
            Step::Return(status) => {
                self.report(at, before, Some(status));
                (row.link(status.end(), K::FULL), status.end())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::script::{Script, play};
    use crate::time::Instant;
    use crate::tree;
    use crate::tree::{Halt, Leaves, Memory, Status, StatusChange, Tree};
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
        let tree: Tree<char, _> = tree! { Sequence { Action('a'), Action('b'), Action('c') } };
        play(tree, "a=S b=F c=S", &["a:S b:F => Failure", "a:S b:F => Failure"]);
        play(tree, "a=S b=S c=S", &["a:S b:S c:S => Success"]);
    }

    #[test]
    fn a_fallback_ends_with_its_first_success() {
        let tree: Tree<char, _> = tree! { Fallback { Action('a'), Action('b'), Action('c') } };
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
        let tree: Tree<char, _> =
            tree! { Sequence { Action('a'), ReactiveSequence { Condition('g'), Action('b') } } };
        let mut memory = Memory::new();
        let mut script = Script::new("a=S g=S b=R");
        tree.halt(&mut memory, &mut script, Instant(0));
        assert_eq!(script.trace("."), ".");
        assert_eq!(tree.tick(&mut memory, &mut script, Instant(0)).status, Status::Running);
        assert_eq!(script.trace("."), "a:S g:S b:R .");
        tree.halt(&mut memory, &mut script, Instant(1));
        tree.halt(&mut memory, &mut script, Instant(1));
        assert_eq!(script.trace("."), "halt(b) .");
        assert!(memory.is_idle());
        assert_eq!(tree.tick(&mut memory, &mut script, Instant(2)).status, Status::Running);
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

        fn on_halted(&mut self, _: &(), now: Instant) -> Halt {
            self.times.push(("halted", now.0));
            Halt::Done
        }

        fn transition(&mut self, it: StatusChange) {
            self.transitions.push((it.node, it.from, it.to));
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
