//! Messages from a task to its teammates.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// The content of a frame: one robot's state and choice, as its task announces them.
///
/// A message is complete. A receiver that has the newest one needs none of those before it, so a
/// frame that is lost costs time and nothing else.
///
/// ```
/// use iibt_core::team::{Invalid, Message};
/// use serde::{Deserialize, Serialize};
///
/// /// How open a valve is, in percent.
/// #[derive(Clone, Serialize, Deserialize)]
/// struct Valve {
///     percent: u8,
/// }
///
/// impl Message for Valve {
///     const SCHEMA: &'static str = "valve: percent u8";
///     const MAX_BYTES: usize = 1;
///
///     fn validate(&self) -> Result<(), Invalid> {
///         if self.percent <= 100 { Ok(()) } else { Err(Invalid("the valve is more than open")) }
///     }
/// }
///
/// assert!(Valve { percent: 40 }.validate().is_ok());
/// assert_eq!(Valve { percent: 140 }.validate().unwrap_err().0, "the valve is more than open");
/// ```
#[doc(alias = "payload")]
#[doc(alias = "broadcast")]
pub trait Message: Clone + Serialize + DeserializeOwned {
    /// A description of the layout.
    ///
    /// Its hash is authenticated with every frame. Change the description with the layout, and
    /// robots whose images disagree reject each other instead of misreading.
    const SCHEMA: &'static str;

    /// The description of the part that is of another type, in a message that is generic over it.
    /// It is hashed with [`SCHEMA`](Self::SCHEMA).
    const PART_SCHEMA: &'static str = "";

    /// The longest encoding in bytes. More than [`MAX_MESSAGE`](super::MAX_MESSAGE) fails the
    /// build. A message that takes more bytes than this says is not sent.
    ///
    /// The encoding is [postcard](https://postcard.jamesmunns.com/wire-format)'s: a `bool`, `u8`
    /// or `i8` takes one byte, a `u16` up to three, a `u32` up to five, an `f32` four. An `Option`
    /// takes one byte more than its value, and so does an enum.
    const MAX_BYTES: usize;

    /// Checks that every value is in its range, where the types alone do not ensure it.
    ///
    /// Neither sender nor receiver lets a message pass that fails this check.
    ///
    /// # Errors
    /// [`Invalid`] with the first value that is out of its range.
    fn validate(&self) -> Result<(), Invalid> {
        Ok(())
    }

    /// Reads a message from the front of `bytes`; returns it with the bytes that follow, or `None`
    /// if there is none.
    ///
    /// It must read what [`Serialize`] writes.
    #[must_use]
    fn read(bytes: &[u8]) -> Option<(Self, &[u8])> {
        postcard::take_from_bytes(bytes).ok()
    }

    /// Reads as [`read`](Self::read) does, into the place of another message; returns the bytes
    /// that follow. If there is no message in the bytes, what is left in its place is any one.
    ///
    /// A large message that reads its parts one by one is not copied on the way.
    #[must_use]
    fn read_into<'b>(&mut self, bytes: &'b [u8]) -> Option<&'b [u8]> {
        let (message, rest) = Self::read(bytes)?;
        *self = message;
        Some(rest)
    }

    /// Whether the sender takes part in joint decisions now. One that does not is not connected.
    fn takes_part(&self) -> bool {
        true
    }
}

/// The value of a message that no sender can mean, in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Invalid(pub &'static str);

/// Nothing: the message of robots that only have to know of each other.
impl Message for () {
    const SCHEMA: &'static str = "nothing";
    const MAX_BYTES: usize = 0;
}
