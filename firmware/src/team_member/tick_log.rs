//! What a robot logs of its ticks.

use super::{Agent, OwnMission, TeamMember};
use crate::LinkReport;
use crate::hardware::{Battery, Clock, Drive, Link};
use heapless::Vec;
use iibt_core::actions::HORIZON;
use iibt_core::navigation::{Report, Stage};

/// The log of a robot's ticks: what has changed, and how long the longest took.
pub(super) struct TickLog {
    ticks: u32,
    longest: u32,
    before: (Report, LinkReport),
}

impl TickLog {
    pub(super) fn of<L: Link, C: Clock, D: Drive, B: Battery>(robot: &TeamMember<L, C, D, B>) -> Self {
        Self { ticks: 0, longest: 0, before: state_of(robot) }
    }

    /// Logs a tick that took this many cycles.
    pub(super) fn tell<L: Link, C: Clock, D: Drive, B: Battery>(
        &mut self,
        robot: &TeamMember<L, C, D, B>,
        mission: &OwnMission,
        took: u32,
    ) {
        self.ticks = self.ticks.wrapping_add(1);
        let state = state_of(robot);
        tell(robot.robot(), mission, self.ticks, &self.before, &state);
        if took > self.longest || state.0.stage != self.before.0.stage {
            defmt::info!("tick {=u32}: took {=u32} cycles", self.ticks, took);
            self.longest = took.max(self.longest);
        }
        self.before = state;
    }
}

/// The state of the robot and of its link.
fn state_of<L: Link, C: Clock, D: Drive, B: Battery>(robot: &TeamMember<L, C, D, B>) -> (Report, LinkReport) {
    (robot.robot().navigation().report(), robot.link_report())
}

/// Logs what has changed in a tick.
fn tell(
    navigator: &Agent,
    mission: &OwnMission,
    tick: u32,
    before: &(Report, LinkReport),
    now: &(Report, LinkReport),
) {
    let ((before, heard_before), (now, heard)) = (before, now);
    #[cfg(feature = "explain")]
    if let Some(entry) = navigator.tree_entry() {
        defmt::info!("tick {=u32}: {}", tick, entry);
    }
    if heard.received.accepted > 0 && heard_before.received.accepted == 0 {
        defmt::info!("tick {=u32}: heard the team", tick);
    }
    if now.waiting != before.waiting
        && let Some(waiting) = now.waiting.filter(|waiting| waiting.outlasts_round())
    {
        defmt::warn!("tick {=u32}: waits: {}", tick, waiting);
    }
    if now.step != before.step {
        defmt::info!("tick {=u32}: step {=usize} done, on p{=u16}", tick, now.step, now.cell.0);
    }
    if let Some(cell) = now.obstructed.filter(|_| now.obstructed != before.obstructed) {
        defmt::warn!("tick {=u32}: does not visit p{=u16}: an obstacle is on it", tick, cell.0);
    }
    if now.stage != before.stage {
        if now.stage == Stage::Agreed {
            tell_decision(navigator, mission, tick, now);
        }
        defmt::info!("tick {=u32}: {} in round {=u32}", tick, now.stage, now.round);
    }
}

/// Logs the posterior over the joint policies, bit by bit, and the choice.
fn tell_decision(navigator: &Agent, mission: &OwnMission, tick: u32, now: &Report) {
    let weighed = navigator.navigation().weighed();
    for (policy, (p, cost)) in weighed.posterior().iter().zip(weighed.costs()).enumerate() {
        defmt::info!(
            "tick {=u32}: posterior of {=usize}: {=u32:08x}, cost {=u32}",
            tick,
            policy,
            p.to_bits(),
            cost.total()
        );
    }
    #[cfg(feature = "explain")]
    if let Some(why) = weighed.explain() {
        defmt::info!("tick {=u32}: why {}", tick, why);
    }
    let mut cells = Vec::<u16, { HORIZON + 1 }>::new();
    for cell in now.path.cells(&mission.map) {
        // There is room for every cell of the longest path.
        let _ = cells.push(cell.0);
    }
    let goal = now.goal.map_or(0, |goal| goal.0);
    defmt::info!(
        "tick {=u32}: chose p{=u16} with {=f32} by {}",
        tick,
        goal,
        now.probability,
        cells.as_slice()
    );
}
