//! The verbs, what they read and what they print.

mod campaign;
mod draws;
mod family;
mod frames;
#[cfg(unix)]
mod hil;
mod kept;
mod learn;
mod log;
mod manipulate;
mod missions;
mod notebook;
mod provision;
mod reproduce;
mod task;
mod tree;

use self::learn::Learn;
use self::manipulate::Manipulate;
use self::reproduce::Reproduce;
use anstream::{AutoStream, ColorChoice};
use clap::{Arg, Args, Command, CommandFactory, FromArgMatches, Parser, Subcommand};
use host_sim::campaign::{Ablation, Disturbance};
use host_sim::show::{Narrator, Palette, Screen, outcome_line, series_lines, summary};
use host_sim::{Conditions, Observer, Pilot, Record, Scenario, fly, fly_series, library};
use serde::Serialize;
use std::error::Error;
use std::fmt::Display;
use std::fs::File;
use std::io::{self, BufWriter, IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use terminal_size::{Height, Width, terminal_size};

/// The exit status when a mission is not accomplished.
const NOT_ACCOMPLISHED: u8 = 1;

/// The exit status for an input that cannot be used; the same as for a wrong command line.
const UNUSABLE: u8 = 2;

/// No scenario is larger than this.
const MAX_BYTES: u64 = 1 << 20;

const EXAMPLES: &str = "\
Examples:
  host-sim                    fly the three-robot factory mission
  host-sim list               see what else is built in
  host-sim run detour --loss 0.3 --seed 7
  host-sim run my-warehouse.toml --json > flight.json
  host-sim reproduce          the paper's results beside ours, as a table and a page
  host-sim campaign factory --seeds 100
  host-sim infer model.json   run an active-inference model from a notebook
  host-sim export model.json > src/model.rs
  host-sim tree check my-tree.xml
From a checkout, `host-sim run ...` is `cargo run --release -- run ...`.

Exit status:
  0  the mission was accomplished, or there was nothing to do
  1  it was not
  2  wrong usage or input";

const RUN_EXAMPLES: &str = "\
Examples:
  host-sim run factory              watch the default mission
  host-sim run factory --loss 0.3   with a radio that loses three frames in ten
  host-sim run factory --tree conventional   the same with a tree written by hand
  host-sim run sign.toml --decider likeliest   with a rule in place of inference
  host-sim run my-warehouse.toml    a scenario of your own
  host-sim run two-goals --json | jq '.robots[].path'
  host-sim run two-goals --tree-log trees.txt && host-sim tree replay pilot trees.txt --robot R1
From a checkout, `host-sim run ...` is `cargo run --release -- run ...`.

A scenario of your own:
  title = \"Two robots in a corridor\"
  map = \"\"\"
  1..#..G
  2.....G
  \"\"\"
'.' is free, '#' blocked, '1' to '8' are robots, 'G' goals.
host-sim/scenarios/README.md tells what else a scenario can say.

A task written as tables is flown in the same way: `host-sim run valves`, `host-sim run my-task.toml`.
host-sim/tasks/README.md tells what such a file says. --tree, --decider, --disturbance, --log and
--tree-log are for scenarios.

Exit status:
  0  the mission was accomplished, or there was nothing to do
  1  it was not
  2  wrong usage or input";

/// Fly teams of robots that decide together, in simulation.
///
/// The robots run the firmware's own controller and talk through a radio that may lose frames.
/// Without a verb, a scenario is flown: `run` may be left out.
#[derive(Parser)]
#[command(name = "host-sim", version, after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    verb: Option<Verb>,
    #[command(flatten)]
    run: RunArgs,
}

