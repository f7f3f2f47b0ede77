//! Authentication of frames with a key of the team.
//!
//! A keyed 64-bit tag costs less than a table-free CRC on a Cortex-M4 and detects what a CRC
//! detects, so there is no unauthenticated frame.

use super::{Context, Keys, RobotId};
use core::hash::Hasher;
use siphasher::sip::SipHasher24;
use zeroize::Zeroize;

/// The length of a tag on the wire.
pub const TAG_BYTES: usize = 8;

/// The authentication tag of one frame.
pub type Tag = [u8; TAG_BYTES];

/// A message authentication code over frames.
///
/// A code with longer tags is truncated to [`TAG_BYTES`]: a blind forger at 100 frames a second
/// then still needs 5.8e9 years.
#[doc(alias = "MAC")]
#[doc(alias = "message authentication code")]
#[doc(alias = "HMAC")]
pub trait FrameAuth {
    /// The tag of the signed bytes of a frame by `sender`, which also covers the context that is
    /// not sent.
    fn tag(&self, sender: RobotId, context: Context, signed: &[u8]) -> Tag;

    /// Whether `tag` is the tag of the signed bytes, in a time that does not depend on where two
    /// tags differ.
    fn verify(&self, sender: RobotId, context: Context, signed: &[u8], tag: &Tag) -> bool {
        is_equal(&self.tag(sender, context, signed), tag)
    }
}

fn is_equal(expected: &Tag, tag: &Tag) -> bool {
    let differing = expected.iter().zip(tag).fold(0, |bits, (a, b)| bits | (a ^ b));
    // Keeps the compiler from turning the fold into a loop that stops at the first difference.
    core::hint::black_box(differing) == 0
}

/// A 128-bit key. It is shown nowhere, not even by `Debug`.
#[derive(Clone)]
pub struct Key([u8; Self::BYTES]);

impl Key {
    /// The length of a key.
    pub const BYTES: usize = 16;

    /// A key from its bytes, which should come from a random number generator.
    #[must_use]
    pub const fn new(bytes: [u8; Self::BYTES]) -> Self {
        Self(bytes)
    }

    /// Returns the bytes, to be written into a robot's memory.
    #[must_use]
    pub const fn to_bytes(&self) -> [u8; Self::BYTES] {
        self.0
    }

    pub(super) const fn bytes(&self) -> &[u8; Self::BYTES] {
        &self.0
    }
}

impl Zeroize for Key {
    fn zeroize(&mut self) {
        self.0.zeroize();
    }
}

impl core::fmt::Debug for Key {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Key(..)")
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for Key {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "Key(..)");
    }
}

/// SipHash-2-4 with a 64-bit tag over the context (little-endian) and the signed bytes.
///
/// A frame of 40 bytes takes about 800 instructions on a Cortex-M4. SipHash is a pseudorandom
/// function with short output (Aumasson and Bernstein, 2012), not a NIST-approved MAC, and hides
/// nothing of the message.
#[doc(alias = "MAC")]
#[doc(alias = "SipHash-2-4")]
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SipHash64 {
    keys: Keys,
}

impl SipHash64 {
    /// The code under one key for all senders of a team.
    #[must_use]
    pub const fn new(key: Key) -> Self {
        Self { keys: Keys::shared(&key) }
    }

    /// The code under a key for each sender.
    #[must_use]
    pub const fn with(keys: Keys) -> Self {
        Self { keys }
    }
}

impl FrameAuth for SipHash64 {
    fn tag(&self, sender: RobotId, context: Context, signed: &[u8]) -> Tag {
        tag(self.keys.of(sender), context, signed)
    }

    /// As for one key; a tag that is not that of the sender's key is compared under the second one
    /// as well, where there is one.
    fn verify(&self, sender: RobotId, context: Context, signed: &[u8], tagged: &Tag) -> bool {
        is_equal(&self.tag(sender, context, signed), tagged)
            || self.keys.also_of(sender).is_some_and(|key| is_equal(&tag(key, context, signed), tagged))
    }
}

impl Zeroize for SipHash64 {
    fn zeroize(&mut self) {
        self.keys.zeroize();
    }
}

fn tag(key: &[u8; Key::BYTES], context: Context, signed: &[u8]) -> Tag {
    let mut hasher = SipHasher24::new_with_key(key);
    hasher.write_u64(context.to_bits().to_le()); // its bytes, little-endian
    // After whole words, this is what writing the rest and finishing comes to, in fewer steps.
    hasher.hash(signed).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    const AUTH: SipHash64 = SipHash64::new(Key::new([
        0x00, 0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x08, 0x09, 0x0a, 0x0b, 0x0c, 0x0d, 0x0e, 0x0f,
    ]));
    const SENDER: RobotId = RobotId(3);

    /// The worked example of the SipHash paper, appendix A: the bytes 0 to 14 under the key 0 to
    /// 15.
    #[test]
    fn is_siphash_2_4() {
        let context = Context::from_bits(u64::from_le_bytes([0, 1, 2, 3, 4, 5, 6, 7]));
        let tag = AUTH.tag(SENDER, context, &[8, 9, 10, 11, 12, 13, 14]);
        assert_eq!(u64::from_le_bytes(tag), 0xa129_ca61_49be_45e5);
    }

    #[test]
    fn verifies_the_very_tag_only() {
        let [seven, eight] = [7, 8].map(Context::from_bits);
        let tag = AUTH.tag(SENDER, seven, b"message");
        assert!(AUTH.verify(SENDER, seven, b"message", &tag));
        assert!(!AUTH.verify(SENDER, eight, b"message", &tag));
        assert!(!AUTH.verify(SENDER, seven, b"massage", &tag));
        for bit in 0..64 {
            let other = (u64::from_le_bytes(tag) ^ (1 << bit)).to_le_bytes();
            assert!(!AUTH.verify(SENDER, seven, b"message", &other), "bit {bit}");
        }
    }

    #[test]
    fn debug_output_does_not_show_the_key() {
        assert_eq!(std::format!("{AUTH:?}"), "SipHash64 { keys: Keys(..) }");
    }
}
