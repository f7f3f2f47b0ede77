//! A robot that logs nothing of its ticks.

use super::{OwnMission, TeamMember};
use crate::hardware::{Battery, Clock, Drive, Link};

/// Nothing is kept, and nothing is told.
pub(super) struct TickLog;

impl TickLog {
    pub(super) const fn of<L: Link, C: Clock, D: Drive, B: Battery>(_: &TeamMember<L, C, D, B>) -> Self {
        Self
    }

    pub(super) const fn tell<L: Link, C: Clock, D: Drive, B: Battery>(
        &mut self,
        _: &TeamMember<L, C, D, B>,
        _: &OwnMission,
        _: u32,
    ) {
    }
}
