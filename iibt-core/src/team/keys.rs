//! The keys of a team's senders, derived from one key of the team.

use super::{Key, MAX_TEAM, RobotId};
use core::hash::Hasher;
use siphasher::sip::SipHasher24;
use zeroize::Zeroize;

/// The begin of what a sender's key is derived from: no frame begins so, as its context comes
/// first.
const LABEL: &[u8; 16] = b"iibt sender key ";

/// The bytes of the keys of all senders.
type Senders = [[u8; Key::BYTES]; MAX_TEAM];

impl Key {
    /// Derives the key of a sender from this key of its team.
    ///
    /// `channel` tells teams with one key apart, `rotation` numbers the keys of a sender that
    /// follow each other. The halves of the derived key are SipHash-2-4 of a label, the channel,
    /// the rotation, the sender and the number of the half: a pseudorandom function in counter mode
    /// (NIST SP 800-108r1, section 4.1). Derived keys say nothing of the team's key or of each
    /// other.
    #[must_use]
    #[doc(alias = "KDF")]
    #[doc(alias = "key derivation")]
    pub fn of_sender(&self, channel: u32, rotation: u32, sender: RobotId) -> Self {
        let half = |number: u8| {
            let mut hasher = SipHasher24::new_with_key(self.bytes());
            hasher.write(LABEL);
            hasher.write(&channel.to_le_bytes());
            hasher.write(&rotation.to_le_bytes());
            hasher.write(&[sender.0, number]);
            hasher.finish()
        };
        Self::new(((u128::from(half(1)) << 64) | u128::from(half(0))).to_le_bytes())
    }
}

/// The keys under which the robots of a team send: one for each sender and, while keys are
/// exchanged, a second one that is accepted too.
///
/// Every robot of the team has all of them, since who can check a tag can make it. So a key of its
/// own keeps a sender's frames apart from those of others, and can be exchanged alone. It does not
/// keep a member from speaking in another's name.
///
/// ```
/// use iibt_core::team::{Context, FrameAuth, Key, Keys, RobotId, SipHash64};
///
/// let team = Key::new(*b"sixteen bytes...");
/// let context = Context::from_bits(7);
/// let [old, new] = [0, 1].map(|rotation| Keys::of_team(&team, 0, rotation));
/// let tag = SipHash64::with(new.clone()).tag(RobotId(1), context, b"frame");
///
/// let verifies = |keys, sender| SipHash64::with(keys).verify(sender, context, b"frame", &tag);
/// assert!(verifies(new.clone(), RobotId(1)) && !verifies(new.clone(), RobotId(2)));
/// assert!(!verifies(old.clone(), RobotId(1)) && verifies(old.accepting(&new), RobotId(1)));
/// ```
#[derive(Clone)]
pub struct Keys {
    senders: Senders,
    also: Option<Senders>,
}

impl Keys {
    /// Creates keys from one for each sender, by their numbers.
    #[must_use]
    pub const fn new(senders: [[u8; Key::BYTES]; MAX_TEAM]) -> Self {
        Self { senders, also: None }
    }

    /// Creates the same key for every sender.
    #[must_use]
    pub const fn shared(key: &Key) -> Self {
        Self::new([*key.bytes(); MAX_TEAM])
    }

    /// Derives the keys of all senders from the key of their team; see [`Key::of_sender`].
    #[must_use]
    pub fn of_team(team: &Key, channel: u32, rotation: u32) -> Self {
        let key = |sender| *team.of_sender(channel, rotation, RobotId(sender as u8)).bytes();
        Self::new(core::array::from_fn(key))
    }

    /// Accepts frames under the keys of `other` too: those before or after these, while keys are
    /// exchanged robot by robot.
    #[must_use]
    pub const fn accepting(self, other: &Self) -> Self {
        Self { also: Some(other.senders), ..self }
    }

    /// Returns the key under which a sender's frames are made; that of sender 0 for no sender.
    pub(super) fn of(&self, sender: RobotId) -> &[u8; Key::BYTES] {
        let [first, ..] = &self.senders;
        self.senders.get(sender.index()).unwrap_or(first)
    }

    /// Returns the second key under which a sender's frames are accepted.
    pub(super) fn also_of(&self, sender: RobotId) -> Option<&[u8; Key::BYTES]> {
        self.also.as_ref()?.get(sender.index())
    }
}

/// The same key for every sender.
impl From<Key> for Keys {
    fn from(key: Key) -> Self {
        Self::shared(&key)
    }
}

/// Overwrites the keys with zeros, in a way that the compiler keeps. Copies that the program has
/// moved from are not reached.
impl Zeroize for Keys {
    fn zeroize(&mut self) {
        self.senders.zeroize();
        self.also.zeroize();
    }
}

impl core::fmt::Debug for Keys {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Keys(..)")
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for Keys {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "Keys(..)");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    const TEAM: Key = Key::new([7; 16]);

    #[test]
    fn every_channel_rotation_and_sender_has_a_key_of_its_own() {
        let places = |n| [0_u32, 1, 256, u32::MAX].into_iter().take(n);
        let keys: BTreeSet<_> = places(4)
            .flat_map(|channel| places(4).map(move |rotation| (channel, rotation)))
            .flat_map(|(channel, rotation)| Keys::of_team(&TEAM, channel, rotation).senders)
            .chain([*TEAM.bytes()])
            .collect();
        assert_eq!(keys.len(), 4 * 4 * MAX_TEAM + 1);
        let halves: BTreeSet<_> = keys.iter().flat_map(|key| [&key[..8], &key[8..]]).collect();
        assert_eq!(halves.len(), 2 * (4 * 4 * MAX_TEAM) + 1, "the halves of a key are two numbers");
    }

    #[test]
    fn keys_are_shown_nowhere_and_can_be_overwritten() {
        let mut keys = Keys::of_team(&TEAM, 0, 1).accepting(&Keys::of_team(&TEAM, 0, 0));
        assert_eq!(std::format!("{keys:?}"), "Keys(..)");
        assert!(keys.senders.iter().all(|key| *key != [0; 16]) && keys.also.is_some());
        keys.zeroize();
        assert!(keys.senders == [[0; 16]; MAX_TEAM] && keys.also.is_none());
    }
}
