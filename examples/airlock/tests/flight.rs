//! The robot of docs/your-robot.md, flown.

use airlock::{AIRLOCK, Door, DoorSkills, TREE};
use firmware::prelude::*;
use host_sim::{Radio, Testbed, settings};
use std::error::Error;

/// The parts of one door, as the world fills and reads them.
#[derive(Clone, Copy)]
struct Parts {
    /// The reading of the switch: 0 for open, 1 for shut.
    switch: u8,
    charge: u8,
    /// The ticks until the drive stops.
    moving: u8,
}

impl Equipment for Parts {
    fn read(&mut self, _: usize) -> Option<u8> {
        Some(self.switch)
    }
    fn is_busy(&mut self) -> bool {
        self.moving > 0
    }
    fn begin(&mut self, _: Command) {
        self.moving = 3;
    }
}

impl Battery for Parts {
    fn charge(&mut self) -> u8 {
        self.charge
    }
}

/// Flies an airlock whose inner door is open and whose outer door is shut. Each drive fails the
/// first time, and every seventh reading is wrong. Returns the ticks until both trees succeed; the
/// doors must never be open together.
fn fly(loss: f64, charge: u8) -> Result<Option<u32>, Box<dyn Error>> {
    let mut doors = [0, 1]; // in truth: the inner one is open
    let mut tries = [0, 0];
    let door = |robot: &Settings| Door::new(&AIRLOCK, robot, &TREE, DoorSkills::default(), Duration(200));
    let parts = |switch| Parts { switch, charge, moving: 0 };
    let [inner, outer] = [settings(RobotId(0), 2)?, settings(RobotId(1), 2)?];
    let team = [(door(&inner)?, parts(0)), (door(&outer)?, parts(1))];
    let mut testbed = Testbed::new(team, Radio { loss, ..Radio::default() }, 7)?;
    for tick in 0..200 {
        for (robot, truth) in doors.iter_mut().enumerate() {
            let parts = testbed.parts_mut(robot);
            if parts.moving == 1 {
                tries[robot] += 1;
                // The drive fails the first time.
                *truth = if tries[robot] > 1 { 1 - *truth } else { *truth };
            }
            parts.moving = parts.moving.saturating_sub(1);
            parts.switch = if tick % 7 == 3 { 1 - *truth } else { *truth };
        }
        assert_ne!(doors, [0, 0], "both doors are open at tick {tick}");
        if testbed.tick() == [Status::Success; 2] {
            assert_eq!((doors, tries), ([1, 0], [2, 2]), "the inner door is shut, the outer one open");
            return Ok(Some(tick));
        }
    }
    Ok(None)
}

#[test]
fn the_airlock_opens_with_and_without_lost_frames() -> Result<(), Box<dyn Error>> {
    let quick = fly(0.0, 80)?.ok_or("never")?;
    let lossy = fly(0.4, 80)?.ok_or("never")?;
    assert!(quick <= lossy && lossy < 100, "{quick} {lossy}");
    Ok(())
}

#[test]
fn nothing_moves_without_charge() -> Result<(), Box<dyn Error>> {
    assert_eq!(fly(0.0, 10)?, None);
    Ok(())
}

const KEY: Key = Key::new(*b"sixteen bytes...");
const TICK: core::num::NonZero<u16> = core::num::NonZero::new(100).unwrap(); // in milliseconds

/// The controller of a door; `None` for a robot that the team of two does not have.
fn controller<H>(robot: u8, epoch: u32, hardware: H) -> Option<Controller<Door<H>, H>>
where
    H: Link + Clock + Equipment + Battery,
{
    let settings = Settings::new(Member::new(RobotId(robot), 2).ok()?, KEY, epoch, TICK);
    let door = Door::new(&AIRLOCK, &settings, &TREE, DoorSkills::default(), Duration(20_000)).ok()?;
    Some(Controller::new(door, settings, hardware))
}

/// A board whose battery is full and whose teammate is silent.
#[derive(Default)]
struct Board {
    now: u32,
}

impl Link for Board {
    fn receive(&mut self) -> Option<u8> {
        None
    }
    fn send(&mut self, _: &[u8]) -> bool {
        true
    }
}

impl Clock for Board {
    fn now(&mut self) -> Instant {
        self.now += u32::from(TICK.get());
        Instant(self.now)
    }
}

impl Equipment for Board {
    fn read(&mut self, _: usize) -> Option<u8> {
        Some(0)
    }
    fn is_busy(&mut self) -> bool {
        false
    }
    fn begin(&mut self, command: Command) {
        panic!("{command:?} without having heard the other door")
    }
}

impl Battery for Board {
    fn charge(&mut self) -> u8 {
        100
    }
}

#[test]
fn a_door_on_a_board_announces_itself_and_waits_for_the_other() {
    assert!(controller(2, 1, Board::default()).is_none());
    let mut door = controller(0, 1, Board::default()).expect("robot 0 of 2");
    for _ in 0..50 {
        assert_eq!(door.tick(), Status::Running);
    }
    assert_eq!(door.link_report().sent, 50);
}
