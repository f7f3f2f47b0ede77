//! The verbs that take a model from a notebook.

use super::{Failure, print, read};
use clap::Args;
use host_sim::notebook::{BeliefMethod, Convention, Forms, InferenceProgress, InferenceRun, Notebook};
use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

/// No model is larger than this.
const MAX_BYTES: u64 = 64 << 20;

/// The time after which a run reports its progress.
const PATIENCE: Duration = Duration::from_secs(2);

pub(super) const INFER_EXAMPLES: &str = "\
Examples:
  host-sim infer model.json
  host-sim infer model.json --obs \"1,0,null\" --gamma 1
  host-sim infer model.json --convention joint | jq .G

docs/notebook.md has the layout of the file and of the output.

Exit status:
  0  the model was run, also when an observation has probability zero: the output says so
  2  wrong usage or input; the message names the file and the place in it";

pub(super) const EXPORT_EXAMPLES: &str = "\
Examples:
  host-sim export model.json > src/model.rs
  host-sim export model.json --name gripper > src/gripper.rs
  host-sim export my-task.toml > src/task.rs      the tables of a task file

The source depends on iibt-core and on nothing else. docs/notebook.md shows how firmware uses a
model, docs/your-robot.md how it uses the tables of a task.

Exit status:
  0  the source was written
  2  wrong usage or input; the message names the file and the place in it";

#[derive(Args, Debug, PartialEq)]
pub(super) struct Infer {
    /// The model
    #[arg(value_name = "MODEL.json")]
    model: String,
    /// What was observed, in place of the file's: an outcome, null or [weights] for each modality
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    obs: Option<String>,
    /// The precision of the policy posterior, in place of the file's
    #[arg(long, value_name = "G", allow_hyphen_values = true)]
    gamma: Option<f64>,
    /// By whose conventions beliefs and free energies are worked out
    #[arg(long, value_name = "NAME", value_enum, default_value_t)]
    convention: Convention,
    /// How beliefs are updated, in place of the convention's way
    #[arg(long, value_name = "HOW", value_enum)]
    beliefs: Option<BeliefMethod>,
    /// Keep full tables: do not look for structure
    #[arg(long)]
    dense: bool,
}

#[derive(Args, Debug, PartialEq)]
pub(super) struct Export {
    /// The model, or a task file
    #[arg(value_name = "MODEL.json|TASK.toml")]
    model: String,
    /// What the model is called in the source, in place of the file's name for it
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Keep full tables: do not look for structure
    #[arg(long)]
    dense: bool,
}

impl Infer {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let mut notebook = notebook(&self.model)?;
        if let Some(obs) = &self.obs {
            notebook = notebook.observing(obs)?;
        }
        if let Some(gamma) = self.gamma {
            notebook = notebook.with_precision(gamma)?;
        }
        let run =
            InferenceRun { convention: self.convention, beliefs: self.beliefs, forms: forms(self.dense) };
        let report = notebook.infer(run, &mut teller())?;
        for (number, step) in report.result.steps().iter().enumerate() {
            if let Some(impossible) = &step.impossible {
                eprintln!("note: observation {number}: {impossible}");
            }
        }
        print(&(serde_json::to_string(&report)? + "\n"))?;
        Ok(())
    }
}

impl Export {
    pub(super) fn run(&self) -> Result<(), Failure> {
        if let Some(text) = super::task::text_of(&self.model)? {
            if self.name.is_some() || self.dense {
                return Err(format!("{}: a task is exported without --name and --dense", self.model).into());
            }
            return super::task::export(&self.model, &text);
        }
        let mut notebook = notebook(&self.model)?;
        if let Some(name) = &self.name {
            notebook = notebook.named(name);
        }
        print(&notebook.to_rust(forms(self.dense))?)?;
        Ok(())
    }
}

fn forms(dense: bool) -> Forms {
    if dense { Forms::Dense } else { Forms::Structured }
}

fn notebook(name: &str) -> Result<Notebook, Failure> {
    Ok(Notebook::read(name, &read(name, MAX_BYTES)?)?)
}

/// Shows the progress of a long run on a terminal.
fn teller() -> impl FnMut(InferenceProgress) + Send {
    let mut last = Instant::now();
    let watched = io::stderr().is_terminal();
    move |progress| {
        if watched && last.elapsed() >= PATIENCE {
            last = Instant::now();
            let InferenceProgress { step, steps, policy, policies } = progress;
            eprintln!("observation {} of {steps}, policy {policy} of {policies}", step + 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        infer: Infer,
    }

    #[test]
    fn conventions_have_the_names_of_the_tools_too() {
        let convention = |name: &str| {
            Line::try_parse_from(["infer", "m.json", "--convention", name])
                .ok()
                .map(|line| line.infer.convention)
        };
        assert_eq!(convention("numpy-pymdp"), Some(Convention::Joint));
        assert_eq!(convention("jax-pymdp"), Some(Convention::PerModality));
        assert_eq!(convention("as-printed"), Some(Convention::AsPrinted));
        assert_eq!(convention("spm"), None);
    }

    #[test]
    fn a_missing_file_is_named() {
        let refusal = notebook("nowhere.json").map_or_else(|error| error.to_string(), |_| String::new());
        assert!(refusal.starts_with("nowhere.json: "));
    }
}
