//! What a planner looks for: which of the plans for a problem, by which searches one after another.

use super::super::Cell;
use super::network::Turn;

/// How many steps later a plan may be for all robots to arrive together.
pub(crate) const LATER_TOGETHER: usize = 4;

/// Which of the plans for a problem is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Choice {
    /// In these turns only.
    pub(super) turn: Option<Turn>,
    /// Without this one of the goals.
    pub(super) without: Option<Cell>,
    /// In at most this many steps.
    pub(super) latest: Option<usize>,
    /// Short of at most this many goals.
    pub(super) most_short: Option<usize>,
    /// Whether it may be shorter for not arriving together.
    pub(super) staggered: bool,
}

impl Choice {
    /// The one of fewest steps, whether or not its robots arrive together.
    pub(super) const SOONEST: Self = Self { staggered: true, ..Self::BEST };

    /// The best one.
    pub(super) const BEST: Self =
        Self { turn: None, without: None, latest: None, most_short: None, staggered: false };
}

/// One search for a flow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Attempt {
    pub(super) kind: Kind,
    pub(super) turn: Turn,
    pub(super) is_second: bool,
}

/// Which plans an attempt looks for, in the order of the attempts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kind {
    /// Any.
    #[default]
    Plain,
    /// Those whose robots come to their goals in the last two steps, and that are not much longer
    /// than a plain one.
    Together,
    /// The path of an owner alone, around those that are fixed before.
    Owner(usize),
    /// Those of the others around the fixed paths of the owners.
    Around,
}
