//! Errors in files that users write, with their places.

mod values;

pub(crate) use values::{
    RadioEntry, RealNumber, Text, WholeNumber, line_of_text, optional, parameter, percent, real, share, whole,
};

use serde::de::DeserializeOwned;
use std::ops::Range;
use thiserror::Error;

/// The error of a file that was refused. Its display is `FILE:LINE:COLUMN: reason`, without the
/// column or the line where they are not known.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}: {reason}", self.place())]
pub struct FileError {
    /// The file, as it was named.
    pub file: String,
    /// The line, from one; `None` where the reason names the place.
    pub line: Option<usize>,
    /// The column in characters, from one.
    pub column: Option<usize>,
    /// The reason, with what would be right.
    pub reason: String,
}

impl FileError {
    fn place(&self) -> String {
        let numbers = [self.line, self.column].into_iter().flatten();
        numbers.fold(self.file.clone(), |place, number| format!("{place}:{number}"))
    }
}

/// A [`FileError`] before the file is known: the byte where it is, and the reason.
#[derive(Debug)]
pub(crate) struct Fault {
    at: Option<usize>,
    reason: String,
}

/// A value that was read, or its first fault.
pub(crate) type Read<T> = Result<T, Fault>;

/// Refuses what is written at `span`.
pub(crate) fn refuse<T>(span: Range<usize>, reason: impl Into<String>) -> Read<T> {
    Err(Fault::new(span, reason))
}

impl Fault {
    pub(crate) fn new(span: Range<usize>, reason: impl Into<String>) -> Self {
        Self { at: Some(span.start), reason: reason.into() }
    }

    /// A fault without a place of its own, because something is missing; see [`Fault::or_at`].
    pub(crate) fn anywhere(reason: impl Into<String>) -> Self {
        Self { at: None, reason: reason.into() }
    }

    /// This fault, at `span` if it has no place of its own.
    pub(crate) fn or_at(self, span: &Range<usize>) -> Self {
        Self { at: self.at.or(Some(span.start)), ..self }
    }

    /// This fault with its line in the file.
    pub(crate) fn on_line(self, file: &str, text: &str) -> FileError {
        FileError { column: None, ..self.in_file(file, text) }
    }

    /// This fault with its line and column in the file.
    pub(crate) fn in_file(self, file: &str, text: &str) -> FileError {
        let (line, column) = place(text.as_bytes(), self.at.unwrap_or(0));
        FileError { file: file.to_owned(), line: Some(line), column: Some(column), reason: self.reason }
    }
}

/// Reads TOML as it is written, before its values are checked.
pub(crate) fn toml<T: DeserializeOwned>(text: &str) -> Read<T> {
    toml::from_str(text).map_err(|error| {
        let span = error.span().unwrap_or_default();
        let message = error.message().trim().replace('\n', "; ");
        let message = message.replace("i64", "a whole number").replace("f64", "a number");
        let header = wrong_header(text, span.start).filter(|_| message.contains(NO_LIST));
        Fault::new(span, header.unwrap_or(message))
    })
}

/// What the message says of a table where a list of them is expected.
const NO_LIST: &str = "invalid type: map, expected a sequence";

/// What is wrong with the header around a byte, of a table that should be one of a list; `None` for
/// a table without a header.
fn wrong_header(text: &str, at: usize) -> Option<String> {
    let begin = text.get(..at)?.rfind('\n').map_or(0, |newline| newline + 1);
    let header = text.get(begin..)?.lines().next()?.trim_start();
    let (name, _) = header.trim_start_matches('[').split_once(']')?;
    match (header.strip_prefix("[["), name.rsplit_once('.')) {
        (Some(_), Some((list, _))) => {
            Some(format!("[[{name}]] belongs to an entry: put it after its [[{list}]]"))
        }
        (None, _) if header.starts_with('[') => Some(format!("[{name}] is one of a list: write [[{name}]]")),
        _ => None,
    }
}

/// Returns the line and the column in characters of a byte, both from one.
pub(crate) fn place(text: &[u8], at: usize) -> (usize, usize) {
    let before = &text[..at.min(text.len())];
    let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
    let begin = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
    (line, 1 + String::from_utf8_lossy(&before[begin..]).chars().count())
}

/// Returns the bytes of a file as text.
pub(crate) fn utf8<'t>(file: &str, bytes: &'t [u8]) -> Result<&'t str, FileError> {
    std::str::from_utf8(bytes).map_err(|error| FileError {
        file: file.to_owned(),
        line: Some(place(bytes, error.valid_up_to()).0),
        column: None,
        reason: "this is no UTF-8 text".to_owned(),
    })
}
