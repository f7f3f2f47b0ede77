//! The size of a task file: what the simulator has room for.

use super::file;
use crate::input::{Read, refuse};
use toml::Spanned;

/// The most robots, states of all factors of a robot, and joint policies.
pub(super) const ROBOTS: usize = 4;
pub(super) const STATES: usize = 64;
pub(super) const POLICIES: usize = 256;

/// Checks that a task fits, before its tables are made.
pub(super) fn check(file: &file::File) -> Read<()> {
    if let Some(surplus) = file.robots.get(ROBOTS) {
        let robots = file.robots.len();
        return refuse(surplus.span(), format!("a task has 1 to {ROBOTS} robots, not {robots}"));
    }
    for robot in file.robots.iter().map(Spanned::get_ref) {
        let states: usize = robot.factors.iter().map(|factor| factor.get_ref().states.len()).sum();
        if states > STATES {
            let reason =
                format!("the factors of a robot have at most {STATES} states together, not {states}");
            return refuse(robot.name.span(), reason);
        }
        if robot.sensors.is_empty() {
            return refuse(robot.name.span(), "a robot needs a [[robot.sensor]]");
        }
    }
    let actions: Vec<usize> = file.robots.iter().map(|robot| robot.get_ref().actions.len()).collect();
    let policies = actions.iter().fold(1, |policies: usize, &actions| policies.saturating_mul(actions));
    if let (Some(first), true) = (file.robots.first(), policies > POLICIES) {
        let factors: Vec<String> = actions.iter().map(usize::to_string).collect();
        let reason = format!(
            "the robots' actions make {} = {policies} joint policies: there is room for {POLICIES}",
            factors.join(" x ")
        );
        return refuse(first.span(), reason);
    }
    Ok(())
}
