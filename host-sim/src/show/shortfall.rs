//! The reasons for a failed mission, a line per robot.

use crate::record::{Record, RobotRecord};

/// A line for every robot that is not where it should be; none when the mission was accomplished.
pub(super) fn shortfall(record: &Record) -> Vec<String> {
    let lacking = |robot: &RobotRecord| lack(robot).map(|lack| format!("{} {lack}", robot.name));
    let robots = record.robots.iter().filter(|_| !record.outcome.is_success());
    robots.filter_map(lacking).collect()
}

fn lack(robot: &RobotRecord) -> Option<String> {
    let here = robot.cell.0;
    if robot.stopped {
        return Some(format!("stands on {here}: it has stopped"));
    }
    Some(match (robot.status, robot.goal) {
        ("away", _) => format!("stands on {here}: its battery is low"),
        ("deciding", _) => {
            format!(
                "stands on {here}: it has not chosen, for want of word from a teammate or of a sure position"
            )
        }
        (_, None) => format!("stands on {here}: no way to a goal"),
        ("announced", Some(goal)) => {
            format!("stands on {here}: it chose goal {}, but has not heard that all have chosen", goal.0)
        }
        (_, Some(goal)) if goal == robot.cell => return None,
        ("arrived", Some(goal)) => format!("stands on {here}, but takes it to be its goal {}", goal.0),
        (_, Some(goal)) => format!("stands on {here}, on its way to goal {}", goal.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Conditions, Outcome, fly, library};
    use iibt_core::grid::Cell;

    /// What R1 of two-goals lacks, standing on 28.
    fn lacking(status: &'static str, goal: Option<u16>) -> Vec<String> {
        let scenario = library::find("two-goals").unwrap().unwrap();
        let mut record = fly(&scenario, Conditions::default(), &mut ()).unwrap();
        record.outcome = Outcome::Unfinished;
        let robot = &mut record.robots[0];
        (robot.cell, robot.status, robot.goal) = (Cell(28), status, goal.map(Cell));
        shortfall(&record)
    }

    #[test]
    fn every_robot_that_is_not_at_its_goal_says_why() {
        #[rustfmt::skip]
        let cases = [
            ("away", Some(26), "R1 stands on 28: its battery is low"),
            ("deciding", None, "R1 stands on 28: it has not chosen, for want of word from a teammate or of a sure position"),
            ("announced", Some(26), "R1 stands on 28: it chose goal 26, but has not heard that all have chosen"),
            ("agreed", None, "R1 stands on 28: no way to a goal"),
            ("announced", None, "R1 stands on 28: no way to a goal"),
            ("agreed", Some(26), "R1 stands on 28, on its way to goal 26"),
            ("arrived", Some(26), "R1 stands on 28, but takes it to be its goal 26"),
        ];
        for (status, goal, line) in cases {
            assert_eq!(lacking(status, goal), [line]);
        }
        assert!(lacking("arrived", Some(28)).is_empty());
    }

    #[test]
    fn nothing_is_missing_after_a_success() {
        let scenario = library::find("two-goals").unwrap().unwrap();
        assert!(shortfall(&fly(&scenario, Conditions::default(), &mut ()).unwrap()).is_empty());
    }
}