#[derive(Subcommand)]
enum Verb {
    /// List the built-in scenarios and tasks
    #[command(after_help = "Example:\n  host-sim list")]
    List,
    /// Fly a scenario or a task
    #[command(after_help = RUN_EXAMPLES)]
    Run(RunArgs),
    /// Fly a scenario with a team of emulated microcontrollers, and compare it with `run`
    #[cfg(unix)]
    #[command(after_help = hil::EXAMPLES)]
    Hil(hil::Hil),
    /// Put the paper's results beside ours: a table, and a page to look at
    #[command(after_help = reproduce::EXAMPLES)]
    Reproduce(Reproduce),
    /// Fly a scenario many times under disturbances, and compare inference with a conventional tree
    #[command(after_help = campaign::examples())]
    Campaign(campaign::FlyMany),
    /// Draw random missions, and write them as scenario files
    #[command(after_help = missions::EXAMPLES)]
    Missions(missions::Missions),
    /// Draw random missions with something unknown, and write them as scenario files
    #[command(after_help = family::EXAMPLES)]
    Family(family::DrawFamily),
    /// Run a model from a notebook: beliefs, expected free energies and a decision, as JSON
    #[command(after_help = notebook::INFER_EXAMPLES)]
    Infer(notebook::Infer),
    /// Write a model from a notebook, or the tables of a task, as Rust source for firmware
    #[command(after_help = notebook::EXPORT_EXAMPLES)]
    Export(notebook::Export),
    /// Tell from recorded frames who goes where or does what, and how surely
    #[command(after_help = frames::EXAMPLES)]
    Frames(frames::Frames),
    /// Learn from a log how often each robot's moves succeed
    #[command(after_help = learn::EXAMPLES)]
    Learn(Learn),
    /// Print the messages in the log of an image
    #[command(after_help = log::EXAMPLES)]
    Log(log::Log),
    /// Let two robots bring a bottle and a plate together
    #[command(after_help = manipulate::EXAMPLES)]
    Manipulate(Manipulate),
    /// Write the page of flash that makes an image one robot of a team, or print one
    #[command(after_help = provision::EXAMPLES)]
    Provision(provision::WritePage),
    /// Check, show, translate and try behavior trees
    Tree(tree::Tree),
}

#[derive(Args, Debug, PartialEq)]
struct RunArgs {
    /// A built-in scenario or task, or a file with one
    #[arg(value_name = "NAME|FILE.toml", default_value = library::DEFAULT)]
    scenario: String,
    /// The seed of all random numbers; the same seed gives the same flight
    #[arg(long, value_name = "N", value_parser = seed, default_value_t = 0)]
    seed: u64,
    /// The probability that a frame does not reach a teammate, 0 to 1, in place of the scenario's
    #[arg(long, value_name = "P", value_parser = probability)]
    loss: Option<f64>,
    /// A disturbance that is drawn from the seed, as `campaign` does
    #[arg(long, value_name = "NAME", default_value = "none", value_parser = campaign::disturbance)]
    disturbance: Disturbance,
    /// The tree that flies the robots: the inference node, or a conventional tree of the paper
    #[arg(long, value_name = "TREE", value_enum, default_value_t)]
    tree: Pilot,
    /// What decides where something is unknown, in place of inference: a name of `campaign
    /// --ablate`
    #[arg(long, value_name = "NAME", value_parser = campaign::ablation, conflicts_with = "tree")]
    decider: Option<&'static Ablation>,
    /// The trees of the robots of a task: for each the one with its name, else the main tree
    #[arg(long, value_name = "FILE.xml")]
    task_tree: Option<String>,
    /// Keep a log of every move that a robot was told to make
    #[arg(long, value_name = "FILE.csv")]
    log: Option<PathBuf>,
    /// Keep a log of what each robot's tree has done, for `tree replay pilot`
    #[arg(long, value_name = "FILE")]
    tree_log: Option<PathBuf>,
    /// Keep all frames that the robots send, for the verb `frames`
    #[arg(long, value_name = "FILE")]
    frames: Option<PathBuf>,
    /// Print one JSON object with everything about the flight, and nothing else
    #[arg(long, conflicts_with = "quiet")]
    json: bool,
    /// Print the outcome in one line, and nothing else
    #[arg(long)]
    quiet: bool,
}

type Failure = Box<dyn Error>;

/// Runs the command line.
pub(crate) fn main() -> ExitCode {
    let read = Cli::from_arg_matches(&with_negative_numbers(Cli::command()).get_matches());
    match read.unwrap_or_else(|error| error.exit()).run() {
        Ok(code) => code,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(UNUSABLE)
        }
    }
}

