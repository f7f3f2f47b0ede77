//! Task files under the verbs that take scenarios and models.

use super::{Failure, MAX_BYTES, RunArgs, about, created, exit_status, print, read, report, tree};
use bumpalo::Bump;
use host_sim::Pilot;
use host_sim::campaign::Disturbance;
use host_sim::task::{TableMission, Trouble, built_in, is_task, level_table, outcome_line};
use std::io::Write;
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

/// A task, with the trees of a file if one is named.
pub(super) fn mission<'a>(
    arena: &'a Bump,
    name: &str,
    text: &str,
    trees: Option<&str>,
) -> Result<TableMission<'a>, Failure> {
    let mission = TableMission::parse(arena, name, text)?;
    let Some(trees) = trees else { return Ok(mission) };
    mission.with_trees(&tree::load(trees, &[])?).map_err(|remarks| {
        let lines: Vec<_> = remarks.iter().map(ToString::to_string).collect();
        lines.join("\n").into()
    })
}

pub(super) fn run(of: &RunArgs, text: &str) -> Result<ExitCode, Failure> {
    let name = &of.scenario;
    if of.is_more_than_a_task() {
        return Err(format!(
            "{name}: a task is flown without --tree, --decider, --disturbance, --log and --tree-log"
        )
        .into());
    }
    let arena = Bump::new();
    let mission = mission(&arena, name, text, of.task_tree.as_deref())?;
    let trouble = Trouble { loss: of.loss, ..Trouble::default() };
    let mut recording = of.frames.as_deref().map(created).transpose()?;
    let mut written = Ok(());
    let mut record = |frames: &[u8]| {
        if let (Some(file), Ok(())) = (&mut recording, &written) {
            written = file.write_all(frames);
        }
    };
    let flown = mission.fly_recorded(of.seed, trouble, &mut record).map_err(about(name))?;
    written.and_then(|()| recording.map_or(Ok(()), |mut file| file.flush()))?;
    report(of.json, &flown, || match of.quiet {
        true => outcome_line(&flown) + "\n",
        false => mission.narrate(&flown),
    })?;
    Ok(exit_status(flown.success))
}

impl RunArgs {
    /// Whether there are arguments that are for scenarios only.
    pub(super) fn is_more_than_a_task(&self) -> bool {
        let keeps_a_log = self.log.is_some() || self.tree_log.is_some();
        let has_pilot = self.tree != Pilot::default() || self.decider.is_some();
        has_pilot || keeps_a_log || self.disturbance != Disturbance::None
    }
}

pub(super) fn campaign(
    name: &str,
    text: &str,
    seeds: u32,
    threads: Option<NonZeroUsize>,
    budget: Option<u32>,
    json: bool,
) -> Result<ExitCode, Failure> {
    let arena = Bump::new();
    let mut mission = TableMission::parse(&arena, name, text)?;
    mission.budget = budget.or(mission.budget);
    let levels = mission.campaign(seeds, threads).map_err(about(name))?;
    report(json, &levels, || level_table(&levels))?;
    Ok(ExitCode::SUCCESS)
}

pub(super) fn export(name: &str, text: &str) -> Result<(), Failure> {
    let arena = Bump::new();
    print(&TableMission::parse(&arena, name, text)?.to_rust())?;
    Ok(())
}
