//! A robot of section 5.1 on the host whose teammate is the image in the emulator, and forged
//! frames.

use firmware::missions::{CELLS, LAYERS, NODES, POLICIES, SECTION_5_1, WORDS, reduced};
use host_sim::{AnyRobot, EventEffect, Faults, Flight, KEY, NavigatorFlight, Provision};
use iibt_core::navigation::{Intention, Navigation};
use iibt_core::team::{Context, Envelope, Key, Keys, MAX_FRAME, RobotId, SipHash64, encode};

/// The key of the image `team_member`.
pub const DEMO_KEY: Key = Key::new(*b"section 5.1 demo");

/// The keys of its senders.
#[must_use]
pub fn demo_keys() -> Keys {
    Keys::of_team(&DEMO_KEY, 0, 0)
}

/// The page that makes it this robot.
///
/// # Panics
/// When the mission is not sound.
#[must_use]
pub fn demo_page(robot: u8) -> Vec<u8> {
    let provision = Provision { epoch: 1, ..Provision::new(RobotId(robot), DEMO_KEY) };
    provision.page_of(&SECTION_5_1).expect("it fits")
}

/// What a robot of section 5.1 announces.
pub type Message = Intention<WORDS, POLICIES>;

/// One of the robots of section 5.1, with any sizes; the others have stopped.
pub struct SizedOnHost<const L: usize, const M: usize, const K: usize> {
    flight: NavigatorFlight<'static, CELLS, WORDS, L, M, K>,
    number: usize,
}

/// One with the sizes of the image.
pub type OnHost = SizedOnHost<LAYERS, NODES, POLICIES>;

/// One in the reduced configuration.
pub type ReducedOnHost = SizedOnHost<{ reduced::LAYERS }, { reduced::NODES }, { reduced::POLICIES }>;

impl<const L: usize, const M: usize, const K: usize> SizedOnHost<L, M, K> {
    /// The robot with this number, from zero.
    ///
    /// # Panics
    /// When the mission is not sound.
    #[must_use]
    pub fn robot(number: usize) -> Self {
        let mut flight =
            Flight::with_key(&SECTION_5_1, demo_keys(), Faults::default(), 0).expect("it is sound");
        let others = (0..SECTION_5_1.starts.len()).filter(|&other| other != number);
        others.for_each(|other| flight.cause(EventEffect::Stop(other, None)));
        Self { flight, number }
    }

    /// Ticks it once with what it has heard; returns what it sent.
    pub fn tick(&mut self, heard: &[u8]) -> Vec<u8> {
        self.flight.deliver(self.number, heard);
        self.flight.tick();
        self.flight.sent(self.number).concat()
    }

    /// Its task.
    #[must_use]
    pub fn navigation(&self) -> &Navigation<'static, CELLS, WORDS, L, M, K> {
        self.flight.robot(self.number).robot().navigation()
    }

    /// What the frames of its team belong to.
    #[must_use]
    pub fn context(&self) -> Context {
        context(self.navigation())
    }
}

/// What the frames of a robot's team belong to.
#[must_use]
pub fn context<const S: usize, const W: usize, const L: usize, const M: usize, const K: usize>(
    robot: &Navigation<'_, S, W, L, M, K>,
) -> Context {
    Context::of::<Intention<W, K>>(0, robot.mission_id())
}

/// Has every robot receive an intention, whichever robot it names, with a valid tag.
///
/// # Panics
/// When no frame carries such an intention.
pub fn overhear<R: AnyRobot, const W: usize, const K: usize>(
    flight: &mut Flight<'_, R>,
    context: Context,
    said: &Envelope<Intention<W, K>>,
) {
    let mut buffer = [0; MAX_FRAME];
    let frame = encode(said, &SipHash64::new(KEY), context, &mut buffer).expect("it fits a frame");
    (0..flight.cells().len()).for_each(|robot| flight.deliver(robot, frame));
}
