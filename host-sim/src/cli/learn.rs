//! `learn`: the ratios in an execution log.

use super::{Failure, print, read};
use clap::Args;
use host_sim::{ExecutionLog, Learned};
use std::path::PathBuf;
use std::process::ExitCode;

pub(super) const EXAMPLES: &str = "\
Examples:
  host-sim run worn --log flight.csv   fly, and keep a log
  host-sim learn flight.csv            how often each robot's moves succeeded
  host-sim learn flight.csv --json | jq '.B | length'
host-sim/scenarios/README.md describes the log.";

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
