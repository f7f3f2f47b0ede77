//! Trees as types: the basic kinds of nodes as straight-line code.
//!
//! What [`tree!`](crate::tree!) writes as a table, [`compiled_tree!`](crate::compiled_tree!) writes
//! as a value whose type is the tree. The compiler turns its tick into nested branches, as if they
//! had been written by hand. In the basic set at most one action is running, so its only state is
//! the number of that action: one byte. It has the same [`Leaves`], ticked and halted in the same
//! order as by a table of the [`Basic`](super::Basic) set. It reports no transitions, and every
//! tree is code of its own: the table is smaller from about the second tree on.
//!
//! The types here are what the macro expands to. A program names only [`Compiled`]:
//!
//! ```
//! use iibt_core::time::Instant;
//! use iibt_core::tree::{Compiled, Halt, Leaves, Status};
//!
//! /// A robot with its tree, of whatever form.
//! struct Robot<T> { tree: T, body: Body }
//!
//! struct Body { low: bool, at: &'static str }
//!
//! impl Leaves<&'static str> for Body {
//!     fn condition(&mut self, _: &&'static str, _: Instant) -> bool { self.low }
//!     fn on_start(&mut self, leaf: &&'static str, _: Instant) -> Status {
//!         self.at = leaf;
//!         Status::Running
//!     }
//!     fn on_running(&mut self, _: &&'static str, _: Instant) -> Status { Status::Running }
//!     fn on_halted(&mut self, _: &&'static str, _: Instant) -> Halt { self.at = ""; Halt::Done }
//! }
//!
//! impl<T: Compiled<&'static str, Body>> Robot<T> {
//!     fn tick(&mut self, now: u32) -> &'static str {
//!         assert_eq!(self.tree.tick(&mut self.body, Instant(now)), Status::Running);
//!         self.body.at
//!     }
//! }
//!
//! let tree = iibt_core::compiled_tree! {
//!     ReactiveFallback { Sequence { Condition("low"), Action("dock") }, Action("field") }
//! };
//! assert_eq!(size_of_val(&tree), 1);
//! let mut robot = Robot { tree, body: Body { low: false, at: "" } };
//! assert_eq!(robot.tick(0), "field");
//! robot.body.low = true;
//! robot.tick(1);
//! robot.tree.halt(&mut robot.body, Instant(2));
//! assert_eq!(robot.body.at, "");
//! ```

use super::leaves::Leaves;
use super::status::Status;
use crate::time::Instant;

/// A tree as straight-line code, whose leaves are those of `V`, named by `L`.
///
/// [`compiled_tree!`](crate::compiled_tree!) makes one.
///
/// ```
/// use iibt_core::compiled_tree;
/// use iibt_core::time::Instant;
/// use iibt_core::tree::{Compiled, Halt, Leaves, Status};
///
/// struct Light { on: bool }
///
/// impl Leaves<bool> for Light {
///     fn condition(&mut self, on: &bool, _: Instant) -> bool { self.on == *on }
///     fn on_start(&mut self, on: &bool, _: Instant) -> Status { self.on = *on; Status::Running }
///     fn on_running(&mut self, _: &bool, _: Instant) -> Status { Status::Success }
///     fn on_halted(&mut self, _: &bool, _: Instant) -> Halt { self.on = false; Halt::Done }
/// }
///
/// let mut tree = compiled_tree! { Fallback { Condition(true), Action(true) } };
/// let mut light = Light { on: false };
/// assert_eq!(tree.tick(&mut light, Instant(0)), Status::Running);
/// tree.halt(&mut light, Instant(1));
/// assert!(!light.on);
/// ```
pub trait Compiled<L, V: ?Sized> {
    /// Ticks the tree once.
    fn tick(&mut self, leaves: &mut V, now: Instant) -> Status;

    /// Halts the action that is running; nothing happens if none is.
    fn halt(&mut self, leaves: &mut V, now: Instant);
}

