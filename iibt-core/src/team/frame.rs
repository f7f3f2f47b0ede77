//! The frame: one intention as bytes for a radio or a serial line.
//!
//! ```text
//! COBS( version 1 B | body: the intention in postcard format | tag 8 B ) | delimiter 0x00
//! ```
//!
//! The tag covers version and body and, unsent, the [`SCHEMA`]: robots whose images disagree about the layout
//! reject each other instead of misreading. There is no other frame version, nothing is negotiated and no
//! frame goes without a tag. A frame has no bit to spare: any changed bit makes it invalid.

use super::{FrameAuth, Intention, Invalid, TAG_BYTES};

/// The first byte of every frame, before COBS.
pub const VERSION: u8 = 1;

/// The hash (FNV-1a) of a description of the body. Whoever changes the layout of [`Intention`] changes the
/// description, so that images before and after the change do not understand each other.
pub const SCHEMA: u64 = fnv1a(
    "robot u8; epoch u32; sequence u32; tick u32; round u16; \
     status Deciding Announced Agreed Arrived Away; plan u32; goal option cell u16; \
     path start u16 moves count u8 nibbles Up Down Left Right Wait; step u8; probability f32; \
     hazards sequence cell u16",
);

/// The longest body: an intention in which every number takes its most bytes.
const MAX_BODY: usize = 83;

const MAX_PLAIN: usize = 1 + MAX_BODY + TAG_BYTES;

/// The longest frame in bytes, its delimiter included.
pub const MAX_FRAME: usize = cobs::max_encoding_length(MAX_PLAIN) + 1;

// A block of 254 bytes without a zero has two COBS forms; shorter frames have one.
const _: () = assert!(MAX_FRAME < 255);

/// Why an intention was not encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EncodeError {
    /// Every receiver would reject it.
    Invalid(Invalid),
    /// The frame does not fit the buffer; [`MAX_FRAME`] bytes fit every one.
    BufferTooSmall,
}

/// Why bytes are no frame, in the order of the checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// More bytes than the longest frame has.
    TooLong,
    /// Not the COBS form of anything, or a delimiter inside.
    Cobs,
    /// Too few bytes for a version and a tag.
    TooShort,
    /// Another version of the frame, which is given.
    Version(u8),
    /// Damaged, or made with another key or another [`SCHEMA`].
    Tag,
    /// Authentic, but the body does not read as an intention.
    Body,
    /// Authentic, but bytes follow the intention.
    Trailing,
    /// Authentic, but a value is out of its range.
    Invalid(Invalid),
}

/// Writes an intention and the delimiter to the front of `buffer`; returns the written bytes.
///
/// # Errors
/// [`EncodeError`] when the intention is invalid or the buffer too small.
pub fn encode<'a>(
    intention: &Intention,
    auth: &impl FrameAuth,
    buffer: &'a mut [u8],
) -> Result<&'a [u8], EncodeError> {
    intention.validate().map_err(EncodeError::Invalid)?;
    let mut plain = [0; MAX_PLAIN];
    let length = seal(intention, auth, &mut plain).ok_or(EncodeError::BufferTooSmall)?;
    let frame = plain.get(..length).and_then(|plain| stuff(plain, buffer));
    frame.ok_or(EncodeError::BufferTooSmall)
}

/// The intention in a frame, which is given without its delimiter.
///
/// Takes any bytes, in a time bounded by [`MAX_FRAME`], and uses less than that on the stack beside the
/// result.
///
/// # Errors
/// [`DecodeError`] names the first check that failed.
pub fn decode(frame: &[u8], auth: &impl FrameAuth) -> Result<Intention, DecodeError> {
    let mut plain = [0; MAX_PLAIN];
    let (signed, tag) =
        unstuff(frame, &mut plain)?.split_last_chunk::<TAG_BYTES>().ok_or(DecodeError::TooShort)?;
    let (&version, body) = signed.split_first().ok_or(DecodeError::TooShort)?;
    if version != VERSION {
        return Err(DecodeError::Version(version));
    }
    if !auth.verify(SCHEMA, signed, tag) {
        return Err(DecodeError::Tag);
    }
    open(body)
}

/// Version, body and tag at the front of `plain`; returns their length.
fn seal(intention: &Intention, auth: &impl FrameAuth, plain: &mut [u8]) -> Option<usize> {
    let (version, rest) = plain.split_first_mut()?;
    *version = VERSION;
    let length = 1 + postcard::to_slice(intention, rest).ok()?.len();
    let (signed, rest) = plain.split_at_mut_checked(length)?;
    *rest.first_chunk_mut()? = auth.tag(SCHEMA, signed);
    Some(length + TAG_BYTES)
}

fn stuff<'a>(plain: &[u8], buffer: &'a mut [u8]) -> Option<&'a [u8]> {
    let length = cobs::try_encode(plain, buffer).ok()?;
    *buffer.get_mut(length)? = 0;
    buffer.get(..=length)
}

fn unstuff<'a>(frame: &[u8], plain: &'a mut [u8]) -> Result<&'a [u8], DecodeError> {
    if frame.is_empty() {
        return Err(DecodeError::TooShort);
    }
    if frame.len() >= MAX_FRAME {
        return Err(DecodeError::TooLong);
    }
    if frame.contains(&0) {
        return Err(DecodeError::Cobs);
    }
    let length = cobs::decode(frame, plain).map_err(|_| DecodeError::Cobs)?.frame_size();
    plain.get(..length).ok_or(DecodeError::TooLong)
}

fn open(body: &[u8]) -> Result<Intention, DecodeError> {
    let (intention, rest): (Intention, _) = postcard::take_from_bytes(body).map_err(|_| DecodeError::Body)?;
    if !rest.is_empty() {
        return Err(DecodeError::Trailing);
    }
    intention.validate().map_err(DecodeError::Invalid)?;
    Ok(intention)
}

const fn fnv1a(text: &str) -> u64 {
    let mut bytes = text.as_bytes();
    let mut hash = 0xcbf2_9ce4_8422_2325;
    while let [first, rest @ ..] = bytes {
        hash = (hash ^ *first as u64).wrapping_mul(0x0000_0100_0000_01b3);
        bytes = rest;
    }
    hash
}

impl core::fmt::Display for EncodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Invalid(invalid) => write!(f, "invalid intention: {invalid}"),
            Self::BufferTooSmall => f.write_str("the frame does not fit the buffer"),
        }
    }
}

impl core::fmt::Display for DecodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooLong => f.write_str("longer than the longest frame"),
            Self::Cobs => f.write_str("no COBS form"),
            Self::TooShort => f.write_str("too short for a version and a tag"),
            Self::Version(found) => write!(f, "frame version {found} instead of {VERSION}"),
            Self::Tag => f.write_str("wrong tag: damaged, or another key or schema"),
            Self::Body => f.write_str("the body is no intention"),
            Self::Trailing => f.write_str("bytes follow the intention"),
            Self::Invalid(invalid) => write!(f, "invalid intention: {invalid}"),
        }
    }
}

impl core::error::Error for EncodeError {}
impl core::error::Error for DecodeError {}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values published with the hash function.
    #[test]
    fn the_schema_hash_is_fnv1a() {
        assert_eq!(fnv1a(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a("a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv1a("foobar"), 0x8594_4171_f739_67e8);
    }
}
