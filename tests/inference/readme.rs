//! The README's twenty lines on inference cannot be made wrong by changing a number: the build
//! fails, or a typed error names what does not fit, or it is another model that is as sound.

use std::process::Command;
use tests::package::Package;

/// The first Rust code in the README.
fn code() -> String {
    let text = include_str!("../../README.md");
    let (_, rest) = text.split_once("## The core in twenty lines\n\n```rust\n").expect("the section");
    let (code, _) = rest.split_once("```").expect("the end of the code");
    code.lines().map(|line| line.strip_prefix("# ").unwrap_or(line)).collect::<Vec<_>>().join("\n")
}

/// The changes: a piece of the code, its replacement, and the expected result.
const CHANGES: &[(&str, &str, &str)] = &[
    ("new(0.9, 5)", "new(1.9, 5)", "`correct` is no probability"),
    ("new(0.9, 5)", "new(0.9, 4)", "C, the preference, does not have an entry per outcome"),
    ("new(0.9, 5)", "new(0.9, 6)", "C, the preference, does not have an entry per outcome"),
    ("[0, 0, 1, 2, 3,", "[5, 0, 1, 2, 3,", "B, the transition: a next state is out of range"),
    ("[0, 0, 1, 2, 3,", "[0, 0, 1, 2, 3, 3,", "does not have a next state for each state and action"),
    ("4, 4], 5, 0.05", "4, 4], 4, 0.05", "B, the transition"),
    ("4, 4], 5, 0.05", "4, 4], 10, 0.05", "D, the prior, does not have an entry per state"),
    ("4, 4], 5, 0.05", "4, 4], 0, 0.05", "does not have a next state for each state and action"),
    ("4, 4], 5, 0.05", "4, 4], 5, 1.05", "the slip is no probability"),
    ("[Factor; 1]", "[Factor; 2]", "mismatched types"),
    ("[0.2; 5]", "[0.3; 5]", "D, the prior, is no distribution"),
    ("[0.2; 5]", "[0.25; 4]", "D, the prior, does not have an entry per state"),
    ("[Modality; 1]", "[Modality; 2]", "mismatched types"),
    ("&[0], &[0.0,", "&[1], &[0.0,", "a modality depends on a factor that does not exist"),
    ("&[0], &[0.0,", "&[0, 0], &[0.0,", "A, the likelihood, needs a factor for each condition"),
    ("0.0, 1.0])];", "0.0, f32::NAN])];", "C, the preference, has a value that is not finite"),
    ("0.0, 1.0])];", "0.0, 0.0, 1.0])];", "C, the preference, does not have an entry per outcome"),
    ("[Policy; 2]", "[Policy; 3]", "mismatched types"),
    ("of(&[1, 1])", "of(&[1, 16])", "a policy has too many actions, or one of 16 or above"),
    ("of(&[1, 1])", "of(&[1; 65])", "a policy has too many actions, or one of 16 or above"),
    ("of(&[1, 1])", "of(&[1, 2])", "control 0 has no action 2: there are 2, from 0"),
    ("agent!(MODEL, 2)", "agent!(MODEL, 0)", "an agent needs a policy to choose"),
    ("agent!(MODEL, 2)", "agent!(MODEL, 70_000)", "an agent has more than 65,535 joint policies"),
    ("agent!(MODEL, 2)", "agent!(MODEL, 1)", "there are 2 joint policies, but the evaluation has room for 1"),
    ("agent!(MODEL, 2)", "agent!(MODEL, 3)", FINE),
    ("Outcome(2)", "Outcome(5)", "modality 0 has no outcome 5: there are 5, from 0"),
    ("most_likely(0)", "most_likely(1)", "there is no factor 1: there are 1, from 0"),
    // Sound models of other corridors, in which the same things hold.
    ("new(0.9, 5)", "new(0.8, 5)", FINE),
    ("5, 0.05", "5, 0.1", FINE),
    ("0.0, 1.0])];", "0.0, 2.0])];", FINE),
];

const FINE: &str = "";

/// A package with a program for each change.
fn package() -> Package {
    let code = code();
    let programs = CHANGES.iter().enumerate().map(|(number, (piece, instead, _))| {
        assert_eq!(code.matches(piece).count(), 1, "{piece} stands in the README once");
        let body = code.replace(piece, instead);
        let body = body.replace("Ok::<(), Box<dyn std::error::Error>>(())", "Ok(())");
        let program = format!(
            "fn run() -> Result<(), Box<dyn std::error::Error>> {{\n{body}\n}}\n\
             fn main() {{\n    if let Err(error) = run() {{\n        eprintln!(\"{{error}}\");\n        \
             std::process::exit(1);\n    }}\n}}\n"
        );
        (format!("bin/change_{number}.rs"), program)
    });
    Package::new(concat!(env!("CARGO_TARGET_TMPDIR"), "/readme"), programs)
}

#[test]
fn every_number_is_checked() {
    let package = package();
    let program = |number: usize| package.program(&format!("change_{number}"));
    // Programs of an earlier run would be taken for what is built now.
    (0..CHANGES.len()).for_each(|number| drop(std::fs::remove_file(program(number))));
    let build = package.cargo(&["build", "--bins", "--keep-going"]);
    let said = String::from_utf8_lossy(&build.stderr).into_owned();
    for (number, (piece, instead, expected)) in CHANGES.iter().enumerate() {
        let outcome = if program(number).exists() {
            let run = Command::new(program(number)).output().expect("it runs");
            let error = String::from_utf8_lossy(&run.stderr).into_owned();
            assert!(!error.contains("panicked"), "{piece} to {instead}: {error}");
            assert_eq!(run.status.success(), expected.is_empty(), "{piece} to {instead}: {error}");
            error
        } else {
            assert!(!expected.is_empty(), "{piece} to {instead} does not build:\n{said}");
            let from = format!("src/bin/change_{number}.rs:");
            let parts = said.split("\nerror").filter(|part| part.contains(&from));
            parts.collect::<Vec<_>>().join("\nerror")
        };
        println!("{piece} to {instead}: {}", outcome.lines().next().unwrap_or("as sound"));
        assert!(outcome.contains(expected), "{piece} to {instead}: {outcome}");
    }
}
