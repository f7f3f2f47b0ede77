//! What a robot waits for, with robots by their names.

use crate::scenario::Scenario;
use iibt_core::team::RobotId;
use iibt_core::team::rounds::Waiting;
use serde::Serialize;
use std::fmt;

/// What a robot waits for.
///
/// ```
/// use host_sim::{Conditions, Outcome, fly, library};
///
/// let scenario = library::find("two-goals").expect("it is built in")?;
/// let silent = Conditions { loss: Some(1.0), ..Conditions::default() };
/// let record = fly(&scenario, silent, &mut ())?;
/// assert_eq!(record.outcome, Outcome::Unfinished);
/// let awaited = record.robots[0].waiting.as_ref().expect("it waits");
/// assert_eq!(awaited.to_string(), "waiting for R2: it was never heard, so it may be anywhere");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Awaited {
    /// The name of the teammate that it waits for; `None` when it waits for none of them.
    pub robot: Option<String>,
    /// The reason in a few words.
    pub reason: String,
}

impl Awaited {
    /// Returns what a robot of a scenario waits for.
    pub(crate) fn of(waiting: Waiting, scenario: &Scenario) -> Self {
        Self::named(waiting, |robot| Some(scenario.robots.get(robot.index())?.name.clone()))
    }

    /// Returns what a robot waits for whose teammates have these names.
    pub(crate) fn named(waiting: Waiting, name: impl FnOnce(RobotId) -> Option<String>) -> Self {
        let text = waiting.to_string();
        let Some(robot) = waiting.robot() else { return Self { robot: None, reason: text } };
        let reason = text.split_once(": ").map_or(text.as_str(), |(_, reason)| reason);
        Self { robot: name(robot), reason: reason.to_owned() }
    }
}

impl fmt::Display for Awaited {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(name) = &self.robot {
            write!(f, "waiting for {name}: ")?;
        }
        f.write_str(&self.reason)
    }
}

/// The ticks of waiting for the same after which it is an event.
const TOLD_AFTER: u32 = 20;

/// Since when each robot waits for the same.
#[derive(Clone, Debug)]
pub(crate) struct Waits(Vec<(Option<Waiting>, u32)>);

impl Waits {
    /// Creates the waits of a team of `size` robots that wait for nothing.
    pub(crate) fn new(size: usize) -> Self {
        Self(vec![(None, 0); size])
    }

    /// Notes what a robot waits for in a tick; returns it in the tick in which it is to be told.
    pub(crate) fn note(&mut self, robot: usize, now: Option<Waiting>) -> Option<Waiting> {
        let (waiting, ticks) = &mut self.0[robot];
        *ticks = if *waiting == now { *ticks + 1 } else { 1 };
        *waiting = now;
        now.filter(|_| *ticks == TOLD_AFTER)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::built_in;

    #[test]
    fn robots_have_the_names_of_the_scenario() {
        let scenario = built_in("mixed");
        let text = |waiting| Awaited::of(waiting, &scenario).to_string();
        assert_eq!(
            text(Waiting::Quorum(RobotId(1))),
            "waiting for Bo: it is lost, and the others are no quorum"
        );
        assert_eq!(text(Waiting::List), "working on the list of policies");
    }

    #[test]
    fn a_wait_is_told_once_and_after_a_while() {
        let mut waits = Waits::new(2);
        let told: Vec<u32> = (1..100).filter(|_| waits.note(1, Some(Waiting::Members)).is_some()).collect();
        assert_eq!(told, [TOLD_AFTER]);
        assert_eq!(waits.note(1, None), None);
        assert!((1..100).all(|tick| waits.note(0, (tick % 10 > 0).then_some(Waiting::Policy)).is_none()));
    }
}
