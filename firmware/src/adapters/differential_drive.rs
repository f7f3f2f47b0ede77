//! A drive for robots with two driven wheels.

use crate::hardware::{Clock, Drive};
use core::f32::consts::PI;
use embedded_hal::digital::{OutputPin, PinState};
use embedded_hal::pwm::SetDutyCycle;
use iibt_core::grid::Move;
use iibt_core::time::{Duration, Instant};
use micromath::F32Ext;

/// The shortest distance that is driven, in metres, and the smallest turn, in radians.
const NEGLIGIBLE: f32 = 1e-3;

/// The measures of a robot and of the grid that it drives on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chassis {
    /// The side of a grid cell, in metres.
    pub cell: f32,
    /// The distance between the two wheels, in metres.
    pub track: f32,
    /// The speed of a wheel's rim at `duty`, in metres per second; more than zero.
    pub speed: f32,
    /// The duty cycle to drive with, in percent, at most 100.
    pub duty: u8,
}

impl Chassis {
    /// Of an image that drives nowhere.
    pub const STANDING: Self = Self { cell: 1.0, track: 0.1, speed: 1.0, duty: 0 };
}

/// The motor on one side of a robot.
pub trait Motor {
    /// Runs at `duty` percent, zero to stop; returns whether the hardware took it.
    fn run(&mut self, duty: u8, forwards: bool) -> bool;
}

/// A [`Motor`] behind a driver with a speed and a direction input, high for forwards.
#[derive(Debug)]
pub struct Wheel<P, D> {
    speed: P,
    direction: D,
}

/// A [`Drive`] that turns on the spot towards the next cell and then drives there, by time alone.
///
/// It relies on the measures of the chassis: without an encoder, slip goes unnoticed. The robot
/// starts in the centre of a cell, facing up the map. The clock must count milliseconds, and
/// [`Drive::is_moving`] must be asked often, as it is what ends a turn and a way. A move that was
/// stopped leaves the robot between two cells, counted as in the one it came from; the next move
/// leads from where it is to the next centre.
#[derive(Debug)]
pub struct DifferentialDrive<L, R, C> {
    left: L,
    right: R,
    clock: C,
    chassis: Chassis,
    /// The position of the robot relative to the centre of its cell, in metres: x to the right, y
    /// up the map.
    offset: (f32, f32),
    /// The direction it faces, anticlockwise from right, in radians.
    heading: f32,
    /// The centre of the cell that it moves to, in the coordinates of `offset`.
    target: (f32, f32),
    phase: Phase,
    failures: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Still,
    Turning { to: f32, until: Instant },
    Rolling { since: Instant, until: Instant },
}

impl<P, D> Wheel<P, D> {
    /// A wheel with its speed and its direction output.
    pub const fn new(speed: P, direction: D) -> Self {
        Self { speed, direction }
    }
}

impl<P: SetDutyCycle, D: OutputPin> Motor for Wheel<P, D> {
    fn run(&mut self, duty: u8, forwards: bool) -> bool {
        let direction = self.direction.set_state(PinState::from(forwards));
        let speed = self.speed.set_duty_cycle_percent(duty.min(100));
        direction.is_ok() && speed.is_ok()
    }
}

impl<L, R, C> DifferentialDrive<L, R, C> {
    /// Creates the drive of a robot that stands in the centre of a cell and faces up the map.
    pub const fn new(left: L, right: R, clock: C, chassis: Chassis) -> Self {
        Self {
            left,
            right,
            clock,
            chassis,
            offset: (0.0, 0.0),
            heading: PI / 2.0,
            target: (0.0, 0.0),
            phase: Phase::Still,
            failures: 0,
        }
    }

    /// Changes the measures of the robot and of the grid, before it drives.
    #[must_use]
    pub fn with_chassis(mut self, chassis: Chassis) -> Self {
        self.chassis = chassis;
        self
    }

    /// Returns the number of commands that an output refused.
    #[must_use]
    pub const fn failures(&self) -> u32 {
        self.failures
    }

    /// Direction in radians and distance in metres from where the robot is to its target.
    fn way(&self) -> (f32, f32) {
        let (x, y) = (self.target.0 - self.offset.0, self.target.1 - self.offset.1);
        let to = F32Ext::atan2(y, x);
        // Along its own direction, as micromath's cosine is off by 0.1 % but its square root by 6
        // %.
        (to, x * F32Ext::cos(to) + y * F32Ext::sin(to))
    }

    /// The time in which the rim of a wheel moves `length` metres.
    fn time_for(&self, length: f32) -> Duration {
        Duration((1000.0 * length / self.chassis.speed) as u32)
    }

    fn arrive(&mut self) {
        self.offset = (0.0, 0.0);
        self.target = (0.0, 0.0);
        self.phase = Phase::Still;
    }
}

