//! Whether a mission with unknowns can be accomplished however they are.
//!
//! Robots without goals of their own can be exchanged: one that is in the way goes itself. So ways
//! to goals that differ are enough, and nobody has to search for moves of the whole team.

use crate::scenario::{Scenario, served};
use iibt_core::grid::Cell;

/// Whether there is a way from every start to every goal where nothing is blocked, and in every
/// world of positive prior as many robots as needed have ways to goals that differ and serve.
pub(super) fn is_soluble(scenario: &Scenario) -> bool {
    let Scenario { map, goals, robots, need, .. } = scenario;
    let reached = |start: Cell| goals.iter().all(|&goal| map.connected(start).contains(goal));
    robots.iter().all(|robot| reached(robot.start)) && served(scenario).all(|robots| robots >= *need)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(need: usize, map: &str, unknowns: &str) -> bool {
        let text = format!("title = 't'\nneed = {need}\nmap = '''\n{map}\n'''\n{unknowns}");
        is_soluble(&Scenario::parse("drawn", &text).expect("it is sound"))
    }

    #[test]
    fn every_start_has_a_way_to_every_goal() {
        let either = "[[unknown]]\nserves = [[3], [7]]\nprior = [0.5, 0.5]\nbeside = 1.0";
        assert!(verdict(1, "1..G\n...G", either));
        assert!(!verdict(1, "1..G\n####\n...G", "") && !verdict(1, "1..G\n####\n2...", ""));
    }

    #[test]
    fn in_every_world_that_may_be_enough_goals_serve() {
        let serves =
            |prior: &str| format!("[[unknown]]\nserves = [[2, 3], [7]]\nprior = {prior}\nbeside = 1.0");
        let map = "1.GG\n2..G";
        assert!(verdict(1, map, &serves("[0.5, 0.5]")) && verdict(2, map, &serves("[1.0, 0.0]")));
        assert!(!verdict(2, map, &serves("[0.5, 0.5]")));
    }

    #[test]
    fn in_every_world_that_may_be_a_way_is_open() {
        let gates = |prior: &str| {
            let gate =
                |cell: u8| format!("[[unknown]]\nblocks = [[{cell}]]\nprior = {prior}\nbeside = 1.0\n");
            gate(1) + &gate(9)
        };
        let two_ways = "1..G\n.##.\n....";
        assert!(!verdict(1, two_ways, &gates("[0.5, 0.5]")) && verdict(1, two_ways, &gates("[1.0, 0.0]")));
        assert!(verdict(1, "1..G\n....\n....", &gates("[0.5, 0.5]")));
    }
}
