//! The values of ports: their types, and how text is read as one.

/// The type of a port's value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ValueType {
    /// A whole number of 32 bits with a sign.
    Int,
    /// A whole number of 32 bits from zero.
    Unsigned,
    /// A real number.
    Double,
    /// A truth value.
    Bool,
    /// The status of a node.
    Status,
    /// Text.
    Text,
    /// Anything: the type is not checked.
    Any,
    /// A type of the program's own, by its name: literals of it are not checked.
    Own(String),
}

/// The fit of a literal to the type of a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fit {
    Whole,
    /// The beginning is read and the rest is silently dropped.
    Beginning,
    None,
}

impl ValueType {
    /// The type with a name as models write it; a missing name stands for anything.
    #[must_use]
    pub fn named(name: &str) -> Self {
        match name.strip_prefix("std::").unwrap_or(name) {
            "int" | "int32_t" => Self::Int,
            "unsigned" | "unsigned int" | "uint32_t" => Self::Unsigned,
            "double" => Self::Double,
            "bool" => Self::Bool,
            "NodeStatus" | "BT::NodeStatus" => Self::Status,
            "string" => Self::Text,
            "" | "any" | "Any" | "BT::Any" | "AnyTypeAllowed" | "BT::AnyTypeAllowed" => Self::Any,
            _ => Self::Own(name.to_owned()),
        }
    }

    /// The name that models write; empty for anything.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Int => "int",
            Self::Unsigned => "unsigned int",
            Self::Double => "double",
            Self::Bool => "bool",
            Self::Status => "NodeStatus",
            Self::Text => "std::string",
            Self::Any => "",
            Self::Own(name) => name,
        }
    }

    pub(super) fn fit(&self, text: &str) -> Fit {
        match self {
            Self::Int => integer_fit(text, i64::from(i32::MIN)..=i64::from(i32::MAX)),
            Self::Unsigned => integer_fit(text, 0..=i64::from(u32::MAX)),
            Self::Double => match real(text) {
                Some((_, length)) => fit_of(length, text),
                None => Fit::None,
            },
            Self::Bool => fit_if(truth(text).is_some()),
            Self::Status => fit_if(matches!(text, "IDLE" | "RUNNING" | "SUCCESS" | "FAILURE" | "SKIPPED")),
            Self::Text | Self::Any | Self::Own(_) => Fit::Whole,
        }
    }
}

/// The whole number that a text begins with, and its length in bytes.
pub(super) fn integer(text: &str) -> Option<(i64, usize)> {
    let digits = text.strip_prefix('-').unwrap_or(text);
    let count = digits.bytes().take_while(u8::is_ascii_digit).count();
    let length = text.len() - digits.len() + count;
    Some((text.get(..length)?.parse().ok()?, length))
}

/// The real number that a text begins with, and its length in bytes.
pub(super) fn real(text: &str) -> Option<(f64, usize)> {
    if text.starts_with('+') {
        return None;
    }
    let is_part = |sign: char| sign.is_ascii_alphanumeric() || matches!(sign, '+' | '-' | '.');
    let longest = text.find(|sign| !is_part(sign)).unwrap_or(text.len()).min(64);
    (1..=longest).rev().find_map(|length| Some((text.get(..length)?.parse().ok()?, length)))
}

pub(super) fn truth(text: &str) -> Option<bool> {
    match text {
        "1" | "true" | "TRUE" | "True" => Some(true),
        "0" | "false" | "FALSE" | "False" => Some(false),
        _ => None,
    }
}

/// The key of `{key}`; spaces around the braces do not count.
pub(super) fn pointer(text: &str) -> Option<&str> {
    let key = text.trim_matches(' ').strip_prefix('{')?.strip_suffix('}')?;
    (!key.is_empty()).then_some(key)
}

fn integer_fit(text: &str, range: std::ops::RangeInclusive<i64>) -> Fit {
    match integer(text) {
        Some((value, length)) if range.contains(&value) => fit_of(length, text),
        _ => Fit::None,
    }
}

fn fit_of(length: usize, text: &str) -> Fit {
    if length == text.len() { Fit::Whole } else { Fit::Beginning }
}

fn fit_if(fits: bool) -> Fit {
    if fits { Fit::Whole } else { Fit::None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_are_read_as_behavior_tree_cpp_reads_them() {
        for (kind, text, fit) in [
            (ValueType::Int, "-12", Fit::Whole),
            (ValueType::Int, "3.5", Fit::Beginning),
            (ValueType::Int, "+3", Fit::None),
            (ValueType::Int, " 3", Fit::None),
            (ValueType::Int, "2147483648", Fit::None),
            (ValueType::Int, "", Fit::None),
            (ValueType::Unsigned, "-1", Fit::None),
            (ValueType::Unsigned, "4294967295", Fit::Whole),
            (ValueType::Double, "1e-3", Fit::Whole),
            (ValueType::Double, "0.5m", Fit::Beginning),
            (ValueType::Double, "x", Fit::None),
            (ValueType::Bool, "True", Fit::Whole),
            (ValueType::Bool, "yes", Fit::None),
            (ValueType::Status, "SKIPPED", Fit::Whole),
            (ValueType::Status, "skipped", Fit::None),
            (ValueType::Own("Pose".into()), "1;2", Fit::Whole),
        ] {
            assert_eq!(kind.fit(text), fit, "{kind:?} {text}");
        }
    }

    #[test]
    fn a_pointer_stands_in_braces() {
        assert_eq!(pointer("{goal}"), Some("goal"));
        assert_eq!(pointer(" {@goal} "), Some("@goal"));
        assert_eq!((pointer("{}"), pointer("goal"), pointer("{goal")), (None, None, None));
    }

    #[test]
    fn names_of_types_are_those_that_are_read() {
        for name in ["int", "unsigned int", "double", "bool", "NodeStatus", "std::string", "", "Pose2D"] {
            assert_eq!(ValueType::named(name).name(), name);
        }
    }
}
