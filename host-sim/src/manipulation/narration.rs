//! The narration of a run, line by line.

use super::record::{RobotTick, Run, TickRecord};
use std::fmt::Write;

/// Narrates a run that has its history: a line for everything that a robot begins, chooses or
/// observes.
#[must_use]
pub fn narrate(run: &Run) -> String {
    let mut text = String::new();
    let mut before: Option<&TickRecord> = None;
    for tick in &run.history {
        for (index, robot) in tick.robots.iter().enumerate() {
            let last = before.map(|tick| &tick.robots[index]);
            let who = format!("tick {:>3}  robot {}", tick.tick, index + 1);
            if let Some(thought) = told(robot, last) {
                _ = writeln!(text, "{who} {thought}");
            }
            if let Some([deed, place]) = robot.begins {
                let to = if deed == "moveTo" { "to" } else { "at" };
                let chosen = run.decisions.iter().find(|of| of.tick == tick.tick && of.robot == index + 1);
                let why = chosen.map_or_else(String::new, |of| {
                    format!(
                        ", by pi{} = ({}, {}), P {:.3}",
                        of.policy, of.actions[0], of.actions[1], of.probability
                    )
                });
                _ = writeln!(text, "{who} begins {deed} {to} {place}{why}");
            }
        }
        for (thing, now, was) in [
            ("the bottle", &tick.bottle, before.map(|tick| &tick.bottle)),
            ("the plate", &tick.plate, before.map(|tick| &tick.plate)),
        ] {
            if was.is_some_and(|was| was != now) {
                _ = writeln!(text, "tick {:>3}  {thing} is {now}", tick.tick);
            }
        }
        before = Some(tick);
    }
    text + &outcome(run)
}

/// A change of the settled state.
fn told(robot: &RobotTick, last: Option<&RobotTick>) -> Option<String> {
    const NAMES: [&str; 4] = ["where its object is", "holding its object", "rid of its object", "free"];
    let most = |of: &RobotTick| {
        let states = of.thought.as_ref()?.states;
        let state = (0..4).max_by(|&a, &b| states[a].total_cmp(&states[b]))?;
        Some((state, states[state]))
    };
    let (state, probability) = most(robot)?;
    let was = last.and_then(most).map(|(state, _)| state);
    (was.is_some_and(|was| was != state))
        .then(|| format!("believes that it is {} (q {probability:.3})", NAMES[state]))
}

fn outcome(run: &Run) -> String {
    let came = match (run.success, run.believed) {
        (true, _) => "The bottle is on the plate.",
        (false, true) => "Robot 1 takes the bottle to be on the plate, and it is not.",
        (false, false) => "The bottle is not on the plate.",
    };
    let actions = run.actions.moves + run.actions.picks + run.actions.placings;
    format!(
        "{came} {} ticks, {actions} actions of which {} are retries, {} frames of which {} were lost.\n",
        run.ticks, run.retries, run.frames.sent, run.frames.lost
    )
}
