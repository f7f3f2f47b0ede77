//! Ticking.
//!
//! The walk goes down the table and comes back along the parents, so it needs no stack. It ends whatever the
//! memory holds: a node is entered again in the same pass only when a count has grown or a child that
//! was running no longer is.

use super::interrupt::{go_on_halting, halt_all, halt_from};
use super::kinds::Kinds;
use super::leaves::Leaves;
use super::log::Transition;
use super::memory::{Cell, Slot};
use super::node::Node;
use super::overdue::halt_overdue;
use super::status::{Halt, Status};
use super::table::{Next, Row, Tick};
use super::{deadline, full};
use crate::time::Instant;
use core::ops::ControlFlow::{self, Break, Continue};

/// Ticks the tree in `rows`, in one pass.
#[inline(always)]
pub(super) fn tick<L, V, K>(rows: &[Row<L>], cells: &mut [Cell<K>], leaves: &mut V, now: Instant) -> Tick
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    // One length for both spares the walk every other bounds check.
    let Some(cells) = cells.get_mut(..rows.len()) else {
        return Tick { status: Status::Failure, next: Next::Event };
    };
    if !K::FULL {
        let status = Walk { rows, cells, leaves, now, stopping: false, yielded: false }.basic_pass();
        return Tick { status, next: Next::Event };
    }
    full_tick(rows, cells, leaves, now)
}

#[inline(never)]
fn full_tick<L, V, K>(rows: &[Row<L>], cells: &mut [Cell<K>], leaves: &mut V, now: Instant) -> Tick
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    if cells.first().is_some_and(|root| root.slot.has_alarm())
        && go_on_halting(rows, cells, leaves, now) == Halt::Pending
    {
        return Tick { status: Status::Running, next: Next::Now };
    }
    let stopping = K::COMPAT && halt_overdue(rows, cells, leaves, now) == Halt::Pending;
    let mut walk = Walk { rows, cells, leaves, now, stopping, yielded: false };
    let status = walk.pass();
    let (stopping, yielded) = (walk.stopping, walk.yielded);
    if stopping {
        raise_alarm(cells);
    }
    let next = if stopping || yielded && status == Status::Running {
        Next::Now
    } else if status == Status::Running {
        deadline::next(rows, cells, leaves, now)
    } else {
        Next::Event
    };
    Tick { status, next }
}

/// Ticks the tree until it no longer wants the next pass at once, `passes` times at the most.
pub(super) fn tick_until_idle<L, V, K>(
    rows: &[Row<L>],
    cells: &mut [Cell<K>],
    leaves: &mut V,
    now: Instant,
    passes: u16,
) -> Tick
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let mut result = tick(rows, cells, leaves, now);
    for _ in 1..passes {
        // An action that is still stopping is asked once a tick, not once a pass.
        let stopping = cells.first().is_some_and(|root| root.slot.has_alarm());
        if result.status != Status::Running || result.next != Next::Now || stopping {
            break;
        }
        result = tick(rows, cells, leaves, now);
    }
    result
}

/// Halts the whole tree.
#[inline(always)]
pub(super) fn halt<L, V, K>(rows: &[Row<L>], cells: &mut [Cell<K>], leaves: &mut V, now: Instant) -> Halt
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let Some(cells) = cells.get_mut(..rows.len()) else { return Halt::Done };
    if K::FULL {
        return full_halt(rows, cells, leaves, now);
    }
    Walk { rows, cells, leaves, now, stopping: false, yielded: false }.halt_rows(0, 0);
    Halt::Done
}

#[inline(never)]
fn full_halt<L, V, K>(rows: &[Row<L>], cells: &mut [Cell<K>], leaves: &mut V, now: Instant) -> Halt
where
    V: Leaves<L> + ?Sized,
    K: Kinds,
{
    let mut pending = false;
    if cells.first().is_some_and(|root| root.slot.has_alarm()) {
        pending = go_on_halting(rows, cells, leaves, now) == Halt::Pending;
    }
    let is_running = cells.first().is_some_and(Cell::is_running);
    pending |= halt_from(rows, cells, leaves, now, 0) == Halt::Pending;
    if K::COMPAT {
        if rows.len() == 1 && !is_running {
            let _ = halt_all(rows, leaves, now); // there the root is halted even if idle, then every node
        }
        pending |= halt_all(rows, leaves, now) == Halt::Pending;
    }
    if !pending {
        return Halt::Done;
    }
    raise_alarm(cells);
    Halt::Pending
}

fn raise_alarm<K: Kinds>(cells: &mut [Cell<K>]) {
    if let Some(root) = cells.first_mut() {
        root.slot = root.slot.with_alarm(true);
    }
}

pub(super) struct Walk<'a, L, V: ?Sized, K: Kinds> {
    pub(super) rows: &'a [Row<L>],
    pub(super) cells: &'a mut [Cell<K>],
    pub(super) leaves: &'a mut V,
    pub(super) now: Instant,
    /// Whether an action that was halted in this pass has not stopped.
    pub(super) stopping: bool,
    /// Whether a node wants the next pass at once.
    pub(super) yielded: bool,
}

