//! A robot that drives through a door: one tree of conditions and actions, without inference.
//!
//! The door may be locked, may need several ticks to open, and may fall shut again. The tree looks
//! at the door in every tick, so the robot reacts to what it sees now. `cargo run -p iibt-core
//! --no-default-features --example door` plays it and asserts what the comments say.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[macro_use]
mod chip;

use iibt_core::time::Instant;
use iibt_core::tree;
use iibt_core::tree::{Full, Halt, Leaves, Memory, Next, Status, Tree};

/// The names of the leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Skill {
    IsInside,
    IsOpen,
    Unlock,
    Push,
    DriveThrough,
    CallForHelp,
}

/// Unless the robot is inside: open the door by pushing for 300 ms, else by the key, and drive
/// through.
#[rustfmt::skip]
static ENTER: Tree<Skill, 13, Full> = tree! {
    ReactiveFallback {
        Condition(Skill::IsInside),
        ReactiveSequence {
            Fallback {
                Condition(Skill::IsOpen),
                Timeout(300) {
                    RetryUntilSuccessful(2) {
                        Sequence { Action(Skill::Push), Condition(Skill::IsOpen) },
                    },
                },
                Action(Skill::Unlock),
            },
            Action(Skill::DriveThrough),
        },
        Action(Skill::CallForHelp),
    }
};

/// The blackboard, which the leaves share.
#[derive(Debug, Default)]
struct Robot {
    door_open: bool,
    door_locked: bool,
    /// The robot's progress through the door, of 3.
    way: u8,
    pushed: Option<Instant>,
    wheels_turn: bool,
}

impl Leaves<Skill> for Robot {
    fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
        match leaf {
            Skill::IsInside => self.way == 3,
            _ => self.door_open,
        }
    }

    fn on_start(&mut self, leaf: &Skill, now: Instant) -> Status {
        match leaf {
            Skill::Push => self.pushed = Some(now),
            Skill::Unlock => self.door_locked = false,
            Skill::DriveThrough => self.wheels_turn = true,
            _ => return Status::Failure,
        }
        Status::Running
    }

    fn on_running(&mut self, leaf: &Skill, now: Instant) -> Status {
        match leaf {
            Skill::DriveThrough if self.way < 2 => self.way += 1,
            Skill::DriveThrough => {
                (self.way, self.wheels_turn) = (3, false);
                return Status::Success;
            }
            Skill::Push if self.pushed.is_some_and(|pushed| now.since(pushed).0 >= 200) => {
                self.door_open = !self.door_locked;
                return Status::Success;
            }
            Skill::Push => {}
            _ => return Status::Success,
        }
        Status::Running
    }

    fn on_halted(&mut self, leaf: &Skill, _: Instant) -> Halt {
        match leaf {
            Skill::DriveThrough => self.wheels_turn = false,
            _ => self.pushed = None,
        }
        Halt::Done
    }

    /// A push is looked at again when it has had its time; the tree need not be ticked before.
    fn deadline(&mut self, leaf: &Skill, _: Instant) -> Option<Instant> {
        let pushed = self.pushed.filter(|_| *leaf == Skill::Push)?;
        Some(Instant(pushed.0 + 200))
    }
}

fn play() {
    let (mut robot, mut memory) = (Robot::default(), Memory::new());
    let mut tick = |robot: &mut Robot, now: u32| {
        let tick = ENTER.tick(&mut memory, robot, Instant(now));
        show!("{now:4} ms: {:?}, {:?}", tick.status, ENTER.running(&memory));
        (tick.status, ENTER.running(&memory).copied(), tick.next)
    };

    // The door is shut: the robot pushes, and says when it wants to look again.
    let pushing = (Status::Running, Some(Skill::Push), Next::At(Instant(200)));
    assert_eq!(tick(&mut robot, 0), pushing);
    assert_eq!(tick(&mut robot, 100), pushing);

    // It is open after 200 ms, and the robot drives.
    assert_eq!(tick(&mut robot, 200).1, Some(Skill::DriveThrough));
    assert!(robot.door_open && robot.wheels_turn);

    // It falls shut on the way: the same tick halts the wheels and pushes again.
    robot.door_open = false;
    assert_eq!(tick(&mut robot, 250).1, Some(Skill::Push));
    assert!(!robot.wheels_turn, "the drive was halted");

    // The rest of the way, and from then on nothing is left to do.
    assert_eq!(tick(&mut robot, 450).1, Some(Skill::DriveThrough));
    for now in [500, 550] {
        assert_eq!(tick(&mut robot, now).0, Status::Running);
    }
    assert_eq!(tick(&mut robot, 600), (Status::Success, None, Next::Event));
    assert_eq!((robot.way, robot.wheels_turn), (3, false));

    // A locked door: 300 ms of pushing are enough, then the robot turns the key and begins again.
    let (mut robot, mut memory) = (Robot { door_locked: true, ..Robot::default() }, Memory::new());
    let now = (0..).map(|tick| 50 * tick).take(40).find(|&now| {
        let status = ENTER.tick(&mut memory, &mut robot, Instant(now)).status;
        assert_ne!(status, Status::Failure, "the robot never has to call for help");
        status == Status::Success
    });
    show!("through the locked door after {now:?} ms");
    assert!(now.is_some_and(|now| now > 300) && robot.way == 3 && !robot.door_locked);
}

play!(play);
