//! What is wrong with a model file, and where.

use std::fmt;

/// Why a model was refused. Its display is `FILE: reason`, or `FILE:LINE:COLUMN: reason` where the
/// text itself is no JSON.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotebookError {
    /// The file, as it was named.
    pub file: String,
    /// The line and column, from one, of an error of syntax; other reasons name their place in the
    /// model.
    pub place: Option<(usize, usize)>,
    /// What is wrong and what would be right.
    pub reason: String,
}

impl fmt::Display for NotebookError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            Some((line, column)) => write!(f, "{}:{line}:{column}: {}", self.file, self.reason),
            None => write!(f, "{}: {}", self.file, self.reason),
        }
    }
}

impl std::error::Error for NotebookError {}

/// A [`NotebookError`] before the file is known.
#[derive(Debug)]
pub(super) struct NotebookFault {
    place: Option<(usize, usize)>,
    reason: String,
}

impl NotebookFault {
    pub(super) fn new(reason: impl Into<String>) -> Self {
        Self { place: None, reason: reason.into() }
    }

    /// An error of syntax at byte `at` of `text`.
    pub(super) fn of_syntax(text: &[u8], at: usize, reason: impl Into<String>) -> Self {
        let before = &text[..at.min(text.len())];
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
        let begin = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
        let column = 1 + String::from_utf8_lossy(&before[begin..]).chars().count();
        Self::at_place((line, column), reason)
    }

    /// An error of syntax at a line and column, from one.
    pub(super) fn at_place(place: (usize, usize), reason: impl Into<String>) -> Self {
        Self { place: Some(place), reason: reason.into() }
    }

    pub(super) fn in_file(self, file: &str) -> NotebookError {
        NotebookError { file: file.to_owned(), place: self.place, reason: self.reason }
    }
}

/// Refuses with a formatted reason.
macro_rules! refuse {
    ($($reason:tt)*) => { return Err($crate::notebook::fault::NotebookFault::new(format!($($reason)*))) };
}
pub(super) use refuse;