impl<L, V: Leaves<L> + ?Sized, K: Kinds> Walk<'_, L, V, K> {
    #[inline]
    fn pass(&mut self) -> Status {
        let mut at = 0;
        loop {
            let status = match self.enter(at) {
                Some(Continue(child)) => {
                    at = child;
                    continue;
                }
                Some(Break(status)) => status,
                None => return Status::Failure,
            };
            match self.climb(at, status) {
                Continue(sibling) => at = sibling,
                Break(status) => return status,
            }
        }
    }

    /// Ticks the node in row `at`: its status if it is a leaf, else the row of the child to enter first; `None`
    /// past the end, which only the memory of another tree leads to.
    #[inline]
    fn enter(&mut self, at: usize) -> Option<ControlFlow<Status, usize>> {
        let (row, cell) = (self.rows.get(at)?, self.cells.get_mut(at)?);
        if self.stopping {
            return Some(Break(Status::Running));
        }
        let before = cell.slot;
        let status = match &row.node {
            Node::Sequence(_)
            | Node::Fallback(_)
            | Node::ReactiveSequence(_)
            | Node::ReactiveFallback(_)
            | Node::Inverter => {
                return Some(Continue(before.child(at)));
            }
            Node::Condition(leaf) => self.leaves.condition(leaf, self.now).into(),
            Node::Action(leaf) | Node::Inference(leaf) => {
                let status = if before.is_running() {
                    self.leaves.on_running(leaf, self.now)
                } else {
                    self.leaves.on_start(leaf, self.now)
                };
                cell.slot = if status == Status::Running { Slot::RUNNING } else { Slot::IDLE };
                status
            }
            _ => return Some(full::enter(self, row, at)),
        };
        self.report(at, before, Some(status));
        Some(Break(status))
    }

    /// Takes the status of the node in row `at` to its parent, and on from there to the next node to enter, or to
    /// the status of the root.
    #[inline]
    fn climb(&mut self, mut at: usize, mut status: Status) -> ControlFlow<Status, usize> {
        let rows = self.rows;
        while let Some(child) = rows.get(at) {
            if let Some(next) = child.next_on(status) {
                return Continue(next);
            }
            let parent = child.parent();
            let Some(row) = rows.get(parent) else { break };
            if !row.node.is_basic() {
                match full::returned(self, row, parent, at, status) {
                    Continue(next) => return Continue(next),
                    Break(own) => status = own,
                }
            } else if status == Status::Running {
                self.settle(parent, at, Slot::waiting(parent, at), status);
            } else {
                if matches!(row.node, Node::Inverter) {
                    status = inverted(status);
                } else if status == Status::Skipped {
                    match self.skip(parent, at) {
                        Continue(next) => return Continue(next),
                        Break(own) => status = own,
                    }
                }
                self.settle(parent, at, Slot::IDLE, status);
            }
            at = parent;
        }
        Break(status)
    }

    /// Ends the tick of the basic inner node in row `parent`, which ticked the child in row `child` last and
    /// keeps `after` in mind. A later child that is running is halted: only a reactive node has one.
    #[inline]
    fn settle(&mut self, parent: usize, child: usize, after: Slot, status: Status) {
        let (Some(row), Some(cell)) = (self.rows.get(parent), self.cells.get_mut(parent)) else { return };
        let before = cell.slot;
        if before != Slot::IDLE || after != Slot::IDLE {
            cell.slot = match row.node {
                _ if !after.is_running() => after,
                Node::ReactiveSequence(_) | Node::ReactiveFallback(_) => Slot::RUNNING,
                _ => after.with_skips(before.skips()),
            };
        }
        if before.is_running() {
            self.halt_after(child);
        }
        self.report(parent, before, Some(status));
    }

    /// Halts what runs among the siblings after the node in row `at`.
    fn halt_after(&mut self, at: usize) {
        let mut at = at;
        while let Some(sibling) = self.rows.get(at).and_then(Row::sibling) {
            if self.cells.get(sibling).is_some_and(Cell::is_running) {
                self.halt_from(sibling);
            }
            at = sibling;
        }
    }

    /// Counts a child that was skipped: the next one to enter or, after the last, the parent's own status.
    /// A sequence or fallback is skipped when all its children were.
    #[cold]
    pub(super) fn skip(&mut self, parent: usize, child: usize) -> ControlFlow<Status, usize> {
        let rows = self.rows;
        let (Some(row), Some(this)) = (rows.get(parent), rows.get(child)) else {
            return Break(Status::Skipped);
        };
        let mut index = 0;
        let mut sibling = parent + 1;
        while sibling < child {
            index += 1;
            sibling = rows.get(sibling).and_then(Row::sibling).unwrap_or(child);
        }
        let Some(cell) = self.cells.get_mut(parent) else { return Break(Status::Skipped) };
        let all = index == 0 || cell.slot.skips() == index;
        if all {
            cell.slot = cell.slot.with_skips(index + 1);
        }
        if let Some(next) = this.sibling() {
            return Continue(next);
        }
        Break(match row.node {
            _ if all => Status::Skipped,
            Node::Fallback(_) | Node::ReactiveFallback(_) | Node::AsyncFallback(_) => Status::Failure,
            _ => Status::Success,
        })
    }

    /// Halts the node in row `top` and what runs below it.
    pub(super) fn halt_from(&mut self, top: usize) {
        let halted = halt_from(self.rows, self.cells, self.leaves, self.now, top);
        self.stopping |= halted == Halt::Pending;
    }

    #[inline]
    pub(super) fn report(&mut self, node: usize, before: Slot, to: Option<Status>) {
        report(self.leaves, self.now, node, before, to);
    }
}

#[inline]
pub(super) fn report<L, V>(leaves: &mut V, time: Instant, node: usize, before: Slot, to: Option<Status>)
where
    V: Leaves<L> + ?Sized,
{
    let from = before.is_running().then_some(Status::Running);
    if from != to {
        leaves.transition(Transition { time, node: node as u16, from, to });
    }
}

pub(super) const fn inverted(status: Status) -> Status {
    match status {
        Status::Success => Status::Failure,
        Status::Failure => Status::Success,
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::super::script::{Script, play};
    use crate::time::Instant;
    use crate::tree;
    use crate::tree::{Halt, Leaves, Memory, Status, Transition, Tree};
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

        fn transition(&mut self, it: Transition) {
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
