//! The resources that the released image takes, checked against `budgets.toml` and README.

use iibt_core::team::{SipHash64, decode};
use tests::budgets::{assert_stack_within, assert_within};
use tests::elf::Elf;
use tests::qemu::{Robot, number, team_member};
use tests::rig::{Message, OnHost, demo_keys, demo_page};

#[test]
fn flash_and_ram_are_within_budget() {
    let elf = Elf::read(team_member());
    assert_within("team_member", "flash", elf.flash);
    assert_within("team_member", "ram", elf.ram);
}

/// What the image has of one form of the tree: what is called by the form's name, and the leaves.
fn flash_of(elf: &Elf, form: impl Fn(&str) -> bool) -> u64 {
    elf.size_of(|name| name.contains("tree_budget6leaves") || form(name))
}

#[test]
fn a_tree_is_within_its_budget() {
    let elf = Elf::read(&tests::qemu::image("tree_budget"));
    let is_compiled = |name: &str| name.contains("tree_budget8compiled") || name.contains("tree8compiled");
    let is_engine = |name: &str| name.contains("iibt_core4tree") && !is_compiled(name);
    let is_table = |name: &str| name.contains("tree_budget5table") || is_engine(name);
    assert_within("tree", "flash_table", flash_of(&elf, is_table));
    assert_within("tree", "flash_compiled", flash_of(&elf, is_compiled));
    assert_within("tree", "ram_per_node", iibt_core::tree::Memory::<21>::BYTES as u64 / 21);
}

/// The instructions of the tick that the image logs next: an instruction takes a nanosecond there,
/// and the timer whose cycles it counts runs at 168 MHz.
fn instructions(image: &mut Robot) -> u64 {
    let line = image.wait_for("took").message;
    u64::from(number(&line, "took ")) * 1000 / 168
}

#[test]
fn instructions_per_tick_are_within_budget() {
    let mut image = Robot::boot_counting_with_page(team_member(), &demo_page(0));
    assert_within("team_member", "ordinary_tick", instructions(&mut image));
    let mut second = OnHost::robot(1);
    image.send(&second.tick(&[]));
    image.wait_for("Announced");
    assert_within("team_member", "listing_tick", instructions(&mut image));
    agree(&mut image, &mut second);
    assert_within("team_member", "deciding_tick", instructions(&mut image));
}

/// Answers with the scores of the other robot until the image has come to an agreement with it.
fn agree(image: &mut Robot, second: &mut OnHost) {
    let has_scored = |frame: &[u8]| {
        let frame =
            decode::<Message>(&frame[1..frame.len() - 1], &SipHash64::with(demo_keys()), second.context());
        frame.expect("it is authentic").message.rounds.answer.digest().is_some()
    };
    let scored = (0..100).map(|_| image.receive()).find(|frame| has_scored(frame));
    second.tick(&scored.expect("it announces its scores"));
    image.send(&second.tick(&[]));
    image.wait_for("Agreed");
}

/// From the first tick on: listening, listing, scoring, deciding and the first moves, with the
/// interrupts in between.
#[test]
fn the_stack_of_a_tick_is_within_budget() {
    let mut image = Robot::boot_with_page(team_member(), &demo_page(0));
    image.wait_for("took");
    let top = image.pause().paint();
    let mut second = OnHost::robot(1);
    image.send(&second.tick(&[]));
    image.wait_for("Announced");
    agree(&mut image, &mut second);
    image.wait_for("took");
    let used = top - image.pause().lowest_used();
    assert_stack_within("team_member", "stack_of_a_tick", used.into());
}

/// From the reset to the end of the first tick: the board is set up, and the robot is made.
#[test]
fn the_stack_of_the_boot_is_within_budget() {
    let mut image = Robot::boot_stopped(team_member(), &demo_page(0));
    let top = image.pause().paint();
    image.wait_for("took");
    let used = top - image.pause().lowest_used();
    assert_stack_within("team_member", "stack_of_the_boot", used.into());
}

/// Ticks in which nothing is heard and nothing decided.
#[test]
fn the_stack_of_an_ordinary_tick_is_within_budget() {
    let mut image = Robot::boot_with_page(team_member(), &demo_page(0));
    image.wait_for("took");
    let top = image.pause().paint();
    // The frames that left before tell of no tick since.
    image.discard_sent();
    (0..30).for_each(|_| drop(image.receive()));
    let used = top - image.pause().lowest_used();
    assert_stack_within("team_member", "stack_of_an_ordinary_tick", used.into());
}

#[test]
fn the_image_has_no_allocator() {
    let elf = Elf::read(team_member());
    let allocator = ["__rust_alloc", "__rg_alloc", "__rust_realloc", "malloc", "alloc5alloc"];
    assert_eq!(elf.symbols_with(&allocator).collect::<Vec<_>>(), Vec::<&str>::new());
}

#[test]
fn the_images_of_robots_have_no_panicking_branch() {
    for image in ["team_member", "based_member", "based_table_robot"] {
        let elf = Elf::read(&tests::qemu::image(image));
        assert_eq!(elf.symbols_with(&["panick"]).collect::<Vec<_>>(), Vec::<&str>::new(), "{image}");
    }
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
