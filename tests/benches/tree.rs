//! The instructions of a tick of the reference trees on x86-64, as a table, compiled, and written
//! by hand: `cargo bench -p tests --bench tree`. Counted by callgrind, so a busy machine changes
//! nothing; needs valgrind.
//!
//! T21 is four times "unless a condition holds, if another does, act"; T33 tests two conditions and
//! acts twice. In R21 and R33 the composites are reactive and the last action runs for ever. Each
//! leaf looks at a flag and counts.

use iibt_core::time::Instant;
use iibt_core::tree::{Compiled, Halt, Leaves, Memory, Status, Tree};
use iibt_core::{compiled_tree, tree};
use std::env::{args, current_exe};
use std::hint::black_box;
use std::process::{Command, ExitCode};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

const BUDGETS: &str = include_str!("../budgets.toml");

#[derive(Clone, Copy)]
enum Leaf {
    Holds,
    Fails,
    Act,
    Run,
}

static FLAGS: [AtomicBool; 4] = [const { AtomicBool::new(false) }; 4];
static CALLS: AtomicU32 = AtomicU32::new(0);

struct Robot;

fn look(leaf: Leaf) -> bool {
    CALLS.store(CALLS.load(Relaxed).wrapping_add(1), Relaxed);
    FLAGS[leaf as usize].load(Relaxed)
}

impl Leaves<Leaf> for Robot {
    fn condition(&mut self, leaf: &Leaf, _: Instant) -> bool {
        look(*leaf)
    }

    fn on_start(&mut self, leaf: &Leaf, _: Instant) -> Status {
        if look(*leaf) { Status::Success } else { Status::Running }
    }

    fn on_running(&mut self, leaf: &Leaf, now: Instant) -> Status {
        self.on_start(leaf, now)
    }

    fn on_halted(&mut self, leaf: &Leaf, _: Instant) -> Halt {
        look(*leaf);
        Halt::Done
    }
}

macro_rules! t21 {
    ($form:ident, $sequence:ident, $fallback:ident, $last:ident) => {
        $form! { $sequence {
            $fallback { Condition(Leaf::Fails), $sequence { Condition(Leaf::Holds), Action(Leaf::Act) } },
            $fallback { Condition(Leaf::Fails), $sequence { Condition(Leaf::Holds), Action(Leaf::Act) } },
            $fallback { Condition(Leaf::Fails), $sequence { Condition(Leaf::Holds), Action(Leaf::Act) } },
            $fallback { Condition(Leaf::Fails), $sequence { Condition(Leaf::Holds), Action(Leaf::$last) } },
        } }
    };
}

macro_rules! t33 {
    ($form:ident, $sequence:ident, $fallback:ident, $last:ident) => {
        $form! { $sequence {
            $fallback { $sequence { Condition(Leaf::Holds), Condition(Leaf::Fails) },
                $sequence { Condition(Leaf::Holds), Action(Leaf::Act), Action(Leaf::Act) } },
            $fallback { $sequence { Condition(Leaf::Holds), Condition(Leaf::Fails) },
                $sequence { Condition(Leaf::Holds), Action(Leaf::Act), Action(Leaf::Act) } },
            $fallback { $sequence { Condition(Leaf::Holds), Condition(Leaf::Fails) },
                $sequence { Condition(Leaf::Holds), Action(Leaf::Act), Action(Leaf::Act) } },
            $fallback { $sequence { Condition(Leaf::Holds), Condition(Leaf::Fails) },
                $sequence { Condition(Leaf::Holds), Action(Leaf::Act), Action(Leaf::$last) } },
        } }
    };
}

static T21: Tree<Leaf, 21> = t21!(tree, Sequence, Fallback, Act);
static T33: Tree<Leaf, 33> = t33!(tree, Sequence, Fallback, Act);
static R21: Tree<Leaf, 21> = t21!(tree, ReactiveSequence, ReactiveFallback, Run);
static R33: Tree<Leaf, 33> = t33!(tree, ReactiveSequence, ReactiveFallback, Run);

fn part_of_21() -> bool {
    look(Leaf::Fails) || look(Leaf::Holds) && look(Leaf::Act)
}

fn part_of_33() -> bool {
    look(Leaf::Holds) && look(Leaf::Fails) || look(Leaf::Holds) && look(Leaf::Act) && look(Leaf::Act)
}

