//! What is wrong with a scenario file, and where.

use std::ops::Range;

/// Why a scenario was refused. Its display is `FILE:LINE: reason`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScenarioError {
    /// The file, as it was named.
    pub file: String,
    /// The line, from one.
    pub line: usize,
    /// What is wrong and what would be right.
    pub reason: String,
}

impl std::fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}: {}", self.file, self.line, self.reason)
    }
}

impl std::error::Error for ScenarioError {}

/// A [`ScenarioError`] before the file is known: the byte where it is, and the reason.
#[derive(Debug)]
pub(super) struct ScenarioFault {
    at: Option<usize>,
    reason: String,
}

impl ScenarioFault {
    pub(super) fn new(span: Range<usize>, reason: impl Into<String>) -> Self {
        Self { at: Some(span.start), reason: reason.into() }
    }

    /// Something that is missing, and so stands nowhere; see [`ScenarioFault::or_at`].
    pub(super) fn anywhere(reason: impl Into<String>) -> Self {
        Self { at: None, reason: reason.into() }
    }

    /// This fault, at `span` if it has no place of its own.
    pub(super) fn or_at(self, span: &Range<usize>) -> Self {
        Self { at: self.at.or(Some(span.start)), ..self }
    }

    pub(super) fn in_file(self, file: &str, text: &str) -> ScenarioError {
        let before = text.bytes().take(self.at.unwrap_or(0));
        let line = 1 + before.filter(|&byte| byte == b'\n').count();
        ScenarioError { file: file.to_owned(), line, reason: self.reason }
    }
}

impl From<toml::de::Error> for ScenarioFault {
    fn from(error: toml::de::Error) -> Self {
        let message = error.message().trim().replace('\n', "; ");
        let message = message.replace("i64", "a whole number").replace("f64", "a number");
        Self::new(error.span().unwrap_or_default(), message)
    }
}
