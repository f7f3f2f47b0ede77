//! The progress of the team: the joint plans that all have agreed to, and the moves made of the
//! last.

use iibt_core::navigation::{Report, Stage};

/// The progress of a team according to its robots' reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Progress {
    plans: u32,
    moves: u32,
    round: Option<u16>,
}

impl Progress {
    /// Updates the progress with the reports of a tick.
    pub(crate) fn note(&mut self, reports: &[Report]) {
        let Some(round) = agreed_round(reports) else { return };
        if self.round != Some(round) {
            self.plans += 1;
        }
        let under_way = reports.iter().filter(|report| report.step < report.path.len());
        let moves = under_way.map(|report| report.step as u32).min();
        // When all paths are done, all their moves are made.
        (self.round, self.moves) = (Some(round), moves.unwrap_or(u32::MAX));
    }

    /// Returns whether the team has agreed to `plans` plans and made `moves` moves of the last one,
    /// or has agreed to a later plan.
    pub(crate) const fn has_come_to(self, plans: u32, moves: u32) -> bool {
        self.plans > plans || (self.plans == plans && self.moves >= moves)
    }
}

/// Returns the round that all robots have agreed to, if there is one.
pub(crate) fn agreed_round(reports: &[Report]) -> Option<u16> {
    let first = reports.first()?.round;
    let agrees =
        |report: &Report| report.round == first && matches!(report.stage, Stage::Agreed | Stage::Arrived);
    reports.iter().all(agrees).then_some(first.0)
}
