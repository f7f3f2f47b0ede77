//! A robot of section 5.1 on the host whose teammate is the image in the emulator, and forged
//! frames.

use firmware::missions::{CANDIDATES, CELLS, SECTION_5_1, WORDS};
use host_sim::{AnyRobot, EventEffect, Faults, Flight, KEY, NavigatorFlight};
use iibt_core::navigation::{Intention, Mission, Navigation, Said};
use iibt_core::team::{Context, Key, MAX_FRAME, SipHash64, encode};

/// The key of the image `team_member`.
pub const DEMO_KEY: Key = Key::new(*b"section 5.1 demo");

/// One of the robots of section 5.1; the others have stopped.
pub struct OnHost {
    flight: NavigatorFlight<'static, CELLS, WORDS, CANDIDATES>,
    number: usize,
}

impl OnHost {
    /// The robot with this number, from zero.
    ///
    /// # Panics
    /// When the mission is not sound.
    #[must_use]
    pub fn robot(number: usize) -> Self {
        let mut flight = Flight::with_key(&SECTION_5_1, DEMO_KEY, Faults::default(), 0).expect("it is sound");
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
    pub fn navigation(&self) -> &Navigation<'static, CELLS, WORDS, CANDIDATES> {
        self.flight.robot(self.number).robot().navigation()
    }
}

/// What the frames of a mission belong to.
#[must_use]
pub fn context<const W: usize>(mission: &Mission<'_, W>) -> Context {
    Context::of::<Intention>(0, mission.id())
}

/// Has every robot receive an intention, whichever robot it names, with a valid tag.
///
/// # Panics
/// When no frame carries such an intention.
pub fn overhear<R: AnyRobot, const W: usize>(
    flight: &mut Flight<'_, R>,
    mission: &Mission<'_, W>,
    said: &Said,
) {
    let mut buffer = [0; MAX_FRAME];
    let frame = encode(said, &SipHash64::new(KEY), context(mission), &mut buffer).expect("it fits a frame");
    (0..mission.starts.len()).for_each(|robot| flight.deliver(robot, frame));
}
