//! The names of a task file.

use super::file;
use crate::input::{Fault, Read, Text, line_of_text, refuse};
use std::collections::BTreeSet;

/// No name is longer, in characters.
const LONGEST: usize = 60;

/// Checks that all things of a kind have a name each, so that a name means one thing.
pub(super) fn check_names(file: &file::File) -> Read<()> {
    distinct("robots", file.robots.iter().map(|robot| &robot.get_ref().name))?;
    for robot in file.robots.iter().map(toml::Spanned::get_ref) {
        distinct("factors", robot.factors.iter().map(|factor| &factor.get_ref().name))?;
        distinct("sensors", robot.sensors.iter().map(|sensor| &sensor.get_ref().name))?;
        distinct("actions", robot.actions.iter().map(|action| &action.get_ref().name))?;
        distinct("facts", robot.facts.iter().map(|fact| &fact.get_ref().name))?;
        distinct("aims", robot.aims.iter().map(|aim| &aim.get_ref().name))?;
        for factor in &robot.factors {
            distinct("states", &factor.get_ref().states)?;
        }
        let labels = robot.sensors.iter().filter_map(|sensor| sensor.get_ref().labels.as_ref());
        for labels in labels.chain(robot.state.iter().map(toml::Spanned::get_ref)) {
            distinct("states", &labels.names)?;
        }
        if let Some(outcome) = &robot.outcome {
            distinct("outcomes", &outcome.get_ref().names)?;
        }
    }
    Ok(())
}

fn distinct<'n>(things: &str, names: impl IntoIterator<Item = &'n Text>) -> Read<()> {
    let mut taken = BTreeSet::new();
    for name in names {
        let text = line_of_text("a name", name, LONGEST)?;
        if taken.contains(&text) {
            return refuse(name.span(), format!("two {things} are called \"{text}\""));
        }
        taken.insert(text);
    }
    Ok(())
}

pub(super) fn is_idle(action: &file::Action) -> bool {
    action.needs.is_empty() && action.forbids.is_empty() && action.effects.is_empty()
}

pub(super) fn texts(texts: &[Text]) -> Vec<&str> {
    texts.iter().map(|text| text.get_ref().as_str()).collect()
}

pub(super) fn factor_names(robot: &file::Robot) -> Vec<&str> {
    robot.factors.iter().map(|factor| factor.get_ref().name.get_ref().as_str()).collect()
}

pub(super) fn states_of(robot: &file::Robot, factor: u8) -> Vec<&str> {
    robot.factors.get(usize::from(factor)).map_or(Vec::new(), |factor| texts(&factor.get_ref().states))
}

/// The semantic states.
pub(super) fn state_names(robot: &file::Robot) -> Vec<&str> {
    match &robot.state {
        Some(labels) => texts(&labels.get_ref().names),
        None => states_of(robot, 0),
    }
}

pub(super) fn action_names(robot: &file::Robot) -> Vec<&str> {
    robot.actions.iter().map(|action| action.get_ref().name.get_ref().as_str()).collect()
}

pub(super) fn fact_names(robot: &file::Robot) -> Vec<&str> {
    robot.facts.iter().map(|fact| fact.get_ref().name.get_ref().as_str()).collect()
}

/// A target: a state of the factor that some action leads to the target.
pub(super) fn target(name: Option<&Text>, robot: &file::Robot) -> Read<Option<u8>> {
    let Some(name) = name else { return Ok(None) };
    let effects = robot.actions.iter().flat_map(|action| &action.get_ref().effects);
    let aimed = effects.filter(|effect| effect.to.get_ref() == "target").map(|effect| &effect.factor).next();
    let Some(factor) = aimed else {
        return refuse(name.span(), "no effect leads to \"target\", so there is none to name");
    };
    let factor = index("factor", factor, &factor_names(robot))?;
    index("state", name, &states_of(robot, factor)).map(Some)
}

pub(super) fn index(what: &str, name: &Text, names: &[&str]) -> Read<u8> {
    let place = names.iter().position(|known| known == name.get_ref());
    let place = place.and_then(|place| u8::try_from(place).ok());
    place.ok_or_else(|| Fault::new(name.span(), unknown(what, name.get_ref(), names)))
}

pub(super) fn unknown(what: &str, name: &str, names: &[&str]) -> String {
    if names.is_empty() {
        return format!("there is no {what} \"{name}\": there is none at all");
    }
    format!("there is no {what} \"{name}\": there are {}", names.join(", "))
}
