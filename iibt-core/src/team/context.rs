//! The context that robots must share to accept each other's frames.

use super::Message;

/// The team, mission and layout that a frame belongs to, as one number under its tag.
///
/// Robots in different contexts reject each other's frames as if the key were wrong, and count
/// them.
///
/// ```
/// use iibt_core::team::{Context, Invalid, Message};
/// use serde::{Deserialize, Serialize};
///
/// #[derive(Clone, Serialize, Deserialize)]
/// struct Ping(u8);
///
/// impl Message for Ping {
///     const SCHEMA: &'static str = "ping: count u8";
///     const MAX_BYTES: usize = 1;
/// }
///
/// const HALL: Context = Context::of::<Ping>(7, 1);
/// assert_ne!(HALL, Context::of::<Ping>(8, 1), "another team");
/// assert_ne!(HALL, Context::of::<Ping>(7, 2), "another mission");
/// ```
#[doc(alias = "associated data")]
#[doc(alias = "AAD")]
#[doc(alias = "domain separation")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Context(u64);

impl Context {
    /// Of a robot without a mission.
    pub const NONE: Self = Self(0);

    /// The context of a team's mission with messages of the layout `M`.
    ///
    /// `team` tells teams with the same key apart, `mission` what they are to do: a hash of it, or
    /// a number given to it.
    #[must_use]
    pub const fn of<M: Message>(team: u32, mission: u64) -> Self {
        let hash = Fnv1a::EMPTY.write(ENVELOPE.as_bytes()).write(M::SCHEMA.as_bytes());
        let hash = hash.write(M::PART_SCHEMA.as_bytes());
        let hash = hash.write(&team.to_le_bytes()).write(&mission.to_le_bytes());
        Self(hash.finish())
    }

    /// The context with this number.
    #[must_use]
    pub const fn from_bits(bits: u64) -> Self {
        Self(bits)
    }

    /// The number.
    #[must_use]
    pub const fn to_bits(self) -> u64 {
        self.0
    }
}

/// The layout of the envelope; it changes with [`VERSION`](super::VERSION).
const ENVELOPE: &str = "sender u8; epoch u32; sequence u32; ";

/// The 64-bit hash FNV-1a, for descriptions and missions; it is not cryptographic.
#[derive(Clone, Copy, Debug)]
pub struct Fnv1a(u64);

impl Fnv1a {
    /// The hash of nothing.
    pub const EMPTY: Self = Self(0xcbf2_9ce4_8422_2325);

    /// The hash of everything so far and `bytes`.
    #[must_use]
    pub const fn write(mut self, mut bytes: &[u8]) -> Self {
        while let [first, rest @ ..] = bytes {
            self.0 = (self.0 ^ *first as u64).wrapping_mul(0x0000_0100_0000_01b3);
            bytes = rest;
        }
        self
    }

    /// The hash.
    #[must_use]
    pub const fn finish(self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values published with the hash function.
    #[test]
    fn the_hash_is_fnv1a() {
        let hash = |text: &str| Fnv1a::EMPTY.write(text.as_bytes()).finish();
        assert_eq!(hash(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(hash("a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(hash("foobar"), 0x8594_4171_f739_67e8);
    }
}
