//! Fixed-size sequences of action codes.
//!
//! A policy is one, and so is the way a robot takes over a grid and the part of an intention that
//! goes over the radio. Two actions share a byte, so that a sequence of [`HORIZON`] actions takes
//! [`BYTES`] bytes on the robot and half a byte per action on the wire.

use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeTuple;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The longest sequence, and so the longest horizon of a policy, in steps.
pub const HORIZON: usize = 64;

/// The bytes of a full sequence.
pub const BYTES: usize = HORIZON / 2;

/// One action code: an index into the actions of a transition model, below [`Actions::CODES`].
pub type Action = u8;

/// A sequence of at most [`HORIZON`] action codes.
#[doc(alias = "policy")]
#[doc(alias = "plan")]
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Actions {
    len: u8,
    packed: [u8; BYTES],
}

/// The sequence holds [`HORIZON`] actions already, or the code is not below [`Actions::CODES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("more than {HORIZON} actions, or an action code of {} or above", Actions::CODES)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ActionError;

impl Actions {
    /// The number of action codes, which run from 0 to `CODES - 1`.
    pub const CODES: u8 = 16;

    /// The sequence without actions.
    pub const EMPTY: Self = Self { len: 0, packed: [0; BYTES] };

    /// A sequence from a slice.
    ///
    /// # Errors
    /// [`ActionError`] when there are more than [`HORIZON`] actions or a code is out of range.
    pub fn new(actions: &[Action]) -> Result<Self, ActionError> {
        let mut sequence = Self::EMPTY;
        for &action in actions {
            sequence.push(action)?;
        }
        Ok(sequence)
    }

    /// A sequence for a `const` table.
    ///
    /// # Panics
    /// When there are more than [`HORIZON`] actions or a code is out of range; in a `const` or
    /// `static` this fails the build.
    ///
    /// ```
    /// use iibt_core::actions::Actions;
    ///
    /// static TWICE_RIGHT: Actions = Actions::of(&[1, 1]);
    /// assert_eq!(Actions::new(&[1, 1]), Ok(TWICE_RIGHT));
    /// ```
    #[must_use]
    pub const fn of(actions: &[Action]) -> Self {
        let mut sequence = Self::EMPTY;
        let mut rest = actions;
        while let [action, others @ ..] = rest {
            assert!(sequence.push(*action).is_ok(), "a policy has too many actions, or one of 16 or above");
            rest = others;
        }
        sequence
    }

    /// The number of actions.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len as usize
    }

    /// Whether there is no action.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Appends one action.
    ///
    /// # Errors
    /// [`ActionError`] when the sequence is full or the code is out of range; it is left as it was.
    pub const fn push(&mut self, action: Action) -> Result<(), ActionError> {
        let index = self.len();
        if action >= Self::CODES || index >= HORIZON {
            return Err(ActionError);
        }
        self.packed[index / 2] |= action << (4 * (index % 2));
        self.len += 1;
        Ok(())
    }

    /// The action at `index`, or `None` past the end.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<Action> {
        if index >= self.len() {
            return None;
        }
        let byte = self.packed.get(index / 2)?;
        Some((byte >> (4 * (index % 2))) & 0xf)
    }

    /// The actions in order.
    pub fn iter(&self) -> impl Iterator<Item = Action> + '_ {
        let code =
            |index: usize| self.packed.get(index / 2).map_or(0, |byte| (byte >> (4 * (index % 2))) & 0xf);
        (0..self.len()).map(code)
    }

    /// The largest action code; zero without actions.
    #[must_use]
    pub fn largest(&self) -> Action {
        self.bytes().iter().fold(0, |most, byte| most.max(byte & 0xf).max(byte >> 4))
    }

    /// Adds the bits of all action codes, two codes a byte, to `bits`: these are no less than the
    /// largest code.
    #[inline]
    pub(crate) fn gather_bits(&self, bits: &mut [u8; BYTES]) {
        bits.iter_mut().zip(&self.packed).for_each(|(bits, codes)| *bits |= codes);
    }

    fn bytes(&self) -> &[u8] {
        self.packed.get(..self.len().div_ceil(2)).unwrap_or(&[])
    }
}

