//! `frames`: what recorded frames say of a team's plans, or of its work on a task.

use super::{Failure, about, print, read_up_to, scenario, task};
use bumpalo::Bump;
use clap::Args;
use host_sim::task::TableMission;
use host_sim::{KEY, TaskFrames, TeamFrames};
use iibt_core::team::Key;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

pub(super) const EXAMPLES: &str = "\
Examples:
  host-sim run factory --frames flight.bin             fly, and keep all frames
  host-sim frames flight.bin --mission factory         who goes where, when and how surely
  host-sim frames radio.bin --mission my-warehouse.toml --key 000102030405060708090a0b0c0d0e0f
  host-sim run valves --frames valves.bin              the same for a task written as tables:
  host-sim frames valves.bin --task valves             who does what, and how surely

The file has frames as robots send them, delimiters included: what a serial line or a radio has carried. Robots
of another mission, another key, or built for other sizes of plans send frames that are refused. Two robots that
send under one number are named: one of the two needs another page. Two recordings in one file look the same.

Exit status:
  0  at least one frame is of this mission
  2  none is, or wrong usage or input";

/// No recording is larger than this.
const MAX_BYTES: u64 = 1 << 26;

#[derive(Args, Debug)]
pub(super) struct Frames {
    /// A file of frames
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The mission of the team: a built-in scenario or task, or a file with one
    #[arg(long, visible_alias = "task", value_name = "NAME|FILE.toml")]
    mission: String,
    /// The team's key, 32 hexadecimal digits, in place of the simulator's
    #[arg(long, value_name = "HEX", value_parser = key)]
    key: Option<[u8; 16]>,
}

impl Frames {
    pub(super) fn run(&self) -> Result<ExitCode, Failure> {
        let name = self.file.display();
        let bytes = read_up_to(&self.file, MAX_BYTES).map_err(about(&name))?;
        let key = self.key.map_or(KEY, Key::new);
        let (told, accepted, refused) = if let Some(text) = task::text_of(&self.mission)? {
            let arena = Bump::new();
            let mission = TableMission::parse(&arena, &self.mission, &text)?;
            let frames = TaskFrames::read(&mission, &key, &bytes).map_err(about(&self.mission))?;
            (frames.to_string(), frames.accepted, frames.refused)
        } else {
            let scenario = scenario(&self.mission)?;
            let frames = TeamFrames::read(&scenario, &key, &bytes).map_err(about(&scenario.name))?;
            (frames.to_string(), frames.accepted, frames.refused)
        };
        if accepted == 0 {
            return Err(
                format!("{name}: no frame of the mission {}: {}", self.mission, reasons(&refused)).into()
            );
        }
        print(&told)?;
        Ok(ExitCode::SUCCESS)
    }
}

fn reasons(refused: &BTreeMap<String, u32>) -> String {
    let reasons: Vec<_> =
        refused.iter().map(|(reason, times)| format!("{times} refused: {reason}")).collect();
    if reasons.is_empty() { "it is empty".to_owned() } else { reasons.join(", ") }
}

pub(super) fn key(text: &str) -> Result<[u8; 16], String> {
    let digits: Option<Vec<u8>> =
        text.chars().map(|digit| digit.to_digit(16).map(|digit| digit as u8)).collect();
    let bytes: Option<Vec<u8>> = digits
        .filter(|digits| digits.len() == 32)
        .map(|digits| digits.chunks(2).map(|pair| 16 * pair[0] + pair[1]).collect());
    let key = bytes.and_then(|bytes| bytes.try_into().ok());
    key.ok_or_else(|| "a key is 32 hexadecimal digits, two for each byte".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_has_two_digits_for_each_byte() {
        let digits = "000102030405060708090a0b0c0d0e0F";
        assert_eq!(key(digits), Ok(core::array::from_fn(|byte| byte as u8)));
        for wrong in ["", "00", &digits[1..], "000102030405060708090a0b0c0d0e0g", &digits.repeat(2)] {
            assert!(key(wrong).is_err(), "{wrong}");
        }
    }
}
