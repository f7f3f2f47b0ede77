//! What is wrong with a task file, and where.

use std::fmt;
use std::ops::Range;

/// Why a task file was refused. Its display is `FILE:LINE:COLUMN: reason`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskFileError {
    /// The file, as it was named.
    pub file: String,
    /// The line, from one.
    pub line: usize,
    /// The column in characters, from one.
    pub column: usize,
    /// What is wrong and what would be right.
    pub reason: String,
}

impl fmt::Display for TaskFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}: {}", self.file, self.line, self.column, self.reason)
    }
}

impl std::error::Error for TaskFileError {}

/// A [`TaskFileError`] before the file is known: the byte where it is, and the reason.
#[derive(Debug)]
pub(super) struct Fault {
    at: usize,
    reason: String,
}

/// What is read, or the first thing that is wrong with it.
pub(super) type Read<T> = Result<T, Fault>;

impl Fault {
    pub(super) fn new(span: Range<usize>, reason: impl Into<String>) -> Self {
        Self { at: span.start, reason: reason.into() }
    }

    pub(super) fn in_file(self, file: &str, text: &str) -> TaskFileError {
        let before = text.get(..self.at).unwrap_or(text);
        let begin = before.rfind('\n').map_or(0, |newline| newline + 1);
        TaskFileError {
            file: file.to_owned(),
            line: 1 + before.matches('\n').count(),
            column: 1 + before[begin..].chars().count(),
            reason: self.reason,
        }
    }
}

impl From<toml::de::Error> for Fault {
    fn from(error: toml::de::Error) -> Self {
        let message = error.message().trim().replace('\n', "; ");
        let message = message.replace("i64", "a whole number").replace("f64", "a number");
        Self::new(error.span().unwrap_or_default(), message)
    }
}
