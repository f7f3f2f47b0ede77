//! What a robot tells its teammate, as an intention.

use super::deed::{Deed, STATES, State};
use super::mission::Place;
use crate::grid::{Cell, Path};
use crate::team::{Intention, RobotId, Round, Status};
use crate::time::Instant;
use heapless::Vec;

/// Where a robot is, what it is, and what it does.
///
/// On the wire it is the intention's path: its start is the code `4 place + state`, its one move the code of the
/// action.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Announcement {
    /// Where it is sure to be, else [`Place::Elsewhere`].
    pub place: Place,
    /// What it is sure to be, else [`State::Free`].
    pub state: State,
    /// What it is doing.
    pub deed: Deed,
}

impl Announcement {
    /// It as a path.
    #[must_use]
    pub fn path(self) -> Path {
        let code = STATES * self.place as usize + self.state as usize;
        Path { start: Cell(code as u16), actions: self.deed.policy() }
    }

    /// It as what a robot tells its teammate, at work on an action or not; the sender adds stamp and clock.
    #[must_use]
    pub fn intention(self, robot: RobotId, tick: Instant, is_busy: bool, probability: f32) -> Intention {
        Intention {
            robot,
            epoch: 0,
            sequence: 0,
            tick,
            round: Round(0),
            status: if is_busy { Status::Announced } else { Status::Deciding },
            plan: 0,
            goal: None,
            path: self.path(),
            step: 0,
            probability,
            hazards: Vec::new(),
        }
    }

    /// What an intention says; `None` when it is about something else.
    #[must_use]
    pub fn read(intention: &Intention) -> Option<Self> {
        let code = intention.path.start.index();
        let deed = intention.path.actions.get(0).filter(|_| intention.path.len() == 1)?;
        Some(Self {
            place: Place::of(code / STATES)?,
            state: State::of(code % STATES)?,
            deed: Deed::of(usize::from(deed))?,
        })
    }
}
