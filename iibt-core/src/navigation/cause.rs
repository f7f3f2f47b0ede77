//! The reasons for opening a round.

/// Why a robot opened a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Cause {
    /// An obstacle is on its path.
    Obstacle,
    /// Its path leads past a way-point.
    WayPoint,
    /// Its battery is low.
    Battery,
    /// It stands in the way of a teammate that cannot get to its charger, and steps aside.
    Room,
    /// It comes back from charging, or from stepping aside.
    Charged,
    /// It is in another cell than its path prescribes.
    Position,
    /// A teammate has agreed to another plan, because a robot has restarted.
    Outdated,
    /// Its best choice is incompatible with the paths chosen before it.
    Misfit,
}
