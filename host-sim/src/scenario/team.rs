//! The team as written and drawn, checked robot by robot.

use super::drawing::Drawing;
use super::file::{self, ScenarioFile};
use super::{MAX_PATHS, RobotSpec};
use crate::input::{Fault, Read, WholeNumber, line_of_text, parameter, percent, refuse, share, whole};
use iibt_core::actions::HORIZON;
use iibt_core::grid::{Cell, Path};
use iibt_core::navigation::MAX_PACE;
use iibt_core::team::MAX_TEAM;
use toml::Spanned;

const LONGEST_NAME: usize = 12;

/// The most ticks that a move takes: the slowest pace of a plan.
const SLOWEST: u32 = MAX_PACE as u32;

impl Drawing {
    /// How many robots there are.
    pub(super) fn team_size(&self, file: &ScenarioFile) -> Read<usize> {
        if let Some(extra) = file.robots.get(MAX_TEAM) {
            let reason = format!("{} robots, but a team has at most {MAX_TEAM}", file.robots.len());
            return refuse(extra.span(), reason);
        }
        let drawn = self.starts.iter().rposition(Option::is_some).map_or(0, |last| last + 1);
        let missing = |&index: &usize| file.robots.get(index).is_none() && self.starts[index].is_none();
        let reason = match (drawn.max(file.robots.len()), (0..drawn).find(missing)) {
            (0, _) => "no robots: add a [[robot]] with its start, or draw '1' on the map".to_owned(),
            (size, None) => return Ok(size),
            (_, Some(index)) => {
                format!(
                    "robot {} is missing, but the map draws robot {drawn}: leave no number out",
                    index + 1
                )
            }
        };
        refuse(file.map.span(), reason)
    }

    /// The robots in the order of their numbers: those written, and those only drawn.
    pub(super) fn team(&self, file: &ScenarioFile, goals: &[Cell]) -> Read<Vec<RobotSpec>> {
        let mut robots = Vec::new();
        for index in 0..self.team_size(file)? {
            let (span, written) = match file.robots.get(index) {
                Some(entry) => (entry.span(), entry.get_ref()),
                None => (file.map.span(), &file::RobotEntry::default()),
            };
            let mut robot = self.robot(index, written, goals).map_err(|fault| fault.or_at(&span))?;
            apart(&robot, &robots).map_err(|reason| Fault::new(span, reason))?;
            robot.slip = share("slip", written.slip.as_ref().or(file.slip.as_ref()), 0.0)?;
            robot.view = whole("view", written.view.as_ref().or(file.view.as_ref()), 1..=8, 1)? as u16;
            robot.charger =
                self.own_cell("charger", written.charger.as_ref(), &robot, &robots, |other| other.charger)?;
            robot.goal = self.own_cell("goal", written.goal.as_ref(), &robot, &robots, |other| other.goal)?;
            robots.push(robot);
        }
        all_or_none(&robots, file)?;
        Ok(robots)
    }

    fn robot(&self, index: usize, written: &file::RobotEntry, goals: &[Cell]) -> Read<RobotSpec> {
        let name = match &written.name {
            Some(name) => line_of_text("name", name, LONGEST_NAME)?,
            None => format!("R{}", index + 1),
        };
        let start = self.start(index, &name, written)?;
        Ok(RobotSpec {
            start,
            battery: whole("battery", written.battery.as_ref(), 0..=100, 100)? as u8,
            charger: None,
            goal: None,
            drain: percent("drain", written.drain.as_ref(), 0.0)?,
            charging: percent("charging", written.charging.as_ref(), 10.0)?,
            slip: 0.0,
            localiser: share("localiser", written.localiser.as_ref(), 1.0)?,
            sensor: parameter("sensor", written.sensor.as_ref(), 0.0..=1.0)?,
            view: 1,
            pace: whole("pace", written.pace.as_ref(), 1..=SLOWEST, 1)?,
            paths: self.paths(start, written, goals)?,
            name,
        })
    }