/// A compiled tree with the root `T`.
#[derive(Clone, Copy, Debug)]
pub struct Root<T> {
    node: T,
    /// The number of the action that is running, from 1; 0 for none.
    running: u8,
}

/// A node of a compiled tree. Actions are numbered in the order of the tree, those below this node
/// from `first` on.
pub trait Part<L, V: ?Sized> {
    /// The number of its actions.
    const ACTIONS: u8;

    /// Ticks the node, in which the action `resume` was running if its number is one of them, and 0
    /// or a lower number if none was.
    fn tick(&self, pass: &mut Pass<'_, V>, first: u8, resume: u8) -> Status;

    /// Halts the action `running`, which is one of them.
    fn halt(&self, leaves: &mut V, now: Instant, first: u8, running: u8);
}

/// The children of a compiled composite, numbered as in [`Part`].
pub trait Children<L, V: ?Sized> {
    /// The number of their actions.
    const ACTIONS: u8;

    /// Ticks the children in turn while they return `go_on`, beginning, unless `REACTIVE`, at the
    /// one in which `resume` was running: the status, and the number of the first action after the
    /// last child ticked.
    fn tick<const REACTIVE: bool>(
        &self,
        go_on: Status,
        pass: &mut Pass<'_, V>,
        first: u8,
        resume: u8,
    ) -> (Status, u8);

    /// Halts the action `running`, which is one of them.
    fn halt(&self, leaves: &mut V, now: Instant, first: u8, running: u8);
}

/// The context that all nodes share during a tick.
#[derive(Debug)]
pub struct Pass<'a, V: ?Sized> {
    leaves: &'a mut V,
    now: Instant,
    running: u8,
}

/// A child and those after it.
#[derive(Clone, Copy, Debug)]
pub struct Cons<A, B>(pub A, pub B);

/// After the last child.
#[derive(Clone, Copy, Debug)]
pub struct End;

/// A sequence or, if not `SEQUENCE`, a fallback; one that is `REACTIVE` begins at its first child
/// every time.
#[derive(Clone, Copy, Debug)]
pub struct Composite<C, const SEQUENCE: bool, const REACTIVE: bool>(pub C);

/// Exchanges success and failure of its child.
#[derive(Clone, Copy, Debug)]
pub struct Inverter<C>(pub C);

/// A condition, named by what `F` returns.
#[derive(Clone, Copy, Debug)]
pub struct CompiledCondition<F>(pub F);

/// An action, named by what `F` returns.
#[derive(Clone, Copy, Debug)]
pub struct CompiledAction<F>(pub F);

impl<T> Root<T> {
    /// An idle tree.
    pub const fn new(node: T) -> Self {
        Self { node, running: 0 }
    }
}

impl<L, V: ?Sized, T: Part<L, V>> Compiled<L, V> for Root<T> {
    #[inline]
    fn tick(&mut self, leaves: &mut V, now: Instant) -> Status {
        const { assert!(T::ACTIONS < u8::MAX, "a compiled tree has at most 254 actions") }
        let mut pass = Pass { leaves, now, running: 0 };
        let status = self.node.tick(&mut pass, 1, self.running);
        self.running = pass.running;
        status
    }

    #[inline]
    fn halt(&mut self, leaves: &mut V, now: Instant) {
        let running = core::mem::take(&mut self.running);
        if running > 0 {
            self.node.halt(leaves, now, 1, running);
        }
    }
}

impl<L, V: ?Sized> Children<L, V> for End {
    const ACTIONS: u8 = 0;

    #[inline(always)]
    fn tick<const REACTIVE: bool>(
        &self,
        go_on: Status,
        _: &mut Pass<'_, V>,
        first: u8,
        _: u8,
    ) -> (Status, u8) {
        (go_on, first)
    }

    #[inline(always)]
    fn halt(&self, _: &mut V, _: Instant, _: u8, _: u8) {}
}

impl<L, V: ?Sized, A: Part<L, V>, B: Children<L, V>> Children<L, V> for Cons<A, B> {
    const ACTIONS: u8 = A::ACTIONS + B::ACTIONS;