/// A command whose options take a negative number for a value: the error is then what the option
/// says of its range, and not that there is no option `-1`.
fn with_negative_numbers(command: Command) -> Command {
    let is_option = |arg: &Arg| arg.get_long().is_some() && arg.get_action().takes_values();
    let command =
        command.mut_args(|arg| if is_option(&arg) { arg.allow_negative_numbers(true) } else { arg });
    command.mut_subcommands(with_negative_numbers)
}

impl Cli {
    fn run(self) -> Result<ExitCode, Failure> {
        match self.verb {
            Some(Verb::List) => list(),
            Some(Verb::Run(run)) => run.run(),
            #[cfg(unix)]
            Some(Verb::Hil(hil)) => hil.run(),
            Some(Verb::Reproduce(reproduce)) => reproduce.run(),
            Some(Verb::Campaign(campaign)) => campaign.run(),
            Some(Verb::Missions(missions)) => missions.run().map(|()| ExitCode::SUCCESS),
            Some(Verb::Family(family)) => family.run().map(|()| ExitCode::SUCCESS),
            Some(Verb::Infer(infer)) => infer.run().map(|()| ExitCode::SUCCESS),
            Some(Verb::Export(export)) => export.run().map(|()| ExitCode::SUCCESS),
            Some(Verb::Frames(frames)) => frames.run(),
            Some(Verb::Learn(learn)) => learn.run(),
            Some(Verb::Log(log)) => log.run(),
            Some(Verb::Manipulate(manipulate)) => manipulate.run(),
            Some(Verb::Provision(provision)) => provision.run().map(|()| ExitCode::SUCCESS),
            Some(Verb::Tree(tree)) => tree.run(),
            None => self.run.run(),
        }
    }
}

fn list() -> Result<ExitCode, Failure> {
    let names = library::names().chain(host_sim::task::NAMES);
    let longest = names.map(str::len).max().unwrap_or(0);
    let mut text = String::new();
    for name in library::names() {
        let title = scenario(name)?.title;
        text += &format!("{name:<longest$}  {title}\n");
    }
    for name in host_sim::task::NAMES {
        text += &format!("{name:<longest$}  {}\n", task::title(name)?);
    }
    print(&text)?;
    Ok(ExitCode::SUCCESS)
}

impl RunArgs {
    fn run(&self) -> Result<ExitCode, Failure> {
        if let Some(text) = task::text_of(&self.scenario)? {
            return task::run(self, &text);
        }
        self.has_no_task_tree()?;
        self.is_no_folder()?;
        let scenario = self.disturbance.applied(&scenario(&self.scenario)?, self.seed);
        let tree = self.pilot(&scenario)?;
        note_conventional(&[tree], std::slice::from_ref(&scenario));
        let conditions = Conditions { seed: self.seed, loss: self.loss, tree };
        if scenario.missions > 1 {
            return self.run_series(&scenario, conditions);
        }
        let mut kept = self.keep(self.observer(&scenario))?;
        let record =
            fly(&scenario, conditions, &mut kept).map_err(|error| format!("{}: {error}", scenario.name))?;
        kept.finish()?;
        print(&self.report(&record)?)?;
        Ok(exit_status(record.outcome.is_success()))
    }

    /// What flies the robots of a scenario.
    fn pilot(&self, scenario: &Scenario) -> Result<Pilot, String> {
        let name = &scenario.name;
        if self.tree == Pilot::Figure5 && scenario.goals.len() != 2 {
            let goals = scenario.goals.len();
            return Err(format!("{name}: the tree of figure 5 is for two goals, not {goals}"));
        }
        if self.tree_log.is_some() && self.tree.is_conventional() {
            return Err(format!("{name}: --tree-log is for the tree with the inference node"));
        }
        if self.decider.is_some() && scenario.unknowns.is_empty() {
            return Err(format!("{name}: nothing is unknown, which --decider is for"));
        }
        Ok(self.decider.map_or(self.tree, Pilot::Ablated))
    }

