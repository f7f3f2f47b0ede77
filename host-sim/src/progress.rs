//! How far the team has come: the joint plans that all have agreed to, and the moves made of the last.

use iibt_core::navigation::{Report, Stage};

/// The progress of a team, by what its robots say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Progress {
    plans: u32,
    moves: u32,
    round: Option<u16>,
}

impl Progress {
    /// Takes the reports of a tick in.
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

    /// Whether so many plans have been agreed to, and so many moves made of the last; a later plan counts as well.
    pub(crate) const fn has_come_to(self, plans: u32, moves: u32) -> bool {
        self.plans > plans || (self.plans == plans && self.moves >= moves)
    }
}

/// The round that every robot has agreed to, if they all have.
pub(crate) fn agreed_round(reports: &[Report]) -> Option<u16> {
    let first = reports.first()?.round;
    let agrees =
        |report: &Report| report.round == first && matches!(report.stage, Stage::Agreed | Stage::Arrived);
    reports.iter().all(agrees).then_some(first.0)
}
