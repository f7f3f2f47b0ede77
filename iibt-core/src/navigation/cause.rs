//! The reasons for opening a round.

/// Why a robot opened a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Cause {
    /// An obstacle is on a path of the plan.
    Obstacle,
    /// It has a way-point to visit.
    WayPoint,
    /// Its battery is low.
    Battery,
    /// It has charged its battery, or visited its way-points, and is free for a goal.
    Free,
    /// It is in another cell than its path prescribes.
    Position,
    /// A teammate is lost or back, has restarted, or knows the round otherwise.
    Teammate,
    /// The plan misses a goal, and more is known now.
    Shortfall,
    /// By what it has read of the unknowns, another plan is better.
    Reading,
    /// Its readings do not follow its moves: its localiser or its drive stands still.
    NoProgress,
}
