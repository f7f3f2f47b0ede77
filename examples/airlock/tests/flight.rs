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