impl<L: Motor, R: Motor, C: Clock> DifferentialDrive<L, R, C> {
    fn wheels(&mut self, duty: u8, left_forwards: bool, right_forwards: bool) {
        let left = self.left.run(duty, left_forwards);
        let right = self.right.run(duty, right_forwards);
        self.failures = self.failures.saturating_add(u32::from(!left) + u32::from(!right));
    }

    fn turn(&mut self, now: Instant) {
        let (to, distance) = self.way();
        let angle = turned(to - self.heading);
        if distance < NEGLIGIBLE || angle.abs() < NEGLIGIBLE {
            return self.roll(now);
        }
        self.wheels(self.chassis.duty, angle < 0.0, angle > 0.0);
        let until = now.after(self.time_for(angle.abs() * self.chassis.track / 2.0));
        self.phase = Phase::Turning { to, until };
    }

    fn roll(&mut self, now: Instant) {
        let (_, distance) = self.way();
        if distance < NEGLIGIBLE {
            self.wheels(0, true, true);
            return self.arrive();
        }
        self.wheels(self.chassis.duty, true, true);
        self.phase = Phase::Rolling { since: now, until: now.after(self.time_for(distance)) };
    }

    /// Updates the estimated position to the moment at which a move is stopped.
    fn break_off(&mut self, now: Instant) {
        match self.phase {
            Phase::Still => {}
            Phase::Turning { to, until } => {
                let left =
                    until.since(now).0 as f32 / 1000.0 * self.chassis.speed / (self.chassis.track / 2.0);
                let angle = turned(to - self.heading);
                self.heading = turned(to - left.copysign(angle));
            }
            Phase::Rolling { since, .. } => {
                let driven = now.since(since).0 as f32 / 1000.0 * self.chassis.speed;
                self.offset.0 += driven * F32Ext::cos(self.heading);
                self.offset.1 += driven * F32Ext::sin(self.heading);
            }
        }
        self.target = (0.0, 0.0);
        self.phase = Phase::Still;
    }
}

impl<L: Motor, R: Motor, C: Clock> Drive for DifferentialDrive<L, R, C> {
    fn go(&mut self, step: Move) {
        let now = self.clock.now();
        self.break_off(now);
        match direction(step) {
            Some((x, y)) => {
                self.target = (x * self.chassis.cell, y * self.chassis.cell);
                self.turn(now);
            }
            None => self.wheels(0, true, true),
        }
    }

    fn is_moving(&mut self) -> bool {
        let now = self.clock.now();
        match self.phase {
            Phase::Turning { to, until } if now.has_reached(until) => {
                self.heading = to;
                self.roll(now);
            }
            Phase::Rolling { until, .. } if now.has_reached(until) => {
                self.wheels(0, true, true);
                self.arrive();
            }
            _ => {}
        }
        self.phase != Phase::Still
    }

    fn stop(&mut self) {
        let now = self.clock.now();
        self.wheels(0, true, true);
        self.break_off(now);
    }
}

/// The unit vector of a move, x to the right and y up the map; `None` for a wait.
const fn direction(step: Move) -> Option<(f32, f32)> {
    match step {
        Move::Up => Some((0.0, 1.0)),
        Move::Down => Some((0.0, -1.0)),
        Move::Left => Some((-1.0, 0.0)),
        Move::Right => Some((1.0, 0.0)),
        Move::Wait => None,
    }
}