    #[inline(always)]
    fn tick<const REACTIVE: bool>(
        &self,
        go_on: Status,
        pass: &mut Pass<'_, V>,
        first: u8,
        resume: u8,
    ) -> (Status, u8) {
        let after = first + A::ACTIONS;
        let is_later = resume >= after;
        if REACTIVE || !is_later {
            let status = self.0.tick(pass, first, if is_later { 0 } else { resume });
            if status != go_on {
                return (status, after);
            }
        }
        self.1.tick::<REACTIVE>(go_on, pass, after, resume)
    }

    #[inline(always)]
    fn halt(&self, leaves: &mut V, now: Instant, first: u8, running: u8) {
        let after = first + A::ACTIONS;
        if running < after {
            self.0.halt(leaves, now, first, running);
        } else {
            self.1.halt(leaves, now, after, running);
        }
    }
}

impl<L, V, C, const SEQUENCE: bool, const REACTIVE: bool> Part<L, V> for Composite<C, SEQUENCE, REACTIVE>
where
    V: ?Sized,
    C: Children<L, V>,
{
    const ACTIONS: u8 = C::ACTIONS;

    #[inline(always)]
    fn tick(&self, pass: &mut Pass<'_, V>, first: u8, resume: u8) -> Status {
        let go_on = if SEQUENCE { Status::Success } else { Status::Failure };
        let (status, after) = self.0.tick::<REACTIVE>(go_on, pass, first, resume);
        if REACTIVE && resume >= after {
            self.0.halt(pass.leaves, pass.now, first, resume);
        }
        status
    }

    #[inline(always)]
    fn halt(&self, leaves: &mut V, now: Instant, first: u8, running: u8) {
        self.0.halt(leaves, now, first, running);
    }
}

impl<L, V: ?Sized, C: Part<L, V>> Part<L, V> for Inverter<C> {
    const ACTIONS: u8 = C::ACTIONS;

    #[inline(always)]
    fn tick(&self, pass: &mut Pass<'_, V>, first: u8, resume: u8) -> Status {
        self.0.tick(pass, first, resume).inverted()
    }

    #[inline(always)]
    fn halt(&self, leaves: &mut V, now: Instant, first: u8, running: u8) {
        self.0.halt(leaves, now, first, running);
    }
}

impl<L, V: Leaves<L> + ?Sized, F: Fn() -> L> Part<L, V> for CompiledCondition<F> {
    const ACTIONS: u8 = 0;

    #[inline(always)]
    fn tick(&self, pass: &mut Pass<'_, V>, _: u8, _: u8) -> Status {
        pass.leaves.condition(&(self.0)(), pass.now).into()
    }

    #[inline(always)]
    fn halt(&self, _: &mut V, _: Instant, _: u8, _: u8) {}
}

impl<L, V: Leaves<L> + ?Sized, F: Fn() -> L> Part<L, V> for CompiledAction<F> {
    const ACTIONS: u8 = 1;

    #[inline(always)]
    fn tick(&self, pass: &mut Pass<'_, V>, first: u8, resume: u8) -> Status {
        let status = act(pass.leaves, &(self.0)(), resume == first, pass.now);
        if status == Status::Running {
            pass.running = first;
        }
        status
    }

    #[inline(always)]
    fn halt(&self, leaves: &mut V, now: Instant, _: u8, _: u8) {
        let _ = leaves.on_halted(&(self.0)(), now);
    }
}

/// Ticks an action. On a chip it is called rather than inlined, which saves a fifth of a tree's
/// flash.
#[cfg_attr(target_os = "none", inline(never))]
fn act<L, V: Leaves<L> + ?Sized>(leaves: &mut V, name: &L, is_running: bool, now: Instant) -> Status {
    if is_running { leaves.on_running(name, now) } else { leaves.on_start(name, now) }
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
    fn its_state_is_one_byte() {
        let tree = compiled_tree! { Sequence { Fallback { Condition('g'), Action('a') }, Action('b') } };
        assert_eq!(size_of_val(&tree), 1);
    }
}
