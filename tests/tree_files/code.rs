//! Rust source from trees; what is checked in is compiled and run here.

use super::*;
use iibt_core::time::Instant;
use iibt_core::tree::{Halt, Leaves, Memory, Status};

const PATROL: &str = include_str!("patrol.xml");

#[test]
fn the_checked_in_source_is_what_is_written_today() {
    assert_eq!(instance(PATROL).codegen().unwrap(), include_str!("patrol.rs"));
    let t21 = library::find("t21").unwrap().unwrap();
    let t21 = Instance::of(&t21, "T21").unwrap();
    assert_eq!(t21.codegen().unwrap(), include_str!("t21.rs"));
}

struct Robot(Vec<patrol::Leaf>);

impl Leaves<patrol::Leaf> for Robot {
    fn condition(&mut self, leaf: &patrol::Leaf, _: Instant) -> bool {
        self.0.push(*leaf);
        *leaf != patrol::Leaf::BatteryOk
    }

    fn on_start(&mut self, leaf: &patrol::Leaf, now: Instant) -> Status {
        self.on_running(leaf, now)
    }

    fn on_running(&mut self, leaf: &patrol::Leaf, _: Instant) -> Status {
        self.0.push(*leaf);
        Status::Running
    }

    fn on_halted(&mut self, _: &patrol::Leaf, _: Instant) -> Halt {
        Halt::Done
    }
}

#[test]
fn the_source_compiles_and_does_what_the_dry_run_does() {
    let mut robot = Robot(Vec::new());
    let status = patrol::TREE.tick(&mut Memory::new(), &mut robot, Instant(0)).status;
    assert_eq!(
        (status, robot.0.as_slice()),
        (Status::Running, &[patrol::Leaf::BatteryOk, patrol::Leaf::MoveTo][..])
    );
    let record = dry_run(&instance(PATROL), 1, &[("BatteryOk", "F"), ("MoveTo", "R")]);
    assert_eq!(record.text, "tick 1: BatteryOk:F MoveTo:R => RUNNING\n");
    assert_eq!(patrol::Leaf::BatteryOk.limit(), Some(0.2));
    assert_eq!(patrol::Leaf::MoveTo.goal(), Some(patrol::Port::Entry(patrol::Entry::Dock)));
    assert_eq!(patrol::Leaf::Home.goal(), Some(patrol::Port::Constant("origin")));
    assert_eq!(t21::NODES, 21);
    assert_eq!(t21::TREE.visits(), 21);
}

#[test]
fn what_firmware_cannot_have_is_refused_with_its_place() {
    let refusal = |root: &str| instance(&file(root)).codegen().err().map(|error| error.to_string());
    let post = "\n<L name=\"a\" s=\"S\" _onHalted=\"x := 1\"/>";
    let expected =
        "f:2:19: error: _onHalted: scripts that run after a node are not translated: let the leaf do it";
    assert_eq!(refusal(post).as_deref(), Some(expected));
    let dead = "<Fallback><AlwaysSuccess/>\n<L name=\"a\" s=\"S\"/></Fallback>";
    let expected = "f:2:1: error: no tick can reach this node: the compiler refuses it";
    assert_eq!(refusal(dead).as_deref(), Some(expected));
}
