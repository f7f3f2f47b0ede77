//! The phases of a flight: the rounds in which the team decided, or a robot charged.

use crate::flight_event::FlightEvent;
use crate::progress::agreed_round;
use crate::scenario::Floor;
use iibt_core::grid::Cell;
use iibt_core::inference::{Eighths, PolicyCost};
use iibt_core::navigation::Cause;
use iibt_core::navigation::Report;
use serde::Serialize;
use std::cmp::Ordering;

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
    /// The joint policies as the first robot to choose has weighed them, in the order of the list.
    pub policies: Vec<WeighedPolicy>,
}

/// A joint policy that was weighed. Times are in ticks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WeighedPolicy {
    /// Its posterior probability.
    pub probability: f32,
    /// What it costs: the sum of the terms less the epistemic value; `None` for one that cannot be
    /// carried out.
    pub total: Option<f32>,
    /// The expected time until it is done if what is seen changes nothing.
    pub time: f32,
    /// What is saved of that because the team goes on by what it sees.
    pub epistemic: f32,
    /// The habit, -ln E / β.
    pub habit: f32,
    /// The largest delay of a robot that it needs.
    pub delay: f32,
    /// What it costs the robots besides.
    pub price: f32,
}

impl WeighedPolicy {
    pub(crate) fn of(cost: PolicyCost, probability: f32) -> Self {
        let ticks = |time: Eighths| f32::from(time) / 8.0;
        Self {
            probability,
            total: (!cost.is_impossible).then(|| cost.total() as f32 / 8.0),
            time: ticks(cost.time),
            epistemic: ticks(cost.epistemic),
            habit: ticks(cost.habit),
            delay: ticks(cost.delay),
            price: ticks(cost.price),
        }
    }
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
    weighed: impl Fn(usize) -> Vec<WeighedPolicy>,
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
            if phase.policies.is_empty() {
                phase.policies = weighed(robot);
            }
        }
    }
    let agreed = agreed_round(reports);
    let phase = phases.iter_mut().find(|phase| Some(phase.round) == agreed);
    if let Some(phase) = phase {
        phase.agreed.get_or_insert(tick);
    }
}

impl Phase {
    /// The event of the policies that were weighed, if any can be carried out.
    pub(crate) fn weighed(&self) -> Option<FlightEvent> {
        let possible = self.policies.iter().copied().enumerate().filter(|(_, policy)| policy.total.is_some());
        let mut ranked: Vec<(usize, WeighedPolicy)> = possible.collect();
        // Stable: the first of equals is chosen.
        ranked.sort_by(|(_, one), (_, other)| one.total.partial_cmp(&other.total).unwrap_or(Ordering::Equal));
        let best = ranked.first().copied()?;
        let next = ranked.get(1).copied();
        Some(FlightEvent::Weighed { round: self.round, policies: self.policies.len(), best, next })
    }

    fn opened(opener: usize, report: &Report, tick: u32, size: usize) -> Self {
        Self {
            round: report.round,
            opener,
            cause: report.cause,
            opened: tick,
            agreed: None,
            obstacles: Vec::new(),
            choices: vec![None; size],
            policies: Vec::new(),
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