impl Default for Actions {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl core::fmt::Debug for Actions {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for Actions {
    fn format(&self, f: defmt::Formatter<'_>) {
        for action in self.iter() {
            defmt::write!(f, "{} ", action);
        }
    }
}

/// On the wire: the number of actions, then two actions a byte and nothing else; an unused half
/// byte must be zero, so that a sequence has exactly one encoding.
impl Serialize for Actions {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let bytes = self.bytes();
        let mut wire = serializer.serialize_tuple(1 + bytes.len())?;
        wire.serialize_element(&self.len)?;
        for byte in bytes {
            wire.serialize_element(byte)?;
        }
        wire.end()
    }
}

impl<'de> Deserialize<'de> for Actions {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple(1 + BYTES, Wire)
    }
}

/// Reads the number of actions and then exactly their bytes.
struct Wire;

impl<'de> Visitor<'de> for Wire {
    type Value = Actions;

    fn expecting(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the number of actions and two actions a byte")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut wire: A) -> Result<Actions, A::Error> {
        let len: u8 = wire.next_element()?.ok_or_else(|| A::Error::custom("no action count"))?;
        let mut actions = Actions { len, packed: [0; BYTES] };
        let used = actions.packed.get_mut(..usize::from(len).div_ceil(2));
        for byte in used.ok_or_else(|| A::Error::custom("more actions than the horizon"))? {
            *byte = wire.next_element()?.ok_or_else(|| A::Error::custom("fewer actions than announced"))?;
        }
        let spare = len % 2 == 1 && actions.bytes().last().is_some_and(|last| last >> 4 != 0);
        if spare { Err(A::Error::custom("spare half byte of an action sequence")) } else { Ok(actions) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_what_was_pushed() {
        let actions = Actions::new(&[4, 0, 15, 3, 1]).unwrap();
        assert_eq!(actions.iter().collect::<std::vec::Vec<_>>(), [4, 0, 15, 3, 1]);
        assert_eq!(actions.get(5), None);
    }

    #[test]
    fn is_full_after_the_horizon() {
        let mut actions = Actions::EMPTY;
        for _ in 0..HORIZON {
            actions.push(7).unwrap();
        }
        let full = actions;
        assert_eq!(actions.push(0), Err(ActionError));
        assert_eq!(actions, full);
        assert_eq!(Actions::new(&[16]), Err(ActionError));
    }

    #[test]
    fn survives_the_wire_at_every_length() {
        for len in 0..=HORIZON {
            let mut actions = Actions::EMPTY;
            for index in 0..len {
                actions.push((index % 16) as u8).unwrap();
            }
            let mut buffer = [0; BYTES + 4];
            let bytes = postcard::to_slice(&actions, &mut buffer).unwrap();
            assert_eq!(bytes.len(), 1 + len.div_ceil(2));
            assert_eq!(postcard::from_bytes::<Actions>(bytes), Ok(actions));
        }
    }

    #[test]
    fn refuses_a_second_encoding() {
        assert!(postcard::from_bytes::<Actions>(&[1, 0x04]).is_ok());
        assert!(postcard::from_bytes::<Actions>(&[1, 0x14]).is_err());
    }

    #[test]
    fn refuses_a_wrong_count() {
        assert!(postcard::from_bytes::<Actions>(&[]).is_err());
        assert!(postcard::from_bytes::<Actions>(&[3, 0x14]).is_err());
        for count in [65, 66, 255] {
            let mut wire = [0; 130];
            wire[0] = count;
            assert!(postcard::from_bytes::<Actions>(&wire).is_err(), "{count} actions");
        }
    }
}
