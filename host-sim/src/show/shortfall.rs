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
    let is_at_goal = robot.goal == Some(robot.cell);
    if robot.status == "arrived" && is_at_goal && robot.failure.is_none() {
        return None;
    }
    let reason = match (robot.status, robot.goal) {
        ("arrived", _) if robot.failure.is_some() => reason(robot)?,
        ("away", _) => "its battery is low".to_owned(),
        ("stuck", _) => "its readings do not follow its moves".to_owned(),
        ("arrived", Some(goal)) => {
            return Some(format!("stands on {here}, but takes it to be its goal {}", goal.0));
        }
        _ => reason(robot)?,
    };
    Some(format!("stands on {here}: {reason}"))
}

/// Why a robot is not at a goal: what its plan lacks, else what it waits for, else that it is on
/// its way.
fn reason(robot: &RobotRecord) -> Option<String> {
    if let Some(failure) = &robot.failure {
        return Some(failure.clone());
    }
    if let Some(waiting) = &robot.waiting {
        return Some(waiting.to_string());
    }
    match (robot.status, robot.goal) {
        (_, Some(goal)) if goal == robot.cell => None,
        (_, Some(goal)) => Some(format!("on its way to goal {}", goal.0)),
        ("deciding", None) => Some("it is not sure where it stands".to_owned()),
        (_, None) => Some("no goal is left for it".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Awaited, Conditions, Outcome, fly, library};
    use iibt_core::grid::Cell;

    /// What R1 of two-goals lacks, standing on 28, after a change of its record.
    fn lacking(change: impl FnOnce(&mut RobotRecord)) -> Vec<String> {
        let scenario = library::find("two-goals").unwrap().unwrap();
        let mut record = fly(&scenario, Conditions::default(), &mut ()).unwrap();
        record.outcome = Outcome::Unfinished;
        let robot = &mut record.robots[0];
        (robot.cell, robot.waiting, robot.failure) = (Cell(28), None, None);
        change(robot);
        shortfall(&record)
    }

    fn in_stage(status: &'static str, goal: Option<u16>) -> Vec<String> {
        lacking(|robot| (robot.status, robot.goal) = (status, goal.map(Cell)))
    }

    #[test]
    fn every_robot_that_is_not_at_its_goal_says_why() {
        #[rustfmt::skip]
        let cases = [
            ("away", Some(26), "R1 stands on 28: its battery is low"),
            ("deciding", None, "R1 stands on 28: it is not sure where it stands"),
            ("agreed", None, "R1 stands on 28: no goal is left for it"),
            ("agreed", Some(26), "R1 stands on 28: on its way to goal 26"),
            ("arrived", Some(26), "R1 stands on 28, but takes it to be its goal 26"),
        ];
        for (status, goal, line) in cases {
            assert_eq!(in_stage(status, goal), [line]);
        }
        assert!(in_stage("arrived", Some(28)).is_empty());
    }

    #[test]
    fn a_plan_that_fails_comes_before_what_is_waited_for() {
        let waiting = Some(Awaited { robot: Some("R2".to_owned()), reason: "it is lost".to_owned() });
        let failure = Some("no way".to_owned());
        let line = |failure| {
            lacking(|robot| {
                (robot.status, robot.waiting, robot.failure) = ("deciding", waiting.clone(), failure)
            })
        };
        assert_eq!(line(None), ["R1 stands on 28: waiting for R2: it is lost"]);
        assert_eq!(line(failure), ["R1 stands on 28: no way"]);
    }

    #[test]
    fn a_robot_that_was_never_heard_is_named() {
        let scenario = library::find("two-goals").unwrap().unwrap();
        let silent = Conditions { loss: Some(1.0), ..Conditions::default() };
        let lines = shortfall(&fly(&scenario, silent, &mut ()).unwrap());
        assert_eq!(
            lines,
            [
                "R1 stands on 28: waiting for R2: it was never heard, so it may be anywhere",
                "R2 stands on 2: waiting for R1: it is lost, and the others are no quorum"
            ]
        );
    }

    #[test]
    fn nothing_is_missing_after_a_success() {
        let scenario = library::find("two-goals").unwrap().unwrap();
        assert!(shortfall(&fly(&scenario, Conditions::default(), &mut ()).unwrap()).is_empty());
    }
}
