//! The content of the report: sections with judged items, and figures.

use super::figure::Figure;
use serde::Serialize;

/// A section of the report, on a part of the paper.
#[derive(Clone, Debug, Serialize)]
pub struct Section {
    /// Its name for `--only`.
    pub id: &'static str,
    /// Its title.
    pub title: &'static str,
    /// The introduction, a paragraph each.
    pub text: Vec<String>,
    /// The comparison.
    pub items: Vec<Item>,
    /// The figures.
    pub figures: Vec<Figure>,
}

/// One line of the comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Item {
    /// The comparison.
    pub what: String,
    /// The paper's value, or the claim where it has none.
    pub paper: Option<String>,
    /// Our value.
    pub ours: Option<String>,
    /// The tolerance.
    pub tolerance: Option<String>,
    /// The verdict.
    pub verdict: Verdict,
    /// A reason, where the verdict needs one.
    pub note: Option<String>,
}

/// The verdict on an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// As in the paper, within the tolerance.
    Agrees,
    /// As claimed, where the paper has no such number.
    Holds,
    /// Short of the paper or of what is claimed.
    Misses,
    /// Different from the paper, for the reason given.
    Differs,
    /// The paper does not say enough to compare.
    Unknown,
    /// A measurement that is compared with nothing.
    Measured,
}

/// The tolerance of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// In parts of the paper's number.
    Relative(f64),
    /// In the number's own unit.
    Absolute(f64),
}

impl Section {
    /// An empty section.
    #[must_use]
    pub const fn new(id: &'static str, title: &'static str) -> Self {
        Self { id, title, text: Vec::new(), items: Vec::new(), figures: Vec::new() }
    }

    /// Adds a paragraph.
    pub fn say(&mut self, text: impl Into<String>) {
        self.text.push(text.into());
    }
}

impl Item {
    fn new(what: impl Into<String>, verdict: Verdict) -> Self {
        Self { what: what.into(), paper: None, ours: None, tolerance: None, verdict, note: None }
    }

    /// Compares a number with the one that the paper prints, to all its digits.
    #[must_use]
    pub fn published(
        what: impl Into<String>,
        printed: &str,
        exact: f64,
        ours: f64,
        tolerance: Tolerance,
    ) -> Self {
        let verdict = if tolerance.admits(exact, ours) { Verdict::Agrees } else { Verdict::Misses };
        Self {
            paper: Some(printed.to_owned()),
            ours: Some(number(ours)),
            tolerance: Some(tolerance.to_string()),
            ..Self::new(what, verdict)
        }
    }

    /// Compares a number with the paper's, within a tolerance.
    #[must_use]
    pub fn close(what: impl Into<String>, paper: f64, ours: f64, tolerance: Tolerance) -> Self {
        Self::published(what, &number(paper), paper, ours, tolerance)
    }

    /// Adds an item that must equal the paper's.
    #[must_use]
    pub fn same(what: impl Into<String>, paper: impl ToString, ours: impl ToString) -> Self {
        let (paper, ours) = (paper.to_string(), ours.to_string());
        let verdict = if paper == ours { Verdict::Agrees } else { Verdict::Misses };
        Self { paper: Some(paper), ours: Some(ours), ..Self::new(what, verdict) }
    }

    /// Adds a claim where the paper has nothing to compare with.
    #[must_use]
    pub fn claim(what: impl Into<String>, claimed: &str, ours: impl Into<String>, holds: bool) -> Self {
        let verdict = if holds { Verdict::Holds } else { Verdict::Misses };
        Self { tolerance: Some(claimed.to_owned()), ours: Some(ours.into()), ..Self::new(what, verdict) }
    }

    /// Adds a measurement.
    #[must_use]
    pub fn measured(what: impl Into<String>, ours: impl Into<String>) -> Self {
        Self { ours: Some(ours.into()), ..Self::new(what, Verdict::Measured) }
    }

    /// Adds an item that differs from the paper for a reason.
    #[must_use]
    pub fn differs(
        what: impl Into<String>,
        paper: impl ToString,
        ours: impl ToString,
        reason: impl Into<String>,
    ) -> Self {
        Self {
            paper: Some(paper.to_string()),
            ours: Some(ours.to_string()),
            note: Some(reason.into()),
            ..Self::new(what, Verdict::Differs)
        }
    }

    /// Adds an item for which the paper gives too little.
    #[must_use]
    pub fn unknown(what: impl Into<String>, paper: impl ToString, reason: impl Into<String>) -> Self {
        Self {
            paper: Some(paper.to_string()),
            note: Some(reason.into()),
            ..Self::new(what, Verdict::Unknown)
        }
    }

    /// Adds a remark to the last item.
    #[must_use]
    pub fn because(self, note: impl Into<String>) -> Self {
        Self { note: Some(note.into()), ..self }
    }
}

impl Verdict {
    /// The verdict in a word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::Holds => "holds",
            Self::Misses => "MISSES",
            Self::Differs => "differs",
            Self::Unknown => "unknown",
            Self::Measured => "measured",
        }
    }
}

impl Tolerance {
    fn admits(self, paper: f64, ours: f64) -> bool {
        let apart = (ours - paper).abs();
        match self {
            Self::Relative(part) => apart <= part * paper.abs(),
            Self::Absolute(most) => apart <= most,
        }
    }
}

impl std::fmt::Display for Tolerance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Relative(part) => write!(f, "{} %", number(100.0 * part)),
            Self::Absolute(most) => write!(f, "± {}", number(*most)),
        }
    }
}

/// A number and its interval.
pub(super) fn with_interval(value: f64, [low, high]: [f64; 2]) -> String {
    format!("{} ({} to {})", number(value), number(low), number(high))
}

/// Formats a number with four significant digits, small ones with an exponent.
#[must_use]
pub fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    if size < 1e-3 {
        return format!("{value:.3e}");
    }
    let before = size.log10().floor() as i32;
    let places = usize::try_from(3 - before).unwrap_or(0);
    let text = format!("{value:.places$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits_that_count() {
        let cases = [
            (0.0, "0"),
            (0.847_142_3, "0.8471"),
            (0.081_27, "0.08127"),
            (1.511_6e-8, "1.512e-8"),
            (0.5, "0.5"),
            (26_202.0, "26202"),
            (17.25, "17.25"),
            (-3.0, "-3"),
            (99.96, "99.96"),
            (120.0, "120"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn a_number_outside_its_tolerance_misses() {
        let verdict = |ours, tolerance| Item::close("x", 0.2, ours, tolerance).verdict;
        assert_eq!(verdict(0.2009, Tolerance::Relative(0.005)), Verdict::Agrees);
        assert_eq!(verdict(0.2011, Tolerance::Relative(0.005)), Verdict::Misses);
        assert_eq!(verdict(0.196, Tolerance::Absolute(0.005)), Verdict::Agrees);
        assert_eq!(verdict(0.194, Tolerance::Absolute(0.005)), Verdict::Misses);
        assert_eq!(verdict(f64::NAN, Tolerance::Absolute(0.005)), Verdict::Misses);
        assert_eq!(Item::same("x", 5, 6).verdict, Verdict::Misses);
        assert_eq!(Item::claim("x", "none", "1", false).verdict, Verdict::Misses);
    }
}
