//! Faults in a model file, with their places.

use crate::input::{FileError, place};

/// A [`FileError`] before the file is known.
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
        Self::at_place(place(text, at), reason)
    }

    /// An error of syntax at a line and column, from one.
    pub(super) fn at_place(place: (usize, usize), reason: impl Into<String>) -> Self {
        Self { place: Some(place), reason: reason.into() }
    }

    pub(super) fn in_file(self, file: &str) -> FileError {
        let (line, column) = self.place.unzip();
        FileError { file: file.to_owned(), line, column, reason: self.reason }
    }
}

/// Refuses with a formatted reason.
macro_rules! refuse {
    ($($reason:tt)*) => { return Err($crate::notebook::fault::NotebookFault::new(format!($($reason)*))) };
}
pub(super) use refuse;
