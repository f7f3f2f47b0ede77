//! The verbs for behavior trees.

use super::{Failure, UNUSABLE, about, is_path, print, read, read_up_to, unknown};
use clap::{Args, Subcommand};
use host_sim::tree::{
    self, Document, DryRun, Extras, Instance, LoadError, Mode, Severity, Statuses, library,
};
use iibt_core::tree::StatusChange;
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The exit status when a check finds errors.
const ERRORS: u8 = 1;

/// No tree file is larger than this.
const MAX_BYTES: u64 = 16 << 20;

const TREE_HELP: &str = "\
Examples:
  host-sim tree check patrol.xml           find what is wrong before the robot does
  host-sim tree show t21 --dot | dot -Tsvg > t21.svg
  host-sim tree codegen patrol.xml > src/patrol.rs
  host-sim tree run patrol.xml --ticks 5 --leaf Door=RRS

Files are BehaviorTree.CPP's XML, version 4, with the nodes of Nav2 (PipelineSequence, RoundRobin,
RecoveryNode, RateController). Built in are pilot, t21, t33 and the paper's figures: `tree export` with any other
name lists them.";

const CHECK_HELP: &str = "\
Finds what BehaviorTree.CPP complains about when it loads a file, and what it finds only when the tree runs:
missing parameters, thresholds that cannot be reached, wrong numbers of cases.
Every remark begins with FILE:LINE:COLUMN.

Examples:
  host-sim tree check patrol.xml
  host-sim tree check patrol.xml --tree Dock    as if Dock were the tree to execute

Exit status:
  0  nothing is wrong; there may be warnings
  1  there are errors
  2  the file cannot be read, or wrong usage";

const SHOW_HELP: &str = "\
Examples:
  host-sim tree show pilot
  host-sim tree show patrol.xml --dot | dot -Tsvg > patrol.svg

Exit status:
  0  shown
  2  the tree cannot be used, or wrong usage";

const EXPORT_HELP: &str = "\
The compact form with a model of every node that is not built in, as Groot2 opens it. What a file includes is
written into the one file; comments are not kept.

Examples:
  host-sim tree export t21 > t21.xml
  host-sim tree export patrol.xml > for-groot.xml

Exit status:
  0  exported
  2  the file cannot be used, or wrong usage";

const CODEGEN_HELP: &str = "\
Writes a table for iibt_core::tree, which the compiler checks again, an enum with a variant for each leaf, and the
places of the tree's ports. Conditions written as scripts become variants too, with their text: the
program answers them.

Examples:
  host-sim tree codegen patrol.xml > src/patrol.rs
  host-sim tree codegen patrol.xml --tree Dock > src/dock.rs

Exit status:
  0  written
  2  the tree cannot be used, or wrong usage";

const RUN_HELP: &str = "\
A leaf plays a script of statuses, one letter a tick of that leaf, the last repeating: S success, F failure,
R running, K skipped. The script is given in the file, <L name=\"a\" s=\"RRS\"/>, or with --leaf by the name of
the leaf or of its kind. A leaf without one succeeds.

Examples:
  host-sim tree run patrol.xml --ticks 3 --leaf Door=RRS --leaf MoveTo=F
  host-sim tree run patrol.xml --ticks 9 --tick-ms 50 --mode exactly-once --halt-after 4

One line a tick, leaves in the order in which they are told:
  tick 1: a:S b:R => RUNNING
  tick 2: guard:F halt(b) => FAILURE
  haltTree: halt(a)

With --mode once the tree is gone through again while nodes ask for it and, as in BehaviorTree.CPP, once more if a
timer has gone off since the last tick; 10000 times at the most.

--compat follows BehaviorTree.CPP 4.10 also where we differ from it on purpose. Without it
  - haltTree tells only leaves that are running, not all leaves a second time
  - Timeout halts its child when the tree is next ticked and comes to it, not in between
  - Precondition is asked at every tick and halts its child when it no longer holds