    fn is_no_folder(&self) -> Result<(), String> {
        let name = &self.scenario;
        if library::find(name).is_none() && Path::new(name).is_dir() {
            return Err(format!(
                "{name}: a folder, but a file is expected; `campaign` flies all scenarios of a folder"
            ));
        }
        Ok(())
    }

    fn has_no_task_tree(&self) -> Result<(), String> {
        match &self.task_tree {
            Some(file) => Err(format!("{}: a scenario is flown without --task-tree {file}", self.scenario)),
            None => Ok(()),
        }
    }

    /// Flies the missions of a scenario that has several, a line each.
    fn run_series(&self, scenario: &Scenario, conditions: Conditions) -> Result<ExitCode, Failure> {
        if self.frames.is_some() {
            return Err(
                format!("{}: --frames keeps those of one mission, not of a series", scenario.name).into()
            );
        }
        let mut kept = self.keep(Box::new(()))?;
        let series = fly_series(scenario, conditions, true, &mut kept).map_err(about(&scenario.name))?;
        kept.finish()?;
        report(self.json, &series, || series_lines(&series, self.quiet) + "\n")?;
        Ok(exit_status(series.missions.iter().all(|mission| mission.record.outcome.is_success())))
    }

    fn observer(&self, scenario: &Scenario) -> Box<dyn Observer> {
        if self.json || self.quiet {
            return Box::new(());
        }
        match size_of_screen() {
            Some((columns, lines)) if fits(scenario, columns, lines) => {
                Box::new(Screen::new(io::stdout(), palette(), columns))
            }
            _ => Box::new(Narrator::new(io::stdout())),
        }
    }

    fn report(&self, record: &Record) -> Result<String, Failure> {
        let text = if self.json {
            record.to_json()?
        } else if self.quiet {
            outcome_line(record)
        } else {
            let columns = size_of_screen().and_then(|(columns, _)| u16::try_from(columns).ok());
            format!("\n{}", summary(record, columns))
        };
        Ok(text + "\n")
    }
}

/// Says on standard error that robots with a conventional tree know of no unknowns, if some fly
/// where there are.
fn note_conventional(pilots: &[Pilot], scenarios: &[Scenario]) {
    if pilots.iter().any(|pilot| pilot.is_conventional())
        && scenarios.iter().any(|scenario| !scenario.unknowns.is_empty())
    {
        eprintln!(
            "note: a conventional tree knows of no [[unknown]]: all cells are free to it until it sees them \
             blocked, and all goals serve"
        );
    }
}

/// The columns and lines of the terminal, if standard output is one that can be redrawn.
fn size_of_screen() -> Option<(usize, usize)> {
    let is_dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
    if is_dumb || !io::stdout().is_terminal() {
        return None;
    }
    terminal_size().map(|(Width(columns), Height(lines))| (usize::from(columns), usize::from(lines)))
}

fn fits(scenario: &Scenario, columns: usize, lines: usize) -> bool {
    let width = 2 * usize::from(scenario.map.width()) + 2;
    width.max(60) < columns && Screen::<io::Stdout>::height(scenario) < lines
}

fn palette() -> Palette {
    match AutoStream::choice(&io::stdout()) {
        ColorChoice::Never => Palette::Plain,
        _ => Palette::Colour,
    }
}

/// A built-in scenario by its name, else a file.
fn scenario(name: &str) -> Result<Scenario, Failure> {
    if let Some(scenario) = library::find(name) {
        return Ok(scenario?);
    }
    if host_sim::task::NAMES.contains(&name) {
        return Err(format!("{name}: a scenario is wanted here, and this is a task").into());
    }
    if !is_path(name) {
        let names = library::names().chain(host_sim::task::NAMES);
        let unknown = unknown("no scenario or task", name, library::nearest(name), names);
        return Err((unknown + "toml").into());
    }
    Ok(Scenario::read(name, &read(name, MAX_BYTES)?)?)
}

/// Whether an argument is a path, and not the name of something built in.
fn is_path(name: &str) -> bool {
    let path = Path::new(name);
    path.extension().is_some() || path.components().count() > 1 || path.exists()
}

