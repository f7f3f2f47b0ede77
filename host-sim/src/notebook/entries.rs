//! The entries of a JSON object, by their keys.

use super::fault::{Fault, refuse};
use super::json::Value;

/// The keys of a model and their values.
pub(super) struct Entries<'a>(&'a [(String, Value)]);

impl<'a> Entries<'a> {
    pub(super) const fn new(entries: &'a [(String, Value)]) -> Self {
        Self(entries)
    }

    pub(super) fn get(&self, key: &str) -> Option<&'a Value> {
        self.0.iter().find(|(known, _)| known == key).map(|(_, value)| value)
    }

    pub(super) fn required(&self, key: &str, what: &str) -> Result<&'a [Value], Fault> {
        match self.get(key) {
            Some(value) => list(value, || key.to_owned()),
            None => refuse!("{key} is missing: {what}"),
        }
    }
}

/// The items of a list, or a refusal that names its place.
pub(super) fn list(value: &Value, place: impl Fn() -> String) -> Result<&[Value], Fault> {
    match value {
        Value::List(items) => Ok(items),
        other => refuse!("{} is {}, not a list", place(), other.shown()),
    }
}
