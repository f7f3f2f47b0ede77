//! The entries of a JSON object, by their keys.

use super::fault::{NotebookFault, refuse};
use super::json::JsonValue;

/// The keys of a model and their values.
pub(super) struct Entries<'a>(&'a [(String, JsonValue)]);

impl<'a> Entries<'a> {
    pub(super) const fn new(entries: &'a [(String, JsonValue)]) -> Self {
        Self(entries)
    }

    pub(super) fn get(&self, key: &str) -> Option<&'a JsonValue> {
        self.0.iter().find(|(known, _)| known == key).map(|(_, value)| value)
    }

    pub(super) fn required(&self, key: &str, what: &str) -> Result<&'a [JsonValue], NotebookFault> {
        match self.get(key) {
            Some(value) => list(value, || key.to_owned()),
            None => refuse!("{key} is missing: {what}"),
        }
    }
}

/// The items of a list, or a refusal that names its place.
pub(super) fn list(value: &JsonValue, place: impl Fn() -> String) -> Result<&[JsonValue], NotebookFault> {
    match value {
        JsonValue::List(items) => Ok(items),
        other => refuse!("{} is {}, not a list", place(), other.shown()),
    }
}
