//! The behavior tree `T21`, written by `host-sim tree codegen`.
//! Change the tree's file, not this one.

use iibt_core::tree::{Node, Tree};

/// The leaves of the tree, which the program provides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leaf {
    /// Condition `Refused`.
    Refused,
    /// Condition `Allowed`.
    Allowed,
    /// Action `Act`.
    Act,
}

/// The number of nodes in the table.
pub const NODES: usize = 21;

/// The tree `T21`.
#[rustfmt::skip]
pub static TREE: Tree<Leaf, NODES> = Tree::new([
    Node::Sequence(4),
        Node::Fallback(2),
            Node::Condition(Leaf::Refused),
            Node::Sequence(2),
                Node::Condition(Leaf::Allowed),
                Node::Action(Leaf::Act),
        Node::Fallback(2),
            Node::Condition(Leaf::Refused),
            Node::Sequence(2),
                Node::Condition(Leaf::Allowed),
                Node::Action(Leaf::Act),
        Node::Fallback(2),
            Node::Condition(Leaf::Refused),
            Node::Sequence(2),
                Node::Condition(Leaf::Allowed),
                Node::Action(Leaf::Act),
        Node::Fallback(2),
            Node::Condition(Leaf::Refused),
            Node::Sequence(2),
                Node::Condition(Leaf::Allowed),
                Node::Action(Leaf::Act),
]);
