//! The progress of the team: the joint plans that were chosen, and the moves made of the last.

use iibt_core::navigation::{Report, Stage};
use iibt_core::team::RobotId;

/// The progress of a team according to its robots' reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Progress {
    plans: u32,
    moves: u32,
    round: Option<u32>,
    is_done: bool,
}

impl Progress {
    /// Updates the progress with the reports of a tick.
    pub(crate) fn note(&mut self, reports: &[Report]) {
        self.is_done = reports.iter().all(|report| report.stage == Stage::Arrived);
        let Some(round) = chosen_round(reports) else { return };
        if self.round != Some(round) {
            self.plans += 1;
        }
        let moves = members(reports).filter_map(|report| match follows(report, round) {
            true => (report.step < report.path.len()).then_some(report.step as u32),
            false => Some(0),
        });
        // When all paths are done, all their moves are made.
        (self.round, self.moves) = (Some(round), moves.min().unwrap_or(u32::MAX));
    }

    /// Returns whether `plans` plans were chosen and `moves` moves of the last one made, or another
    /// plan was chosen since. A team that has arrived has come to all of them: it makes no other
    /// plan by itself.
    pub(crate) const fn has_come_to(self, plans: u32, moves: u32) -> bool {
        self.is_done || self.plans > plans || (self.plans == plans && self.moves >= moves)
    }
}

/// Returns the newest round, if a member knows its plan: then the choice is made, whether or not
/// the others know. Conventional robots have no rounds; there it is when all follow a path.
fn chosen_round(reports: &[Report]) -> Option<u32> {
    let newest = reports.iter().max_by_key(|report| report.round)?;
    if newest.members.is_empty() {
        return agreed_round(reports);
    }
    members(reports).any(|report| follows(report, newest.round)).then_some(newest.round)
}

/// Whether a robot takes part, by its index: it is a member of the newest round. All are, where
/// there are no rounds.
pub(crate) fn is_member(reports: &[Report]) -> impl Fn(usize) -> bool + use<> {
    let newest = reports.iter().max_by_key(|report| report.round).map(|report| report.members);
    let view = newest.filter(|view| !view.is_empty());
    move |robot| view.is_none_or(|view| view.contains(RobotId(robot as u8)))
}

/// The reports of the robots that take part.
fn members(reports: &[Report]) -> impl Iterator<Item = &Report> {
    let is_member = is_member(reports);
    reports.iter().enumerate().filter(move |&(robot, _)| is_member(robot)).map(|(_, report)| report)
}

/// Whether a robot knows the plan of a round.
fn follows(report: &Report, round: u32) -> bool {
    let knows = report.policy.is_some() || matches!(report.stage, Stage::Agreed | Stage::Arrived);
    report.round == round && knows
}

/// Returns the newest round, if all its members know its plan; with conventional robots, which have
/// no rounds, that is when all follow a path.
pub(crate) fn agreed_round(reports: &[Report]) -> Option<u32> {
    let newest = reports.iter().map(|report| report.round).max()?;
    members(reports).all(|report| follows(report, newest)).then_some(newest)
}
