//! JSON as notebooks write it: with the tokens NaN, Infinity and -Infinity, which Python adds.
//!
//! It is read as JSON5, which has these tokens, and comments and commas at the end of a list as
//! well.

use super::fault::NotebookFault;
use serde::de::{Deserialize, DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// A value of a JSON text.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum JsonValue {
    Null,
    Bool(bool),
    /// A number; not finite for Python's tokens and for numbers that no `f64` holds.
    Number(f64),
    Text(String),
    List(Vec<JsonValue>),
    /// Keys in the order of the text, each once.
    Object(Vec<(String, JsonValue)>),
}

impl JsonValue {
    /// The kind of value, in words.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "a truth value",
            Self::Number(_) => "a number",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Object(_) => "an object",
        }
    }

    /// The number as a count, if it is a whole one from zero.
    pub(super) fn as_count(&self) -> Option<usize> {
        match self {
            Self::Number(number) if *number >= 0.0 && number.fract() == 0.0 && *number < 1e9 => {
                Some(*number as usize)
            }
            _ => None,
        }
    }

    /// The value as a message shows it: a number itself, else its kind.
    pub(super) fn shown(&self) -> String {
        match self {
            Self::Number(number) => format!("{number}"),
            other => other.kind().to_owned(),
        }
    }
}

/// No model is nested deeper.
const MAX_DEPTH: usize = 64;

/// Reads one JSON value and nothing after it.
///
/// # Errors
/// What is wrong, with its line and column.
pub(super) fn read(text: &[u8]) -> Result<JsonValue, NotebookFault> {
    let utf8 = str::from_utf8(text)
        .map_err(|error| NotebookFault::of_syntax(text, error.valid_up_to(), "this is not UTF-8"))?;
    json5::from_str(utf8).map_err(|error| fault(utf8, &error))
}

/// The fault that the reader found, with the character at that place.
fn fault(text: &str, error: &json5::Error) -> NotebookFault {
    let Some(place) = error.position().filter(|_| !is_at_end(error)) else {
        let reason = error.code().map_or_else(|| error.to_string(), |code| code.to_string());
        return NotebookFault::of_syntax(text.as_bytes(), text.len(), reason);
    };
    let (line, column) = (place.line + 1, place.column + 1);
    let reason = match error.code() {
        Some(code) => {
            let found = text.lines().nth(place.line).and_then(|line| line.chars().nth(place.column));
            found.map_or_else(|| code.to_string(), |sign| format!("{code}, found '{}'", sign.escape_debug()))
        }
        None => error.to_string().trim_end_matches(&format!(" at {place}")).to_owned(),
    };
    NotebookFault::at_place((line, column), reason)
}

/// Whether the text ends too early; the reader then names where its last list or object begins, if
/// anything.
fn is_at_end(error: &json5::Error) -> bool {
    error.code().is_some_and(|code| code.to_string().starts_with("EOF"))
}

impl<'de> Deserialize<'de> for JsonValue {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        NestingLevel(0).deserialize(from)
    }
}

/// A reader of values at a depth of nesting, which is limited so that no file overflows the stack.
#[derive(Clone, Copy)]
struct NestingLevel(usize);

impl NestingLevel {
    fn deeper<E: Error>(self) -> Result<Self, E> {
        match self.0 {
            MAX_DEPTH => Err(E::custom(format!("nested deeper than {MAX_DEPTH} levels"))),
            level => Ok(Self(level + 1)),
        }
    }
}

impl<'de> DeserializeSeed<'de> for NestingLevel {
    type Value = JsonValue;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<JsonValue, D::Error> {
        from.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for NestingLevel {
    type Value = JsonValue;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_unit<E>(self) -> Result<JsonValue, E> {
        Ok(JsonValue::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<JsonValue, E> {
        Ok(JsonValue::Bool(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<JsonValue, E> {
        Ok(JsonValue::Number(value as f64))
    }

    fn visit_i64<E>(self, value: i64) -> Result<JsonValue, E> {
        Ok(JsonValue::Number(value as f64))
    }

    fn visit_f64<E>(self, value: f64) -> Result<JsonValue, E> {
        Ok(JsonValue::Number(value))
    }

    fn visit_str<E>(self, value: &str) -> Result<JsonValue, E> {
        Ok(JsonValue::Text(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<JsonValue, A::Error> {
        let level = self.deeper()?;
        let mut list = Vec::new();
        while let Some(item) = items.next_element_seed(level)? {
            list.push(item);
        }
        Ok(JsonValue::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<JsonValue, A::Error> {
        let level = self.deeper()?;
        let mut object = Vec::new();
        while let Some(key) = entries.next_key_seed(NewKey(&object))? {
            object.push((key, entries.next_value_seed(level)?));
        }
        Ok(JsonValue::Object(object))
    }
}

/// A reader of a key that an object does not have yet.
struct NewKey<'a>(&'a [(String, JsonValue)]);

impl<'de> DeserializeSeed<'de> for NewKey<'_> {
    type Value = String;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<String, D::Error> {
        from.deserialize_str(self)
    }
}

impl Visitor<'_> for NewKey<'_> {
    type Value = String;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E: Error>(self, key: &str) -> Result<String, E> {
        match self.0.iter().any(|(known, _)| known == key) {
            true => Err(E::custom(format!("the key \"{key}\" is there twice"))),
            false => Ok(key.to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        read(text.as_bytes()).expect_err(text).in_file("f").to_string()
    }

    #[test]
    fn values_are_read_as_json_has_them() {
        let text = " {\"a\": [1, -2.5e-1, null, true], \"b\\u00e9\\ud83d\\ude00\": {}} ";
        let list =
            vec![JsonValue::Number(1.0), JsonValue::Number(-0.25), JsonValue::Null, JsonValue::Bool(true)];
        let object = vec![
            ("a".to_owned(), JsonValue::List(list)),
            ("b\u{e9}\u{1f600}".to_owned(), JsonValue::Object(vec![])),
        ];
        assert_eq!(read(text.as_bytes()).ok(), Some(JsonValue::Object(object)));
    }

    #[test]
    fn what_python_writes_for_no_number_is_read() {
        let Ok(JsonValue::List(items)) = read(b"[NaN, Infinity, -Infinity, 1e999]") else {
            panic!("no list")
        };
        assert!(items.iter().all(|item| matches!(item, JsonValue::Number(number) if !number.is_finite())));
    }

    #[test]
    fn comments_and_a_last_comma_are_read() {
        let list = JsonValue::List(vec![JsonValue::Number(1.0), JsonValue::Number(2.0)]);
        assert_eq!(read(b"// states\n[1, /* and */ 2,]").ok(), Some(list));
    }

    #[test]
    fn syntax_errors_have_a_line_and_a_column() {
        assert_eq!(refusal("{\n  \"a\": [1,,2]}"), "f:2:11: expected value, found ','");
        assert_eq!(refusal("{\"a\": 1"), "f:1:8: EOF parsing object");
        assert_eq!(refusal("[1] x"), "f:1:5: trailing characters, found 'x'");
        assert_eq!(refusal("{\"a\": 1, \"a\": 2}"), "f:1:10: the key \"a\" is there twice");
        for text in [
            "",
            "[01]",
            "[1",
            "[1 2]",
            "{1: 1}",
            "[1e]",
            "{\"a\" 1}",
            "\"x",
            "[nul]",
            "\"\\u12\"",
            "\"\\ud800\"",
        ] {
            assert!(refusal(text).starts_with("f:1:"), "{text}");
        }
        assert!(refusal(&"[".repeat(100_000)).contains("nested deeper than 64"));
    }
}
