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
const MAX_PLAIN: usize = MAX_FRAME - 2 - 1;

/// The longest encoding of a [`Message`] in bytes.
pub const MAX_MESSAGE: usize = MAX_PLAIN - MAX_HEADER - TAG_BYTES;

// A block of 254 bytes without a zero has two COBS forms; shorter frames have one.
const _: () = assert!(cobs::max_encoding_length(MAX_PLAIN) + 2 == MAX_FRAME && MAX_FRAME < 255);

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
struct Header {
    sender: RobotId,
    epoch: u32,
    sequence: u32,
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
    let mut plain = [0; MAX_PLAIN];
    let (signed, tag) =
        unstuff(frame, &mut plain)?.split_last_chunk::<TAG_BYTES>().ok_or(DecodeError::TooShort)?;
    let (&version, body) = signed.split_first().ok_or(DecodeError::TooShort)?;
    if version != VERSION {
        return Err(DecodeError::Version(version));
    }
    let &sender = body.first().ok_or(DecodeError::TooShort)?;
    if !auth.verify(RobotId(sender), context, signed, tag) {
        return Err(DecodeError::Tag);
    }
    open(body)
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

fn stuff<'a>(plain: &[u8], buffer: &'a mut [u8]) -> Option<&'a [u8]> {
    let (first, rest) = buffer.split_first_mut()?;
    *first = 0;
    let length = cobs::try_encode(plain, rest).ok()?;
    *rest.get_mut(length)? = 0;
    buffer.get(..length + 2)
}

fn unstuff<'a>(frame: &[u8], plain: &'a mut [u8]) -> Result<&'a [u8], DecodeError> {
    if frame.is_empty() {
        return Err(DecodeError::TooShort);
    }
    if frame.len() > MAX_FRAME - 2 {
        return Err(DecodeError::TooLong);
    }
    if frame.contains(&0) {
        return Err(DecodeError::Cobs);
    }
    let length = cobs::decode(frame, plain).map_err(|_| DecodeError::Cobs)?.frame_size();
    plain.get(..length).ok_or(DecodeError::TooLong)
}

fn open<M: Message>(body: &[u8]) -> Result<Envelope<M>, DecodeError> {
    let (header, rest): (Header, _) = postcard::take_from_bytes(body).map_err(|_| DecodeError::Body)?;
    let (message, rest): (M, _) = postcard::take_from_bytes(rest).map_err(|_| DecodeError::Body)?;
    if !rest.is_empty() {
        return Err(DecodeError::Trailing);
    }
    if header.sender.index() >= MAX_TEAM {
        return Err(DecodeError::Sender);
    }
    message.validate().map_err(DecodeError::Invalid)?;
    let stamp = Stamp { epoch: header.epoch, sequence: header.sequence };
    Ok(Envelope { sender: header.sender, stamp, message })
}
