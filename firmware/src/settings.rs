//! What differs from robot to robot and from team to team, apart from the mission.

use iibt_core::team::Key;
use iibt_core::time::Duration;

/// A robot's settings. Durations are in ticks of its clock.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The key that all robots of the team share.
    pub key: Key,
    /// How often this robot has started, counted in memory that outlives a restart; a number used before makes
    /// teammates take its frames for replayed ones.
    pub epoch: u32,
    /// The time between two frames. A teammate is fresh for eight of them, and lost after sixteen.
    pub beacon: Duration,
    /// How long the inference node looks for a policy whose precondition holds before it fails.
    pub timeout: Duration,
    /// The charge in percent below which the robot leaves the team to charge.
    pub low_battery: u8,
    /// The charge in percent at which it comes back.
    pub charged: u8,
}

impl Settings {
    /// Settings for a controller whose clock counts its own ticks: a frame at every tick.
    ///
    /// On a clock that counts milliseconds, set `beacon` to the period of the controller's ticks and `timeout` to
    /// some seconds: with the values from here, a teammate would be stale after eight milliseconds.
    #[must_use]
    pub const fn new(key: Key, epoch: u32) -> Self {
        Self { key, epoch, beacon: Duration(1), timeout: Duration(100), low_battery: 20, charged: 90 }
    }
}
