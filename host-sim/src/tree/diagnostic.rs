//! Remarks about a tree file, with their places.

use std::fmt;
use std::sync::Arc;
use thiserror::Error;

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Place {
    /// The file, as it was named.
    pub file: Arc<str>,
    /// The line, from one.
    pub line: usize,
    /// The column in characters, from one.
    pub column: usize,
}

impl Place {
    /// The first character of a file.
    #[must_use]
    pub fn start_of(file: &str) -> Self {
        Self { file: file.into(), line: 1, column: 1 }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// The severity of a remark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Severity {
    /// The tree cannot be used.
    Error,
    /// The tree can be used, but probably does not do what was meant.
    Warning,
}

/// One remark about a tree file. Its display is `FILE:LINE:COLUMN: error: message`.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{place}: {}: {message}", .severity.name())]
pub struct Diagnostic {
    /// The place in the file.
    pub place: Place,
    /// The severity.
    pub severity: Severity,
    /// The problem, and what would be right.
    pub message: String,
}

impl Severity {
    const fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

impl Diagnostic {
    pub(super) fn error(place: &Place, message: impl Into<String>) -> Self {
        Self { place: place.clone(), severity: Severity::Error, message: message.into() }
    }

    pub(super) fn warning(place: &Place, message: impl Into<String>) -> Self {
        Self { place: place.clone(), severity: Severity::Warning, message: message.into() }
    }
}

/// The remarks about a file, in the order they were found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Remarks(Vec<Diagnostic>);

impl Remarks {
    pub(super) fn error(&mut self, place: &Place, message: impl Into<String>) {
        self.0.push(Diagnostic::error(place, message));
    }

    pub(super) fn warning(&mut self, place: &Place, message: impl Into<String>) {
        self.0.push(Diagnostic::warning(place, message));
    }

    pub(super) fn extend(&mut self, others: impl IntoIterator<Item = Diagnostic>) {
        self.0.extend(others);
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.0.iter()
    }

    /// All remarks, in the order of the places they are about, each once.
    #[must_use]
    pub fn into_sorted(self) -> Vec<Diagnostic> {
        let mut remarks = self.0;
        remarks.sort_by(|a, b| (&a.place, a.severity).cmp(&(&b.place, b.severity)));
        remarks.dedup();
        remarks
    }

    /// Whether one of them is an error.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.first_error().is_some()
    }

    /// The error that was found first.
    #[must_use]
    pub fn first_error(&self) -> Option<&Diagnostic> {
        self.0.iter().find(|remark| remark.severity == Severity::Error)
    }
}

impl IntoIterator for Remarks {
    type Item = Diagnostic;
    type IntoIter = std::vec::IntoIter<Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}
