//! A robot's hardware, composed of parts.

use super::Absent;
use crate::hardware::{Battery, Clock, Drive, Link, Localiser, Scanner};
use iibt_core::grid::{Cell, Move};
use iibt_core::navigation::{Reading, Sighting};
use iibt_core::time::Instant;

/// A composition of hardware parts; a part that the robot does not have is [`Absent`].
///
/// ```
/// use firmware::adapters::Body;
/// use firmware::hardware::{Battery, Clock, Link, Scanner};
/// use iibt_core::time::Instant;
///
/// struct Radio;
/// impl Link for Radio {
///     fn receive(&mut self) -> Option<u8> {
///         None
///     }
///     fn send(&mut self, _: &[u8]) -> bool {
///         true
///     }
/// }
///
/// struct Tick(u32);
/// impl Clock for Tick {
///     fn now(&mut self) -> Instant {
///         Instant(self.0)
///     }
/// }
///
/// let mut body = Body::new(Radio, Tick(7));
/// assert_eq!(body.now(), Instant(7));
/// assert_eq!((body.scan(), body.charge()), (None, 100)); // no scanner, no battery gauge
/// ```
#[derive(Clone, Debug)]
pub struct Body<L, C, D = Absent, P = Absent, S = Absent, B = Absent> {
    /// The radio or wire to the teammates.
    pub link: L,
    /// The clock.
    pub clock: C,
    /// The wheels.
    pub drive: D,
    /// The positioning.
    pub localiser: P,
    /// The obstacle sensor.
    pub scanner: S,
    /// The battery gauge.
    pub battery: B,
}

impl<L, C> Body<L, C> {
    /// Creates a body with a link and a clock, and nothing else.
    #[must_use]
    pub const fn new(link: L, clock: C) -> Self {
        Self { link, clock, drive: Absent, localiser: Absent, scanner: Absent, battery: Absent }
    }

    /// Adds wheels and positioning.
    #[must_use]
    pub fn driving<D, P>(self, drive: D, localiser: P) -> Body<L, C, D, P> {
        let Self { link, clock, scanner, battery, .. } = self;
        Body { link, clock, drive, localiser, scanner, battery }
    }
}

impl<L, C, D, P, S, B> Body<L, C, D, P, S, B> {
    /// Adds or replaces the battery gauge.
    #[must_use]
    pub fn powered<G>(self, battery: G) -> Body<L, C, D, P, S, G> {
        let Self { link, clock, drive, localiser, scanner, .. } = self;
        Body { link, clock, drive, localiser, scanner, battery }
    }
}

impl<L: Link, C, D, P, S, B> Link for Body<L, C, D, P, S, B> {
    fn receive(&mut self) -> Option<u8> {
        self.link.receive()
    }
    fn receive_into(&mut self, bytes: &mut [u8]) -> usize {
        self.link.receive_into(bytes)
    }
    fn receive_packet(&mut self, packet: &mut [u8]) -> Option<usize> {
        self.link.receive_packet(packet)
    }
    fn send(&mut self, frame: &[u8]) -> bool {
        self.link.send(frame)
    }
}

impl<L, C: Clock, D, P, S, B> Clock for Body<L, C, D, P, S, B> {
    fn now(&mut self) -> Instant {
        self.clock.now()
    }
}

impl<L, C, D: Drive, P, S, B> Drive for Body<L, C, D, P, S, B> {
    fn go(&mut self, step: Move) {
        self.drive.go(step);
    }
    fn is_moving(&mut self) -> bool {
        self.drive.is_moving()
    }
    fn stop(&mut self) {
        self.drive.stop();
    }
}

impl<L, C, D, P: Localiser, S, B> Localiser for Body<L, C, D, P, S, B> {
    fn locate(&mut self) -> Option<Cell> {
        self.localiser.locate()
    }
}

impl<L, C, D, P, S: Scanner, B> Scanner for Body<L, C, D, P, S, B> {
    fn scan(&mut self) -> Option<Cell> {
        self.scanner.scan()
    }

    fn is_clear(&mut self, cell: Cell) -> bool {
        self.scanner.is_clear(cell)
    }

    fn recognise(&mut self) -> Option<Reading> {
        self.scanner.recognise()
    }

    fn sight(&mut self) -> Option<Sighting> {
        self.scanner.sight()
    }
}

impl<L, C, D, P, S, B: Battery> Battery for Body<L, C, D, P, S, B> {
    fn charge(&mut self) -> u8 {
        self.battery.charge()
    }
}