These differences remain with --compat:
  - RetryUntilSuccessful, Repeat, Timeout and Delay start again after they were skipped
  - a node that runs and is then skipped is idle at once, and not halted afterwards
  - IfThenElse and WhileDoElse are skipped with their condition, where BehaviorTree.CPP throws an exception
  - with --mode once, a node that asks for another tick in the tick that ends the tree is not heard in the next

Exit status:
  0  the ticks were run, whatever the tree returned
  2  the tree cannot be run, or wrong usage";

const REPLAY_HELP: &str = "\
LOG is what a robot or a run has recorded of this tree, or of the table that `tree codegen` writes for it:
  - what `log` prints of the log of an image with the feature explain, as text or with --json
  - what `run --tree-log` has written; --robot chooses one of the robots
  - a file of Groot2, as `tree run --log` writes it
  - records of nine bytes, as StatusChange::btlog makes them

Every tick that changed other nodes than the one before is drawn, with the status of each node; one that was halted
or not ticked has none. The engine ticks the tree with what its leaves returned, and must change the same nodes: a
log of another tree, or with a change left out, is refused with the place where it differs. Entries that are missing
are reported; after them, and for a tree with conditions before nodes, the engine cannot tell.

Examples:
  host-sim log team_member robot-1.bin > robot-1.txt && host-sim tree replay pilot robot-1.txt
  host-sim run factory --quiet --tree-log trees.txt && host-sim tree replay pilot trees.txt --robot R2 --tick 30
  host-sim tree replay patrol.xml robot-1.bin --timeline robot-1.html
  host-sim tree replay patrol.xml robot-1.bin --log robot-1.btlog    for Groot2

Exit status:
  0  replayed
  1  entries are missing
  2  the tree or the log cannot be used, the log is not of this tree, or wrong usage";

/// The verbs for behavior trees.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = TREE_HELP, arg_required_else_help = true)]
pub(super) struct Tree {
    #[command(subcommand)]
    verb: TreeVerb,
}

#[derive(Subcommand, Debug, PartialEq)]
enum TreeVerb {
    /// Find what is wrong with a tree file
    #[command(after_help = CHECK_HELP)]
    Check(TreeSource),
    /// Show a tree as text or as a graph, and count its nodes
    #[command(after_help = SHOW_HELP)]
    Show(TreeShowArgs),
    /// Write a tree as Rust source: a table for firmware
    #[command(after_help = CODEGEN_HELP)]
    Codegen(TreeSource),
    /// Write a tree as compact XML with models
    #[command(after_help = EXPORT_HELP)]
    Export(TreeSource),
    /// Tick a tree whose leaves play scripts
    #[command(after_help = RUN_HELP)]
    Run(TreeRunArgs),
    /// Step through what a robot or a run has recorded, and draw the tree as it ticked
    #[command(after_help = REPLAY_HELP)]
    Replay(TreeReplayArgs),
}

#[derive(Args, Debug, PartialEq)]
struct TreeSource {
    /// A tree file, or the name of a built-in tree
    #[arg(value_name = "FILE.xml|NAME")]
    source: String,
    /// The tree to execute, in place of the one that the file names
    #[arg(long, value_name = "ID")]
    tree: Option<String>,
}

#[derive(Args, Debug, PartialEq)]
struct TreeShowArgs {
    #[command(flatten)]
    source: TreeSource,
    /// A graph for Graphviz in place of the text
    #[arg(long)]
    dot: bool,
}

#[derive(Args, Debug, PartialEq)]
struct TreeRunArgs {
    #[command(flatten)]
    source: TreeSource,
    /// How many ticks
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    ticks: u32,
    /// How often the tree is gone through in a tick
    #[arg(long, value_enum, default_value_t = Mode::ExactlyOnce)]
    mode: Mode,
    /// Milliseconds from one tick to the next
    #[arg(long, value_name = "M", default_value_t = 10, value_parser = clap::value_parser!(u32).range(0..=3_600_000))]
    tick_ms: u32,
    /// The script of a leaf; may be given several times
    #[arg(long = "leaf", value_name = "NAME=STATUSES", value_parser = leaf)]
    leaves: Vec<(String, Statuses)>,
    /// Halt the tree after this tick
    #[arg(long, value_name = "K")]
    halt_after: Option<u32>,
    /// Follow BehaviorTree.CPP also where we differ on purpose
    #[arg(long)]
    compat: bool,
    #[command(flatten)]
    logs: Logs,
}

