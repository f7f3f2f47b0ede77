//! The script of a leaf in a dry run: what it returns, tick by tick.

use iibt_core::tree::Status;
use std::str::FromStr;

/// Statuses, one for each tick of a leaf; the last repeats. Written in letters: S success, F
/// failure, R running, K skipped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Statuses(Vec<Status>);

impl Statuses {
    /// The status of the tick number `tick`, from zero.
    #[must_use]
    pub fn at(&self, tick: usize) -> Status {
        self.0.get(tick).or(self.0.last()).copied().unwrap_or(Status::Success)
    }
}

impl FromStr for Statuses {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text.is_empty() {
            return Err("a script of statuses has at least one letter: S, F, R or K".into());
        }
        let statuses = text.chars().map(|letter| match letter {
            'S' => Ok(Status::Success),
            'F' => Ok(Status::Failure),
            'R' => Ok(Status::Running),
            'K' => Ok(Status::Skipped),
            other => Err(format!("'{other}' is no status: S success, F failure, R running, K skipped")),
        });
        Ok(Self(statuses.collect::<Result<_, _>>()?))
    }
}

/// The letter of a status.
pub(super) fn letter(status: Status) -> char {
    match status {
        Status::Success => 'S',
        Status::Failure => 'F',
        Status::Running => 'R',
        Status::Skipped => 'K',
    }
}

/// The name of a status in BehaviorTree.CPP.
pub(super) fn name(status: Option<Status>) -> &'static str {
    match status {
        None => "IDLE",
        Some(Status::Running) => "RUNNING",
        Some(Status::Success) => "SUCCESS",
        Some(Status::Failure) => "FAILURE",
        Some(Status::Skipped) => "SKIPPED",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_status_repeats() {
        let statuses: Statuses = "RSK".parse().unwrap();
        let played: String = (0..5).map(|tick| letter(statuses.at(tick))).collect();
        assert_eq!(played, "RSKKK");
        assert!("RX".parse::<Statuses>().is_err() && "".parse::<Statuses>().is_err());
    }
}
