//! A number that stands for all that a round decides from.

use core::hash::Hasher;
use postcard::ser_flavors::Flavor;
use serde::{Deserialize, Serialize};
use siphasher::sip::SipHasher24;

/// 32 bits over a round's number, view and walls, and every member's epoch and fact.
///
/// Members whose digests are equal work on the same list from the same facts. Facts that differ
/// have equal digests by accident once in 2^32.
#[doc(alias = "hash")]
#[doc(alias = "fingerprint")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Digest(pub [u8; 4]);

/// SipHash-2-4 over bytes as a frame would carry them.
pub(super) struct Digester(SipHasher24);

impl Digester {
    /// A digest under a number that stands for the mission and the generator of the list.
    pub(super) fn new(mission: u64) -> Self {
        Self(SipHasher24::new_with_keys(mission, 0))
    }

    /// Takes in a value. One that has no encoding counts as far as it was encoded: it can be in no
    /// frame either, so no teammate takes it in as a whole.
    pub(super) fn absorb(mut self, value: &impl Serialize) -> Self {
        drop(postcard::serialize_with_flavor(value, Bytes(&mut self.0)));
        self
    }

    /// The low half of the hash, little-endian.
    pub(super) fn finish(&self) -> Digest {
        Digest((self.0.finish() as u32).to_le_bytes())
    }
}

/// Where encoded bytes go.
struct Bytes<'a>(&'a mut SipHasher24);

impl Flavor for Bytes<'_> {
    type Output = ();

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.0.write(&[byte]);
        Ok(())
    }

    fn try_extend(&mut self, bytes: &[u8]) -> postcard::Result<()> {
        self.0.write(bytes);
        Ok(())
    }

    fn finalize(self) -> postcard::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// The digest is of the encoded bytes, in however many pieces they come.
    #[test]
    fn is_the_hash_of_the_encoded_bytes() {
        let values = (300_u32, 7_u8, Some(2_u16));
        let bytes: Vec<u8> = [0xac, 0x02, 7, 1, 2].to_vec();
        let mut whole = SipHasher24::new_with_keys(9, 0);
        whole.write(&bytes);
        let expected = Digest((whole.finish() as u32).to_le_bytes());
        assert_eq!(Digester::new(9).absorb(&values).finish(), expected);
        assert_eq!(Digester::new(9).absorb(&values.0).absorb(&(values.1, values.2)).finish(), expected);
        assert_ne!(Digester::new(8).absorb(&values).finish(), expected);
    }
}
