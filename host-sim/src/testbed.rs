//! Robots of one's own over the simulated radio.

use crate::body::{Antenna, Clock};
use crate::radio::{KEY, Radio, Traffic};
use crate::scenario;
use firmware::{Controller, Robot, Settings, hardware};
use iibt_core::grid::{Cell, Move};
use iibt_core::team::{Member, MemberError, RobotId};
use iibt_core::time::Instant;
use iibt_core::tree::Status;
use std::num::NonZero;

/// The hardware of one simulated robot: an end of the radio, a clock, and parts of any kind.
///
/// The parts are sensors and actuators as the world fills and reads them. Implement the firmware's hardware
/// traits that a robot asks for on the parts, and traits of your own on `Simulated` with parts of that kind.
#[derive(Debug, Default)]
pub struct Simulated<T> {
    /// Sensors and actuators.
    pub parts: T,
    link: Antenna,
    clock: Clock,
}

impl<T> hardware::Link for Simulated<T> {
    fn receive(&mut self) -> Option<u8> {
        self.link.receive()
    }
    fn send(&mut self, frame: &[u8]) -> bool {
        self.link.send(frame)
    }
}

impl<T> hardware::Clock for Simulated<T> {
    fn now(&mut self) -> Instant {
        self.clock.now()
    }
}

impl<T: hardware::Drive> hardware::Drive for Simulated<T> {
    fn go(&mut self, step: Move) {
        self.parts.go(step);
    }
    fn is_moving(&mut self) -> bool {
        self.parts.is_moving()
    }
    fn stop(&mut self) {
        self.parts.stop();
    }
}

impl<T: hardware::Localiser> hardware::Localiser for Simulated<T> {
    fn locate(&mut self) -> Option<Cell> {
        self.parts.locate()
    }
}

impl<T: hardware::Scanner> hardware::Scanner for Simulated<T> {
    fn scan(&mut self) -> Option<Cell> {
        self.parts.scan()
    }
}

impl<T: hardware::Battery> hardware::Battery for Simulated<T> {
    fn charge(&mut self) -> u8 {
        self.parts.charge()
    }
}

/// A team of robots of one kind, each run by the firmware's controller, joined by the simulated radio.
///
/// The world is the caller's: before a tick it puts into the [`parts`](Self::parts_mut) what the sensors read,
/// and afterwards carries out what the actuators were told. What a robot sends in a tick arrives in a later
/// one, so the order of the robots does not matter; the same seed gives the same flight.
///
/// ```
/// use firmware::Robot;
/// use host_sim::{Radio, Simulated, Testbed};
/// use iibt_core::team::{Message, Peers};
/// use iibt_core::time::Instant;
/// use iibt_core::tree::Status;
/// use serde::{Deserialize, Serialize};
///
/// /// What a robot counts, and announces.
/// #[derive(Clone, Copy, Default, Serialize, Deserialize)]
/// struct Counted(u8);
///
/// impl Message for Counted {
///     const SCHEMA: &'static str = "counted u8";
///     const MAX_BYTES: usize = 1;
/// }
///
/// /// A robot that is done when the team has counted ten things together.
/// #[derive(Default)]
/// struct Counter(Counted);
///
/// impl Robot<Simulated<bool>> for Counter {
///     type Message = Counted;
///
///     fn sense(&mut self, hardware: &mut Simulated<bool>, _: Instant) {
///         self.0.0 += u8::from(hardware.parts); // whether something has come by
///     }
///     fn tick(&mut self, peers: Peers<'_, Counted>, _: Instant) -> Status {
///         let counted: u8 = peers.iter().map(|peer| peer.message().0).sum();
///         if self.0.0 + counted >= 10 { Status::Success } else { Status::Running }
///     }
///     fn act(&mut self, _: &mut Simulated<bool>) {}
///     fn message(&self) -> Counted {
///         self.0
///     }
/// }
///
/// let team = (0..3).map(|_| (Counter::default(), false));
/// let mut testbed = Testbed::new(team, Radio { loss: 0.3, ..Radio::default() }, 7)?;
/// let mut statuses = vec![];
/// for tick in 0..12 {
///     for robot in 0..3 {
///         *testbed.parts_mut(robot) = tick % 3 == robot && tick < 10; // the world
///     }
///     statuses = testbed.tick();
/// }
/// assert_eq!(statuses, [Status::Success; 3]);
/// # Ok::<(), iibt_core::team::MemberError>(())
/// ```
pub struct Testbed<R: Robot<Simulated<T>>, T> {
    robots: Vec<Controller<R, Simulated<T>>>,
    radio: Radio,
    tick: u32,
}

impl<R: Robot<Simulated<T>>, T> Testbed<R, T> {
    /// A team of these robots with their parts, numbered in their order.
    ///
    /// # Errors
    /// [`MemberError`] when there are more than [`MAX_TEAM`](iibt_core::team::MAX_TEAM).
    pub fn new(
        team: impl IntoIterator<Item = (R, T)>,
        radio: scenario::Radio,
        seed: u64,
    ) -> Result<Self, MemberError> {
        let team: Vec<(R, T)> = team.into_iter().collect();
        let size = team.len();
        let controller = |(robot, (mind, parts)): (u8, (R, T))| {
            let settings = Settings::new(Member::new(RobotId(robot), size)?, KEY, 1, NonZero::<u16>::MIN);
            let hardware = Simulated { parts, link: Antenna::default(), clock: Clock::default() };
            Ok(Controller::new(mind, settings, hardware))
        };
        let robots = (0..).zip(team).map(controller).collect::<Result<_, _>>()?;
        Ok(Self { robots, radio: Radio::new(radio, size, seed), tick: 0 })
    }

    /// Hands out the frames that arrive, ticks every robot once, and sends what they announce; returns what
    /// their trees returned.
    pub fn tick(&mut self) -> Vec<Status> {
        for (receiver, frame) in self.radio.arrivals(self.tick) {
            self.robots[receiver].hardware_mut().link.received.extend(frame);
        }
        let statuses = self.robots.iter_mut().map(|robot| {
            robot.hardware_mut().clock.now = self.tick;
            robot.tick()
        });
        let statuses = statuses.collect();
        for (sender, robot) in self.robots.iter_mut().enumerate() {
            for frame in robot.hardware_mut().link.sent.drain(..) {
                self.radio.send(self.tick, sender, &frame);
            }
        }
        self.tick += 1;
        statuses
    }

    /// The ticks flown.
    #[must_use]
    pub const fn ticks(&self) -> u32 {
        self.tick
    }

    /// The robots in their order.
    pub fn robots(&self) -> impl Iterator<Item = &R> {
        self.robots.iter().map(Controller::robot)
    }

    /// The sensors and actuators of a robot.
    ///
    /// # Panics
    /// When there is no such robot.
    #[must_use]
    pub fn parts(&self, robot: usize) -> &T {
        &self.robots[robot].hardware().parts
    }

    /// The sensors and actuators of a robot, for the world to fill and read.
    ///
    /// # Panics
    /// When there is no such robot.
    pub fn parts_mut(&mut self, robot: usize) -> &mut T {
        &mut self.robots[robot].hardware_mut().parts
    }

    /// What became of the frames of all robots.
    #[must_use]
    pub fn traffic(&self) -> Traffic {
        self.radio.traffic().iter().sum()
    }
}
