//! The kinds of nodes.

/// One row of a tree's table; `L` names the caller's leaves.
///
/// An inner node is followed by its children, each with all its descendants. A composite says how many
/// children follow, at least one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Node<L> {
    /// Succeeds when all its children have succeeded, fails with the first that fails; resumes at the
    /// child that was running.
    Sequence(u8),
    /// Succeeds with the first child that succeeds, fails when all have failed; resumes at the child that
    /// was running.
    Fallback(u8),
    /// A sequence that starts from its first child at every tick.
    ReactiveSequence(u8),
    /// A fallback that starts from its first child at every tick.
    ReactiveFallback(u8),
    /// Exchanges success and failure of its one child.
    Inverter,
    /// A question that is answered at once.
    Condition(L),
    /// An action, which may take several ticks.
    Action(L),
    /// An interactive inference node: to the tree an action like any other.
    Inference(L),
}

impl<L> Node<L> {
    /// How many children follow, or `None` for a leaf.
    #[must_use]
    pub const fn children(&self) -> Option<u8> {
        match self {
            Self::Sequence(count)
            | Self::Fallback(count)
            | Self::ReactiveSequence(count)
            | Self::ReactiveFallback(count) => Some(*count),
            Self::Inverter => Some(1),
            Self::Condition(_) | Self::Action(_) | Self::Inference(_) => None,
        }
    }
}