#[derive(Args, Debug, PartialEq)]
struct TreeReplayArgs {
    #[command(flatten)]
    source: TreeSource,
    /// What a robot or a run has recorded; - is the standard input
    #[arg(value_name = "LOG")]
    recorded: String,
    /// The robot, in a log of several
    #[arg(long, value_name = "NAME")]
    robot: Option<String>,
    /// Draw the tree as it was in this tick only
    #[arg(long, value_name = "N")]
    tick: Option<u32>,
    #[command(flatten)]
    logs: Logs,
}

#[derive(Args, Debug, PartialEq)]
struct Logs {
    /// Write what happened for Groot2
    #[arg(long, value_name = "FILE.btlog")]
    log: Option<PathBuf>,
    /// Write what happened as a page
    #[arg(long, value_name = "FILE.html")]
    timeline: Option<PathBuf>,
}

impl Tree {
    pub(super) fn run(&self) -> Result<ExitCode, Failure> {
        match &self.verb {
            TreeVerb::Check(source) => source.check(),
            TreeVerb::Show(show) => show.run(),
            TreeVerb::Codegen(source) => {
                source.print(|instance| instance.codegen().map_err(|error| vec![error]))
            }
            TreeVerb::Export(source) => source.export(),
            TreeVerb::Run(run) => run.run(),
            TreeVerb::Replay(replay) => replay.run(),
        }
    }
}

/// A built-in document by its name, else a file with what it includes. `leaves` need no
/// declaration.
pub(super) fn load(source: &str, leaves: &[String]) -> Result<Document, LoadError> {
    if let Some(document) = library::find(source) {
        return Ok(document?);
    }
    if !is_path(source) {
        let nearest = library::nearest(source);
        let reason = unknown("none", source, nearest, library::names()) + "xml";
        return Err(LoadError::Unreadable("tree".into(), reason));
    }
    let files = |path: &Path| {
        let bytes = read_up_to(path, MAX_BYTES)?;
        String::from_utf8(bytes).map_err(|_| std::io::Error::other("this is no UTF-8 text"))
    };
    Document::load(Path::new(source), &files, &Extras { leaves })
}

impl TreeSource {
    fn check(&self) -> Result<ExitCode, Failure> {
        let document = match load(&self.source, &[]) {
            Ok(document) => document,
            Err(LoadError::Malformed(error)) => {
                print(&format!("{error}\n{}: 1 error, 0 warnings\n", self.source))?;
                return Ok(ExitCode::from(ERRORS));
            }
            Err(error) => return Err(error.into()),
        };
        let remarks = tree::check(&document, self.tree.as_deref());
        let errors = remarks.iter().filter(|remark| remark.severity == Severity::Error).count();
        let mut text: String = remarks.iter().map(|remark| format!("{remark}\n")).collect();
        text += &format!(
            "{}: {}, {}\n",
            self.source,
            counted(errors, "error"),
            counted(remarks.len() - errors, "warning")
        );
        print(&text)?;
        Ok(if errors == 0 { ExitCode::SUCCESS } else { ExitCode::from(ERRORS) })
    }

    fn instance(&self, leaves: &[String]) -> Result<Result<Instance, Vec<tree::Diagnostic>>, Failure> {
        let document = load(&self.source, leaves)?;
        let main = match document.main_tree(self.tree.as_deref()) {
            Ok(main) => main,
            Err(error) => return Ok(Err(vec![error])),
        };
        Ok(Instance::of(&document, &main))
    }

    fn print(
        &self,
        write: impl FnOnce(&Instance) -> Result<String, Vec<tree::Diagnostic>>,
    ) -> Result<ExitCode, Failure> {
        match self.instance(&[])?.and_then(|instance| write(&instance)) {
            Ok(text) => {
                print(&text)?;
                Ok(ExitCode::SUCCESS)
            }
            Err(remarks) => Ok(refuse(&remarks)),
        }
    }

