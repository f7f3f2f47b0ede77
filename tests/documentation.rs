//! The files, links and tests that the documents name exist.

use std::fs;
use std::path::{Path, PathBuf};

const DOCUMENTS: [&str; 19] = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "docs/figures.md",
    "docs/flashing.md",
    "docs/hil.md",
    "docs/inference.md",
    "docs/notebook.md",
    "docs/page.md",
    "docs/paper.md",
    "docs/protocol.md",
    "docs/symbols.md",
    "docs/trees.md",
    "docs/your-robot.md",
    "firmware/README.md",
    "host-sim/scenarios/README.md",
    "host-sim/tasks/README.md",
    "host-sim/trees/README.md",
    "iibt-core/README.md",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The text between each pair of back-ticks outside code blocks.
fn quoted(document: &str) -> Vec<String> {
    let prose = document.split("```").step_by(2).collect::<String>();
    prose.split('`').skip(1).step_by(2).map(String::from).collect()
}

/// Where each link of a document leads, but for addresses on the network.
fn links(document: &str) -> Vec<&str> {
    let targets = document.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter(|target| !target.starts_with("http")).collect()
}

/// Every source file of the workspace.
fn sources(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of the workspace").flatten() {
        let (path, name) = (entry.path(), entry.file_name());
        if path.is_dir() && name != "target" && name != ".git" {
            sources(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// Whether a word is the name of a test, which is a sentence.
fn is_sentence(word: &str) -> bool {
    let is_name = word.chars().all(|sign| sign.is_ascii_lowercase() || sign.is_ascii_digit() || sign == '_');
    is_name && word.matches('_').count() >= 3
}

#[test]
fn links_lead_somewhere() {
    for name in DOCUMENTS {
        let path = root().join(name);
        for link in links(&read(&path)) {
            let target = path.with_file_name("").join(link.split('#').next().unwrap_or(link));
            assert!(target.exists(), "{name} links to {link}");
        }
    }
}

#[test]
fn files_that_are_named_exist() {
    for name in DOCUMENTS {
        for word in quoted(&read(&root().join(name))) {
            let is_file = [".rs", ".toml", ".md", ".x"].iter().any(|ending| word.ends_with(ending));
            if is_file && word.contains('/') && !word.contains(' ') {
                assert!(root().join(&word).exists(), "{name} names {word}");
            }
        }
    }
}

#[test]
fn tests_that_are_named_exist() {
    let mut files = vec![];
    sources(&root(), &mut files);
    let code: String = files.iter().map(|file| read(file)).collect();
    let mut named = 0;
    for name in DOCUMENTS {
        for word in quoted(&read(&root().join(name))).iter().filter(|word| is_sentence(word)) {
            assert!(code.contains(&format!("fn {word}(")), "{name} names the test {word}");
            named += 1;
        }
    }
    assert!(named >= 8, "only {named} tests are named: are they still found?");
}

/// Beyond the head of a table, its rule, and its rows in other documents: every row is a statement
/// about the paper.
#[test]
fn every_statement_about_the_paper_names_its_test() {
    let document = read(&root().join("docs/paper.md"));
    let rows: Vec<_> = document.lines().filter(|line| line.starts_with('|')).collect();
    let is_head = |row: usize| {
        rows.get(row + 1).is_some_and(|next| next.starts_with("|---")) || rows[row].starts_with("|---")
    };
    for (index, row) in rows.iter().enumerate().filter(|&(index, _)| !is_head(index)) {
        let last = row.trim_end_matches('|').rsplit('|').next().unwrap_or_default();
        assert!(quoted(last).iter().any(|word| is_sentence(word)), "row {index} names no test: {row}");
    }
    assert!(rows.len() > 50, "only {} rows: are they still found?", rows.len());
}

/// The code in docs/your-robot.md is built for the chip and flown, and it is complete.
#[test]
fn a_robot_of_your_own_is_the_one_that_is_flown() {
    let document = read(&root().join("docs/your-robot.md"));
    let blocks: Vec<_> =
        document.split("```rust\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    let [robot, flight, links, porter] =
        ["src/lib.rs", "tests/flight.rs", "tests/links.rs", "tests/porter.rs"]
            .map(|file| read(&root().join("examples/airlock").join(file)));
    let mut shown = 0;
    for block in blocks {
        let is_flown = [&robot, &flight, &links, &porter].iter().any(|file| file.contains(block));
        assert!(is_flown, "it is not flown: {block}");
        shown += if robot.contains(block) { block.lines().count() } else { 0 };
    }
    assert!(shown + 15 > robot.lines().filter(|line| !line.is_empty()).count(), "{shown} lines are shown");
    let code = robot.lines().map(str::trim_start).filter(|line| !line.is_empty() && !line.starts_with("//"));
    let lines = code.count();
    assert!(document.contains(&format!("The robot has {lines} lines")) && lines <= 60, "it has {lines}");
}
