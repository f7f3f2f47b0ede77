//! The end of a flight in a table and a line.

use super::shortfall::shortfall;
use crate::record::{Record, RobotRecord};
use crate::text::{counted, route};
use crate::verdict::Outcome;
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, Table, TableStyle};

/// A line below the header and nothing else.
const STYLE: TableStyle = TableStyle::new().header_separator(LineStyle::new('─', '─', '─', '─'));

/// A terminal narrower than this gets lines that are too long for it.
const NARROWEST: u16 = 72;

const HEADER: [&str; 9] =
    ["robot", "goal", "chosen path", "prob.", "moves", "sent", "lost", "rejected", "arrived"];
const LEGEND: &str = "path: the last; prob.: of its joint policy among all weighed; lost: of deliveries";
const PATH: usize = 2;
const TEXTS: [usize; 3] = [0, PATH, 8];

/// A table of the robots, the outcome below it, and what the robots lack if the mission failed.
/// Paths are wrapped in a terminal with this number of `columns`.
#[must_use]
pub fn summary(record: &Record, columns: Option<u16>) -> String {
    let mut table = Table::new();
    table.load_style(STYLE).set_header(HEADER).add_rows(record.robots.iter().map(row));
    if let Some(columns) = columns {
        table.set_content_arrangement(ContentArrangement::Dynamic).set_width(columns.max(NARROWEST));
    }
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, 2));
        if index != PATH {
            column.set_constraint(ColumnConstraint::ContentWidth);
        }
        if !TEXTS.contains(&index) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let events: String = record.robots.iter().filter_map(events).collect();
    let lacking: String = shortfall(record).into_iter().map(|line| format!("\n  {line}")).collect();
    format!("{}\n\n{LEGEND}\n{events}{}{lacking}", table.trim_fmt(), outcome_line(record))
}

/// The events of a robot besides its plans, in a line; `None` when nothing did.
fn events(robot: &RobotRecord) -> Option<String> {
    let visited = (!robot.visited.is_empty()).then(|| format!("visited {}", route(&robot.visited)));
    let charged = (robot.charged > 0).then(|| format!("charged {}", counted(robot.charged, "time")));
    let battery = (robot.battery < 100).then(|| format!("battery {} %", robot.battery));
    let stopped = robot.stopped.then(|| "stopped".to_owned());
    let parts: Vec<_> = [visited, charged, battery, stopped].into_iter().flatten().collect();
    (!parts.is_empty()).then(|| format!("{}: {}\n", robot.name, parts.join(", ")))
}

fn row(robot: &RobotRecord) -> [String; 9] {
    [
        robot.name.clone(),
        robot.goal.map_or_else(|| "-".to_owned(), |goal| goal.0.to_string()),
        route(&robot.path),
        format!("{:.3}", robot.probability),
        robot.moves.to_string(),
        robot.frames.sent.to_string(),
        format!("{}/{}", robot.frames.lost, robot.frames.lost + robot.frames.delivered),
        robot.rejected.to_string(),
        arrival(robot),
    ]
}

fn arrival(robot: &RobotRecord) -> String {
    match robot.goal {
        _ if robot.status != "arrived" => format!("no: {}", robot.status),
        Some(goal) if goal == robot.cell => format!("tick {}", robot.arrived),
        Some(_) => "no: elsewhere".to_owned(),
        None => format!("tick {}, at no goal", robot.arrived),
    }
}

/// The outcome in one line.
#[must_use]
pub fn outcome_line(record: &Record) -> String {
    let name = &record.scenario;
    let copies = record.frames.delivered + record.frames.lost;
    let lost = format!("{} of {copies} deliveries lost", record.frames.lost);
    format!("{name}: {}; {}, {lost} (seed {})", ending(record), collisions(record), record.seed)
}

/// The outcome of a flight, without its name.
pub(super) fn ending(record: &Record) -> String {
    let (team, arrival, flown) = (team(record), record.last_arrival(), counted(record.ticks + 1, "tick"));
    match (record.outcome, record.spread()) {
        (Outcome::Together, _) if record.members().count() == 1 => {
            format!("{team} arrived at tick {arrival}")
        }
        (Outcome::Together, 0) => format!("{team} arrived together at tick {arrival}"),
        (Outcome::Together, spread) => {
            let apart = counted(spread, "tick");
            format!("{team} arrived together, at most {apart} apart, at tick {arrival}")
        }
        (Outcome::Apart, _) => format!("{team} arrived, but not together, by tick {arrival}"),
        (Outcome::NothingToDo, _) => "there was nothing to do".to_owned(),
        (Outcome::Unfinished, _) => format!("NOT accomplished within {flown}"),
        (Outcome::Collided, _) => format!("FAILED by a collision, {flown} flown"),
    }
}

