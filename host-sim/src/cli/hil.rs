//! The verb `hil`: a team of emulated microcontrollers.

use super::{Failure, RunArgs, exit_status, print, read, report, scenario, task};
use bumpalo::Bump;
use clap::Args;
use host_sim::campaign::Ablation;
use host_sim::hil::{
    Bench, Compared, Difference, HilRecord, build_image, build_task_image, fly_emulated, fly_emulated_task,
};
use host_sim::show::{outcome_line, summary};
use host_sim::task::{Trouble, outcome_line as task_line};
use host_sim::{Conditions, Pilot, Scenario};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

pub(super) const EXAMPLES: &str = "\
Examples:
  host-sim hil two-goals            two emulated STM32F405s decide and drive
  host-sim hil factory --loss 0.2   with a radio that loses two frames in ten
  host-sim hil factory --restart R2@12   R2's machine is reset before tick 12
  host-sim hil factory --frames a.bin, then --replay a.bin --starts 1   a recording is played back
  host-sim hil bottle-and-plate     two robots with a table task, of which the image has the tables
  host-sim hil bottle-and-plate --task-tree my-trees.xml   with other trees in their pages
  host-sim hil factory --image robot.elf --logs logs   with an image that is built already
From a checkout, `host-sim hil ...` is `cargo run --release -- hil ...`.

The image is `based_member` of the package firmware, `based_table_robot` for the task, built as it is released unless --image names it.
Each robot is a process of QEMU. Beside it the same robot runs in process, as with `run --tree image`;
what both decide, send and do is compared in every tick, bit by bit. docs/hil.md tells more.

Exit status:
  0  the mission was accomplished, and nothing differed
  1  it was not, or something differed: the first difference is printed
  2  wrong usage or input, no QEMU, or an image that does not build or start";

/// No recording of a flight is larger than this.
const MOST_FRAMES: u64 = 1 << 26;

#[derive(Args)]
pub(super) struct Hil {
    #[command(flatten)]
    run: RunArgs,
    /// Fly with the first robots of the scenario only
    #[arg(long, value_name = "N")]
    robots: Option<usize>,
    /// Reset the machine of a robot before a tick; may be given several times
    #[arg(long, value_name = "ROBOT@TICK")]
    restart: Vec<String>,
    /// The starts that the robots have had before: their first epoch is the one after
    #[arg(long, value_name = "N", default_value_t = 0)]
    starts: u32,
    /// Let all robots hear frames that were kept with --frames, as many in a tick as there are
    /// robots
    #[arg(long, value_name = "FILE")]
    replay: Option<String>,
    /// The ELF file of the image, in place of building it
    #[arg(long, value_name = "ELF")]
    image: Option<PathBuf>,
    /// Keep the log of each robot in a folder, for `log ELF FILE`
    #[arg(long, value_name = "FOLDER")]
    logs: Option<PathBuf>,
}

impl Hil {
    pub(super) fn run(self) -> Result<ExitCode, Failure> {
        if let Some(text) = task::text_of(&self.run.scenario)? {
            return self.run_task(&text);
        }
        self.run.has_no_task_tree()?;
        if !matches!(self.run.tree, Pilot::Inference | Pilot::Image) {
            return Err(
                format!("--tree {}: the image has the tree with inference", self.run.tree.name()).into()
            );
        }
        if let Some(Ablation { name, .. }) = self.run.decider {
            return Err(format!("--decider {name}: the image decides by inference").into());
        }
        let scenario = self.run.disturbance.applied(&scenario(&self.run.scenario)?, self.run.seed);
        let scenario = self.with_robots(scenario)?;
        let restarts =
            self.restart.iter().map(|text| restart(text, &scenario)).collect::<Result<Vec<_>, _>>()?;
        let replay = self.replay.as_ref().map_or(Ok(Vec::new()), |file| read(file, MOST_FRAMES))?;
        let image = self.image.clone().map_or_else(build_image, Ok)?;
        let (starts, logs) = (self.starts, self.logs.clone());
        let bench = Bench { image, restarts, starts, replay, logs, sabotage: None };
        self.fly(&scenario, &bench)
    }

