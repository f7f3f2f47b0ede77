//! The behavior tree `Patrol`, written by `host-sim tree codegen`.
//! Change the tree's file, not this one.

use iibt_core::tree::{Full, Millis, Node, Status, Times, Tree};

/// The leaves of the tree, which the program provides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leaf {
    /// Condition `BatteryOk`: limit = `0.2`.
    BatteryOk,
    /// Action `MoveTo`: err = `{error}`, goal = `{target}`, speed = `0.5`.
    MoveTo,
    /// Action `MoveTo` `home`: err = `{error}`, goal = `origin`, speed = `0.5`.
    Home,
    /// Condition: whether `mode < 3`.
    Precondition,
    /// Condition before `near`: whether `clear`.
    BeforeNear,
    /// Action `MoveTo` `near`: goal = `a`, speed = `0.5`.
    Near,
    /// Switch: which of `1`, `2` `{mode}` is, counted from 0.
    Switch2,
    /// Action `MoveTo` `far`: goal = `b`, speed = `1.5`.
    Far,
    /// Action `MoveTo` `round`: goal = `c`, speed = `0.5`.
    Round,
    /// Action: runs the script `mode = 1` and succeeds.
    Script,
}

/// The values that leaves share; the program keeps them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// `error`
    Error,
    /// `dock`
    Dock,
    /// `error`
    Error2,
}

/// The source of a port's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Port<T> {
    /// A constant.
    Constant(T),
    /// An entry of the blackboard.
    Entry(Entry),
}

impl Leaf {
    /// The port `err` of the leaves that have one.
    #[must_use]
    pub const fn err(self) -> Option<Entry> {
        match self {
            Self::MoveTo => Some(Entry::Error),
            Self::Home => Some(Entry::Error2),
            #[allow(unreachable_patterns)]
            _ => None,
        }
    }

    /// The port `goal` of the leaves that have one.
    #[must_use]
    pub const fn goal(self) -> Option<Port<&'static str>> {
        match self {
            Self::MoveTo => Some(Port::Entry(Entry::Dock)),
            Self::Home => Some(Port::Constant("origin")),
            Self::Near => Some(Port::Constant("a")),
            Self::Far => Some(Port::Constant("b")),
            Self::Round => Some(Port::Constant("c")),
            #[allow(unreachable_patterns)]
            _ => None,
        }
    }

    /// The port `limit` of the leaves that have one.
    #[must_use]
    pub const fn limit(self) -> Option<f32> {
        match self {
            Self::BatteryOk => Some(0.2),
            #[allow(unreachable_patterns)]
            _ => None,
        }
    }

    /// The port `speed` of the leaves that have one.
    #[must_use]
    pub const fn speed(self) -> Option<f32> {
        match self {
            Self::MoveTo => Some(0.5),
            Self::Home => Some(0.5),
            Self::Near => Some(0.5),
            Self::Far => Some(1.5),
            Self::Round => Some(0.5),
            #[allow(unreachable_patterns)]
            _ => None,
        }
    }
}

/// The number of nodes in the table.
pub const NODES: usize = 20;

/// The tree `Patrol`.
#[rustfmt::skip]
pub static TREE: Tree<Leaf, NODES, Full> = Tree::new([
    Node::ReactiveFallback(6),
        Node::Condition(Leaf::BatteryOk),
        Node::SubTree,
            Node::RetryUntilSuccessful(Times::new(4)),
                Node::Action(Leaf::MoveTo),
        Node::Timeout(Millis::new(500)),
            Node::Action(Leaf::Home),
        Node::Precondition { condition: Leaf::Precondition, otherwise: Status::Skipped },
            Node::Sleep(Millis::new(20)),
        Node::Parallel { children: 2, success_count: 2, failure_count: 1 },
            Node::Precondition { condition: Leaf::BeforeNear, otherwise: Status::Skipped },
                Node::Action(Leaf::Near),
            Node::AlwaysSuccess,
        Node::Switch(3, Leaf::Switch2),
            Node::RunOnce { then_skip: true },
                Node::Action(Leaf::Far),
            Node::Delay(Millis::new(30)),
                Node::Repeat(Times::new(-1)),
                    Node::Action(Leaf::Round),
            Node::Action(Leaf::Script),
]);
