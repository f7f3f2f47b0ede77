//! The comparison of an emulated robot with the same robot in process.

use firmware::adapters::base::{Decision, Operation};
use iibt_core::grid::{Cell, Move};
use serde::Serialize;
use std::fmt;

/// What a robot has done in a tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Done {
    /// The move that it begins.
    pub(super) step: Option<Move>,
    /// The operator of a table task that it begins.
    pub(super) operation: Option<Operation>,
    /// Its decision, in the tick in which it has made it.
    pub(super) decision: Option<Decision>,
    /// The bytes that it has sent to its teammates.
    pub(super) sent: Vec<u8>,
    /// The cells that it wants to be looked at.
    pub(super) watched: Vec<Cell>,
}

/// The first difference between an emulated robot and the same robot in process.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// The robot's name.
    pub robot: String,
    /// The tick, from zero.
    pub tick: u32,
    /// What differs, and how.
    pub what: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} in tick {}: {}", self.robot, self.tick, self.what)
    }
}

impl Done {
    /// What differs from the same tick in process, if anything does.
    pub(super) fn differs_from(&self, in_process: &Self) -> Option<String> {
        self.decisions_differ(in_process)
            .or_else(|| {
                (self.step != in_process.step).then(|| {
                    format!("the move is {}, in process {}", shown(self.step), shown(in_process.step))
                })
            })
            .or_else(|| {
                (self.operation != in_process.operation).then(|| {
                    format!("the operator is {:?}, in process {:?}", self.operation, in_process.operation)
                })
            })
            .or_else(|| frames_differ(&self.sent, &in_process.sent))
            .or_else(|| {
                let cells =
                    |cells: &[Cell]| format!("{:?}", cells.iter().map(|cell| cell.0).collect::<Vec<_>>());
                (self.watched != in_process.watched).then(|| {
                    format!(
                        "the cells to look at are {}, in process {}",
                        cells(&self.watched),
                        cells(&in_process.watched)
                    )
                })
            })
    }

    fn decisions_differ(&self, in_process: &Self) -> Option<String> {
        match (&self.decision, &in_process.decision) {
            (None, None) => None,
            (Some(decision), None) => {
                Some(format!("it decides in round {}, in process it does not", decision.round))
            }
            (None, Some(decision)) => {
                Some(format!("it does not decide, in process it does in round {}", decision.round))
            }
            (Some(one), Some(other)) => {
                let bits = |of: &Decision| of.posterior.iter().map(|p| p.to_bits()).collect::<Vec<_>>();
                let key = |of: &Decision| (of.round, of.policy, bits(of));
                (key(one) != key(other)).then(|| {
                    let text = |of: &Decision| {
                        format!("policy {} of round {}, posterior {:08x?}", of.policy, of.round, bits(of))
                    };
                    format!("the decision is {}, in process {}", text(one), text(other))
                })
            }
        }
    }
}

fn frames_differ(one: &[u8], other: &[u8]) -> Option<String> {
    let place = (0..one.len().max(other.len())).find(|&place| one.get(place) != other.get(place))?;
    let hex = |bytes: &[u8]| match bytes {
        [] => "none".to_owned(),
        _ => bytes.iter().map(|byte| format!("{byte:02x}")).collect(),
    };
    Some(format!("the frame is {}, in process {}: byte {place} differs", hex(one), hex(other)))
}

fn shown(step: Option<Move>) -> String {
    step.map_or("none".to_owned(), |step| format!("{step:?}").to_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn done() -> Done {
        Done {
            step: Some(Move::Up),
            operation: None,
            decision: Some(Decision::new(3, 1, &[0.25, 0.75])),
            sent: vec![0, 7, 8, 0],
            watched: vec![Cell(4)],
        }
    }

    #[test]
    fn every_part_is_compared_and_named() {
        assert_eq!(done().differs_from(&done()), None);
        let differing = |change: fn(&mut Done)| {
            let mut other = done();
            change(&mut other);
            done().differs_from(&other).unwrap_or_default()
        };
        assert_eq!(differing(|other| other.step = None), "the move is up, in process none");
        let operation = |other: &mut Done| other.operation = Some(Operation { operator: 1, target: None });
        assert!(differing(operation).starts_with("the operator is None, in process Some(Operation"));
        let decision =
            differing(|other| other.decision = Some(Decision::new(3, 1, &[0.25, 0.75_f32.next_down()])));
        assert!(
            decision.starts_with("the decision is policy 1 of round 3, posterior [3e800000, 3f400000]"),
            "{decision}"
        );
        assert!(differing(|other| other.decision = None).starts_with("it decides in round 3"));
        assert_eq!(
            differing(|other| other.sent[2] = 9),
            "the frame is 00070800, in process 00070900: byte 2 differs"
        );
        assert!(differing(|other| other.sent.clear()).ends_with("in process none: byte 0 differs"));
        assert!(differing(|other| other.watched.clear()).contains("to look at are [4], in process []"));
    }
}