fn team(record: &Record) -> String {
    match (record.members().count(), record.robots.len()) {
        (1, 1) => "the robot".to_owned(),
        (2, 2) => "both robots".to_owned(),
        (members, size) if members < size => format!("{members} of {size} robots"),
        (_, size) => format!("all {size} robots"),
    }
}

fn collisions(record: &Record) -> String {
    let seen = &record.collisions;
    match seen.total() {
        0 => "no collisions".to_owned(),
        total => format!(
            "{} ({}, {}, {})",
            counted(total, "collision"),
            counted(seen.shared, "shared cell"),
            counted(seen.swapped, "swap"),
            counted(seen.bumps, "bump")
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Conditions, fly, library};
    use iibt_core::grid::Cell;

    fn flown(loss: f64) -> Record {
        let scenario = library::find("two-goals").unwrap().unwrap();
        fly(&scenario, Conditions { seed: 1, loss: Some(loss), ..Conditions::default() }, &mut ()).unwrap()
    }

    #[test]
    fn tells_every_robot_and_the_outcome() {
        let text = summary(&flown(0.0), None);
        let lines: Vec<_> = text.lines().collect();
        let words = |line: usize| lines[line].split_whitespace().take(9).collect::<Vec<_>>().join(" ");
        assert_eq!(lines.len(), 7, "{text}");
        assert_eq!(words(0), "robot goal chosen path prob. moves sent lost rejected");
        assert_eq!(words(2), "R1 24 28 35 36 37 38 31 24");
        assert_eq!(words(3), "R2 26 2 3 4 11 18 25 26");
        assert!(lines[5].contains("prob.: of its joint policy"), "{text}");
        assert!(lines[6].starts_with("two-goals: both robots arrived together at tick"), "{text}");
    }

    #[test]
    fn tells_what_happened_to_a_robot_besides_its_plans() {
        let mut record = flown(0.0);
        let robot = &mut record.robots[1];
        (robot.visited, robot.charged) = (vec![Cell(4), Cell(9)], 1);
        (robot.battery, robot.stopped) = (35, true);
        let text = summary(&record, None);
        assert!(text.contains("\nR2: visited 4 9, charged 1 time, battery 35 %, stopped\n"), "{text}");
        assert!(!text.contains("\nR1: "), "{text}");
    }

    #[test]
    fn tells_where_a_robot_is_that_has_arrived() {
        let arrived = |goal| {
            let mut record = flown(0.0);
            record.robots[0].goal = goal;
            arrival(&record.robots[0])
        };
        let record = flown(0.0);
        let tick = format!("tick {}", record.robots[0].arrived);
        assert_eq!(arrived(Some(record.robots[0].cell)), tick);
        assert_eq!(arrived(None), tick + ", at no goal");
        assert_eq!(arrived(Some(Cell(0))), "no: elsewhere");
    }

    #[test]
    fn fits_the_terminal() {
        let text = summary(&flown(0.0), Some(80));
        let mut table = text.lines().take_while(|line| !line.is_empty());
        assert!(table.all(|line| line.chars().count() <= 80), "{text}");
        assert!(text.lines().count() > 7, "paths are wrapped:\n{text}");
    }

    #[test]
    fn ends_with_what_the_robots_lack() {
        let text = summary(&flown(1.0), None);
        let last: Vec<_> = text.lines().rev().take(2).collect();
        assert!(last[1].starts_with("  R1 ") && last[0].starts_with("  R2 "), "{text}");
    }

    #[test]
    fn tells_how_it_ended() {
        let mut record = flown(1.0);
        assert!(outcome_line(&record).contains("NOT accomplished within 200 ticks; no collisions"));
        record.collisions.swapped = 2;
        record.outcome = Outcome::Collided;
        assert!(outcome_line(&record).contains("FAILED by a collision"));
        assert!(outcome_line(&record).contains("2 collisions (0 shared cells, 2 swaps, 0 bumps)"));
        record.outcome = Outcome::Apart;
        assert!(outcome_line(&record).contains("not together"));
        record.outcome = Outcome::Together;
        (record.robots[0].arrived, record.robots[1].arrived) = (7, 8);
        assert!(outcome_line(&record).contains("both robots arrived together, at most"));
        record.outcome = Outcome::NothingToDo;
        assert!(outcome_line(&record).starts_with("two-goals: there was nothing to do; "));
        record.outcome = Outcome::Together;
        record.robots.truncate(1);
        assert!(outcome_line(&record).contains("the robot arrived at tick"));
    }
}
