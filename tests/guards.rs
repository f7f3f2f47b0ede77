//! The guards on which safety rests. Each is taken out of a copy of the code in turn, and the test
//! that names what it is for must fail.
//!
//! A copy holds every guard of a table beside what stands there without it, and is built once:
//! which guard is out is told to each run. `tests/nightly` does it; the tables themselves are
//! checked with the other tests.

mod doubt;
mod inference;
mod rounds;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// One guard.
struct Guard {
    name: &'static str,
    file: &'static str,
    /// The code that is the guard, once in its file, and what stands there without it: expressions
    /// or statements.
    code: &'static str,
    without: &'static str,
    /// A test that fails without it, after its module.
    caught_by: &'static str,
}

const fn guard(
    name: &'static str,
    file: &'static str,
    code: &'static str,
    without: &'static str,
    caught_by: &'static str,
) -> Guard {
    Guard { name, file, code, without, caught_by }
}

/// Guards, and the copy in which they are taken out: a workspace of its own.
struct Table {
    name: &'static str,
    guards: &'static [Guard],
    /// The file of a module with tests.
    file_of: fn(&str) -> String,
    /// The packages beside that of the tests.
    packages: &'static [&'static str],
    /// What is copied of the package of the tests.
    tests: &'static [&'static str],
    /// What its manifest says of its library, its tests and its dependencies.
    manifest: &'static str,
    /// Its one file that is not copied.
    root: (&'static str, &'static str),
    /// What Cargo tests.
    targets: &'static [&'static str],
}

const TABLES: [Table; 3] = [rounds::TABLE, doubt::TABLE, inference::TABLE];

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

#[test]
fn every_guard_is_where_the_table_says_and_has_a_test() {
    for table in TABLES {
        for Guard { name, file, code, without, caught_by } in table.guards {
            let source = fs::read_to_string(Path::new(ROOT).join(file)).expect(file);
            assert_eq!(source.matches(code).count(), 1, "{name}: {code:?} in {file}");
            assert_ne!(code, without, "{name}");
            let (module, test) = caught_by.split_once("::").expect("a module and a test");
            let tests = fs::read_to_string(Path::new(ROOT).join((table.file_of)(module))).expect(module);
            assert!(tests.contains(&format!("fn {test}() {{")), "{name}: no test {caught_by}");
        }
    }
}

#[test]
#[ignore = "a build of the core and a run for each guard: tests/nightly"]
fn no_guard_of_the_rounds_can_be_taken_out_unseen() {
    rounds::TABLE.take_out_each();
}

#[test]
#[ignore = "a build of the simulator and a run for each guard: tests/nightly"]
fn no_guard_of_a_robot_in_doubt_can_be_taken_out_unseen() {
    doubt::TABLE.take_out_each();
}

#[test]
#[ignore = "a build of the simulator and a run for each guard: tests/nightly"]
fn no_part_of_inference_can_be_taken_out_unseen() {
    inference::TABLE.take_out_each();
}

impl Table {
    fn take_out_each(&self) {
        let copy = Path::new(env!("CARGO_TARGET_TMPDIR")).join("guards").join(self.name);
        self.copy(&copy);
        self.make_guards_removable(&copy);
        let build = self.cargo(&copy, &["--no-run"]).output().expect("cargo starts");
        assert!(build.status.success(), "{}", String::from_utf8_lossy(&build.stderr));
        assert!(self.passes(&copy, "", None), "the copy passes as it is");
        let is_missed = |&(number, guard): &(usize, &Guard)| {
            let (_, test) = guard.caught_by.split_once("::").expect("a module and a test");
            let is_missed = !self.passes(&copy, test, Some(number));
            println!("{}: {}", guard.name, if is_missed { guard.caught_by } else { "NOT CAUGHT" });
            is_missed
        };
        let unseen = self.guards.iter().enumerate().filter(|guard| !is_missed(guard));
        assert_eq!(unseen.map(|(_, guard)| guard.name).collect::<Vec<_>>(), [""; 0]);
    }

