//! The boards: what the image takes on each of them, packages of one's own that depend on the
//! firmware, and the examples.

use firmware::page::Slots;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::{env, fs};
use tests::budgets::assert_within;
use tests::elf::Elf;
use tests::qemu::{Robot, image_for, reduced_image};
use tests::rig::demo_page;

const CORTEX_M4F: &str = "thumbv7em-none-eabihf";
const RISC_V: &str = "riscv32imc-unknown-none-elf";

#[test]
fn the_image_is_within_budget_on_each_board() {
    let others = [("nrf52840", CORTEX_M4F), ("nrf52840-radio", CORTEX_M4F), ("rp2040", "thumbv6m-none-eabi")];
    for (board, target) in others {
        let elf = Elf::read(&image_for("team_member", "firmware", target, board));
        assert_within(board, "flash", elf.flash);
        assert_within(board, "ram", elf.ram);
        assert_eq!(elf.symbols_with(&["panick"]).collect::<Vec<_>>(), Vec::<&str>::new(), "{board}");
    }
}

/// 64 KiB of flash and 20 KiB of RAM, the page and the stack included. Compiled for size alone,
/// `postcard` keeps a check of an index that is always in range; there is no other.
#[test]
fn the_reduced_image_fits_the_smallest_board() {
    let elf = Elf::read(&reduced_image());
    assert_within("nrf51822", "flash", elf.flash);
    assert_within("nrf51822", "ram", elf.ram);
    let panics: Vec<_> = elf.symbols_with(&["panick"]).collect();
    assert!(matches!(panics[..], [only] if only.ends_with("9panic_fmt")), "{panics:?}");
    let mut checks = elf.symbols_with(&["SliceIndex"]);
    assert!(checks.all(|check| check.contains("RangeToInclusive")));
    let [bottom, top] = ["_stack_end", "_stack_start"].map(|symbol| elf.value_of(symbol));
    assert!(elf.flash <= u64::from(Slots::NRF51822.first) && Slots::NRF51822.second + 1024 == 64 << 10);
    assert!(top - bottom + elf.ram + 16 <= 20 << 10, "the stack, the statics, and why the last run ended");
}

/// The HAL of the ESP32-C3 panics where it finds the chip or its own calls wrong. Nothing else in
/// the image may: of the files that its panics name, each belongs to the HAL, but for the
/// formatting of what they say.
#[test]
fn only_the_hal_of_the_esp32c3_has_panicking_branches() {
    let elf = Elf::read(&image_for("team_member", "firmware", RISC_V, "esp32c3"));
    assert_within("esp32c3", "flash", elf.flash);
    assert_within("esp32c3", "ram", elf.ram);
    let hal = ["/esp-hal-", "/esp-sync-", "/esp-rom-sys-", "/esp32c3-", "/riscv-", "/core/src/"];
    let is_of_hal = |file: &&String| hal.iter().any(|part| file.contains(part));
    let others: Vec<_> = elf.sources.iter().filter(|file| !is_of_hal(file)).collect();
    assert!(elf.sources.iter().any(|file| file.contains("/esp-hal-")), "the files are found");
    assert_eq!(others, Vec::<&String>::new());
}

/// A copy of `examples/board` outside of the workspace, in a folder of its own.
struct Outside(PathBuf);

impl Outside {
    fn new(name: &str) -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the workspace");
        let folder = env::temp_dir().join(format!("iibt-{name}-{}", std::process::id()));
        fs::create_dir_all(folder.join("src")).expect("a folder");
        for file in ["build.rs", "memory.x", "src/main.rs"] {
            fs::copy(root.join("examples/board").join(file), folder.join(file)).expect("a copy");
        }
        fs::copy(root.join("Cargo.lock"), folder.join("Cargo.lock")).expect("a copy");
        let manifest = fs::read_to_string(root.join("examples/board/Cargo.toml")).expect("a manifest");
        let manifest = manifest.replace("../..", root.to_str().expect("a path of UTF-8"));
        fs::write(folder.join("Cargo.toml"), manifest).expect("a manifest");
        Self(folder)
    }

    fn build(&self) -> Output {
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("outside");
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["build", "--release", "--offline", "--target", CORTEX_M4F, "--target-dir"]).arg(target);
        cargo.current_dir(&self.0).env("DEFMT_LOG", "info").output().expect("cargo starts")
    }

    fn image() -> PathBuf {
        Path::new(env!("CARGO_TARGET_TMPDIR")).join("outside").join(CORTEX_M4F).join("release/own-board")
    }
}

impl Drop for Outside {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Without a memory map a package must not link: with that of another board it would, in silence.
#[test]
fn a_board_of_ones_own_runs_with_its_own_memory_map_only() {
    let own = Outside::new("board");
    fs::rename(own.0.join("memory.x"), own.0.join("elsewhere.x")).expect("it is renamed");
    let output = own.build();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && told.contains("cannot find linker script memory.x"), "{told}");

    fs::rename(own.0.join("elsewhere.x"), own.0.join("memory.x")).expect("it is renamed");
    let output = own.build();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let elf = Elf::read(&Outside::image());
    assert_eq!(elf.symbols_with(&["panick"]).collect::<Vec<_>>(), Vec::<&str>::new());
    let mut robot = Robot::boot_on("mps2-an386", &Outside::image(), (0x20_0000, &demo_page(0)));
    robot.wait_for("boot: robot 1 of 2");
    robot.wait_for("took");
    assert!(robot.receive().len() > 10, "it announces what it knows");
}

#[test]
fn a_board_of_ones_own_takes_at_most_fifty_lines() {
    let source = include_str!("../examples/board/src/main.rs");
    let is_code = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with("//");
    assert!(source.lines().filter(is_code).count() <= 50);
}

#[test]
fn the_controller_runs_in_embassy_and_in_rtic() {
    for example in ["embassy-robot", "rtic-robot"] {
        let mut robot = Robot::boot_with_page(
            &tests::qemu::image_of(example, example, "firmware", CORTEX_M4F, None),
            &demo_page(0),
        );
        robot.wait_for("boot: robot 1 of 2");
        robot.wait_for("took");
        assert!(robot.receive().len() > 10, "{example}: it announces what it knows");
    }
}
