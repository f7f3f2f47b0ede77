//! Task files under the verbs that take scenarios and models.

use super::{Failure, MAX_BYTES, RunArgs, about, exit_status, print, read, report};
use bumpalo::Bump;
use host_sim::Pilot;
use host_sim::campaign::Disturbance;
use host_sim::task::{TableMission, Trouble, built_in, is_task, level_table, outcome_line};
use std::num::NonZeroUsize;
use std::path::Path;
use std::process::ExitCode;

/// The text of a task, built in or in a file; `None` where the name is of something else.
pub(super) fn text_of(name: &str) -> Result<Option<String>, Failure> {
    if let Some(text) = built_in(name) {
        return Ok(Some(text.to_owned()));
    }
    let path = Path::new(name);
    if path.extension().is_none_or(|extension| extension != "toml") || !path.is_file() {
        return Ok(None);
    }
    Ok(String::from_utf8(read(name, MAX_BYTES)?).ok().filter(|text| is_task(text)))
}

pub(super) fn title(name: &str) -> Result<String, Failure> {
    let arena = Bump::new();
    Ok(TableMission::parse(&arena, name, built_in(name).unwrap_or_default())?.title)
}

pub(super) fn run(of: &RunArgs, text: &str) -> Result<ExitCode, Failure> {
    let name = &of.scenario;
    let is_flight = of.log.is_some() || of.frames.is_some() || of.disturbance != Disturbance::None;
    if of.tree != Pilot::default() || is_flight {
        return Err(
            format!("{name}: a task is flown without --tree, --disturbance, --log and --frames").into()
        );
    }
    let arena = Bump::new();
    let mission = TableMission::parse(&arena, name, text)?;
    let trouble = Trouble { loss: of.loss, ..Trouble::default() };
    let flown = mission.fly(of.seed, trouble).map_err(about(name))?;
    report(of.json, &flown, || match of.quiet {
        true => outcome_line(&flown) + "\n",
        false => mission.narrate(&flown),
    })?;
    Ok(exit_status(flown.success))
}

pub(super) fn campaign(
    name: &str,
    text: &str,
    seeds: u32,
    threads: Option<NonZeroUsize>,
    json: bool,
) -> Result<ExitCode, Failure> {
    let arena = Bump::new();
    let mission = TableMission::parse(&arena, name, text)?;
    let levels = mission.campaign(seeds, threads).map_err(about(name))?;
    report(json, &levels, || level_table(&levels))?;
    Ok(ExitCode::SUCCESS)
}

pub(super) fn export(name: &str, text: &str) -> Result<(), Failure> {
    let arena = Bump::new();
    print(&TableMission::parse(&arena, name, text)?.to_rust())?;
    Ok(())
}
