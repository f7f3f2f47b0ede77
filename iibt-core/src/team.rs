//! What robots tell each other and how it travels.
//!
//! ```text
//! sender     Numbering ─ Stamp ─► Intention ─► encode ─► bytes for the radio
//! receiver   bytes ─► Deframer ─► one frame ─► Roster::receive ─► newest intention of each peer
//!                                              = decode + replay check + when it was heard
//! ```
//!
//! Whatever arrives from the radio is taken for hostile: any bytes give an intention or a typed error, the
//! work per byte and per frame is bounded, and nothing without a valid tag is looked into. The room has no
//! clock: the time of reception comes in as an [`Instant`](crate::time::Instant).
//!
//! All robots of a team share one key. A tag says that *a* holder of the key made the frame, not which one:
//! robots that hold the key can speak in each other's name.

mod agreement;
mod auth;
mod counters;
mod deframer;
mod frame;
mod freshness;
mod intention;
mod paces;
mod replay;
mod roster;

pub use agreement::Agreement;
pub use auth::{FrameAuth, Key, SipHash64, TAG_BYTES, Tag};
pub use counters::Counters;
pub use deframer::Deframer;
pub use frame::{DecodeError, EncodeError, MAX_FRAME, SCHEMA, VERSION, decode, encode};
pub use freshness::{Freshness, Limits, LimitsError};
pub use intention::{Intention, Invalid, MAX_HAZARDS, MAX_TEAM, RobotId, Round, Status};
pub use paces::{MAX_PACE, Paces};
pub use replay::{Numbering, Stamp};
pub use roster::{Heard, Peer, Refused, Roster, RosterError};
