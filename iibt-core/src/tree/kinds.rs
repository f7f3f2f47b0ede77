//! Which kinds of nodes a tree may have.

/// A set of node kinds, chosen by a tree's type: what a set leaves out costs neither flash nor RAM.
///
/// Sealed: the sets are [`Basic`], [`Full`] and [`Compat`].
pub trait Kinds: sealed::Sealed + Copy + core::fmt::Debug + Eq {
    /// Whether every [`Node`](super::Node) is in it.
    const FULL: bool;
    /// Whether it does what BehaviorTree.CPP does where that is peculiar.
    const COMPAT: bool;
    /// What a node remembers besides its slot.
    #[doc(hidden)]
    type Extra: sealed::Extra;
}

/// Sequences and fallbacks, with memory and reactive, inverters, and leaves: 4 bytes of RAM a node.
///
/// It leaves out two things more: [`Halt::Pending`](super::Halt::Pending) counts as done, and
/// [`Status::Skipped`](super::Status::Skipped) is passed on like a success.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basic {}

/// Every kind of node: 8 bytes of RAM a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Full {}

/// Every kind of node, following BehaviorTree.CPP 4.10 also in those differences for which the [module](super)
/// says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compat {}

impl Kinds for Basic {
    const FULL: bool = false;
    const COMPAT: bool = false;
    type Extra = ();
}

impl Kinds for Full {
    const FULL: bool = true;
    const COMPAT: bool = false;
    type Extra = u32;
}

impl Kinds for Compat {
    const FULL: bool = true;
    const COMPAT: bool = true;
    type Extra = u32;
}

pub(super) mod sealed {
    pub trait Sealed {}

    impl Sealed for super::Basic {}
    impl Sealed for super::Full {}
    impl Sealed for super::Compat {}

    /// A count or the time at which something began; nothing in the basic set.
    pub trait Extra: Copy + PartialEq + core::fmt::Debug {
        const ZERO: Self;
        fn get(self) -> u32;
        fn of(value: u32) -> Self;
    }

    impl Extra for () {
        const ZERO: Self = ();
        fn get(self) -> u32 {
            0
        }
        fn of(_: u32) -> Self {}
    }

    impl Extra for u32 {
        const ZERO: Self = 0;
        fn get(self) -> u32 {
            self
        }
        fn of(value: u32) -> Self {
            value
        }
    }
}
