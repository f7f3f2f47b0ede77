//! A testbed for robots of any kind: simulated hardware, clocks and radio.

use crate::body::{Antenna, Clock};
use crate::radio::{KEY, RadioChannel, Traffic};
use crate::scenario;
use firmware::{Controller, Robot, Settings, hardware};
use iibt_core::team::{Invalid, Keys, Member, MemberError, Peers, RobotId};
use iibt_core::time::Instant;
use iibt_core::tree::Status;
use std::collections::VecDeque;
use std::num::NonZero;

/// The settings of a robot in a [`Testbed`] with a team of `team`: it has been switched on once,
/// and ticks every millisecond.
///
/// # Errors
/// [`MemberError`] when there is no such team, or the robot is not in it.
pub fn settings(robot: RobotId, team: usize) -> Result<Settings, MemberError> {
    Ok(Settings::new(Member::new(robot, team)?, KEY, 1, NonZero::<u16>::MIN))
}

/// The hardware of one simulated robot: an end of the radio, a clock, and parts of any kind.
#[derive(Debug, Default)]
struct Simulated<T> {
    parts: T,
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

/// What runs beside the robots of a [`Testbed`], with the same inputs.
pub(crate) trait Shadow<R, T> {
    /// Takes what a robot senses and hears in a tick, before any of them ticks.
    fn prepare(&mut self, robot: usize, tick: u32, parts: &T, received: &VecDeque<u8>);

    /// Takes a robot after the tick, what it has told its parts, and the frames that it sends.
    fn compare(&mut self, robot: usize, own: &R, parts: &T, sent: &[Vec<u8>]);
}

/// A robot on the parts of simulated hardware: it sees neither the radio nor the clock.
struct OnParts<R>(R);

impl<R: Robot<T>, T> Robot<Simulated<T>> for OnParts<R> {
    type Message = R::Message;

    fn mission(&self) -> u64 {
        self.0.mission()
    }
    fn accepts(&self, message: &R::Message) -> Result<(), Invalid> {
        self.0.accepts(message)
    }
    fn sense(&mut self, hardware: &mut Simulated<T>, now: Instant) {
        self.0.sense(&mut hardware.parts, now);
    }
    fn tick(&mut self, peers: Peers<'_, R::Message>, now: Instant) -> Status {
        self.0.tick(peers, now)
    }
    fn act(&mut self, hardware: &mut Simulated<T>) {
        self.0.act(&mut hardware.parts);
    }
    fn message(&self) -> Option<R::Message> {
        self.0.message()
    }
    fn repeats_itself(&self) -> bool {
        self.0.repeats_itself()
    }
}

/// A team of robots of one kind, each run by the firmware's controller, joined by the simulated
/// radio.
///
/// Each robot runs on parts of its own, a type on which the hardware traits that it asks for are
/// implemented; the testbed adds link and clock. The world is the caller's: before a tick it puts
/// into the [`parts`](Self::parts_mut) what the sensors read, and afterwards carries out what the
/// actuators were told. What a robot sends in a tick arrives in a later one, so the order of the
/// robots does not matter; the same seed gives the same flight.
///
/// ```
/// use firmware::Robot;
/// use host_sim::{Radio, Testbed};
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
/// impl Robot<bool> for Counter {
///     type Message = Counted;
///
///     fn sense(&mut self, came_by: &mut bool, _: Instant) {
///         self.0.0 += u8::from(*came_by);
///     }
///     fn tick(&mut self, peers: Peers<'_, Counted>, _: Instant) -> Status {
///         let counted: u8 = peers.iter().map(|peer| peer.message().0).sum();
///         if self.0.0 + counted >= 10 { Status::Success } else { Status::Running }
///     }
///     fn act(&mut self, _: &mut bool) {}
///     fn message(&self) -> Option<Counted> {
///         Some(self.0)
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
pub struct Testbed<R: Robot<T>, T> {
    shadow: Option<Box<dyn Shadow<R, T>>>,
    robots: Vec<Controller<OnParts<R>, Simulated<T>>>,
    radio: RadioChannel,
    tick: u32,
    /// The frames of the last tick, one after the other.
    frames: Vec<u8>,
}

impl<R: Robot<T>, T> Testbed<R, T> {
    /// A team of these robots with their parts, numbered in their order.
    ///
    /// # Errors
    /// [`MemberError`] when there are more than [`MAX_TEAM`](iibt_core::team::MAX_TEAM).
    pub fn new(
        team: impl IntoIterator<Item = (R, T)>,
        radio: scenario::Radio,
        seed: u64,
    ) -> Result<Self, MemberError> {
        Self::beside(team, radio, seed, Keys::shared(&KEY), None)
    }

    /// A team with its keys, and with what runs beside it.
    pub(crate) fn beside(
        team: impl IntoIterator<Item = (R, T)>,
        radio: scenario::Radio,
        seed: u64,
        keys: Keys,
        shadow: Option<Box<dyn Shadow<R, T>>>,
    ) -> Result<Self, MemberError> {
        let team: Vec<(R, T)> = team.into_iter().collect();
        let size = team.len();
        let controller = |(robot, (mind, parts)): (u8, (R, T))| {
            let hardware = Simulated { parts, link: Antenna::default(), clock: Clock::default() };
            let member = Member::new(RobotId(robot), size)?;
            let settings = Settings::with_keys(member, keys.clone(), 1, NonZero::<u16>::MIN);
            Ok(Controller::new(OnParts(mind), settings, hardware))
        };
        let robots = (0..).zip(team).map(controller).collect::<Result<_, _>>()?;
        let radio = RadioChannel::new(radio, size, seed);
        Ok(Self { shadow, robots, radio, tick: 0, frames: Vec::new() })
    }

    /// Hands out the frames that arrive, ticks every robot once, and sends what they announce;
    /// returns what their trees returned.
    pub fn tick(&mut self) -> Vec<Status> {
        for (receiver, frame) in self.radio.arrivals(self.tick) {
            self.robots[receiver].hardware_mut().link.received.extend(frame);
        }
        if let Some(shadow) = &mut self.shadow {
            for (index, robot) in self.robots.iter().enumerate() {
                let Simulated { parts, link, .. } = robot.hardware();
                shadow.prepare(index, self.tick, parts, &link.received);
            }
        }
        let statuses = self.robots.iter_mut().map(|robot| {
            robot.hardware_mut().clock.now = self.tick;
            robot.tick()
        });
        let statuses = statuses.collect();
        if let Some(shadow) = &mut self.shadow {
            for (index, robot) in self.robots.iter().enumerate() {
                let Simulated { parts, link, .. } = robot.hardware();
                shadow.compare(index, &robot.robot().0, parts, &link.sent);
            }
        }
        self.frames.clear();
        for (sender, robot) in self.robots.iter_mut().enumerate() {
            for frame in robot.hardware_mut().link.sent.drain(..) {
                self.radio.send(self.tick, sender, &frame);
                self.frames.extend(frame);
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

    /// The frames that the robots sent in the last tick, one after the other, with their
    /// delimiters.
    #[must_use]
    pub fn frames(&self) -> &[u8] {
        &self.frames
    }

    /// The robots in their order.
    pub fn robots(&self) -> impl Iterator<Item = &R> {
        self.robots.iter().map(|robot| &robot.robot().0)
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

    /// The traffic of all robots.
    #[must_use]
    pub fn traffic(&self) -> Traffic {
        self.radio.traffic().iter().sum()
    }
}
