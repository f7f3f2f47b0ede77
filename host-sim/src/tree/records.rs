//! The transitions that a robot has recorded, nine bytes each.

use super::instance::Instance;
use iibt_core::time::Instant;
use iibt_core::tree::{Status, StatusChange};
use std::collections::BTreeSet;

/// The bytes of a record.
const SIZE: usize = 9;

impl Instance {
    /// The transitions in what a robot that ticks the table of [`codegen`](Self::codegen) wrote
    /// with [`StatusChange::btlog`], one record after the other.
    ///
    /// # Errors
    /// What is wrong, and with which record, counted from 1.
    pub fn records(&self, bytes: &[u8]) -> Result<Vec<StatusChange>, String> {
        records(bytes, self.nodes.len())
    }
}

/// The transitions of a tree with so many nodes.
pub(super) fn records(bytes: &[u8], nodes: usize) -> Result<Vec<StatusChange>, String> {
    if !bytes.len().is_multiple_of(SIZE) {
        return Err(format!("{} bytes are not whole records of {SIZE} bytes", bytes.len()));
    }
    let mut running = BTreeSet::new();
    let mut transitions = Vec::new();
    for (index, record) in bytes.chunks(SIZE).enumerate() {
        let number = index + 1;
        let field = |from: usize, to: usize| {
            let bytes = record.get(from..to).unwrap_or_default();
            bytes.iter().rev().fold(0_u64, |sum, &byte| sum << 8 | u64::from(byte))
        };
        let time =
            u32::try_from(field(0, 6) / 1000).map_err(|_| format!("record {number}: later than 49 days"))?;
        let uid = field(6, 8);
        let Some(node) = (1..=nodes as u64).contains(&uid).then(|| (uid - 1) as u16) else {
            return Err(format!("record {number}: there is no node {uid}"));
        };
        let to = match field(8, 9) {
            0 => None,
            1 => Some(Status::Running),
            2 => Some(Status::Success),
            3 => Some(Status::Failure),
            4 => Some(Status::Skipped),
            code => return Err(format!("record {number}: there is no status {code}")),
        };
        let from = running.remove(&node).then_some(Status::Running);
        if to == Some(Status::Running) {
            running.insert(node);
        }
        transitions.push(StatusChange { time: Instant(time), node, from, to });
    }
    Ok(transitions)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_robot_records_is_read_as_it_was() {
        let at = |time, node, from, to| StatusChange { time: Instant(time), node, from, to };
        let (running, success) = (Some(Status::Running), Some(Status::Success));
        let told = [at(0, 2, None, running), at(7, 2, running, None), at(90_000, 0, None, success)];
        let bytes: Vec<u8> = told.iter().flat_map(|it| it.btlog(Instant(0))).collect();
        assert_eq!(records(&bytes, 3), Ok(told.to_vec()));
    }

    #[test]
    fn a_record_that_cannot_be_is_named() {
        let refused = |bytes: &[u8]| records(bytes, 3).unwrap_err();
        assert_eq!(refused(&[0; 10]), "10 bytes are not whole records of 9 bytes");
        assert_eq!(refused(&[0, 0, 0, 0, 0, 0, 4, 0, 1]), "record 1: there is no node 4");
        assert_eq!(refused(&[0; 9]), "record 1: there is no node 0");
        assert_eq!(refused(&[0, 0, 0, 0, 0, 0, 1, 0, 5]), "record 1: there is no status 5");
        assert_eq!(refused(&[255; 9]), "record 1: later than 49 days");
    }
}