    /// Puts a choice in the place of each guard: the code that is the guard, or what stands there
    /// without it.
    fn make_guards_removable(&self, copy: &Path) {
        for (number, Guard { file, code, without, .. }) in self.guards.iter().enumerate() {
            // A place can have several guards: only the first of them brings the code.
            if self.guards[..number].iter().any(|other| (other.file, other.code) == (*file, *code)) {
                continue;
            }
            let path = copy.join(file);
            let source = fs::read_to_string(&path).expect("it was copied");
            let others = self.guards.iter().enumerate().skip(number + 1);
            let others = others.filter(|(_, other)| (other.file, other.code) == (*file, *code));
            let more: String = others
                .map(|(number, other)| format!("else if {IS_OUT}({number}) {{ {} }} ", other.without))
                .collect();
            let choice = format!("{{ if {IS_OUT}({number}) {{ {without} }} {more}else {{ {code} }} }}");
            fs::write(path, source.replace(code, &choice)).expect("the copy can be written");
        }
        let library = copy.join("iibt-core/src/lib.rs");
        let source = fs::read_to_string(&library).expect("it was copied");
        let source = source.replacen("#[cfg(test)]\nextern crate std;", "extern crate std;", 1);
        fs::write(library, format!("{source}{CHOICE}")).expect("the copy can be written");
        // What asks for a choice is no constant.
        let view = copy.join(rounds::VIEW);
        let source = fs::read_to_string(&view).expect("it was copied");
        fs::write(view, source.replace("const fn is_quorum", "fn is_quorum"))
            .expect("the copy can be written");
    }

    /// Whether the tests of the copy with this name pass, without the guard of this number.
    fn passes(&self, copy: &Path, name: &str, out: Option<usize>) -> bool {
        let mut command = self.cargo(copy, &["--", name]);
        if let Some(guard) = out {
            command.env("GUARD_OUT", guard.to_string());
        }
        command.output().expect("cargo starts").status.success()
    }

    /// The tests of the copy.
    fn cargo(&self, copy: &Path, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO"));
        command
            .current_dir(copy)
            .args(["test", "--offline"])
            .args(self.targets)
            .args(arguments)
            .env_remove("RUSTFLAGS")
            .env_remove("GUARD_OUT");
        command
    }

    fn copy(&self, to: &Path) {
        let _ = fs::remove_dir_all(to);
        let tests = self.tests.iter().map(|part| format!("tests/{part}"));
        for part in self.packages.iter().map(|&package| package.to_owned()).chain(tests) {
            copy(&Path::new(ROOT).join(&part), &to.join(&part));
        }
        for file in ["Cargo.lock", "rust-toolchain.toml", "README.md"] {
            fs::copy(Path::new(ROOT).join(file), to.join(file)).expect(file);
        }
        let write = |file: &str, text: &str| fs::write(to.join(file), text).expect("it can be written");
        write("Cargo.toml", &self.workspace());
        write("tests/Cargo.toml", &format!("{PACKAGE}{}", self.manifest));
        write(&format!("tests/{}", self.root.0), self.root.1);
    }

    /// The manifest of the workspace, with the packages of the copy.
    fn workspace(&self) -> String {
        let workspace = fs::read_to_string(format!("{ROOT}/Cargo.toml")).expect("there is a manifest");
        let is_elsewhere =
            |line: &&str| !["members", "default-members"].iter().any(|key| line.starts_with(key));
        let workspace: Vec<&str> = workspace.lines().filter(is_elsewhere).collect();
        let members: String = self.packages.iter().map(|package| format!("{package:?}, ")).collect();
        let members = format!("[workspace]\nmembers = [{members}\"tests\"]");
        let workspace = workspace.join("\n").replacen("[workspace]", &members, 1);
        if self.packages.contains(&"host-sim") {
            return workspace;
        }
        workspace.replacen("[profile.dev.package.host-sim]\nopt-level = 2\n", "", 1)
    }
}

/// Asks whether the guard of a number is out, in the core and in what uses it.
const IS_OUT: &str = "::iibt_core::is_out";

const CHOICE: &str = r#"
extern crate self as iibt_core;

/// Whether the guard of this number is out, by the environment.
pub fn is_out(guard: usize) -> bool {
    static OUT: std::sync::OnceLock<Option<usize>> = std::sync::OnceLock::new();
    *OUT.get_or_init(|| std::env::var("GUARD_OUT").ok()?.parse().ok()) == Some(guard)
}
"#;

const PACKAGE: &str = r#"
[package]
name = "tests"
version = "0.0.0"
edition = "2024"
autotests = false
"#;

fn copy(from: &Path, to: &Path) {
    if from.is_file() {
        fs::copy(from, to).expect("the copy can be written");
        return;
    }
    fs::create_dir_all(to).expect("the copy can be written");
    for entry in fs::read_dir(from).expect("the folder is there") {
        let path: PathBuf = entry.expect("it can be read").path();
        copy(&path, &to.join(path.file_name().expect("it has a name")));
    }
}
