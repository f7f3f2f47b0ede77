//! Trees as types: the basic kinds of nodes as straight-line code.
//!
//! What [`tree!`](crate::tree!) writes as a table, [`compiled_tree!`](crate::compiled_tree!) writes as a value
//! whose type is the tree. The compiler turns its tick into nested branches, as if they had been written by hand; its
//! only state is a byte for each composite and each action. It has the same [`Leaves`], ticked and halted in the same
//! order as by a table of the [`Basic`](super::Basic) set. It reports no transitions, and every tree is code of its
//! own: the table is smaller from about the second tree on.

use super::leaves::{Leaves, Status};
use super::walk::inverted;
use crate::time::Instant;

/// A node of a compiled tree whose leaves are those of `V`, named by `L`; the root stands for the tree.
pub trait Compiled<L, V: ?Sized> {
    /// Ticks the node once.
    fn tick(&mut self, leaves: &mut V, now: Instant) -> Status;

    /// Halts what runs in the node; nothing happens if nothing does.
    fn halt(&mut self, leaves: &mut V, now: Instant);
}

/// The children of a compiled composite.
pub trait Children<L, V: ?Sized> {
    /// Ticks the children from number `from` on while they return `pass`, this one being number `index`; the
    /// status, and the number of the child that it came from.
    fn tick_from(&mut self, from: u8, index: u8, pass: Status, leaves: &mut V, now: Instant) -> (Status, u8);

    /// Halts the child that comes `after` so many others.
    fn halt_one(&mut self, after: u8, leaves: &mut V, now: Instant);
}

/// A child and those after it.
#[derive(Clone, Copy, Debug)]
pub struct Cons<A, B>(pub A, pub B);

/// After the last child.
#[derive(Clone, Copy, Debug)]
pub struct End;

/// A sequence or, if not `SEQUENCE`, a fallback; one that is `REACTIVE` begins at its first child every time.
#[derive(Clone, Copy, Debug)]
pub struct Composite<C, const SEQUENCE: bool, const REACTIVE: bool> {
    children: C,
    /// With memory: the number of the child to begin at. Reactive: of the one that runs, from 1.
    place: u8,
}

/// Exchanges success and failure of its child.
#[derive(Clone, Copy, Debug)]
pub struct Inverter<C>(pub C);

/// A condition, named by what `F` returns.
#[derive(Clone, Copy, Debug)]
pub struct Condition<F>(pub F);

/// An action, named by what `F` returns.
#[derive(Clone, Copy, Debug)]
pub struct Action<F> {
    name: F,
    running: bool,
}

impl<C, const SEQUENCE: bool, const REACTIVE: bool> Composite<C, SEQUENCE, REACTIVE> {
    const PASS: Status = if SEQUENCE { Status::Success } else { Status::Failure };

    /// An idle composite.
    pub const fn new(children: C) -> Self {
        Self { children, place: 0 }
    }
}

impl<F> Action<F> {
    /// An idle action.
    pub const fn new(name: F) -> Self {
        Self { name, running: false }
    }
}

impl<L, V: ?Sized> Children<L, V> for End {
    #[inline(always)]
    fn tick_from(&mut self, _: u8, index: u8, pass: Status, _: &mut V, _: Instant) -> (Status, u8) {
        (pass, index)
    }

    #[inline(always)]
    fn halt_one(&mut self, _: u8, _: &mut V, _: Instant) {}
}

impl<L, V: ?Sized, A: Compiled<L, V>, B: Children<L, V>> Children<L, V> for Cons<A, B> {
    #[inline(always)]
    fn tick_from(&mut self, from: u8, index: u8, pass: Status, leaves: &mut V, now: Instant) -> (Status, u8) {
        if from <= index {
            let status = self.0.tick(leaves, now);
            if status != pass {
                return (status, index);
            }
        }
        self.1.tick_from(from, index + 1, pass, leaves, now)
    }

    #[inline(always)]
    fn halt_one(&mut self, after: u8, leaves: &mut V, now: Instant) {
        match after.checked_sub(1) {
            None => self.0.halt(leaves, now),
            Some(after) => self.1.halt_one(after, leaves, now),
        }
    }
}

impl<L, V, C, const SEQUENCE: bool> Compiled<L, V> for Composite<C, SEQUENCE, false>
where
    V: ?Sized,
    C: Children<L, V>,
{
    #[inline(always)]
    fn tick(&mut self, leaves: &mut V, now: Instant) -> Status {
        let (status, child) = self.children.tick_from(self.place, 0, Self::PASS, leaves, now);
        self.place = if status == Status::Running { child } else { 0 };
        status
    }

    #[inline]
    fn halt(&mut self, leaves: &mut V, now: Instant) {
        let place = core::mem::take(&mut self.place);
        self.children.halt_one(place, leaves, now);
    }
}