    fn export(&self) -> Result<ExitCode, Failure> {
        let document = load(&self.source, &[])?;
        let remarks: Vec<_> = document.remarks().cloned().collect();
        if remarks.iter().any(|remark| remark.severity == Severity::Error) {
            return Ok(refuse(&remarks));
        }
        print(&document.export())?;
        Ok(ExitCode::SUCCESS)
    }
}

impl TreeShowArgs {
    fn run(&self) -> Result<ExitCode, Failure> {
        self.source.print(|instance| Ok(if self.dot { instance.dot() } else { instance.outline() }))
    }
}

impl TreeRunArgs {
    fn run(&self) -> Result<ExitCode, Failure> {
        let names: Vec<_> = self.leaves.iter().map(|(name, _)| name.clone()).collect();
        let instance = match self.source.instance(&names)? {
            Ok(instance) => instance,
            Err(remarks) => return Ok(refuse(&remarks)),
        };
        let dry_run = DryRun {
            ticks: self.ticks,
            mode: self.mode,
            tick_ms: self.tick_ms,
            leaves: &self.leaves,
            halt_after: self.halt_after,
            compat: self.compat,
        };
        let record = match dry_run.run(&instance) {
            Ok(record) => record,
            Err(error) => return Ok(refuse(&[error])),
        };
        print(&record.text)?;
        self.logs.write(&instance, &record.transitions)?;
        match record.error {
            Some(error) => Ok(refuse(&[error])),
            None => Ok(ExitCode::SUCCESS),
        }
    }
}

impl TreeReplayArgs {
    fn run(&self) -> Result<ExitCode, Failure> {
        let instance = match self.source.instance(&[])? {
            Ok(instance) => instance,
            Err(remarks) => return Ok(refuse(&remarks)),
        };
        let bytes = self.read()?;
        let ticks = instance.recorded(&self.recorded, &bytes, self.robot.as_deref())?;
        let replay = match instance.replay(&ticks) {
            Ok(replay) => replay,
            Err(error) => return Ok(refuse(&[error])),
        };
        print(&self.drawn(&replay)?)?;
        replay.gaps.iter().for_each(|gap| eprintln!("{}: {gap}", self.recorded));
        if let Some(fault) = replay.fault {
            return Err(format!("{}: {fault}", self.recorded).into());
        }
        self.logs.write(&instance, &replay.transitions)?;
        Ok(if replay.gaps.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(ERRORS) })
    }

    fn read(&self) -> Result<Vec<u8>, Failure> {
        if self.recorded != "-" {
            return Ok(read(&self.recorded, MAX_BYTES)?);
        }
        let mut bytes = Vec::new();
        io::stdin().take(MAX_BYTES).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    /// The tree in the tick that is asked for; else in every tick, unless that is written to a
    /// file.
    fn drawn(&self, replay: &tree::Replay) -> Result<String, Failure> {
        let (ticks, changes) = (replay.ticks.len(), replay.transitions.len());
        let count = format!("{}, recorded for {}\n", counted(changes, "change"), counted(ticks, "tick"));
        if let Some(tick) = self.tick {
            let is_in = |drawn: &&tree::DrawnTick| (drawn.ticks.0..=drawn.ticks.1).contains(&tick);
            let drawn = replay.ticks.iter().find(is_in);
            let none = || format!("{}: tick {tick} is not in the log", self.recorded);
            return Ok(drawn.ok_or_else(none)?.text.clone());
        }
        if self.logs.log.is_some() || self.logs.timeline.is_some() {
            return Ok(count);
        }
        Ok(replay.ticks.iter().map(|drawn| drawn.text.clone() + "\n").collect::<String>() + &count)
    }
}

impl Logs {
    fn write(&self, instance: &Instance, transitions: &[StatusChange]) -> Result<(), Failure> {
        if let Some(path) = &self.log {
            fs::write(path, instance.btlog(transitions)).map_err(about(path.display()))?;
        }
        if let Some(path) = &self.timeline {
            fs::write(path, instance.timeline(transitions)).map_err(about(path.display()))?;
        }
        Ok(())
    }
}

