//! The frame: one message as bytes for a radio or a serial line.
//!
//! ```text
//! 0x00 | COBS(version 1 B | sender 1 B | epoch 1-5 B | sequence 1-5 B | message | tag 8 B) | 0x00
//! ```
//!
//! Numbers of more than a byte are varints, as in the postcard format that the message is in. The
//! delimiter before the frame ends whatever noise the line has carried since the last one.
//!
//! The tag covers everything before it and, unsent, the [`Context`]: frames of another team,
//! another mission or another layout fail the check of the tag. There is no other version, nothing
//! is negotiated, and no frame goes without a tag. A frame has no bit to spare: any changed bit
//! makes it invalid.

use super::{Context, FrameAuth, Invalid, MAX_TEAM, Message, RobotId, Stamp, TAG_BYTES};
use serde::{Deserialize, Serialize};

/// The first byte of every frame, before COBS.
pub const VERSION: u8 = 2;

/// The longest frame in bytes, both delimiters included: what IEEE 802.15.4 carries.
pub const MAX_FRAME: usize = 127;

/// Version, sender, epoch and sequence at their longest.
const MAX_HEADER: usize = 1 + 1 + 5 + 5;

/// The longest content before COBS, which adds a byte.
pub(super) const MAX_PLAIN: usize = MAX_FRAME - 2 - 1;

/// The longest encoding of a [`Message`] in bytes.
pub const MAX_MESSAGE: usize = MAX_PLAIN - MAX_HEADER - TAG_BYTES;

// A block of 254 bytes without a zero has two COBS forms; shorter frames have one.
const _: () = assert!(MAX_FRAME < 255);

/// A message with its sender and its stamp in the sender's order.
#[doc(alias = "packet")]
#[doc(alias = "header")]
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Envelope<M> {
    /// The sender: below [`MAX_TEAM`].
    pub sender: RobotId,
    /// The number of the frame.
    pub stamp: Stamp,
    /// The content.
    pub message: M,
}

/// The head of a frame after the version.
#[derive(Serialize, Deserialize)]
pub(super) struct Header {
    pub(super) sender: RobotId,
    epoch: u32,
    sequence: u32,
}

impl Header {
    pub(super) const fn stamp(&self) -> Stamp {
        Stamp { epoch: self.epoch, sequence: self.sequence }
    }
}

/// The reason why a message was not encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EncodeError {
    /// The sender is not below [`MAX_TEAM`].
    #[error("the sender's number is not below the largest team")]
    Sender,
    /// Every receiver would reject the message.
    #[error("invalid message: {0}")]
    Invalid(Invalid),
    /// The frame does not fit the buffer; [`MAX_FRAME`] bytes fit every one.
    #[error("the frame does not fit the buffer")]
    BufferTooSmall,
    /// The message takes more bytes than its [`MAX_BYTES`](Message::MAX_BYTES) say.
    #[error("the message is longer than its type says")]
    MessageTooLong,
}

/// The reason why bytes are not a frame, in the order of the checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// More bytes than the longest frame has.
    #[error("longer than the longest frame")]
    TooLong,
    /// Not a COBS encoding, or a delimiter inside.
    #[error("no COBS form")]
    Cobs,
    /// Too few bytes for a version and a tag.
    #[error("too short for a version and a tag")]
    TooShort,
    /// Another version of the frame, which is given.
    #[error("frame version {0} instead of {VERSION}")]
    Version(u8),
    /// Damaged, or made with another key or in another [`Context`].
    #[error("wrong tag: damaged, or another key, team, mission or schema")]
    Tag,
    /// Authentic, but the body does not read as header and message.
    #[error("the body does not read as a message")]
    Body,
    /// Authentic, but bytes follow the message.
    #[error("bytes after the message")]
    Trailing,
    /// Authentic, but the sender is not below [`MAX_TEAM`].
    #[error("the sender's number is not below the largest team")]
    Sender,
    /// Authentic, but a value of the message is out of its range.
    #[error("invalid message: {0}")]
    Invalid(Invalid),
}

