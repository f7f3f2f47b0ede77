//! What a robot tells its teammate.

use super::deed::{Deed, State};
use super::mission::Place;
use crate::team::Message;
use serde::{Deserialize, Serialize};

/// Where a robot is, what it is, and what it does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Announcement {
    /// Where it is sure to be, else [`Place::Elsewhere`].
    pub place: Place,
    /// What it is sure to be, else [`State::Free`].
    pub state: State,
    /// What it is doing.
    pub deed: Deed,
}

impl Message for Announcement {
    const SCHEMA: &'static str =
        "place Elsewhere A B C; state Loc Hold Place Free; deed MoveTo Pick Place Idle";
    const MAX_BYTES: usize = 3;
}
