//! Conventional robots: the same body, the same frames, but behavior trees of conditions and actions written by hand.
//!
//! They tick the trees of the paper's figures 8 and 5(a) as they stand in `trees/`: loaded, lowered to the core's table, each
//! leaf bound by its name to a skill. They are what inference is compared with, so they are made as an engineer would make
//! them who has the same sensors, radio and maps, and no probabilities:
//!
//! | question | answer |
//! |---|---|
//! | where am I | where the last move should have led, if the reading says so; any other reading counts when it comes twice in a row |
//! | whose goal is which | least sum of ways from the announced cells; the lower number keeps the goal it has announced |
//! | which way | a path in space and time past those with the right of way and those that stand, constructed anew when an obstacle or a teammate is on it |
//! | when to arrive | not before the slowest teammate: waits before the last move, and the last move only when all are one move away |
//! | may I move | into a cell that was announced a tick before, where no teammate can be, and that none with the right of way goes to |
//! | who has the right of way | robots on their way to a charger, then the lower number |
//! | who was not heard | may be anywhere it can have come to; one not heard for sixteen frames stands where it was |
//! | battery low | drive to the charger, stay until charged, come back |
//!
//! There is no round and no agreement: every robot decides by itself from what it heard last, and announces in the same
//! frames as all others, `Agreed` when it makes the next step of its path now and `Announced` when it will
//! later. A frame takes one period to arrive; where the radio is slower, the robots act as much more seldom.
//!
//! ```text
//! frames ─► roster ─► teammates ─┐
//! localiser ─► position ─────────┼─► tree: conditions ask, actions propose ─► released if safe ─► drive
//! scanner ─► obstacles in mind ──┘                     └─► intention ─► frame
//! ```

mod assignment;
mod leaves;
mod navigator;
mod position;
mod route;
mod teammate;

pub(crate) use leaves::Figure;

use self::leaves::Skill;
use self::navigator::{Navigator, Orders};
use self::teammate::Teammate;
use crate::body::Body;
use crate::robot::{Robot, shrunk};
use crate::scenario::Scenario;
use crate::tree::BoundTree;
use firmware::hardware::{Battery, Drive, Link, Localiser, Scanner};
use firmware::{ControllerError, Report, Settings};
use heapless::Vec as Bounded;
use iibt_core::grid::{Cell, Map};
use iibt_core::iibt::navigation::{MAX_GOALS, MissionError};
use iibt_core::team::{
    Counters, Deframer, Freshness, Intention, Limits, MAX_FRAME, MAX_HAZARDS, MAX_TEAM, Numbering, Peer,
    RobotId, Roster, Round, SipHash64, encode,
};
use iibt_core::time::{Duration, Instant};
use iibt_core::tree::{self, Full, Halt, Leaves};

/// A robot that ticks a conventional tree.
pub(crate) struct Conventional<const S: usize, const W: usize> {
    body: Body,
    tree: &'static BoundTree<Skill>,
    memory: Vec<tree::NodeMemory<Full>>,
    navigator: Navigator<S, W>,
    roster: Roster,
    deframer: Deframer,
    auth: SipHash64,
    numbering: Numbering,
    /// The ticks from one control cycle to the next: what a frame takes.
    period: u32,
    /// When it acted last.
    acted: Option<Instant>,
    /// The cell that each teammate was last heard to be in, and since when.
    seen: [(Cell, Instant); MAX_TEAM],
    sent: u32,
}

impl<const S: usize, const W: usize> Conventional<S, W> {
    /// Robot `robot` of a scenario's team.
    ///
    /// # Errors
    /// [`ControllerError`] when the team or the goals do not fit, or the tree is for two goals only.
    pub(crate) fn new(
        scenario: &Scenario,
        figure: Figure,
        robot: u8,
        settings: Settings,
    ) -> Result<Self, ControllerError> {
        let period = scenario.radio.delay.max(1);
        let limits = Limits::for_beacons(Duration(period)).map_err(ControllerError::Beacon)?;
        let team = scenario.robots.len();
        let roster = Roster::new(RobotId(robot), team, limits).map_err(ControllerError::Team)?;
        let is_for_two = figure == Figure::Five;
        if (is_for_two && scenario.goals.len() != 2) || scenario.goals.len() > MAX_GOALS {
            return Err(ControllerError::Mission(MissionError::GoalCount));
        }
        let orders = Orders {
            robot: usize::from(robot),
            map: shrunk::<W>(&scenario.map),
            starts: scenario.robots.iter().map(|robot| robot.start).collect(),
            goals: scenario.goals.iter().copied().collect(),
            charger: scenario.robots.get(usize::from(robot)).and_then(|robot| robot.charger),
            low_battery: settings.low_battery,
            charged: settings.charged,
            has_fixed_goals: is_for_two,
        };
        let tree = figure.tree();
        Ok(Self {
            body: Body::default(),
            tree,
            memory: vec![tree::NodeMemory::NEW; tree.len()],
            navigator: Navigator::new(orders),
            roster,
            deframer: Deframer::new(),
            auth: SipHash64::new(settings.key),
            numbering: Numbering::new(settings.epoch),
            period,
            acted: None,
            seen: [(Cell(u16::MAX), Instant(0)); MAX_TEAM],
            sent: 0,
        })
    }

    fn act(&mut self, now: Instant) {
        self.listen(now);
        self.sense(now);
        let mut hands = Hands { navigator: &mut self.navigator };
        let status = self.tree.tick(&mut self.memory, &mut hands, now).status;
        if let Some(step) = self.navigator.release(status) {
            self.body.wheels.go(step);
        }
        self.announce(now);
    }