/// Writes a frame with its delimiters to the front of `buffer` and returns the written bytes.
///
/// A message type that cannot fit a frame fails the build.
///
/// # Errors
/// [`EncodeError`] when the message is invalid or the buffer is too small.
///
/// ```
/// use iibt_core::team::{
///     Context, DecodeError, Envelope, Key, MAX_FRAME, Message, RobotId, SipHash64, Stamp, decode,
///     encode,
/// };
/// use serde::{Deserialize, Serialize};
///
/// #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
/// struct Ping(u8);
///
/// impl Message for Ping {
///     const SCHEMA: &'static str = "ping: count u8";
///     const MAX_BYTES: usize = 1;
/// }
///
/// let (auth, context) = (SipHash64::new(Key::new([7; 16])), Context::of::<Ping>(1, 1));
/// let stamp = Stamp { epoch: 1, sequence: 0 };
/// let envelope = Envelope { sender: RobotId(1), stamp, message: Ping(3) };
/// let mut buffer = [0; MAX_FRAME];
/// let frame = encode(&envelope, &auth, context, &mut buffer)?;
/// assert!(frame.first() == Some(&0) && frame.last() == Some(&0)); // the delimiters
///
/// let inside = &frame[1..frame.len() - 1];
/// assert_eq!(decode::<Ping>(inside, &auth, context)?.message, Ping(3));
/// let other = SipHash64::new(Key::new([8; 16]));
/// assert_eq!(decode::<Ping>(inside, &other, context).unwrap_err(), DecodeError::Tag);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn encode<'a, M: Message>(
    envelope: &Envelope<M>,
    auth: &impl FrameAuth,
    context: Context,
    buffer: &'a mut [u8],
) -> Result<&'a [u8], EncodeError> {
    const { assert!(M::MAX_BYTES <= MAX_MESSAGE, "the message does not fit a frame") }
    if envelope.sender.index() >= MAX_TEAM {
        return Err(EncodeError::Sender);
    }
    envelope.message.validate().map_err(EncodeError::Invalid)?;
    let mut plain = [0; MAX_PLAIN];
    let length = seal(envelope, auth, context, &mut plain).ok_or(EncodeError::MessageTooLong)?;
    let frame = plain.get(..length).and_then(|plain| stuff(plain, buffer));
    frame.ok_or(EncodeError::BufferTooSmall)
}

/// Reads the envelope in a frame, which is given without its delimiters.
///
/// Takes any bytes, in a time bounded by [`MAX_FRAME`], and uses less than that on the stack beside
/// the result.
///
/// # Errors
/// [`DecodeError`] names the first check that failed.
pub fn decode<M: Message>(
    frame: &[u8],
    auth: &impl FrameAuth,
    context: Context,
) -> Result<Envelope<M>, DecodeError> {
    let mut room = [0; MAX_PLAIN + 1];
    let (header, rest) = unseal(frame, auth, context, &mut room)?;
    let (message, rest) = M::read(rest).ok_or(DecodeError::Body)?;
    check(&header, &message, rest)?;
    Ok(Envelope { sender: header.sender, stamp: header.stamp(), message })
}

/// The header of an authentic frame, and the bytes that follow it.
#[inline]
pub(super) fn unseal<'a>(
    frame: &[u8],
    auth: &impl FrameAuth,
    context: Context,
    room: &'a mut [u8; MAX_PLAIN + 1],
) -> Result<(Header, &'a [u8]), DecodeError> {
    let (signed, tag) = unstuff(frame, room)?.split_last_chunk::<TAG_BYTES>().ok_or(DecodeError::TooShort)?;
    let (&version, body) = signed.split_first().ok_or(DecodeError::TooShort)?;
    if version != VERSION {
        return Err(DecodeError::Version(version));
    }
    let &sender = body.first().ok_or(DecodeError::TooShort)?;
    if !auth.verify(RobotId(sender), context, signed, tag) {
        return Err(DecodeError::Tag);
    }
    postcard::take_from_bytes(body).map_err(|_| DecodeError::Body)
}

/// Whether an authentic frame says what a robot can mean, and ends there.
pub(super) fn check<M: Message>(header: &Header, message: &M, rest: &[u8]) -> Result<(), DecodeError> {
    if !rest.is_empty() {
        return Err(DecodeError::Trailing);
    }
    if header.sender.index() >= MAX_TEAM {
        return Err(DecodeError::Sender);
    }
    message.validate().map_err(DecodeError::Invalid)
}

