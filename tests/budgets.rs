//! What the released image takes of its chip, held against `budgets.toml` and what README says.

use serde_json::Value;
use tests::elf::Elf;
use tests::qemu::{Robot, number, team_member};
use tests::rig::{robot, tick};

const BUDGETS: &str = include_str!("budgets.toml");
const README: &str = include_str!("../README.md");

fn budget(figure: &str) -> u64 {
    let budgets: Value = toml::from_str(BUDGETS).expect("budgets.toml is TOML");
    budgets["team_member"][figure].as_u64().unwrap_or_else(|| panic!("budgets.toml has {figure}"))
}

/// A number the way README prints it: `12,345`.
fn with_commas(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|group| core::str::from_utf8(group).unwrap()).collect();
    groups.join(",")
}

fn assert_within(figure: &str, measured: u64) {
    let budget = budget(figure);
    println!("team_member: {figure} {measured} of {budget}");
    assert!(measured <= budget, "{figure}: {measured} is over the budget of {budget}");
    assert!(measured * 100 >= budget * 95, "{figure}: {measured}: lower the budget of {budget}");
    assert!(README.contains(&with_commas(budget)), "README does not say {figure} {}", with_commas(budget));
}

#[test]
fn flash_and_ram_are_within_budget() {
    let elf = Elf::read(team_member());
    assert_within("flash", elf.flash);
    assert_within("ram", elf.ram);
}

/// The instructions of the tick that the image logs next: an instruction takes a nanosecond there, and the
/// timer whose cycles it counts runs at 168 MHz.
fn instructions(image: &mut Robot) -> u64 {
    let line = image.wait_for("took").message;
    u64::from(number(&line, "took ")) * 1000 / 168
}

#[test]
fn instructions_per_tick_are_within_budget() {
    let mut image = Robot::boot_counting(team_member());
    assert_within("ordinary_tick", instructions(&mut image));
    image.send(&tick(&mut robot(1), &[]));
    image.wait_for("Announced");
    assert_within("deciding_tick", instructions(&mut image));
}

#[test]
fn the_image_has_no_allocator() {
    let elf = Elf::read(team_member());
    let allocator = ["__rust_alloc", "__rg_alloc", "__rust_realloc", "malloc", "alloc5alloc"];
    assert_eq!(elf.symbols_with(&allocator).collect::<Vec<_>>(), Vec::<&str>::new());
}

#[test]
fn the_image_has_no_panicking_branch() {
    let elf = Elf::read(team_member());
    assert_eq!(elf.symbols_with(&["panick"]).collect::<Vec<_>>(), Vec::<&str>::new());
}

#[test]
fn the_checks_find_what_they_look_for() {
    let elf = Elf::read(&tests::qemu::image("fault"));
    assert!(
        elf.symbols_with(&["panick"]).count() > 0,
        "the image that panics on purpose has a panicking branch"
    );
    assert!(elf.flash > 1000 && elf.ram > 1000);
}
