//! Tree files: what is read, what is refused, and that trees behave as in BehaviorTree.CPP.

use host_sim::tree::{
    self, Diagnostic, Document, DryRecord, DryRun, Extras, Instance, LoadError, Mode, Severity, Statuses,
    library,
};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

#[path = "tree_files/binding.rs"]
mod binding;
#[path = "tree_files/built_in.rs"]
mod built_in;
#[path = "tree_files/code.rs"]
mod code;
#[path = "tree_files/fuzzing.rs"]
mod fuzzing;
#[path = "tree_files/includes.rs"]
mod includes;
#[path = "tree_files/pictures.rs"]
mod pictures;
#[path = "tree_files/records.rs"]
mod records;
#[path = "tree_files/refusals.rs"]
mod refusals;
#[path = "tree_files/replays.rs"]
mod replays;
#[path = "tree_files/traces.rs"]
mod traces;
// What a program would not use of it is no concern here.
#[allow(dead_code, unreachable_pub)]
#[path = "tree_files/patrol.rs"]
mod patrol;
#[allow(dead_code, unreachable_pub)]
#[path = "tree_files/t21.rs"]
mod t21;

fn document(text: &str) -> Document {
    Document::parse("f", text, &Extras::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn instance(text: &str) -> Instance {
    let document = document(text);
    let main = document.main_tree(None).unwrap_or_else(|error| panic!("{error}"));
    Instance::of(&document, &main).unwrap_or_else(|remarks| panic!("{remarks:?}"))
}

/// A file with one tree.
fn file(root: &str) -> String {
    format!("<root BTCPP_format=\"4\"><BehaviorTree ID=\"Main\">{root}</BehaviorTree></root>")
}

/// What a check says about a file, one remark a line.
fn remarks(text: &str) -> String {
    let found = match Document::parse("f", text, &Extras::default()) {
        Ok(document) => tree::check(&document, None),
        Err(error) => vec![error],
    };
    found.iter().map(Diagnostic::to_string).collect::<Vec<_>>().join("\n")
}

fn dry_run(instance: &Instance, ticks: u32, leaves: &[(&str, &str)]) -> DryRecord {
    let leaves: Vec<(String, Statuses)> =
        leaves.iter().map(|(name, part)| ((*name).to_owned(), part.parse().unwrap())).collect();
    let settings = DryRun {
        ticks,
        mode: Mode::ExactlyOnce,
        tick_ms: 10,
        leaves: &leaves,
        halt_after: None,
        compat: false,
    };
    settings.run(instance).unwrap_or_else(|error| panic!("{error}"))
}
