//! What a conventional robot announces: where it goes, and how far it is.

use iibt_core::grid::{Cell, Move, Path};
use iibt_core::navigation::{MAX_HAZARDS, Stage};
use iibt_core::team::{Envelope, Invalid, Message};
use serde::{Deserialize, Serialize};

/// A conventional robot's message.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PathMessage {
    /// How far it is.
    pub(super) stage: Stage,
    /// The goal it has chosen.
    pub(super) goal: Option<Cell>,
    /// Its path.
    pub(super) path: Path,
    /// The number of steps of the path that are done.
    pub(super) step: u8,
    /// The newest obstacles that it knows.
    pub(super) hazards: heapless::Vec<Cell, MAX_HAZARDS>,
}

/// A teammate's message with its sender and number.
pub(super) type Said = Envelope<PathMessage>;

impl Message for PathMessage {
    const SCHEMA: &'static str = "conventional: stage Deciding Announced Agreed Arrived Away Stuck; goal option cell \
        u16; path start u16 moves count u8 nibbles Up Down Left Right Wait; step u8; hazards sequence cell u16";

    const MAX_BYTES: usize = 1 + (1 + 3) + (3 + 1 + 32) + 1 + (1 + 3 * MAX_HAZARDS);

    fn validate(&self) -> Result<(), Invalid> {
        if self.path.actions.iter().any(|code| Move::from_code(code).is_none()) {
            return Err(Invalid("an action code of the path is no move"));
        }
        if usize::from(self.step) > self.path.len() {
            return Err(Invalid("more moves are done than the path has"));
        }
        Ok(())
    }
}

impl PathMessage {
    /// Returns whether every cell that it names is one of the first `cells`.
    pub(super) fn fits(&self, cells: usize) -> bool {
        let named = [self.path.start].into_iter().chain(self.goal).chain(self.hazards.iter().copied());
        named.into_iter().all(|cell| cell.index() < cells)
    }
}
