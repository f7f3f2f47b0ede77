//! One robot: senses, ticks its behavior tree, moves, and tells its teammates.

use crate::hardware::{Battery, Clock, Drive, Hardware, Link, Localiser, Scanner};
use crate::pilot;
use crate::pilot::{NODES, Pilot, TREE};
use crate::{Report, Settings};
use iibt_core::grid::Cell;
use iibt_core::iibt::navigation::{MAX_GOALS, MissionError, Percept, VisitError};
use iibt_core::iibt::{Mission, Navigation, Node};
use iibt_core::team::{
    Deframer, Intention, Limits, LimitsError, MAX_FRAME, MAX_TEAM, Numbering, RobotId, Roster, RosterError,
    SipHash64, Stamp, encode,
};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::{Memory, Status};

/// The most bytes that one tick takes from the link: two frames of every robot. Whoever floods the link delays
/// frames, but no tick.
const BYTES_PER_TICK: usize = 2 * MAX_TEAM * MAX_FRAME;

/// A robot of a team on hardware `H`, for maps of up to `S` cells in `W` words, weighing up to `P` candidates.
///
/// `W` is [`words`](iibt_core::grid::words) of the map's width and height. A decision takes memory for `P * S`
/// predicted probabilities twice over and time for `P * P` pairs with each teammate; 16 candidates serve three or
/// four goals. Robots with the same `P` choose alike, whatever their `S`. Call [`tick`](Self::tick) at a
/// fixed period, on the real time of [`Settings`]. The smallest hardware there is stands in
/// `tests/support/rig.rs`.
#[derive(Clone, Debug)]
pub struct Controller<'m, H, const S: usize, const W: usize, const P: usize> {
    hardware: H,
    pilot: Pilot<'m, S, W, P>,
    memory: Memory<NODES>,
    deframer: Deframer,
    auth: SipHash64,
    numbering: Numbering,
    beacon: Duration,
    last_sent: Option<Instant>,
    sent: u32,
    unsent: u32,
}

/// Why there is no such controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ControllerError {
    /// The mission does not fit.
    Mission(MissionError),
    /// The team does not fit.
    Team(RosterError),
    /// The time between frames is too long.
    Beacon(LimitsError),
}

impl<'m, H: Hardware, const S: usize, const W: usize, const P: usize> Controller<'m, H, S, W, P> {
    /// A robot at the start of its mission.
    ///
    /// # Errors
    /// [`ControllerError`] when mission, team or settings do not fit.
    pub fn new(
        mission: &'m Mission<'m, W>,
        robot: RobotId,
        settings: Settings,
        hardware: H,
    ) -> Result<Self, ControllerError> {
        let limits = Limits::for_beacons(settings.beacon).map_err(ControllerError::Beacon)?;
        let roster = Roster::new(robot, mission.starts.len(), limits).map_err(ControllerError::Team)?;
        let navigation =
            Navigation::new(mission, robot, settings.epoch, roster).map_err(ControllerError::Mission)?;
        Ok(Self {
            hardware,
            pilot: Pilot {
                navigation,
                node: Node::new(settings.timeout),
                charge: 100,
                low_battery: settings.low_battery,
                charged: settings.charged,
            },
            memory: Memory::new(),
            deframer: Deframer::new(),
            auth: SipHash64::new(settings.key),
            numbering: Numbering::new(settings.epoch),
            beacon: settings.beacon,
            last_sent: None,
            sent: 0,
            unsent: 0,
        })
    }

    /// Senses, decides, moves and sends, once; returns what the tree returned. Bounded work, never waits.
    pub fn tick(&mut self) -> Status {
        let now = self.hardware.clock().now();
        self.listen(now);
        self.sense(now);
        let status = TREE.tick(&mut self.memory, &mut self.pilot, now).status;
        if let Some(step) = self.pilot.navigation.command() {
            self.hardware.drive().go(step);
        }
        self.announce(now);
        status
    }

