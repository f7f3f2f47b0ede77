//! The two doors of an airlock, as docs/your-robot.md builds them: own task, own tree, own message.
#![no_std]

use firmware::prelude::*;
use serde::{Deserialize, Serialize};

/// The states of a door.
const OPEN: u8 = 0;
const SHUT: u8 = 1;

/// What both doors have in common: a leaf that is open or shut, and a switch that is right nine
/// times in ten.
const DOOR: Role = Role {
    sensors: &[Sensor::even("switch", Reads::Factor(0), 0.9)],
    ..Role::of(&[HiddenFactor::unknown("leaf", &["open", "shut"])])
};

/// The inner door shuts; the outer one opens once the inner one has announced that it is shut. A
/// drive succeeds nine times in ten.
pub static AIRLOCK: Tables = Tables::new(&[
    Role {
        name: "inner",
        operators: &[Operator::IDLE, Operator::bringing("shut", SHUT, 0.9)],
        facts: &[Fact::sure("shut", 0, &[SHUT])],
        aims: &[Aim::new("shut", &[0], &[0.0, 1.0])],
        ..DOOR
    },
    Role {
        name: "outer",
        operators: &[Operator::IDLE, Operator { requires: &[1], ..Operator::bringing("open", OPEN, 0.9) }],
        facts: &[Fact::sure("open", 0, &[OPEN]), Fact::announced("inner shut", 0, 0, &[SHUT])],
        aims: &[Aim::new("open", &[0], &[1.0, 0.0])],
        ..DOOR
    },
]);

/// What a door tells the other beside its task: the charge of its battery, in percent.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
pub struct Charge(u8);

impl Message for Charge {
    const SCHEMA: &'static str = "airlock: charge u8";
    const MAX_BYTES: usize = 1;
}

/// The leaves of one's own.
#[derive(Clone, Copy)]
pub enum Leaf {
    /// Whether the batteries of both doors are charged.
    BothCharged,
}

/// The tree of both doors.
pub static TREE: Tree<TaskLeaf<Leaf>, 3> = tree! {
    ReactiveSequence { Condition(TaskLeaf::Own(Leaf::BothCharged)), Inference(TaskLeaf::Aim(0)) }
};

/// What a door has beside its tables.
#[derive(Default)]
pub struct DoorSkills {
    charge: Charge,
}

impl<H: Battery> Skills<H> for DoorSkills {
    type Leaf = Leaf;
    type Message = Charge;

    fn sense(&mut self, hardware: &mut H, _: Instant) {
        self.charge = Charge(hardware.charge());
    }
    fn condition(&mut self, _: &Leaf, turn: &Turn<'_, Charge>) -> bool {
        self.charge.0 > 20 && turn.peers.fresh().all(|peer| peer.message().own.0 > 20)
    }
    fn message(&self) -> Charge {
        self.charge
    }
}

/// A door on hardware `H`.
pub type Door<H> = table_robot!(AIRLOCK, H, DoorSkills, 3);