    /// Works on a task.
    fn run_task(&self, text: &str) -> Result<ExitCode, Failure> {
        let name = &self.run.scenario;
        let is_more = self.robots.is_some() || !self.restart.is_empty() || self.replay.is_some();
        if is_more || self.starts > 0 || self.run.frames.is_some() || self.run.is_more_than_a_task() {
            let reason = "a task is flown without --robots, --restart, --starts, --replay, --tree, \
                          --disturbance, --log and --frames";
            return Err(format!("{name}: {reason}").into());
        }
        let arena = Bump::new();
        let mission = task::mission(&arena, name, text, self.run.task_tree.as_deref())?;
        let image = self.image.clone().map_or_else(build_task_image, Ok)?;
        let bench = Bench { image, logs: self.logs.clone(), ..Bench::default() };
        let since = Instant::now();
        let trouble = Trouble { loss: self.run.loss, ..Trouble::default() };
        let done = fly_emulated_task(&mission, self.run.seed, trouble, &bench)?;
        let (robots, ticks) = (mission.tables.robots(), done.flown.ticks);
        report(self.run.json, &done, || {
            let compared =
                compared((robots, ticks), done.compared, done.difference.as_ref(), since.elapsed());
            match self.run.quiet {
                true => task_line(&done.flown) + "\n" + &compared,
                false => mission.narrate(&done.flown) + "\n" + &compared,
            }
        })?;
        Ok(exit_status(done.difference.is_none() && done.flown.success))
    }

    fn with_robots(&self, scenario: Scenario) -> Result<Scenario, Failure> {
        let Some(robots) = self.robots else { return Ok(scenario) };
        let (name, most) = (scenario.name.clone(), scenario.robots.len());
        let fewer = scenario.with_robots(robots);
        fewer.ok_or_else(|| format!("--robots {robots}: {name} has 1 to {most}").into())
    }

    fn fly(&self, scenario: &Scenario, bench: &Bench) -> Result<ExitCode, Failure> {
        let conditions = Conditions { seed: self.run.seed, loss: self.run.loss, tree: Pilot::Image };
        let mut kept = self.run.keep(self.run.observer(scenario))?;
        let since = Instant::now();
        let flown = fly_emulated(scenario, conditions, bench, &mut kept)?;
        let took = since.elapsed();
        kept.finish()?;
        print(&self.report(&flown, took)?)?;
        Ok(exit_status(flown.difference.is_none() && flown.record.outcome.is_success()))
    }

    fn report(&self, flown: &HilRecord, took: Duration) -> Result<String, Failure> {
        if self.run.json {
            return Ok(serde_json::to_string(flown)? + "\n");
        }
        let size = (flown.record.robots.len(), flown.record.ticks + 1);
        let compared = compared(size, flown.compared, flown.difference.as_ref(), took);
        if self.run.quiet {
            return Ok(outcome_line(&flown.record) + "\n" + &compared);
        }
        let columns = super::size_of_screen().and_then(|(columns, _)| u16::try_from(columns).ok());
        Ok(format!("\n{}\n{compared}", summary(&flown.record, columns)))
    }
}

/// What was compared, and the first difference.
fn compared(
    (robots, ticks): (usize, u32),
    compared: Compared,
    difference: Option<&Difference>,
    took: Duration,
) -> String {
    let pace = f64::from(ticks) / took.as_secs_f64().max(f64::MIN_POSITIVE);
    let found = match difference {
        None => "all the same".to_owned(),
        Some(difference) => format!("THE FIRST DIFFERENCE: {difference}"),
    };
    format!(
        "Emulated robots beside the same in process: {robots} robots, {} ticks, {} decisions, {} moves, {} bytes \
         of frames: {found}.\n{pace:.0} ticks a second of the whole team.\n",
        compared.ticks, compared.decisions, compared.moves, compared.bytes
    )
}

/// A restart as it is written: the robot's name and the tick.
fn restart(text: &str, scenario: &Scenario) -> Result<(usize, u32), String> {
    let (name, tick) = text.split_once('@').ok_or_else(|| format!("--restart {text}: write ROBOT@TICK"))?;
    let robot = scenario.robots.iter().position(|robot| robot.name == name).ok_or_else(|| {
        let names: Vec<_> = scenario.robots.iter().map(|robot| robot.name.as_str()).collect();
        format!("--restart {text}: no robot is called {name}; there are {}", names.join(", "))
    })?;
    let tick = tick.parse().map_err(|_| format!("--restart {text}: {tick} is no tick"))?;
    Ok((robot, tick))
}