/// The reason why a name is unknown, up to the extension of files.
fn unknown(
    none: &str,
    name: &str,
    nearest: Option<&str>,
    names: impl Iterator<Item = &'static str>,
) -> String {
    let hint = nearest.map_or_else(String::new, |nearest| format!("did you mean '{nearest}'? "));
    let names = names.collect::<Vec<_>>().join(", ");
    format!("{none} is called '{name}': {hint}built in are {names}; a file of your own ends in .")
}

/// Creates a file; an error names it.
fn created(path: &Path) -> Result<BufWriter<File>, String> {
    File::create(path).map(BufWriter::new).map_err(about(path.display()))
}

/// Reads a file of at most `most` bytes; an error names the file.
fn read(name: &str, most: u64) -> Result<Vec<u8>, String> {
    read_up_to(Path::new(name), most).map_err(about(name))
}

/// Puts the subject of an error before it.
fn about<E: Display>(subject: impl Display) -> impl FnOnce(E) -> String {
    move |error| format!("{subject}: {error}")
}

/// Prints a result as one JSON object, or as text.
fn report(json: bool, result: &impl Serialize, text: impl FnOnce() -> String) -> Result<(), Failure> {
    Ok(print(&if json { serde_json::to_string(result)? + "\n" } else { text() })?)
}

/// The exit status of a verb that accomplishes something or does not.
fn exit_status(is_accomplished: bool) -> ExitCode {
    if is_accomplished { ExitCode::SUCCESS } else { ExitCode::from(NOT_ACCOMPLISHED) }
}

fn read_up_to(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    if path.is_dir() {
        return Err(io::Error::other("a folder, but a file is expected"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let reason = format!("larger than {} MiB, which no such file is", most >> 20);
        return Err(io::Error::other(reason));
    }
    Ok(bytes)
}

fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("a seed is a whole number from 0 to {}", u64::MAX))
}

fn probability(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value| (0.0..=1.0).contains(value));
    value.ok_or_else(|| "a probability is a number from 0 to 1".to_owned())
}

/// Prints to standard output. A closed pipe is no error.
fn print(text: &str) -> io::Result<()> {
    match io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn run_may_be_left_out() {
        for arguments in [&[][..], &["detour"], &["--loss", "0.3"], &["my.toml", "--json", "--seed", "7"]] {
            let Some(Verb::Run(run)) = Cli::parse_from([&["host-sim", "run"], arguments].concat()).verb
            else {
                panic!("not a run: {arguments:?}")
            };
            let short = Cli::parse_from([&["host-sim"], arguments].concat());
            assert!(short.verb.is_none(), "{arguments:?}");
            assert_eq!(short.run, run, "{arguments:?}");
        }
        assert!(matches!(Cli::parse_from(["host-sim", "list"]).verb, Some(Verb::List)));
    }

    #[test]
    fn wrong_arguments_are_refused() {
        let refused =
            |arguments: &[&str]| Cli::try_parse_from([&["host-sim", "run"], arguments].concat()).is_err();
        assert!(refused(&["--loss", "1.5"]) && refused(&["--loss", "NaN"]) && refused(&["--seed", "-1"]));
        assert!(refused(&["--json", "--quiet"]) && refused(&["--fast"]));
        assert!(!refused(&["--loss", "1", "--seed", "18446744073709551615"]));
    }

    #[test]
    fn an_unknown_name_gets_a_suggestion_and_a_missing_file_its_name() {
        let refusal = |name: &str| scenario(name).map_or_else(|error| error.to_string(), |_| String::new());
        assert!(
            refusal("factry").starts_with("no scenario or task is called 'factry': did you mean 'factory'?")
        );
        assert!(refusal("xyzzy").starts_with("no scenario or task is called 'xyzzy': built in are factory"));
        assert!(
            refusal("valvs").starts_with("no scenario or task is called 'valvs': did you mean 'valves'?")
        );
        assert!(refusal("valves").starts_with("valves: a scenario is wanted here"));
        assert!(refusal("xyzzy").contains("deliveries, bottle-and-plate, valves; "));
        assert!(refusal("nowhere/mine.toml").starts_with("nowhere/mine.toml: "));
    }
}
