//! From a file as written to a sound scenario, or the first thing that is wrong with it.

use super::drawing::Drawing;
use super::file::ScenarioFile;
use super::{DriveFault, InferenceSpec, MAX_TICKS, RobotSpec, Scenario, file, reach};
use crate::input::{Fault, Read, WholeNumber, line_of_text, optional, parameter, refuse, share, whole};
use crate::text::{counted, move_called};
use iibt_core::grid::Cell;
use iibt_core::navigation::MAX_GOALS;
use std::ops::Range;
use toml::Spanned;

const LONGEST_TITLE: usize = 120;

const MOST_MISSIONS: u32 = 1000;

/// Checks everything; `text` is what `file` was read from.
pub(super) fn check(name: &str, text: &str, file: &ScenarioFile) -> Read<Scenario> {
    let scenario = read(name, text, file)?;
    possible(&scenario, file)?;
    Ok(scenario)
}

fn read(name: &str, text: &str, file: &ScenarioFile) -> Read<Scenario> {
    let drawing = Drawing::read(text, &file.map)?;
    let goals = drawing.goals(file)?;
    let robots = drawing.team(file, &goals)?;
    let goals = with_own_goals(goals, &robots);
    sensible(goals.len(), robots.len()).map_err(|reason| {
        let span = file.goals.as_ref().map_or(file.map.span(), Spanned::span);
        Fault::new(span, reason)
    })?;
    let need = needed(file, &goals, &robots)?;
    reach::enough_goals(&drawing.map, &goals, &robots, need)
        .map_err(|(robot, reason)| Fault::new(start_of(robot, file), reason))?;
    let events = file.events.iter().map(|event| drawing.event(event, &robots));
    let serves = services(file, &goals)?;
    let unknowns = drawing.unknowns(file, &goals, &robots)?;
    Ok(Scenario {
        name: name.to_owned(),
        title: line_of_text("title", &file.title, LONGEST_TITLE)?,
        limit: whole("limit", file.limit.as_ref(), 1..=MAX_TICKS, 200)?,
        need,
        waits_for_charging: file.wait_for_charging.unwrap_or(false),
        forgets: whole("forget", file.forget.as_ref(), 0..=MAX_TICKS.min(u16::MAX.into()), 0)? as u16,
        missions: whole("missions", file.missions.as_ref(), 1..=MOST_MISSIONS, 1)?,
        radio: file.radio.check()?,
        inference: inference(&file.inference)?,
        drive_faults: file
            .drive_faults
            .iter()
            .map(|fault| drive_fault(fault, &robots))
            .collect::<Result<_, _>>()?,
        events: events.collect::<Result<_, _>>()?,
        map: drawing.map,
        goals,
        serves,
        unknowns,
        robots,
    })
}

impl Drawing {
    /// A free cell of the map.
    pub(super) fn free(&self, what: &str, number: &WholeNumber) -> Read<Cell> {
        let value = *number.get_ref();
        let cell = u16::try_from(value).ok().map(Cell).filter(|&cell| self.map.contains(cell));
        let reason = match cell {
            Some(cell) if self.map.is_free(cell) => return Ok(cell),
            Some(_) => format!("{what} {value} is blocked on the map"),
            None => {
                let last = self.map.len() - 1;
                format!("{what} {value} is outside the map, whose cells are 0 to {last}")
            }
        };
        refuse(number.span(), reason)
    }

    fn goals(&self, file: &ScenarioFile) -> Read<Vec<Cell>> {
        let Some(listed) = &file.goals else { return Ok(self.goals.clone()) };
        if !self.goals.is_empty() {
            let reason = "the map draws goals as 'G' already: leave one of the two out";
            return refuse(listed.span(), reason);
        }
        let mut goals = Vec::new();
        for number in listed.get_ref() {
            let goal = self.free("goal", number)?;
            if goals.contains(&goal) {
                return refuse(number.span(), format!("goal {} is listed twice", goal.0));
            }
            goals.push(goal);
        }
        Ok(goals)
    }
}

