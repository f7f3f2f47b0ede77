//! A series of missions, a line each.

use super::summary::ending;
use crate::series::{Series, SeriesMission};
use crate::text::counted;

/// A line for every mission: the robots' goals, who was served, and the outcome; with `brief`, one
/// line for all.
#[must_use]
pub fn series_lines(series: &Series, brief: bool) -> String {
    let missions = series.missions.len();
    let served: f64 = series.missions.iter().map(SeriesMission::share).sum::<f64>() / missions.max(1) as f64;
    let done = series.missions.iter().filter(|mission| mission.record.outcome.is_success()).count();
    let collisions: u32 = series.missions.iter().map(|mission| mission.record.collisions.total()).sum();
    let total = format!(
        "{done} of {missions} missions accomplished, {:.0} % of the robots served, {}",
        100.0 * served,
        if collisions == 0 { "no collisions".to_owned() } else { counted(collisions, "collision") }
    );
    if brief {
        return total;
    }
    let lines = series.missions.iter().enumerate().map(|(index, mission)| line(index + 1, mission));
    lines.chain([String::new(), total]).collect::<Vec<_>>().join("\n")
}

fn line(number: usize, mission: &SeriesMission) -> String {
    let robots = mission.record.robots.iter().zip(&mission.served);
    let stood = robots.map(|(robot, served)| match served {
        Some(true) => format!("{} served at {}", robot.name, robot.cell.0),
        Some(false) => format!("{} not served at {}", robot.name, robot.cell.0),
        None => format!("{} at no goal", robot.name),
    });
    let stood = stood.collect::<Vec<_>>().join(", ");
    format!("mission {number:>3}  {stood}; {}", ending(&mission.record))
}
