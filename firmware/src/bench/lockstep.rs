//! A robot of a team on 8 x 8 cells that ticks when it is told to, with what it is told to sense
//! and hear: the same on the host and on the target, so that frames can be compared and ticks
//! counted.

use super::joint_plans::{Instance, Problems};
use crate::adapters::{Absent, Body, ByteQueue};
use crate::hardware::{Clock, Drive, Link, Localiser, Scanner};
use crate::missions::{LAYERS, NODES, POLICIES};
use crate::{Controller, Navigator, Settings};
use core::num::NonZero;
use heapless::Vec;
use iibt_core::grid::{Cell, Move, words};
use iibt_core::navigation::Mission;
use iibt_core::team::{Key, MAX_FRAME, MAX_TEAM, Member, RobotId};
use iibt_core::time::Instant;

/// The cells of the map.
pub const CELLS: usize = 64;

/// The words of the map.
pub const WORDS: usize = words(8, 8);

/// The key of the team; it keeps nothing secret.
pub const KEY: Key = Key::new(*b"robots in step..");

/// A robot of a team, on maps of `S` cells in `W` words, with eyes of its own.
pub type Robot<'m, const S: usize = CELLS, const W: usize = WORDS, E = Absent> =
    Controller<Navigator<'m, S, W, LAYERS, NODES, POLICIES>, Hardware<E>>;

/// What the robot works on: one frame is sent in a tick at the most.
pub type Hardware<E = Absent> = Body<Line, Ticks, Still, Told, E>;

/// The problem of a team, by the number of robots and of a draw.
///
/// `None` where the map has too few free cells.
#[must_use]
pub fn problem(robots: usize, draw: usize) -> Option<Instance> {
    let mut problems = Problems::new(2026);
    for _ in 0..draw {
        let _ = problems.next(robots);
    }
    problems.next(robots)
}

/// A robot that has just started.
///
/// `None` if the team does not have it.
#[must_use]
pub fn robot<'m>(mission: &'m Mission<'m, WORDS>, number: u8) -> Option<Robot<'m>> {
    let settings = settings(mission, number)?;
    let mut robot = idle(&settings, Absent);
    start(&mut robot, mission, &settings)?;
    Some(robot)
}

/// The settings of a robot; `None` if the team does not have it.
#[must_use]
pub fn settings<const W: usize>(mission: &Mission<'_, W>, number: u8) -> Option<Settings> {
    let member = Member::new(RobotId(number), mission.starts.len()).ok()?;
    Some(Settings::new(member, KEY, 1, NonZero::<u16>::MIN))
}

/// A robot without a mission, to be started where it lies.
#[inline(always)] // built where it is to be, not on the stack
#[must_use]
pub fn idle<'m, const S: usize, const W: usize, E: Senses>(
    settings: &Settings,
    eyes: E,
) -> Robot<'m, S, W, E> {
    let (link, clock) = (Line::default(), Ticks(0));
    let body = Body { link, clock, drive: Still, localiser: Told(None), scanner: eyes, battery: Absent };
    Controller::idle(Navigator::idle(), settings.clone(), body)
}

/// Starts a robot; `None` if it cannot fly the mission.
pub fn start<'m, const S: usize, const W: usize, E: Senses>(
    robot: &mut Robot<'m, S, W, E>,
    mission: &'m Mission<'m, W>,
    settings: &Settings,
) -> Option<()> {
    robot.start(|navigator| navigator.start(mission, settings)).ok()
}

/// Ticks a robot once, with the cell that it reads and the bytes that it hears; returns the frame
/// that it sends, empty if it sends none. It makes its whole list in one tick.
pub fn tick<'r, const S: usize, const W: usize, E: Senses>(
    robot: &'r mut Robot<'_, S, W, E>,
    reading: Cell,
) -> &'r [u8] {
    robot.robot_mut().navigation_mut().set_budget(u32::MAX);
    let hardware = robot.hardware_mut();
    hardware.localiser = Told(Some(reading));
    hardware.scanner.stand(reading);
    hardware.clock.0 = hardware.clock.0.wrapping_add(1);
    hardware.link.sent.clear();
    robot.tick();
    &robot.hardware().link.sent
}

/// A scanner that is told where its robot stands.
pub trait Senses: Scanner {
    /// Looks around from a cell.
    fn stand(&mut self, at: Cell);
}

impl Senses for Absent {
    fn stand(&mut self, _: Cell) {}
}

/// A link whose two ends are buffers.
#[derive(Clone, Debug, Default)]
pub struct Line {
    /// What the robot will hear.
    pub heard: ByteQueue<{ MAX_TEAM * MAX_FRAME }>,
    sent: Vec<u8, MAX_FRAME>,
}

impl Link for Line {
    fn receive(&mut self) -> Option<u8> {
        let mut byte = [0];
        (self.receive_into(&mut byte) == 1).then_some(byte[0])
    }

    fn receive_into(&mut self, bytes: &mut [u8]) -> usize {
        self.heard.read(bytes)
    }

    fn send(&mut self, frame: &[u8]) -> bool {
        self.sent.extend_from_slice(frame).is_ok()
    }
}

/// A clock that counts ticks.
#[derive(Clone, Copy, Debug)]
pub struct Ticks(pub u32);

impl Clock for Ticks {
    fn now(&mut self) -> Instant {
        Instant(self.0)
    }
}

/// Wheels whose moves are made elsewhere, between two ticks.
#[derive(Clone, Copy, Debug)]
pub struct Still;

impl Drive for Still {
    fn go(&mut self, _: Move) {}

    fn is_moving(&mut self) -> bool {
        false
    }

    fn stop(&mut self) {}
}

/// A positioning that reads what it is told.
#[derive(Clone, Copy, Debug)]
pub struct Told(Option<Cell>);

impl Localiser for Told {
    fn locate(&mut self) -> Option<Cell> {
        self.0
    }
}
