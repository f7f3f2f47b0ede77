//! What a robot of a task waits for, in words, when a flight ends without success.

use super::{HostTask, HostWanted};
use crate::Awaited;
use iibt_core::iibt::table::{HiddenFactor, Holds, Role, Tables};
use iibt_core::iibt::{Condition, Literal, Logic};
use iibt_core::team::RobotId;

/// What a robot waits for; `None` where it does not wait. `raised` is what its node has raised.
pub(super) fn of_robot(
    tables: &Tables<'_>,
    task: &HostTask<'_>,
    raised: Option<&HostWanted>,
) -> Option<String> {
    let role = task.role();
    let name = |robot: RobotId| Some(tables.role(robot.index())?.name.to_owned());
    if let Some(waiting) = task.rounds().waiting()
        && let Awaited { robot: Some(robot), reason } = Awaited::named(waiting, name)
    {
        return Some(format!("waits for {robot}: {reason}"));
    }
    let mut factors = role.factors.iter().enumerate();
    if let Some((number, factor)) = factors.find(|&(number, _)| task.sure(number).is_none()) {
        return Some(unsure(factor, task.belief(number)));
    }
    let operator = task.part(task.decision()?.choice);
    let target = raised.and_then(|wanted| wanted.target);
    let logic = task.logic(target);
    if operator == role.idle {
        let lacks = |missing: &Literal| logic.is(missing.variable) != missing.value;
        let mut missing = role.remedies.iter().map(|remedy| remedy.missing).filter(lacks);
        let missing = missing.find(|&missing| target.is_some() || !is_about_target(role, missing));
        let until = missing.and_then(|missing| until(role, missing));
        return Some(format!("prefers to do nothing{}", until.unwrap_or_default()));
    }
    let operator = role.operators.get(usize::from(operator))?;
    let condition = Condition { all: Logic::of(operator.requires), none: Logic::of(operator.forbids) };
    let missing = condition.unmet(logic)?;
    let hint = if lacks_remedy(role, missing) { ": no remedy says what to do until then" } else { "" };
    Some(format!("does not begin \"{}\"{}{hint}", operator.name, until(role, missing)?))
}

fn until(role: &Role<'_>, missing: Literal) -> Option<String> {
    let fact = role.facts.get(usize::from(missing.variable))?;
    let verb = if missing.value { "holds" } else { "no longer holds" };
    Some(format!(" until \"{}\" {verb}", fact.name))
}

fn is_about_target(role: &Role<'_>, missing: Literal) -> bool {
    let fact = role.facts.get(usize::from(missing.variable));
    fact.is_some_and(|fact| matches!(fact.holds, Holds::AtTarget { .. }))
}

/// Whether a fact is about the robot itself, so that it may stay as it is while the robot waits.
fn lacks_remedy(role: &Role<'_>, missing: Literal) -> bool {
    let fact = role.facts.get(usize::from(missing.variable));
    let is_own = fact.is_some_and(|fact| matches!(fact.holds, Holds::Sure { .. } | Holds::AtTarget { .. }));
    is_own && role.remedies.iter().all(|remedy| remedy.missing != missing)
}

fn unsure(factor: &HiddenFactor<'_>, belief: &[f32]) -> String {
    let states = factor.states.iter().zip(belief).map(|(state, p)| format!("\"{state}\" {p:.3}"));
    format!("is not sure of \"{}\": {}", factor.name, states.collect::<Vec<_>>().join(", "))
}
