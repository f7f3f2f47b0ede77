//! The built-in scenarios.

use crate::input::FileError;
use crate::scenario::Scenario;
use crate::text;

/// The default scenario.
pub const DEFAULT: &str = "factory";

macro_rules! scenarios {
    ($($name:literal)*) => {
        [$(($name, include_str!(concat!("../scenarios/", $name, ".toml")))),*]
    };
}

const TEXTS: [(&str, &str); 10] = scenarios!["factory" "shift" "two-goals" "detour" "obstacle" "warehouse" "courtyard" "worn" "mixed" "deliveries"];

/// Returns the names in the order in which they are listed.
pub fn names() -> impl Iterator<Item = &'static str> {
    TEXTS.iter().map(|&(name, _)| name)
}

/// Returns the scenario with a name, or `None`. A test checks that all of them parse.
#[must_use]
pub fn find(name: &str) -> Option<Result<Scenario, FileError>> {
    let (name, text) = TEXTS.iter().find(|(known, _)| *known == name)?;
    Some(Scenario::parse(name, text))
}

/// Returns a scenario that is known to be built in.
pub(crate) fn built_in(name: &str) -> Scenario {
    find(name).expect("it is built in").expect("it is sound")
}

/// Returns the built-in name that is closest to `name`, of a scenario or a task, for an error
/// message.
#[must_use]
pub fn nearest(name: &str) -> Option<&'static str> {
    text::nearest(names().chain(crate::task::NAMES), name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scenario_is_sound_and_named_after_itself() {
        for name in names() {
            let scenario = find(name).unwrap().unwrap();
            assert_eq!(scenario.name, name);
        }
        assert!(names().any(|name| name == DEFAULT));
    }

    #[test]
    fn a_mistyped_name_is_recognised() {
        for (typed, meant) in [("factry", "factory"), ("Two_goals", "two-goals"), ("warehose", "warehouse")] {
            assert_eq!(nearest(typed), Some(meant));
        }
        assert_eq!(nearest("xyzzy"), None);
    }
}
