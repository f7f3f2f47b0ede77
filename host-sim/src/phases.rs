//! The phases of a flight: the rounds in which the team decided, or a robot charged.

use crate::progress::agreed_round;
use crate::scenario::Floor;
use iibt_core::grid::Cell;
use iibt_core::navigation::Cause;
use iibt_core::navigation::Report;
use serde::Serialize;

/// One round: its opener, its cause, and the choices of all robots.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Phase {
    /// The number of the round.
    pub round: u32,
    /// The robot that opened it, by its index.
    pub opener: usize,
    /// The cause; `None` for the round that the mission begins with.
    pub cause: Option<Cause>,
    /// The tick in which it was opened.
    pub opened: u32,
    /// The tick in which all robots had agreed; `None` when they never did.
    pub agreed: Option<u32>,
    /// The obstacles that had appeared at the time of the last choice.
    pub obstacles: Vec<Cell>,
    /// The robots' choices, in the order of their numbers; `None` for a robot without one.
    pub choices: Vec<Option<Chosen>>,
}

/// A robot's choice in a round.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chosen {
    /// The tick in which it chose.
    pub tick: u32,
    /// The goal; `None` for a robot that could only stay.
    pub goal: Option<Cell>,
    /// The cells of its path, from where it stood.
    pub path: Vec<Cell>,
    /// The posterior probability of the joint policy that the choice belongs to.
    pub probability: f32,
}

/// Updates the phases with the reports of a tick.
pub(crate) fn note(
    phases: &mut Vec<Phase>,
    tick: u32,
    reports: &[Report],
    floor: &Floor,
    obstacles: impl Fn() -> Vec<Cell>,
) {
    let size = reports.len();
    for (robot, report) in reports.iter().enumerate() {
        let is_opener = report.round as usize % size.max(1) == robot;
        let is_known = phases.iter().any(|phase| phase.round == report.round);
        if is_opener && !is_known && (report.cause.is_some() || report.round == 0) {
            phases.push(Phase::opened(robot, report, tick, size));
        }
        let chosen = report.policy.is_some();
        let Some(phase) = phases.iter_mut().find(|phase| phase.round == report.round) else { continue };
        if chosen && phase.choices[robot].is_none() {
            phase.choices[robot] = Some(Chosen::by(report, tick, floor));
            phase.obstacles = obstacles();
        }
    }
    let agreed = agreed_round(reports);
    let phase = phases.iter_mut().find(|phase| Some(phase.round) == agreed);
    if let Some(phase) = phase {
        phase.agreed.get_or_insert(tick);
    }
}

impl Phase {
    fn opened(opener: usize, report: &Report, tick: u32, size: usize) -> Self {
        Self {
            round: report.round,
            opener,
            cause: report.cause,
            opened: tick,
            agreed: None,
            obstacles: Vec::new(),
            choices: vec![None; size],
        }
    }
}

impl Chosen {
    fn by(report: &Report, tick: u32, floor: &Floor) -> Self {
        Self {
            tick,
            goal: report.goal,
            path: report.path.cells(floor).collect(),
            probability: report.probability,
        }
    }
}