    fn start(&self, index: usize, name: &str, written: &file::RobotEntry) -> Read<Cell> {
        let mark = index + 1;
        match (self.starts.get(index).copied().flatten(), &written.start) {
            (None, Some(number)) => self.free("start", number),
            (Some(cell), None) => Ok(cell),
            (Some(_), Some(number)) => {
                let reason = format!("the map draws {name} as '{mark}' already: leave one of the two out");
                refuse(number.span(), reason)
            }
            (None, None) => {
                let reason = format!("{name} has no start: write start = CELL, or draw '{mark}' on the map");
                Err(Fault::anywhere(reason))
            }
        }
    }

    /// The charger or the goal that a robot has to itself: a cell that it can reach and that `of`
    /// gives for none of the other robots.
    fn own_cell(
        &self,
        what: &str,
        number: Option<&WholeNumber>,
        robot: &RobotSpec,
        others: &[RobotSpec],
        of: impl Fn(&RobotSpec) -> Option<Cell>,
    ) -> Read<Option<Cell>> {
        let Some(number) = number else { return Ok(None) };
        let cell = self.within_reach(what, number, robot)?;
        match others.iter().find(|other| of(other) == Some(cell)) {
            Some(other) => {
                let reason = format!("{} is the {what} of {} already", cell.0, other.name);
                refuse(number.span(), reason)
            }
            None => Ok(Some(cell)),
        }
    }

    fn paths(&self, start: Cell, written: &file::RobotEntry, goals: &[Cell]) -> Read<Vec<Path>> {
        let Some(listed) = &written.paths else { return Ok(Vec::new()) };
        let count = listed.get_ref().len();
        if count == 0 || count > MAX_PATHS {
            let reason = format!("{count} paths listed: give 1 to {MAX_PATHS}, or leave `paths` out");
            return refuse(listed.span(), reason);
        }
        let paths = listed.get_ref().iter().map(|path| self.path(path, goals));
        let paths = paths.collect::<Read<Vec<_>>>()?;
        if paths.iter().all(|path| path.start != start) {
            let reason = format!("no path begins at {}, where the robot starts", start.0);
            return refuse(listed.span(), reason);
        }
        Ok(paths)
    }

    fn path(&self, listed: &Spanned<Vec<WholeNumber>>, goals: &[Cell]) -> Read<Path> {
        let numbers = listed.get_ref();
        let cells = numbers.iter().map(|number| self.free("path cell", number));
        let cells = cells.collect::<Read<Vec<_>>>()?;
        for (pair, number) in cells.windows(2).zip(numbers.iter().skip(1)) {
            if self.map.move_between(pair[0], pair[1]).is_none() {
                let reason = format!("{} and {} on the path are no neighbours", pair[0].0, pair[1].0);
                return refuse(number.span(), reason);
            }
        }
        ends_well(&cells, goals).map_err(|reason| Fault::new(listed.span(), reason))?;
        Path::through(&self.map, &cells).ok_or_else(|| {
            let moves = cells.len().saturating_sub(1);
            Fault::new(listed.span(), format!("the path has {moves} moves, but at most {HORIZON} fit"))
        })
    }
}

fn ends_well(cells: &[Cell], goals: &[Cell]) -> Result<(), String> {
    match cells {
        [.., last] if !goals.contains(last) => Err(format!("the path ends at {}, which is no goal", last.0)),
        [] => Err("the path has no cells".to_owned()),
        _ => Ok(()),
    }
}

/// Whether a robot differs from those before it.
fn apart(robot: &RobotSpec, others: &[RobotSpec]) -> Result<(), String> {
    if let Some(other) = others.iter().find(|other| other.start == robot.start) {
        return Err(format!(
            "{} starts at {}, where {} stands already",
            robot.name, robot.start.0, other.name
        ));
    }
    if others.iter().any(|other| other.name == robot.name) {
        return Err(format!("two robots are called {}", robot.name));
    }
    Ok(())
}

fn all_or_none(robots: &[RobotSpec], file: &ScenarioFile) -> Read<()> {
    let listed = file.robots.iter().find_map(|robot| robot.get_ref().paths.as_ref());
    match (listed, robots.iter().find(|robot| robot.paths.is_empty())) {
        (Some(listed), Some(robot)) => {
            let reason = format!("{} has no paths: list them for every robot or for none", robot.name);
            refuse(listed.span(), reason)
        }
        _ => Ok(()),
    }
}