/// With which probability each goal serves: one says so at the most once.
fn services(file: &ScenarioFile, goals: &[Cell]) -> Read<Vec<f64>> {
    let mut serves = vec![None; goals.len()];
    for service in &file.services {
        let service = service.get_ref();
        let number = *service.cell.get_ref();
        let Some(goal) = goals.iter().position(|goal| i64::from(goal.0) == number) else {
            return refuse(service.cell.span(), format!("{number} is no goal"));
        };
        if serves[goal].replace(share("serves", Some(&service.serves), 1.0)?).is_some() {
            return refuse(service.cell.span(), format!("goal {number} has a [[goal]] already"));
        }
    }
    Ok(serves.into_iter().map(|serves| serves.unwrap_or(1.0)).collect())
}

/// The most joint policies that robots weigh.
const POLICIES: u32 = crate::team::POLICIES as u32;

/// The goals, with those that robots own and that are not listed.
fn with_own_goals(mut goals: Vec<Cell>, robots: &[RobotSpec]) -> Vec<Cell> {
    for own in robots.iter().filter_map(|robot| robot.goal) {
        if !goals.contains(&own) {
            goals.push(own);
        }
    }
    goals
}

/// The number of goals that must be reached: by default one for each robot, at most all.
fn needed(file: &ScenarioFile, goals: &[Cell], robots: &[RobotSpec]) -> Read<usize> {
    let most = goals.len().min(robots.len());
    Ok(whole("need", file.need.as_ref(), 1..=most as u32, most as u32)? as usize)
}

/// Whether robots can accomplish a mission with unknowns in one of its worlds, and may look.
fn possible(scenario: &Scenario, file: &ScenarioFile) -> Read<()> {
    let Some(first) = file.unknowns.first() else { return Ok(()) };
    if let Some(paths) = file.robots.iter().find_map(|robot| robot.get_ref().paths.as_ref()) {
        return refuse(paths.span(), "robots with paths do not look: leave them out, or every [[unknown]]");
    }
    let (need, most) = (scenario.need, reach::served(scenario).max().unwrap_or(0));
    if most >= need {
        return Ok(());
    }
    let reason = format!("need = {need}, but at most {most} can be held, whatever the unknowns are");
    refuse(file.need.as_ref().map_or(first.span(), Spanned::span), reason)
}

/// Whether a mission has this many goals.
fn sensible(goals: usize, robots: usize) -> Result<(), String> {
    match goals {
        0 => {
            Err(format!("no goal for {}: draw 'G' on the map or list them", counted(robots as u32, "robot")))
        }
        1..=MAX_GOALS => Ok(()),
        _ => Err(format!("{goals} goals, but a mission has at most {MAX_GOALS}")),
    }
}

/// Where the start of a robot is written: as a number, or else on the map.
fn start_of(robot: usize, file: &ScenarioFile) -> Range<usize> {
    let written = file.robots.get(robot).and_then(|robot| robot.get_ref().start.as_ref());
    written.map_or(file.map.span(), Spanned::span)
}

pub(super) fn named(name: &Spanned<String>, robots: &[RobotSpec]) -> Read<usize> {
    robots.iter().position(|robot| robot.name == *name.get_ref()).ok_or_else(|| {
        let names: Vec<_> = robots.iter().map(|robot| robot.name.as_str()).collect();
        let reason = format!("no robot is called \"{}\": there are {}", name.get_ref(), names.join(", "));
        Fault::new(name.span(), reason)
    })
}

fn drive_fault(fault: &Spanned<file::DriveFaultEntry>, robots: &[RobotSpec]) -> Read<DriveFault> {
    let written = fault.get_ref();
    Ok(DriveFault {
        robot: named(&written.robot, robots)?,
        step: move_called(written.step.get_ref())
            .map_err(|reason| Fault::new(written.step.span(), reason))?,
        from: whole("from", written.from.as_ref(), 0..=MAX_TICKS, 0)?,
        fails: share("fails", Some(&written.fails), 0.0)?,
    })
}

fn inference(written: &file::InferenceEntry) -> Read<InferenceSpec> {
    Ok(InferenceSpec {
        precision: parameter("precision", written.precision.as_ref(), 0.0..=1000.0)?,
        habit: parameter("habit", written.habit.as_ref(), 0.0..=1000.0)?,
        sensor: parameter("sensor", written.sensor.as_ref(), 0.0..=1.0)?,
        policies: optional("policies", written.policies.as_ref(), 1..=POLICIES)?.map(|count| count as u8),
        budget: optional("budget", written.budget.as_ref(), 1..=1_000_000_000)?,
        learning: parameter("learning", written.learning.as_ref(), 0.0..=1000.0)?,
        alike: written.alike.unwrap_or(false),
    })
}
