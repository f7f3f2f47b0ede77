//! Why a robot calls its team to another decision.

/// What made a robot open a round.
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
    /// It finds itself elsewhere than its path says.
    Position,
    /// A teammate has agreed to another plan, because somebody has started anew.
    Outdated,
    /// Its best choice does not go with what the teammates before it have chosen.
    Misfit,
}
