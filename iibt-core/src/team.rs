//! Messages between robots, and their transport.
//!
//! ```text
//! sender     message + Stamp of the Numbering ─► Envelope ─► encode ─► bytes for the radio
//! receiver   bytes ─► Deframer ─► one frame ─► Roster::receive ─► newest message of each peer
//!                                              = decode + replay check + when it was heard
//! ```
//!
//! What is announced is the task's: any type that implements [`Message`]. Frames, authentication,
//! freshness and replay protection are the same for all.
//!
//! Whatever arrives from the radio is taken for hostile: any bytes give a message or a typed error,
//! the work per byte and per frame is bounded, and nothing without a valid tag is looked into. The
//! room has no clock: the time of reception comes in as an [`Instant`](crate::time::Instant).
//!
//! Each sender has a key of its own, and all robots of a team have the keys of all. A tag says that
//! *a* member of the team made the frame, not which one: members can speak in each other's name.

mod auth;
mod context;
mod counters;
mod deframer;
mod form;
mod frame;
mod freshness;
mod keys;
mod message;
mod peers;
pub(crate) mod reading;
mod replay;
mod robot_id;
mod roster;
pub mod rounds;

pub use auth::{FrameAuth, Key, SipHash64, TAG_BYTES, Tag};
pub use context::{Context, Fnv1a};
pub use counters::Counters;
pub use deframer::Deframer;
pub use form::{MAX_PACKET, check_form};
pub use frame::{DecodeError, EncodeError, Envelope, MAX_FRAME, MAX_MESSAGE, VERSION, decode, encode};
pub use freshness::{Freshness, Limits, LimitsError};
pub use keys::Keys;
pub use message::{Invalid, Message};
pub use peers::Peers;
pub use replay::{Numbering, Stamp};
pub use robot_id::{MAX_TEAM, Member, MemberError, RobotId};
pub use roster::{Heard, Peer, Refused, Roster};
