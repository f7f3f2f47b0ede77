//! The cost of a robot's tick, in instructions on this machine's processor.
//!
//! Callgrind counts tick by tick, so a busy machine changes nothing. A tick is all that a robot
//! does in it: it receives frames, updates its belief, ticks its tree, and writes its frame.

use crate::team::Pilot;
use serde::Serialize;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use thiserror::Error;

/// The instructions of the ticks of one flight, of all robots together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// The ticks counted.
    pub ticks: usize,
    /// The mean of a tick.
    pub mean: f64,
    /// The median: an ordinary tick.
    pub median: u64,
    /// The most: the tick of the costliest decision.
    pub most: u64,
    /// All ticks of the flight together.
    pub flight: u64,
}

/// The reason why nothing was measured.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NotMeasured {
    /// There is no valgrind on this machine.
    #[error("not measured: valgrind is not installed")]
    NoValgrind,
    /// The program did not fly under valgrind; the last line of its output.
    #[error("not measured: under valgrind the flight failed: {0}")]
    Failed(String),
    /// The output of valgrind cannot be read.
    #[error("not measured: {0}")]
    Unreadable(String),
}

/// The functions that a tick begins and ends with: see `flight.rs`.
const TICK: [&str; 2] = ["host_sim::flight::act_in_turn", "host_sim::flight::has_acted"];

/// Flies a scenario once with `program`, which is the simulator itself, under valgrind.
///
/// `program` has to be built with symbols, as every profile of the workspace is. Takes some
/// seconds.
///
/// # Errors
/// [`NotMeasured`]; without valgrind that is what is to be shown instead of figures.
pub fn cost(program: &Path, scenario: &str, pilot: Pilot, seed: u64) -> Result<Cost, NotMeasured> {
    let folder = Folder::new().map_err(|error| NotMeasured::Unreadable(error.to_string()))?;
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--combine-dumps=yes"])
        .args(TICK.map(|function| format!("--dump-before={function}")))
        .arg(format!("--callgrind-out-file={}", folder.dumps().display()))
        .arg(program)
        .args(["run", scenario, "--quiet", "--tree", pilot.name(), "--seed", &seed.to_string()])
        .output()
        .map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => NotMeasured::NoValgrind,
            _ => NotMeasured::Failed(error.to_string()),
        })?;
    // One that does not accomplish the mission flies just as well: its exit status is 1.
    if !matches!(output.status.code(), Some(0 | 1)) {
        let last = String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or_default().to_owned();
        return Err(NotMeasured::Failed(last));
    }
    let dumps = fs::read(folder.dumps()).map_err(|error| NotMeasured::Unreadable(error.to_string()))?;
    Cost::read(&String::from_utf8_lossy(&dumps))
}

impl Cost {
    /// From callgrind's dumps: each holds the instructions since the one before, and names the
    /// function before which it was made.
    fn read(dumps: &str) -> Result<Self, NotMeasured> {
        let mut ends_a_tick = false;
        let mut ticks: Vec<u64> = Vec::new();
        for line in dumps.lines() {
            if let Some(trigger) = line.strip_prefix("desc: Trigger: ") {
                ends_a_tick = trigger.ends_with(TICK[1]);
            } else if let Some(count) = line.strip_prefix("totals: ").filter(|_| ends_a_tick) {
                ticks.extend(count.trim().parse::<u64>().ok());
            }
        }
        ticks.sort_unstable();
        let (Some(&most), flight) = (ticks.last(), ticks.iter().sum::<u64>()) else {
            return Err(NotMeasured::Unreadable(
                "valgrind saw no tick: is the program built with symbols?".to_owned(),
            ));
        };
        let mean = flight as f64 / ticks.len() as f64;
        Ok(Self { ticks: ticks.len(), mean, median: ticks[ticks.len() / 2], most, flight })
    }
}

/// A temporary folder for valgrind's files, removed when it is dropped.
struct Folder(PathBuf);

impl Folder {
    fn new() -> io::Result<Self> {
        use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let name = format!("host-sim-cost-{}-{}", std::process::id(), NUMBER.fetch_add(1, Relaxed));
        let folder = std::env::temp_dir().join(name);
        fs::create_dir(&folder)?;
        Ok(Self(folder))
    }

    fn dumps(&self) -> PathBuf {
        self.0.join("callgrind.out")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // What cannot be removed stays in the folder for temporary files.
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dumps_of_all_ticks_are_read() {
        let dump = |function: &str, count: u64| {
            format!(
                "part: 1\ndesc: Trigger: --dump-before={function}\nevents: Ir\nfn=(1) a\ntotals: {count}\n\n"
            )
        };
        let (begin, end) = ("host_sim::flight::act_in_turn", "host_sim::flight::has_acted");
        let dumps =
            [(begin, 999), (end, 10), (begin, 7), (end, 30), (begin, 7), (end, 40), (begin, 7), (end, 20)];
        let dumps: String = dumps.map(|(function, count)| dump(function, count)).concat();
        let cost = Cost::read(&dumps).unwrap();
        assert_eq!(cost, Cost { ticks: 4, mean: 25.0, median: 30, most: 40, flight: 100 });
        assert!(Cost::read("").unwrap_err().to_string().starts_with("not measured: valgrind saw no tick"));
    }
}
