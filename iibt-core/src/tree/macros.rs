//! The nested notation for trees.

/// A [`Tree`](crate::tree::Tree) written as it nests; the numbers of children are counted.
///
/// Each node is the name of a [`Node`](crate::tree::Node) with its children in braces or its leaf in
/// parentheses. In a `static` or `const`, a mistake fails the build.
///
/// The macro recurses once a node: more than about 120 nodes need a larger `recursion_limit` in the crate
/// that uses it, or a table given to [`Tree::new`](crate::tree::Tree::new).
///
/// ```
/// use iibt_core::tree::{Node, Tree};
///
/// #[derive(Clone, Copy, Debug, PartialEq)]
/// enum Skill { BatteryEnough, Charge, MoveToGoal }
///
/// static MISSION: Tree<Skill, 5> = iibt_core::tree! {
///     Sequence {
///         Fallback {
///             Condition(Skill::BatteryEnough),
///             Action(Skill::Charge),
///         },
///         Inference(Skill::MoveToGoal),
///     }
/// };
///
/// assert_eq!(MISSION, Tree::new([
///     Node::Sequence(2),
///         Node::Fallback(2),
///             Node::Condition(Skill::BatteryEnough),
///             Node::Action(Skill::Charge),
///         Node::Inference(Skill::MoveToGoal),
/// ]));
/// ```
#[macro_export]
macro_rules! tree {
    (@table [$($row:expr,)*]) => {
        $crate::tree::Tree::new([$($row),*])
    };
    (@table [$($row:expr,)*] Inverter { $kind:ident $body:tt $(,)? } $($rest:tt)*) => {
        $crate::tree!(@table [$($row,)* $crate::tree::Node::Inverter,] $kind $body $($rest)*)
    };
    (@table [$($row:expr,)*] Inverter { $($children:tt)* } $($rest:tt)*) => {
        ::core::compile_error!("an inverter has exactly one child")
    };
    (@table [$($row:expr,)*] $kind:ident { $($child:ident $body:tt),* $(,)? } $($rest:tt)*) => {
        $crate::tree!(
            @table
            [$($row,)* $crate::tree::Node::$kind({
                const CHILDREN: &[&::core::primitive::str] = &[$(::core::stringify!($child)),*];
                ::core::assert!(CHILDREN.len() <= 255, "a composite has at most 255 children");
                CHILDREN.len() as u8
            }),]
            $($child $body)* $($rest)*
        )
    };
    (@table [$($row:expr,)*] $kind:ident ($leaf:expr) $($rest:tt)*) => {
        $crate::tree!(@table [$($row,)* $crate::tree::Node::$kind($leaf),] $($rest)*)
    };
    ($kind:ident $body:tt) => {
        $crate::tree!(@table [] $kind $body)
    };
}