    /// Has the robot visit a cell before its goal; see [`Navigation::visit`].
    ///
    /// # Errors
    /// [`VisitError`] when it cannot, or has too many to visit already.
    pub fn visit(&mut self, cell: Cell) -> Result<(), VisitError> {
        self.pilot.navigation.visit(cell)
    }

    /// Has each goal of the mission worth so much from the next decision on; see [`Navigation::prefer`].
    pub fn prefer(&mut self, values: &[f32; MAX_GOALS]) {
        self.pilot.navigation.prefer(values);
    }

    /// The leaf of the tree that is running since the last tick.
    #[must_use]
    pub fn activity(&self) -> Option<&'static str> {
        (0..NODES as u16).filter(|&node| self.memory.is_running(node)).find_map(pilot::activity)
    }

    /// The robot's state after the last tick.
    #[must_use]
    pub fn report(&self) -> Report {
        let navigation = &self.pilot.navigation;
        let agreement = navigation.agreement();
        let (cell, confidence) = navigation.position();
        Report {
            status: navigation.status(),
            round: agreement.round(),
            goal: agreement.goal(),
            path: *agreement.path(),
            step: agreement.step(),
            probability: agreement.probability(),
            cell,
            confidence,
            surprise: navigation.surprise().ok(),
            waypoint: navigation.waypoints().first().copied(),
            cause: navigation.cause(),
            sent: self.sent,
            unsent: self.unsent,
            dropped: self.deframer.dropped(),
            received: *navigation.roster().counters(),
        }
    }

    /// The task behind the inference node, with its last decision.
    #[must_use]
    pub const fn navigation(&self) -> &Navigation<'m, S, W, P> {
        &self.pilot.navigation
    }

    /// The hardware.
    #[must_use]
    pub const fn hardware(&self) -> &H {
        &self.hardware
    }

    /// The hardware, to be changed from outside.
    pub const fn hardware_mut(&mut self) -> &mut H {
        &mut self.hardware
    }

    fn listen(&mut self, now: Instant) {
        let roster = self.pilot.navigation.roster_mut();
        roster.expire(now);
        for _ in 0..BYTES_PER_TICK {
            let Some(byte) = self.hardware.link().receive() else { break };
            if let Some(frame) = self.deframer.feed(byte) {
                // The roster counts what it refuses.
                let _ = roster.receive(frame, &self.auth, now);
            }
        }
    }

    fn sense(&mut self, now: Instant) {
        self.pilot.charge = self.hardware.battery().charge();
        let mut percept = Percept {
            now,
            reading: self.hardware.localiser().locate(),
            moving: self.hardware.drive().is_moving(),
            ..Percept::default()
        };
        while !percept.hazards.is_full() {
            let Some(hazard) = self.hardware.scanner().scan() else { break };
            // There is room: the list is not full.
            let _ = percept.hazards.push(hazard);
        }
        self.pilot.navigation.perceive(percept);
    }

    /// Sends this robot's intention when a beacon is due.
    fn announce(&mut self, now: Instant) {
        if self.last_sent.is_some_and(|sent| now.since(sent) < self.beacon) {
            return;
        }
        let Some(stamp) = self.numbering.next_stamp() else { return };
        let mut buffer = [0; MAX_FRAME];
        let taken = encode(&self.intention(stamp, now), &self.auth, &mut buffer)
            .is_ok_and(|frame| self.hardware.link().send(frame));
        let counter = if taken { &mut self.sent } else { &mut self.unsent };
        *counter = counter.saturating_add(1);
        self.last_sent = Some(now);
    }

    fn intention(&self, stamp: Stamp, now: Instant) -> Intention {
        let mut intention = self.pilot.navigation.intention();
        intention.epoch = stamp.epoch;
        intention.sequence = stamp.sequence;
        intention.tick = now;
        intention
    }
}

impl core::fmt::Display for ControllerError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Mission(error) => error.fmt(f),
            Self::Team(error) => error.fmt(f),
            Self::Beacon(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ControllerError {}
