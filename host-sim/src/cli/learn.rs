//! `learn`: the ratios in an execution log.

use super::{Failure, print};
use clap::Args;
use host_sim::{ExecutionLog, Learned};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

pub(super) const EXAMPLES: &str = "\
Examples:
  host-sim run worn --log flight.csv   fly, and keep a log
  host-sim learn flight.csv            how often each robot's moves succeeded
  host-sim learn flight.csv --json | jq '.B | length'
host-sim/scenarios/README.md describes the log.";

/// No log is larger than this.
const MAX_BYTES: u64 = 1 << 26;

#[derive(Args, Debug)]
pub(super) struct Learn {
    /// An execution log
    #[arg(value_name = "LOG.csv")]
    log: PathBuf,
    /// Print one JSON object with the ratios and B[f][s'][s][u], and nothing else
    #[arg(long)]
    json: bool,
}

impl Learn {
    pub(super) fn run(&self) -> Result<ExitCode, Failure> {
        let name = self.log.display().to_string();
        let bytes = read(&self.log).map_err(|error| format!("{name}: {error}"))?;
        let learned = Learned::from(&ExecutionLog::read(&name, &bytes)?);
        print(&if self.json { learned.to_json()? + "\n" } else { learned.table() })?;
        Ok(ExitCode::SUCCESS)
    }
}

fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(io::Error::other("larger than 64 MiB"));
    }
    Ok(bytes)
}
