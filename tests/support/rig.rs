//! A robot on a bench: a body whose senses and radio a test holds in its hands.

use core::num::NonZero;
use firmware::hardware::{Battery, Clock, Drive, Link, Localiser, Scanner};
use firmware::missions::{CANDIDATES, CELLS, SECTION_5_1, WORDS};
use firmware::{Controller, Navigator, Settings};
use iibt_core::grid::{Cell, Map, Move};
use iibt_core::navigation::Intention;
use iibt_core::team::{Context, Key, Member, RobotId};
use iibt_core::time::Instant;
use std::collections::VecDeque;

/// The key of the image `team_member`.
pub const DEMO_KEY: Key = Key::new(*b"section 5.1 demo");

/// One of the robots of section 5.1 on the bench.
pub type Bench = Controller<Navigator<'static, CELLS, WORDS, CANDIDATES>, Body>;

/// A robot of section 5.1, by its number from zero.
///
/// # Panics
/// When there is no such robot.
#[must_use]
pub fn robot(number: u8) -> Bench {
    let start = SECTION_5_1.starts[usize::from(number)];
    let settings = settings(number, SECTION_5_1.starts.len(), 1);
    let robot = Navigator::new(&SECTION_5_1, &settings).expect("the mission is sound");
    Bench::new(robot, settings, Body::on(start))
}

/// The settings of a robot of a team with the demonstration key, for a clock that counts its ticks.
///
/// # Panics
/// When the team has no such robot.
#[must_use]
pub fn settings(number: u8, team: usize, epoch: u32) -> Settings {
    let member = Member::new(RobotId(number), team).expect("the team has such a robot");
    Settings::new(member, DEMO_KEY, epoch, NonZero::<u16>::MIN)
}

/// What frames of section 5.1 belong to.
#[must_use]
pub fn context() -> Context {
    Context::of::<Intention>(0, SECTION_5_1.id())
}

/// Ticks a robot on the bench once with what it has heard, and makes its move; returns what it sent.
pub fn tick(robot: &mut Bench, heard: &[u8]) -> Vec<u8> {
    let body = robot.hardware_mut();
    body.now = Instant(body.now.0 + 1);
    body.inbox.extend(heard);
    robot.tick();
    let body = robot.hardware_mut();
    body.carry_out(&SECTION_5_1.map);
    body.outbox.drain(..).flatten().collect()
}

/// A body that does what it is told and reads where it stands.
#[derive(Clone, Debug)]
pub struct Body {
    /// The truth about where it is.
    pub cell: Cell,
    /// The present.
    pub now: Instant,
    /// What the localiser reads instead of the truth, if it does.
    pub reading: Option<Cell>,
    /// Obstacles in view that were not scanned yet.
    pub hazards: Vec<Cell>,
    /// The charge in percent.
    pub charge: u8,
    /// Bytes that have arrived.
    pub inbox: VecDeque<u8>,
    /// Frames that were sent.
    pub outbox: Vec<Vec<u8>>,
    /// The move that was asked for and not made yet.
    pub asked: Option<Move>,
    /// The ticks that a move takes.
    pub pace: u32,
    /// Where a move leads that is not done yet, and the ticks that it takes from now on.
    pub under_way: Option<(Cell, u32)>,
    /// Whether the localiser reads nothing.
    pub blind: bool,
    /// Whether moves fail and leave the body where it is.
    pub stuck: bool,
}

impl Body {
    /// A body on a cell, at time zero, fully charged.
    #[must_use]
    pub fn on(cell: Cell) -> Self {
        Self {
            cell,
            now: Instant(0),
            reading: None,
            hazards: vec![],
            charge: 100,
            inbox: VecDeque::new(),
            outbox: vec![],
            asked: None,
            pace: 1,
            under_way: None,
            blind: false,
            stuck: false,
        }
    }

    /// The cells that the body is in: two while it is on its way.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        [Some(self.cell), self.under_way.map(|(to, _)| to)].into_iter().flatten()
    }

    /// Makes the move that was asked for, or goes on with the last; returns the cell it came from.
    pub fn carry_out<const W: usize>(&mut self, map: &Map<W>) -> Cell {
        let before = self.cell;
        if let Some(step) = self.asked.take() {
            let next = map.neighbour(self.cell, step);
            let goes = next != self.cell && map.is_free(next) && !self.stuck;
            self.under_way = self.under_way.or(goes.then_some((next, self.pace)));
        }
        self.under_way = match self.under_way {
            Some((to, 0 | 1)) => {
                self.cell = to;
                None
            }
            moving => moving.map(|(to, ticks)| (to, ticks - 1)),
        };
        before
    }
}

impl Link for Body {
    fn receive(&mut self) -> Option<u8> {
        self.inbox.pop_front()
    }
    fn send(&mut self, frame: &[u8]) -> bool {
        self.outbox.push(frame.to_vec());
        true
    }
}

impl Drive for Body {
    fn go(&mut self, step: Move) {
        self.asked = Some(step);
    }
    fn is_moving(&mut self) -> bool {
        self.under_way.is_some()
    }
    fn stop(&mut self) {
        self.asked = None;
    }
}

impl Localiser for Body {
    fn locate(&mut self) -> Option<Cell> {
        (!self.blind).then(|| self.reading.unwrap_or(self.cell))
    }
}

impl Scanner for Body {
    fn scan(&mut self) -> Option<Cell> {
        self.hazards.pop()
    }
}

impl Battery for Body {
    fn charge(&mut self) -> u8 {
        self.charge
    }
}

impl Clock for Body {
    fn now(&mut self) -> Instant {
        self.now
    }
}