    fn listen(&mut self, now: Instant) {
        self.roster.expire(now);
        while let Some(byte) = self.body.antenna.receive() {
            if let Some(frame) = self.deframer.feed(byte) {
                // The roster counts what it refuses.
                let _ = self.roster.receive(frame, &self.auth, now);
            }
        }
    }

    fn sense(&mut self, now: Instant) {
        let on_time = self.acted.replace(now).is_some_and(|acted| now.since(acted).0 == self.period);
        let navigator = &mut self.navigator;
        if !on_time {
            navigator.withdraw();
        }
        navigator.charge = self.body.battery.charge();
        navigator.locate(self.body.localiser.locate());
        for hazard in (0..MAX_HAZARDS).map_while(|_| self.body.scanner.scan()) {
            navigator.notice(hazard);
        }
        let map = navigator.orders().map;
        for hazard in sound(&self.roster, &map).flat_map(|peer| peer.intention().hazards.iter().copied()) {
            navigator.notice(hazard);
        }
        self.navigator.team = self.teammates(&map, now);
    }

    /// Every teammate as it stands by its newest frame.
    fn teammates(&mut self, map: &Map<W>, now: Instant) -> Bounded<Teammate, MAX_TEAM> {
        let orders = self.navigator.orders();
        let mut team: Bounded<Teammate, MAX_TEAM> = Bounded::new();
        for (robot, &start) in orders.starts.iter().enumerate().filter(|&(robot, _)| robot != orders.robot) {
            let peer = sound(&self.roster, map).find(|peer| peer.intention().robot.index() == robot);
            let mut mate = peer.map_or(Teammate::unheard(robot, start), |peer| {
                Teammate::heard(map, peer.intention(), now.since(peer.heard()).0 / self.period + 1)
            });
            let (cell, since) = &mut self.seen[robot];
            if std::mem::replace(cell, mate.cells[0]) != mate.cells[0] {
                *since = now;
            }
            mate.still = now.since(*since).0 / self.period;
            mate.is_lost = self.roster.freshness(RobotId(robot as u8), now) == Freshness::Lost;
            // There is room: the team has at most MAX_TEAM robots.
            let _ = team.push(mate);
        }
        team
    }

    fn announce(&mut self, now: Instant) {
        let Some(stamp) = self.numbering.next_stamp() else { return };
        let navigator = &self.navigator;
        let newest = navigator.hazards.len().saturating_sub(MAX_HAZARDS);
        let intention = Intention {
            robot: self.roster.own(),
            epoch: stamp.epoch,
            sequence: stamp.sequence,
            tick: now,
            round: Round(0),
            status: navigator.status,
            plan: 0,
            goal: navigator.goal,
            path: navigator.path,
            step: navigator.step.min(navigator.path.len()) as u8,
            probability: 1.0,
            hazards: navigator.hazards.iter().skip(newest).copied().collect(),
        };
        let mut buffer = [0; MAX_FRAME];
        if let Ok(frame) = encode(&intention, &self.auth, &mut buffer) {
            self.sent += u32::from(self.body.antenna.send(frame));
        }
    }

    fn counters(&self) -> Counters {
        *self.roster.counters()
    }
}

/// The teammates that speak of the same map.
fn sound<'r, const W: usize>(roster: &'r Roster, map: &'r Map<W>) -> impl Iterator<Item = &'r Peer> {
    roster.peers().filter(|peer| {
        let said = peer.intention();
        said.fits(map.len()) && said.path.is_open(map)
    })
}

/// The skills as the leaves of the tree.
struct Hands<'n, const S: usize, const W: usize> {
    navigator: &'n mut Navigator<S, W>,
}

impl<const S: usize, const W: usize> Leaves<Skill> for Hands<'_, S, W> {
    fn condition(&mut self, leaf: &Skill, _: Instant) -> bool {
        self.navigator.holds(*leaf)
    }

    fn on_start(&mut self, leaf: &Skill, _: Instant) -> tree::Status {
        self.navigator.perform(*leaf)
    }

    fn on_running(&mut self, leaf: &Skill, now: Instant) -> tree::Status {
        self.on_start(leaf, now)
    }

    fn on_halted(&mut self, _: &Skill, _: Instant) -> Halt {
        Halt::Done
    }
}

impl<const S: usize, const W: usize> Robot for Conventional<S, W> {
    fn tick(&mut self) {
        let now = Instant(self.body.clock.now);
        if now.0.is_multiple_of(self.period) {
            self.act(now);
        }
    }

    fn report(&self) -> Report {
        let navigator = &self.navigator;
        Report {
            status: navigator.status,
            round: Round(0),
            goal: navigator.goal,
            path: navigator.path,
            step: navigator.step,
            probability: 1.0,
            cell: navigator.position.last(),
            confidence: self.belief(navigator.position.last()),
            surprise: Some(0.0),
            waypoint: navigator.waypoints.first().copied(),
            cause: None,
            sent: self.sent,
            unsent: 0,
            dropped: self.deframer.dropped(),
            received: self.counters(),
        }
    }

    fn activity(&self) -> Option<&'static str> {
        self.navigator.last.map(|skill| skill.name())
    }

    fn visit(&mut self, cell: Cell) -> bool {
        let is_free = self.navigator.orders().map.is_free(cell) && !self.navigator.hazards.contains(&cell);
        is_free && self.navigator.waypoints.push(cell).is_ok()
    }

    fn waypoints(&self) -> &[Cell] {
        &self.navigator.waypoints
    }

    /// It believes in one cell, or in two while a move is under way.
    fn belief(&self, cell: Cell) -> f32 {
        let position = &self.navigator.position;
        let is_likely = position.last() == cell;
        match position.here() {
            Some(_) => f32::from(u8::from(is_likely)),
            None => f32::from(u8::from(is_likely)) / 2.0,
        }
    }

    fn body(&mut self) -> &mut Body {
        &mut self.body
    }
}