/// Version, header, message and tag at the front of `plain`; returns their length.
fn seal<M: Message>(
    envelope: &Envelope<M>,
    auth: &impl FrameAuth,
    context: Context,
    plain: &mut [u8],
) -> Option<usize> {
    let Stamp { epoch, sequence } = envelope.stamp;
    let header = Header { sender: envelope.sender, epoch, sequence };
    let (version, rest) = plain.split_first_mut()?;
    *version = VERSION;
    let length = postcard::to_slice(&header, rest).ok()?.len();
    let message = postcard::to_slice(&envelope.message, rest.get_mut(length..)?).ok()?.len();
    if message > M::MAX_BYTES {
        return None;
    }
    let (signed, rest) = plain.split_at_mut_checked(1 + length + message)?;
    *rest.first_chunk_mut()? = auth.tag(envelope.sender, context, signed);
    Some(signed.len() + TAG_BYTES)
}

/// COBS between delimiters: a byte for each zero, and one before the first, says how far on the
/// next of them is, the last one how far the end is.
fn stuff<'a>(plain: &[u8], buffer: &'a mut [u8]) -> Option<&'a [u8]> {
    let frame = buffer.get_mut(..plain.len() + 3)?;
    let [before, first, bytes @ .., after] = &mut *frame else { return None };
    (*before, *after) = (0, 0);
    let mut distance = 1;
    for (to, &byte) in bytes.iter_mut().zip(plain).rev() {
        *to = if byte == 0 { core::mem::take(&mut distance) } else { byte };
        distance += 1;
    }
    *first = distance;
    Some(frame)
}

/// Puts the zeros back, in a copy of the frame: one visit for each.
fn unstuff<'a>(frame: &[u8], room: &'a mut [u8; MAX_PLAIN + 1]) -> Result<&'a [u8], DecodeError> {
    if frame.is_empty() {
        return Err(DecodeError::TooShort);
    }
    let copy = room.get_mut(..frame.len()).ok_or(DecodeError::TooLong)?;
    if frame.contains(&0) {
        return Err(DecodeError::Cobs);
    }
    copy.iter_mut().zip(frame).for_each(|(to, &byte)| *to = byte);
    let mut next = 0;
    while let Some(distance) = copy.get_mut(next) {
        next += usize::from(core::mem::take(distance));
    }
    copy.get(1..).filter(|_| next == frame.len()).ok_or(DecodeError::Cobs)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes of which about one in five is a zero, from a seed.
    fn bytes(seed: u32, length: usize) -> std::vec::Vec<u8> {
        let mut random = seed;
        let draw = |_| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            if random >> 29 == 0 { 0 } else { (random >> 24) as u8 % 7 }
        };
        (0..length).map(draw).collect()
    }

    #[test]
    fn frames_are_stuffed_as_by_the_library_of_the_standard_form() {
        for seed in 0..20_000 {
            let plain = bytes(seed, seed as usize % (MAX_PLAIN + 1));
            let mut buffer = [7; MAX_FRAME];
            let frame = stuff(&plain, &mut buffer).unwrap();
            let mut expected = [0; MAX_FRAME];
            let length = cobs::encode(&plain, &mut expected[1..]);
            assert_eq!(frame, &expected[..length + 2]);
            let mut room = [0; MAX_PLAIN + 1];
            assert_eq!(unstuff(&frame[1..frame.len() - 1], &mut room), Ok(&plain[..]));
            assert_eq!(stuff(&plain, &mut buffer[..plain.len() + 2]), None, "a byte too few");
        }
    }

    #[test]
    fn any_bytes_are_unstuffed_as_by_the_library_of_the_standard_form() {
        for seed in 0..200_000 {
            let frame = bytes(seed, 1 + seed as usize % (MAX_FRAME - 2));
            let (mut room, mut expected) = ([0; MAX_PLAIN + 1], [0; MAX_FRAME]);
            let decoded = cobs::decode(&frame, &mut expected).ok().filter(|_| !frame.contains(&0));
            let decoded = decoded.and_then(|report| expected.get(..report.frame_size()));
            assert_eq!(unstuff(&frame, &mut room).ok(), decoded, "{frame:?}");
        }
        let mut room = [0; MAX_PLAIN + 1];
        assert_eq!(unstuff(&[], &mut room), Err(DecodeError::TooShort));
        assert_eq!(unstuff(&[1; MAX_FRAME - 1], &mut room), Err(DecodeError::TooLong));
    }
}