/// An angle as the shortest turn, in radians from -pi to pi.
fn turned(angle: f32) -> f32 {
    if angle > PI {
        angle - 2.0 * PI
    } else if angle < -PI {
        angle + 2.0 * PI
    } else {
        angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Set};
    use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as Duty};
    use std::cell::Cell;
    use std::rc::Rc;
    use std::vec::Vec;

    /// One cell in 1 s, a quarter turn in 157 ms.
    const CHASSIS: Chassis = Chassis { cell: 0.5, track: 0.1, speed: 0.5, duty: 40 };

    #[derive(Clone, Default)]
    struct Hand(Rc<Cell<u32>>);

    impl Clock for Hand {
        fn now(&mut self) -> Instant {
            Instant(self.0.get())
        }
    }

    type Mocked = Wheel<Pwm, Pin>;

    /// A robot whose wheels must see exactly these commands: duty, left forwards, right forwards.
    struct Bench {
        drive: DifferentialDrive<Mocked, Mocked, Hand>,
        hand: Hand,
    }

    impl Bench {
        fn expecting(commands: &[(u16, bool, bool)]) -> Self {
            let hand = Hand::default();
            let left = commands.iter().map(|&(duty, left, _)| (duty, left));
            let right = commands.iter().map(|&(duty, _, right)| (duty, right));
            let drive = DifferentialDrive::new(wheel(left), wheel(right), hand.clone(), CHASSIS);
            Self { drive, hand }
        }

        /// How many milliseconds the drive goes on moving, to the millisecond.
        fn run(&mut self) -> u32 {
            let start = self.hand.0.get();
            while self.drive.is_moving() {
                self.wait(1);
            }
            self.hand.0.get() - start
        }

        fn wait(&mut self, milliseconds: u32) {
            self.hand.0.set(self.hand.0.get() + milliseconds);
        }

        fn done(mut self) {
            assert_eq!(self.drive.failures(), 0);
            for wheel in [&mut self.drive.left, &mut self.drive.right] {
                wheel.speed.done();
                wheel.direction.done();
            }
        }
    }

    fn wheel(commands: impl Iterator<Item = (u16, bool)> + Clone) -> Mocked {
        let duty =
            commands.clone().flat_map(|(duty, _)| [Duty::max_duty_cycle(100), Duty::set_duty_cycle(duty)]);
        let side = commands.map(|(_, on)| Set::set(if on { State::High } else { State::Low }));
        Wheel::new(Pwm::new(&duty.collect::<Vec<_>>()), Pin::new(&side.collect::<Vec<_>>()))
    }

    /// micromath trades accuracy for size: within 1 % and 2 ms.
    fn assert_about(milliseconds: u32, expected: u32) {
        assert!(milliseconds.abs_diff(expected) <= expected / 100 + 2, "{milliseconds} ms, not {expected}");
    }

    const AHEAD: (u16, bool, bool) = (40, true, true);
    const ANTICLOCKWISE: (u16, bool, bool) = (40, false, true);
    const CLOCKWISE: (u16, bool, bool) = (40, true, false);
    const OFF: (u16, bool, bool) = (0, true, true);

    #[test]
    fn drives_one_cell_ahead() {
        let mut bench = Bench::expecting(&[AHEAD, OFF]);
        bench.drive.go(Move::Up);
        assert_about(bench.run(), 1000);
        bench.done();
    }

    #[test]
    fn turns_the_short_way_before_it_drives() {
        for (step, turn, milliseconds) in [(Move::Left, ANTICLOCKWISE, 1157), (Move::Right, CLOCKWISE, 1157)]
        {
            let mut bench = Bench::expecting(&[turn, AHEAD, OFF]);
            bench.drive.go(step);
            assert_about(bench.run(), milliseconds);
            bench.done();
        }
    }

    #[test]
    fn remembers_where_it_faces() {
        let mut bench = Bench::expecting(&[ANTICLOCKWISE, AHEAD, OFF, AHEAD, OFF, ANTICLOCKWISE, AHEAD, OFF]);
        for (step, milliseconds) in [(Move::Left, 1157), (Move::Left, 1000), (Move::Down, 1157)] {
            bench.drive.go(step);
            assert_about(bench.run(), milliseconds);
        }
        bench.done();
    }

    #[test]
    fn a_wait_moves_nothing() {
        let mut bench = Bench::expecting(&[OFF]);
        bench.drive.go(Move::Wait);
        assert!(!bench.drive.is_moving());
        bench.done();
    }

    #[test]
    fn goes_on_from_where_it_was_stopped() {
        for (then, turn, milliseconds) in [(Move::Up, None, 700), (Move::Down, Some(314), 1300)] {
            let commands = [AHEAD, OFF, OFF, CLOCKWISE, AHEAD, OFF].into_iter();
            let commands = commands.filter(|&command| turn.is_some() || command != CLOCKWISE);
            let mut bench = Bench::expecting(&commands.collect::<Vec<_>>());
            bench.drive.go(Move::Up);
            bench.wait(300);
            assert!(bench.drive.is_moving());
            bench.drive.stop();
            bench.drive.go(Move::Wait);
            assert!(!bench.drive.is_moving());
            bench.drive.go(then);
            assert_about(bench.run(), turn.unwrap_or(0) + milliseconds);
            bench.done();
        }
    }

    #[test]
    fn finishes_a_turn_that_was_stopped() {
        let mut bench = Bench::expecting(&[CLOCKWISE, OFF, CLOCKWISE, AHEAD, OFF]);
        bench.drive.go(Move::Right);
        bench.wait(100);
        assert!(bench.drive.is_moving());
        bench.drive.stop();
        bench.drive.go(Move::Right);
        assert_about(bench.run(), 57 + 1000);
        bench.done();
    }

    #[test]
    fn counts_what_the_hardware_refuses() {
        use embedded_hal_mock::eh1::MockError;
        let failing = || {
            let refused = Set::set(State::High).with_error(MockError::Io(std::io::ErrorKind::NotConnected));
            Wheel::new(Pwm::new(&[Duty::max_duty_cycle(100), Duty::set_duty_cycle(0)]), Pin::new(&[refused]))
        };
        let mut drive = DifferentialDrive::new(failing(), failing(), Hand::default(), CHASSIS);
        drive.stop();
        assert_eq!(drive.failures(), 2);
        for wheel in [&mut drive.left, &mut drive.right] {
            wheel.speed.done();
            wheel.direction.done();
        }
    }
}