/// Reports why a tree cannot be used.
fn refuse(remarks: &[tree::Diagnostic]) -> ExitCode {
    remarks.iter().for_each(|remark| eprintln!("{remark}"));
    ExitCode::from(UNUSABLE)
}

fn leaf(text: &str) -> Result<(String, Statuses), String> {
    let (name, statuses) = text.rsplit_once('=').ok_or("write NAME=STATUSES, for example Door=RRS")?;
    if name.is_empty() {
        return Err("the name of the leaf is missing before '='".into());
    }
    Ok((name.to_owned(), statuses.parse()?))
}

fn counted(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        tree: Tree,
    }

    fn parse(line: &str) -> Result<Tree, clap::Error> {
        let words = std::iter::once("tree").chain(line.split(' '));
        Cli::try_parse_from(words).map(|cli| cli.tree)
    }

    /// The exit status of a command line; one that fails says what the program prints.
    fn status(line: &str) -> String {
        let tree = parse(line).unwrap_or_else(|error| panic!("{error}"));
        match tree.run() {
            Ok(code) if code == ExitCode::SUCCESS => "0".into(),
            Ok(code) if code == ExitCode::from(ERRORS) => "1".into(),
            Ok(code) if code == ExitCode::from(UNUSABLE) => "2".into(),
            Ok(code) => panic!("{code:?}"),
            Err(failure) => failure.to_string(),
        }
    }

    fn file(name: &str, text: &str) -> String {
        let path = std::env::temp_dir().join(format!("host-sim-{}-{name}.xml", std::process::id()));
        fs::write(&path, text).unwrap();
        path.display().to_string()
    }

    #[test]
    fn the_exit_status_tells_what_is_wrong() {
        let right = file(
            "right",
            "<root BTCPP_format=\"4\"><BehaviorTree ID=\"M\"><L name=\"a\"/></BehaviorTree></root>",
        );
        let wrong =
            file("wrong", "<root BTCPP_format=\"4\"><BehaviorTree ID=\"M\"><A/></BehaviorTree></root>");
        let broken = file("broken", "<root>");
        for (line, expected) in [
            (format!("check {right}"), "0"),
            (format!("check {wrong}"), "1"),
            (format!("check {broken}"), "1"),
            (format!("check {right} --tree Other"), "1"),
            (format!("show {right}"), "0"),
            (format!("show {wrong}"), "2"),
            (format!("codegen {wrong}"), "2"),
            (format!("export {wrong}"), "2"),
            (format!("export {right}"), "0"),
            (format!("run {right} --ticks 2 --leaf a=RF"), "0"),
            (format!("run {right} --ticks 2 --leaf b=R"), "2"),
            (format!("run {wrong} --ticks 2 --leaf A=R"), "0"),
        ] {
            assert_eq!(status(&line), expected, "{line}");
        }
        [right, wrong, broken].iter().for_each(|path| fs::remove_file(path).unwrap());
    }

    #[test]
    fn an_unknown_name_gets_a_suggestion_and_a_missing_file_its_name() {
        assert!(
            status("show t22")
                .starts_with("tree: none is called 't22': did you mean 't21'? built in are pilot")
        );
        assert!(status("check nowhere/mine.xml").starts_with("nowhere/mine.xml: "));
    }

    #[test]
    fn wrong_arguments_are_refused() {
        for line in [
            "run t21",
            "run t21 --ticks 0",
            "run t21 --ticks 3 --leaf a",
            "run t21 --ticks 3 --leaf a=X",
            "run t21 --ticks 3 --leaf =S",
            "run t21 --ticks 3 --mode twice",
            "show",
        ] {
            assert!(parse(line).is_err(), "{line}");
        }
        let leaves =
            "run t21 --ticks 3 --leaf a=b=SF --leaf c=R --mode once --tick-ms 0 --halt-after 2 --compat";
        assert!(
            matches!(parse(leaves).unwrap().verb, TreeVerb::Run(run) if run.leaves[0].0 == "a=b" && run.leaves.len() == 2)
        );
    }
}