impl<L, V, C, const SEQUENCE: bool> Compiled<L, V> for Composite<C, SEQUENCE, true>
where
    V: ?Sized,
    C: Children<L, V>,
{
    #[inline(always)]
    fn tick(&mut self, leaves: &mut V, now: Instant) -> Status {
        let (status, child) = self.children.tick_from(0, 0, Self::PASS, leaves, now);
        let before = self.place;
        self.place = if status == Status::Running { child + 1 } else { 0 };
        if before > child + 1 {
            self.children.halt_one(before - 1, leaves, now);
        }
        status
    }

    #[inline]
    fn halt(&mut self, leaves: &mut V, now: Instant) {
        if let Some(child) = core::mem::take(&mut self.place).checked_sub(1) {
            self.children.halt_one(child, leaves, now);
        }
    }
}

impl<L, V: ?Sized, C: Compiled<L, V>> Compiled<L, V> for Inverter<C> {
    #[inline(always)]
    fn tick(&mut self, leaves: &mut V, now: Instant) -> Status {
        inverted(self.0.tick(leaves, now))
    }

    #[inline]
    fn halt(&mut self, leaves: &mut V, now: Instant) {
        self.0.halt(leaves, now);
    }
}

impl<L, V: Leaves<L> + ?Sized, F: Fn() -> L> Compiled<L, V> for Condition<F> {
    #[inline(always)]
    fn tick(&mut self, leaves: &mut V, now: Instant) -> Status {
        leaves.condition(&(self.0)(), now).into()
    }

    #[inline]
    fn halt(&mut self, _: &mut V, _: Instant) {}
}

impl<L, V: Leaves<L> + ?Sized, F: Fn() -> L> Compiled<L, V> for Action<F> {
    #[inline(always)]
    fn tick(&mut self, leaves: &mut V, now: Instant) -> Status {
        let name = (self.name)();
        let status = if self.running { leaves.on_running(&name, now) } else { leaves.on_start(&name, now) };
        self.running = status == Status::Running;
        status
    }

    #[inline]
    fn halt(&mut self, leaves: &mut V, now: Instant) {
        if core::mem::take(&mut self.running) {
            let _ = leaves.on_halted(&(self.name)(), now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::script::Script;
    use super::super::{Compiled, Memory, Tree};
    use crate::time::Instant;
    use crate::{compiled_tree, tree};

    /// Both forms of one tree do the same, halts from outside included.
    fn same<const N: usize>(table: Tree<char, N>, mut compiled: impl Compiled<char, Script>, lines: &str) {
        let mut memory = Memory::new();
        let (mut ours, mut theirs) = (Script::new(lines), Script::new(lines));
        for tick in 0..24 {
            if tick % 7 == 6 {
                compiled.halt(&mut ours, Instant(tick));
                let _ = table.halt(&mut memory, &mut theirs, Instant(tick));
            } else {
                let status = compiled.tick(&mut ours, Instant(tick));
                assert_eq!(status, table.tick(&mut memory, &mut theirs, Instant(tick)).status);
            }
            assert_eq!(ours.trace(""), theirs.trace(""), "{lines} tick {tick}");
        }
    }

    macro_rules! same {
        ({ $($tree:tt)* } $lines:expr) => {
            for lines in $lines {
                same(tree! { $($tree)* }, compiled_tree! { $($tree)* }, lines);
            }
        };
    }

    #[test]
    fn a_compiled_tree_does_what_its_table_does() {
        same!({ ReactiveFallback {
            ReactiveSequence { Condition('g'), Action('h') },
            Sequence { Action('a'), Action('b') },
        } } ["g=SFSFFS h=RRS a=SRS b=RRRFRS", "g=FFS h=SRF a=RRRS b=FSR", "g=F h=R a=S b=R"]);
        same!({ Sequence {
            Fallback { Condition('g'), Inverter { Action('a') } },
            Inverter { Fallback { Action('b'), Action('c') } },
        } } ["g=SFSF a=RSFRF b=FSRF c=RRFS", "g=F a=RF b=FRF c=RS", "g=S a=R b=F c=R"]);
        same!({ ReactiveSequence { Action('a'), ReactiveFallback { Action('b'), Action('c') }, Action('d') } }
            ["a=SSRSF b=FSRF c=RRS d=R", "a=S b=RFR c=RSR d=R", "a=SSSSR b=F c=SSR d=R"]);
        same!({ Action('a') }["a=RSRF"]);
    }

    #[test]
    fn its_state_is_a_byte_for_each_composite_and_action() {
        let tree = compiled_tree! { Sequence { Fallback { Condition('g'), Action('a') }, Action('b') } };
        assert_eq!(size_of_val(&tree), 4);
    }
}
