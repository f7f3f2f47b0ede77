//! A flight drawn as text: the map with everything on it, and a line for every robot.

use crate::awaited::Awaited;
use crate::fly::Snapshot;
use anstyle::{AnsiColor, Style};
use iibt_core::grid::Cell;
use iibt_core::navigation::Report;

/// The colours of a picture, if any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Palette {
    /// Characters only.
    Plain,
    /// ANSI colours.
    Colour,
}

const ROBOTS: [AnsiColor; 8] = [
    AnsiColor::Cyan,
    AnsiColor::Yellow,
    AnsiColor::Magenta,
    AnsiColor::Green,
    AnsiColor::Blue,
    AnsiColor::Red,
    AnsiColor::BrightCyan,
    AnsiColor::BrightYellow,
];

/// The legend; narrower than the narrowest terminal that is drawn on.
const LEGEND: &str = "  1 robot   G goal   ## wall   XX new obstacle   * way ahead";

const WALL: Style = AnsiColor::BrightBlack.on_default();
const OBSTACLE: Style = AnsiColor::Red.on_default().bold();
const GOAL: Style = AnsiColor::Green.on_default().bold();
const FLOOR: Style = AnsiColor::BrightBlack.on_default();

impl Palette {
    fn paint(self, style: Style, text: &str) -> String {
        match self {
            Self::Plain => text.to_owned(),
            Self::Colour => format!("{style}{text}{style:#}"),
        }
    }
}

/// The snapshot in lines of the same number at every tick.
///
/// Robots are drawn as their numbers, strangers as `M`, goals as `G`, walls as `##`, obstacles that
/// appeared as `XX`, and the cells that robots still mean to enter as `*`.
#[must_use]
pub fn picture(snapshot: &Snapshot<'_>, palette: Palette) -> Vec<String> {
    let mut lines = vec![format!("tick {}", snapshot.tick), String::new()];
    let width = snapshot.floor.width();
    for row in 0..snapshot.floor.height() {
        let cells = (0..width).map(|column| Cell(row * width + column));
        let drawn: String = cells.map(|cell| square(snapshot, cell, palette)).collect();
        lines.push(format!("  {}", drawn.trim_end()));
    }
    lines.extend([String::new(), palette.paint(FLOOR, LEGEND)]);
    lines.extend((0..snapshot.cells.len()).map(|robot| robot_line(snapshot, robot, palette)));
    lines
}

/// One cell, two characters wide.
fn square(snapshot: &Snapshot<'_>, cell: Cell, palette: Palette) -> String {
    if let Some(robot) = snapshot.cells.iter().position(|&at| at == cell) {
        return palette.paint(colour(robot).bold(), &format!("{} ", robot + 1));
    }
    if snapshot.strangers.contains(&cell) {
        return palette.paint(OBSTACLE, "M ");
    }
    if !snapshot.scenario.map.is_free(cell) {
        return palette.paint(WALL, "##");
    }
    if !snapshot.floor.is_free(cell) {
        return palette.paint(OBSTACLE, "XX");
    }
    if snapshot.scenario.goals.contains(&cell) {
        return palette.paint(GOAL, "G ");
    }
    let heading_here =
        |report: &Report| report.path.cells(snapshot.floor).skip(report.step + 1).any(|at| at == cell);
    match snapshot.reports.iter().position(heading_here) {
        Some(robot) => palette.paint(colour(robot), "* "),
        None => palette.paint(FLOOR, ". "),
    }
}

fn robot_line(snapshot: &Snapshot<'_>, robot: usize, palette: Palette) -> String {
    let (setup, report) = (&snapshot.scenario.robots[robot], &snapshot.reports[robot]);
    let name = palette.paint(colour(robot).bold(), &format!("{:<4}", setup.name));
    let plan = match report.goal {
        Some(goal) => format!(
            "to {}, step {} of {}, probability {:.3}",
            goal.0,
            report.step,
            report.path.len(),
            report.probability
        ),
        None => "has not chosen".to_owned(),
    };
    let stopped = snapshot.stopped[robot].then_some("stopped");
    let activity = stopped.or(snapshot.activities[robot]).unwrap_or("-");
    let errand = report.waypoint.map_or_else(String::new, |cell| format!(", by way of {}", cell.0));
    let look = report.look_out.map_or_else(String::new, |cell| format!(", by the look-out {}", cell.0));
    let awaited = report.waiting.and_then(|waiting| Awaited::of(waiting, snapshot.scenario).robot);
    let waiting = awaited.map_or_else(String::new, |name| format!(", waits for {name}"));
    let charge = snapshot.charges[robot];
    let battery = if charge < 100 { format!(", battery {charge} %") } else { String::new() };
    format!(
        "  {name} at {:>3}  {activity:<10}  {plan}{errand}{look}{battery}{waiting}",
        snapshot.cells[robot].0
    )
}

fn colour(robot: usize) -> Style {
    ROBOTS[robot % ROBOTS.len()].on_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Conditions, Observer, Scenario, fly};

    /// Keeps the picture of one tick.
    struct Photograph {
        tick: u32,
        palette: Palette,
        lines: Vec<String>,
    }

    impl Observer for Photograph {
        fn observe(&mut self, snapshot: &Snapshot<'_>) {
            if snapshot.tick == self.tick {
                self.lines = picture(snapshot, self.palette);
            }
        }
    }

    fn photograph(tick: u32, palette: Palette) -> Vec<String> {
        let text = "title = 't'\nmap = '''\n1..G\n.##.\n2..G\n'''\n[[event]]\ntick = 0\nblock = 4";
        let scenario = Scenario::parse("test", text).unwrap();
        let mut photograph = Photograph { tick, palette, lines: Vec::new() };
        fly(&scenario, Conditions::default(), &mut photograph).unwrap();
        photograph.lines
    }

    #[test]
    fn shows_robots_goals_walls_and_obstacles() {
        let map = ["  1 . . G", "  . ####.", "  2 . . G"];
        assert_eq!(photograph(0, Palette::Plain)[2..5], map);
        assert_eq!(photograph(1, Palette::Plain)[3], "  XX####.");
    }

    #[test]
    fn shows_plans_and_says_who_has_one() {
        let (early, late) = (photograph(0, Palette::Plain), photograph(4, Palette::Plain));
        assert!(early[7].contains("R1") && early[7].contains("has not chosen"), "{early:?}");
        assert_eq!(late[2], "  . 1 * G");
        assert!(late[7].contains("to 3, step 0 of 3"), "{late:?}");
    }

    #[test]
    fn colours_only_when_asked() {
        assert!(!photograph(4, Palette::Plain).concat().contains('\x1b'));
        assert!(photograph(4, Palette::Colour).concat().contains('\x1b'));
    }
}