#[inline(never)]
fn plain_21() -> Status {
    (part_of_21() && part_of_21() && part_of_21() && part_of_21()).into()
}

#[inline(never)]
fn plain_33() -> Status {
    (part_of_33() && part_of_33() && part_of_33() && part_of_33()).into()
}

#[inline(never)]
fn tick<const N: usize>(tree: &Tree<Leaf, N>, memory: &mut Memory<N>) -> Status {
    tree.tick(memory, &mut Robot, Instant(0)).status
}

#[inline(never)]
fn tick_compiled(tree: &mut impl Compiled<Leaf, Robot>) -> Status {
    tree.tick(&mut Robot, Instant(0))
}

fn table<const N: usize>(tree: &Tree<Leaf, N>, ticks: u32) {
    let mut memory = Memory::new();
    (0..ticks).for_each(|_| _ = black_box(tick(tree, &mut memory)));
}

fn compiled(mut tree: impl Compiled<Leaf, Robot>, ticks: u32) {
    (0..ticks).for_each(|_| _ = black_box(tick_compiled(&mut tree)));
}

fn run(form: &str, ticks: u32) {
    for (flag, holds) in FLAGS.iter().zip([true, false, true, false]) {
        flag.store(black_box(holds), Relaxed);
    }
    match form {
        "t21_table" => table(&T21, ticks),
        "t33_table" => table(&T33, ticks),
        "r21_table" => table(&R21, ticks),
        "r33_table" => table(&R33, ticks),
        "t21_compiled" => compiled(t21!(compiled_tree, Sequence, Fallback, Act), ticks),
        "t33_compiled" => compiled(t33!(compiled_tree, Sequence, Fallback, Act), ticks),
        "r21_compiled" => compiled(t21!(compiled_tree, ReactiveSequence, ReactiveFallback, Run), ticks),
        "r33_compiled" => compiled(t33!(compiled_tree, ReactiveSequence, ReactiveFallback, Run), ticks),
        "21_plain" => (0..ticks).for_each(|_| _ = black_box(plain_21())),
        _ => (0..ticks).for_each(|_| _ = black_box(plain_33())),
    }
}

/// The instructions of a process that ticks so often; `None` without valgrind.
fn instructions(form: &str, ticks: u32) -> Option<u64> {
    let ticks = ticks.to_string();
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(current_exe().ok()?)
        .args(["run", form, &ticks])
        .output()
        .ok()?;
    let messages = String::from_utf8(output.stderr).ok()?;
    messages.lines().find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok())
}

/// The instructions of one tick.
fn per_tick(form: &str) -> Option<u64> {
    Some((instructions(form, 1100)? - instructions(form, 100)?) / 1000)
}

fn main() -> ExitCode {
    if let [_, verb, form, ticks] = &*args().collect::<Vec<_>>()
        && verb == "run"
    {
        run(form, ticks.parse().unwrap_or(0));
        return ExitCode::SUCCESS;
    }
    let (Some(plain_21), Some(plain_33)) = (per_tick("21_plain"), per_tick("33_plain")) else {
        println!("valgrind is missing: nothing is measured");
        return ExitCode::SUCCESS;
    };
    println!("instructions a tick; written by hand: {plain_21} (21 nodes), {plain_33} (33 nodes)");
    let budgets: toml::Table = toml::from_str(BUDGETS).expect("budgets.toml is TOML");
    let mut code = ExitCode::SUCCESS;
    for form in ["table", "compiled"] {
        for tree in ["t21", "t33", "r21", "r33"] {
            let name = format!("{tree}_{form}");
            let Some(count) = per_tick(&name) else { continue };
            let ratio = count as f64 / if tree.ends_with("21") { plain_21 } else { plain_33 } as f64;
            let budget = budgets["tree"].get(&name).and_then(toml::Value::as_integer);
            let of = budget.map_or(String::new(), |budget| format!(" of {budget}"));
            println!("{name:<14}{count:>5}{of:<8}{ratio:>6.2} times as many");
            if budget.is_some_and(|budget| count > budget as u64) {
                println!("{name} is over its budget");
                code = ExitCode::FAILURE;
            }
        }
    }
    code
}
