//! What happens on the way: the trigger and the effect of an event.

use super::check::named;
use super::drawing::Drawing;
use super::{Device, Event, EventEffect, MAX_TICKS, RobotSpec, Trigger, file, reach};
use crate::input::{Fault, Read, WholeNumber, optional, refuse, whole};
use iibt_core::actions::HORIZON;
use iibt_core::grid::Cell;
use toml::Spanned;

const WHEN: &str = "say when it happens: tick = N, or robot = \"NAME\" and at = CELL, or plan = N";
const WHAT: &str = "say what happens: exactly one of block, block_path_of, clear, charge, visit, stop \
                    and freeze";

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
        let given = [
            written.block.is_some(),
            written.block_path_of.is_some(),
            written.clear.is_some(),
            written.charge.is_some(),
            written.visit.is_some(),
            written.stop.is_some(),
            written.freeze.is_some(),
        ];
        if given.iter().filter(|&&given| given).count() != 1 {
            return Err(Fault::anywhere(WHAT));
        }
        if let (Some(ticks), None, None) = (&written.ticks, &written.stop, &written.freeze) {
            return refuse(ticks.span(), "only stop and freeze take a time: leave `for` out");
        }
        if let (Some(who), true) = (&written.who, given[..3].contains(&true)) {
            return refuse(who.span(), "an obstacle is nobody's: leave `who` out");
        }
        let concerned = || whose(written, when, robots);
        if let Some(cell) = &written.block {
            self.obstacle(cell, robots)
        } else if let Some(name) = &written.block_path_of {
            named(name, robots).map(EventEffect::BlockPath)
        } else if let Some(cell) = &written.clear {
            self.free("clear", cell).map(EventEffect::Clear)
        } else if let Some(charge) = &written.charge {
            Ok(EventEffect::Charge(concerned()?, whole("charge", Some(charge), 0..=100, 0)? as u8))
        } else if let Some(cell) = &written.visit {
            let robot = concerned()?;
            self.within_reach("way-point", cell, &robots[robot]).map(|cell| EventEffect::Visit(robot, cell))
        } else if let Some(device) = &written.freeze {
            Ok(EventEffect::Freeze(concerned()?, device_called(device)?, duration(written)?))
        } else {
            stop(written, concerned()?)
        }
    }

    fn obstacle(&self, cell: &WholeNumber, robots: &[RobotSpec]) -> Read<EventEffect> {
        let (blocked, span) = (self.free("block", cell)?, cell.span());
        if let Some(robot) = robots.iter().find(|robot| robot.start == blocked) {
            let reason =
                format!("{} is where {} starts: no obstacle can appear there", blocked.0, robot.name);
            return refuse(span, reason);
        }
        Ok(EventEffect::Block(blocked))
    }

    /// A free cell to which a way leads a robot by the drawn map.
    pub(super) fn within_reach(&self, what: &str, number: &WholeNumber, robot: &RobotSpec) -> Read<Cell> {
        let cell = self.free(what, number)?;
        if reach::is_near(&self.map, robot, cell) {
            return Ok(cell);
        }
        let (name, start) = (&robot.name, robot.start.0);
        refuse(number.span(), format!("{name} on {start} cannot reach the {what} {}", cell.0))
    }
}

fn stop(written: &file::EventEntry, robot: usize) -> Read<EventEffect> {
    if let Some(stop) = written.stop.as_ref().filter(|stop| !*stop.get_ref()) {
        let reason = "stop = false says nothing: write true, or leave it out";
        return refuse(stop.span(), reason);
    }
    Ok(EventEffect::Stop(robot, duration(written)?))
}

fn device_called(name: &Spanned<String>) -> Read<Device> {
    let device = Device::ALL.into_iter().find(|device| device.name() == name.get_ref());
    device.ok_or_else(|| {
        let names = Device::ALL.map(Device::name).join(" and ");
        Fault::new(name.span(), format!("no device is called \"{}\": there are {names}", name.get_ref()))
    })
}

/// The ticks that an event lasts; `None` for good.
fn duration(written: &file::EventEntry) -> Read<Option<u32>> {
    optional("for", written.ticks.as_ref(), 1..=MAX_TICKS)
}

/// Whom an event concerns: the robot that is named, else the one that sets it off.
fn whose(written: &file::EventEntry, when: Trigger, robots: &[RobotSpec]) -> Read<usize> {
    match (&written.who, when) {
        (Some(who), _) => named(who, robots),
        (None, Trigger::Reached(robot, _)) => Ok(robot),
        (None, Trigger::Tick(_) | Trigger::Planned(..)) => {
            Err(Fault::anywhere("say whom it concerns: who = \"NAME\""))
        }
    }
}
