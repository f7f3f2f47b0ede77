//! A light that blinks, and stays on while a button is held: a tree of a dozen lines, without
//! inference.
//!
//! `cargo run -p iibt-core --no-default-features --example blink` plays it on the PC, with a button
//! that is held from 1.2 to 2 seconds; on a board, `Board` owns two pins, and `now` comes from a
//! timer.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[macro_use]
mod chip;

use iibt_core::time::Instant;
use iibt_core::tree;
use iibt_core::tree::{Full, Halt, Leaves, Memory, Next, Status, Tree};

#[derive(Clone, Copy)]
enum Skill {
    ButtonHeld,
    On,
    Off,
}

#[rustfmt::skip]
static BLINK: Tree<Skill, 9, Full> = tree! {
    ReactiveFallback {
        Sequence { Condition(Skill::ButtonHeld), Action(Skill::On) },
        Sequence { Action(Skill::On), Sleep(250), Action(Skill::Off), Sleep(250) },
    }
};

struct Board {
    held: bool,
    light: bool,
}

impl Leaves<Skill> for Board {
    fn condition(&mut self, _: &Skill, _: Instant) -> bool {
        self.held
    }

    fn on_start(&mut self, leaf: &Skill, _: Instant) -> Status {
        self.light = matches!(leaf, Skill::On);
        Status::Success
    }

    fn on_running(&mut self, leaf: &Skill, now: Instant) -> Status {
        self.on_start(leaf, now)
    }

    fn on_halted(&mut self, _: &Skill, _: Instant) -> Halt {
        Halt::Done
    }
}

fn play() {
    let mut board = Board { held: false, light: false };
    let mut memory = Memory::new();
    let mut now = Instant(0);
    let (mut switched, mut count) = ([0; 8], 0);
    while now.0 < 3000 {
        board.held = (1200..2000).contains(&now.0);
        let before = board.light;
        let tick = BLINK.tick(&mut memory, &mut board, now);
        if board.light != before {
            show!("{:4} ms: {}", now.0, if board.light { "on" } else { "off" });
            switched[count] = now.0;
            count += 1;
        }
        // A board sleeps until a timer or the pin of the button wakes it; here it looks every 100
        // ms.
        now = match tick.next {
            _ if board.held => Instant(now.0 + 100),
            _ if tick.status == Status::Success => now, // the next cycle begins at once
            Next::At(due) if due.0 - now.0 < 100 => due,
            _ => Instant(now.0 + 100),
        };
    }
    // It blinks twice a second, stays on while the button is held, and then starts its cycle again.
    assert_eq!(switched, [0, 250, 500, 750, 1000, 2250, 2500, 2750]);
}

play!(play);
