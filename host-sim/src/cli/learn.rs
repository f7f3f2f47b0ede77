//! `learn`: the ratios in an execution log.

use super::{Failure, read, report};
use clap::Args;
use host_sim::{ExecutionLog, Learned};

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
    log: String,
    /// Print one JSON object with the ratios and B[f][s'][s][u], and nothing else
    #[arg(long)]
    json: bool,
}

impl Learn {
    pub(super) fn run(&self) -> Result<ExitCode, Failure> {
        let learned = Learned::from(&ExecutionLog::read(&self.log, &read(&self.log, MAX_BYTES)?)?);
        report(self.json, &learned, || learned.table())?;
        Ok(ExitCode::SUCCESS)
    }
}
