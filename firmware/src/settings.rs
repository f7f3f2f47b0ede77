//! The settings of a robot: its place in the team, the key, and the rhythm of its ticks.

use core::num::NonZero;
use iibt_core::team::{Key, Keys, Limits, Member};
use iibt_core::time::Duration;

/// A robot's place in its team, its key, and its rhythm.
///
/// ```
/// use core::num::NonZero;
/// use firmware::Settings;
/// use iibt_core::team::{Key, Member, RobotId};
/// use iibt_core::time::Duration;
///
/// const KEY: Key = Key::new(*b"sixteen bytes...");
/// const TICK: NonZero<u16> = NonZero::new(100).unwrap(); // ms, the period of `Controller::tick`
///
/// let settings = Settings::new(Member::new(RobotId(0), 3)?, KEY, 1, TICK);
/// assert_eq!(settings.tick(), Duration(100));
/// assert_eq!(settings.limits().fresh_for(), Duration(800)); // eight frames
/// # Ok::<(), iibt_core::team::MemberError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Settings {
    member: Member,
    keys: Keys,
    epoch: u32,
    tick: NonZero<u16>,
    channel: u32,
}

impl Settings {
    /// Creates the settings of a member of a team.
    ///
    /// `key` is shared by the team. `epoch` counts this robot's starts, in memory that outlives a
    /// restart; with a number used before, teammates take its frames for replayed ones. `tick` is
    /// the period of [`Controller::tick`](crate::Controller::tick) in ticks of the robot's clock.
    /// The robot sends a frame in each of them; a teammate is fresh for eight, and lost after
    /// sixteen.
    #[must_use]
    pub const fn new(member: Member, key: Key, epoch: u32, tick: NonZero<u16>) -> Self {
        Self::with_keys(member, Keys::shared(&key), epoch, tick)
    }

    /// Creates the same settings with a key for each sender.
    #[must_use]
    pub const fn with_keys(member: Member, keys: Keys, epoch: u32, tick: NonZero<u16>) -> Self {
        Self { member, keys, epoch, tick, channel: 0 }
    }

    /// Sets the channel, for several teams that share a key: frames of other channels are refused.
    #[must_use]
    pub const fn on_channel(mut self, channel: u32) -> Self {
        self.channel = channel;
        self
    }

    /// Returns the robot and its team.
    #[must_use]
    pub const fn member(&self) -> Member {
        self.member
    }

    /// Returns the epoch, the number of this start.
    #[must_use]
    pub const fn epoch(&self) -> u32 {
        self.epoch
    }

    /// Returns the period of the controller's ticks.
    #[must_use]
    pub const fn tick(&self) -> Duration {
        Duration(self.tick.get() as u32)
    }

    /// Returns the ages at which a teammate stops being fresh and is lost.
    #[must_use]
    pub const fn limits(&self) -> Limits {
        Limits::every(self.tick)
    }

    /// Returns the keys.
    #[must_use]
    pub const fn keys(&self) -> &Keys {
        &self.keys
    }

    pub(crate) const fn channel(&self) -> u32 {
        self.channel
    }
}
