//! Events: their triggers and effects.

use super::check::named;
use super::drawing::Drawing;
use super::{Event, EventEffect, MAX_TICKS, RobotSpec, Trigger, file, reach};
use crate::input::{Fault, Read, WholeNumber, refuse, whole};
use iibt_core::actions::HORIZON;
use iibt_core::grid::Cell;
use toml::Spanned;

const WHEN: &str = "say when it happens: tick = N, or robot = \"NAME\" and at = CELL, or plan = N";
const WHAT: &str = "say what happens: exactly one of block, charge, visit and stop";

impl Drawing {
    /// An event, checked against the team.
    pub(super) fn event(&self, event: &Spanned<file::EventEntry>, robots: &[RobotSpec]) -> Read<Event> {
        let (written, span) = (event.get_ref(), event.span());
        let when = self.when(written, robots).map_err(|fault| fault.or_at(&span))?;
        Ok(Event { when, effect: self.effect(written, when, robots).map_err(|fault| fault.or_at(&span))? })
    }

    fn when(&self, written: &file::EventEntry, robots: &[RobotSpec]) -> Read<Trigger> {
        let moves = whole("moves", written.moves.as_ref(), 0..=HORIZON as u32, 0)?;
        let when = match (&written.tick, &written.robot, &written.at, &written.plan) {
            (tick @ Some(_), None, None, None) => {
                Trigger::Tick(whole("tick", tick.as_ref(), 0..=MAX_TICKS, 0)?)
            }
            (None, Some(name), Some(at), None) => {
                Trigger::Reached(named(name, robots)?, self.free("at", at)?)
            }
            (None, None, None, plan @ Some(_)) => {
                return Ok(Trigger::Planned(whole("plan", plan.as_ref(), 1..=1000, 1)?, moves));
            }
            _ => return Err(Fault::anywhere(WHEN)),
        };
        match &written.moves {
            Some(moves) => refuse(moves.span(), "moves are those of a plan: write plan = N with it"),
            None => Ok(when),
        }
    }

    fn effect(&self, written: &file::EventEntry, when: Trigger, robots: &[RobotSpec]) -> Read<EventEffect> {
        let concerned = || whose(written, when, robots);
        let effect = match (&written.block, &written.charge, &written.visit, &written.stop) {
            (Some(cell), None, None, None) => self.obstacle(written, cell, robots)?,
            (None, Some(charge), None, None) => {
                EventEffect::Charge(concerned()?, whole("charge", Some(charge), 0..=100, 0)? as u8)
            }
            (None, None, Some(cell), None) => {
                let robot = concerned()?;
                EventEffect::Visit(robot, self.within_reach("way-point", cell, &robots[robot])?)
            }
            (None, None, None, Some(stop)) if *stop.get_ref() => {
                let ticks = whole("for", written.ticks.as_ref(), 1..=MAX_TICKS, MAX_TICKS)?;
                return Ok(EventEffect::Stop(concerned()?, written.ticks.as_ref().map(|_| ticks)));
            }
            (None, None, None, Some(stop)) => {
                return refuse(stop.span(), "stop = false says nothing: write true, or leave it out");
            }
            _ => return Err(Fault::anywhere(WHAT)),
        };
        match &written.ticks {
            Some(ticks) => refuse(ticks.span(), "only stop takes a time: leave `for` out"),
            None => Ok(effect),
        }
    }

    fn obstacle(
        &self,
        written: &file::EventEntry,
        cell: &WholeNumber,
        robots: &[RobotSpec],
    ) -> Read<EventEffect> {
        let (blocked, span) = (self.free("block", cell)?, cell.span());
        if let Some(robot) = robots.iter().find(|robot| robot.start == blocked) {
            let reason =
                format!("{} is where {} starts: no obstacle can appear there", blocked.0, robot.name);
            return refuse(span, reason);
        }
        match &written.who {
            Some(who) => refuse(who.span(), "an obstacle is nobody's: leave `who` out"),
            None => Ok(EventEffect::Block(blocked)),
        }
    }

    /// A free cell that a robot can reach on the drawn map.
    pub(super) fn within_reach(&self, what: &str, number: &WholeNumber, robot: &RobotSpec) -> Read<Cell> {
        let cell = self.free(what, number)?;
        if reach::is_near(&self.map, robot, cell) {
            return Ok(cell);
        }
        let (name, start) = (&robot.name, robot.start.0);
        refuse(number.span(), format!("{name} on {start} cannot reach the {what} {}", cell.0))
    }
}

/// The robot that an event concerns: the one that is named, else the one that triggers it.
fn whose(written: &file::EventEntry, when: Trigger, robots: &[RobotSpec]) -> Read<usize> {
    match (&written.who, when) {
        (Some(who), _) => named(who, robots),
        (None, Trigger::Reached(robot, _)) => Ok(robot),
        (None, Trigger::Tick(_) | Trigger::Planned(..)) => {
            Err(Fault::anywhere("say whom it concerns: who = \"NAME\""))
        }
    }
}
