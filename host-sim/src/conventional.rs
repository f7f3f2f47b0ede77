//! Robots with conventional trees: the same body, the same frames, but behavior trees of conditions
//! and actions written by hand.
//!
//! They tick the trees of the paper's figures 8 and 5(a) from `trees/`: loaded, lowered to the
//! core's table, each leaf bound by its name. They are the baseline for inference, written as an
//! engineer would with the same sensors, radio and maps, and no probabilities:
//!
//! - Where am I: where the last move should have led, if the reading says so; any other reading
//!   counts when it comes twice in a row.
//! - Whose goal is which: the least sum of ways from the announced cells; the lower number keeps
//!   the goal it has announced.
//! - Which way: a path in space and time past those with the right of way and those that stand,
//!   constructed again when an obstacle or a teammate is on it.
//! - When to arrive: not before the slowest teammate. Waits come before the last move, and the last
//!   move only when all are one move away.
//! - May I move: into a cell that was announced a tick before, where no teammate can be, and that
//!   none with the right of way goes to.
//! - Who has the right of way: robots on their way to a charger, then the lower number.
//! - A teammate that was not heard may be anywhere it can have come to; one not heard for sixteen
//!   frames stands where it was.
//! - With a low battery: drive to the charger, stay until charged, come back.
//!
//! There is no round and no agreement: every robot decides by itself from the last messages. It
//! announces `Agreed` when it makes the next step of its path in this tick, and `Announced` when it
//! will later. A frame takes one period to arrive; with a slower radio, the robots act less often.
//!
//! ```text
//! frames ─► roster ─► teammates ─┐
//! localiser ─► position ─────────┼─► tree: conditions ask, actions propose ─► released if safe ─► drive
//! scanner ─► known obstacles ────┘                     └─► message ─► frame
//! ```

mod assignment;
mod leaves;
mod message;
mod navigator;
mod position;
mod route;
mod teammate;

pub(crate) use leaves::ConventionalTree;

use self::leaves::ConventionalLeaf;
use self::message::PathMessage;
use self::navigator::{ConventionalNavigator, Orders};
use self::teammate::Teammate;
use crate::body::Body;
use crate::robot::{AnyRobot, shrunk};
use crate::scenario::Scenario;
use crate::tree::BoundTree;
use firmware::hardware::{Battery, Drive, Localiser, Scanner};
use firmware::{Controller, LinkReport, Robot, Settings, Thresholds};
use heapless::Vec as Bounded;
use iibt_core::grid::{Cell, Map};
use iibt_core::navigation::{MAX_GOALS, MAX_HAZARDS, MissionError, Report};
use iibt_core::team::rounds::View;
use iibt_core::team::{Freshness, Invalid, MAX_TEAM, Peers, RobotId};
use iibt_core::time::Instant;
use iibt_core::tree::{self, Full, Halt, Leaves};
use std::num::NonZero;

/// A robot that ticks a conventional tree.
pub(crate) struct ConventionalRobot<const S: usize, const W: usize> {
    tree: &'static BoundTree<ConventionalLeaf>,
    memory: Vec<tree::NodeMemory<Full>>,
    navigator: ConventionalNavigator<S, W>,
    /// The ticks from one control cycle to the next: the delay of a frame.
    period: u32,
    /// The time of the last action.
    acted: Option<Instant>,
    /// The last announced cell of each teammate, and the time since which it is there.
    seen: [(Cell, Instant); MAX_TEAM],
    /// The status of the tree in this tick.
    status: tree::Status,
}

/// The ticks from one control cycle of a conventional robot to the next.
pub(crate) fn period(scenario: &Scenario) -> NonZero<u16> {
    // Scenarios have delays of up to a thousand ticks.
    u16::try_from(scenario.radio.delay).ok().and_then(NonZero::new).unwrap_or(NonZero::<u16>::MIN)
}

impl<const S: usize, const W: usize> ConventionalRobot<S, W> {
    /// A robot of a scenario's team.
    ///
    /// # Errors
    /// [`MissionError`] when the goals do not fit, or the tree is for two goals only.
    pub(crate) fn new(
        scenario: &Scenario,
        figure: ConventionalTree,
        settings: &Settings,
    ) -> Result<Self, MissionError> {
        let robot = settings.member().robot().index();
        let is_for_two = figure == ConventionalTree::Five;
        if (is_for_two && scenario.goals.len() != 2) || scenario.goals.len() > MAX_GOALS {
            return Err(MissionError::GoalCount);
        }
        let orders = Orders {
            robot,
            map: shrunk::<W>(&scenario.map),
            starts: scenario.robots.iter().map(|robot| robot.start).collect(),
            goals: scenario.goals.iter().copied().collect(),
            charger: scenario.robots.get(robot).and_then(|robot| robot.charger),
            low_battery: Thresholds::DEFAULT.low,
            charged: Thresholds::DEFAULT.charged,
            has_fixed_goals: is_for_two,
        };
        let tree = figure.tree();
        Ok(Self {
            tree,
            memory: vec![tree::NodeMemory::NEW; tree.len()],
            navigator: ConventionalNavigator::new(orders),
            period: settings.tick().0,
            acted: None,
            seen: [(Cell(u16::MAX), Instant(0)); MAX_TEAM],
            status: tree::Status::Running,
        })
    }

    /// Returns the state of every teammate from its newest frame.
    fn teammates(&mut self, map: &Map<W>, peers: Peers<'_, PathMessage>) -> Bounded<Teammate, MAX_TEAM> {
        let (orders, now) = (self.navigator.orders(), peers.now());
        let mut team: Bounded<Teammate, MAX_TEAM> = Bounded::new();
        for (robot, &start) in orders.starts.iter().enumerate().filter(|&(robot, _)| robot != orders.robot) {
            let id = RobotId(robot as u8);
            let mut mate = peers.get(id).map_or(Teammate::unheard(robot, start), |peer| {
                Teammate::heard(map, peer.envelope(), now.since(peer.heard()).0 / self.period + 1)
            });
            let (cell, since) = &mut self.seen[robot];
            if std::mem::replace(cell, mate.cells[0]) != mate.cells[0] {
                *since = now;
            }
            mate.still = now.since(*since).0 / self.period;
            mate.is_lost = peers.freshness(id) == Freshness::Lost;
            // There is room: the team has at most MAX_TEAM robots.
            let _ = team.push(mate);
        }
        team
    }
}

impl<H, const S: usize, const W: usize> Robot<H> for ConventionalRobot<S, W>
where
    H: Drive + Localiser + Scanner + Battery,
{
    type Message = PathMessage;

    fn accepts(&self, message: &PathMessage) -> Result<(), Invalid> {
        let map = &self.navigator.orders().map;
        if message.fits(map.len()) && message.path.is_open(map) {
            Ok(())
        } else {
            Err(Invalid("it speaks of another map"))
        }
    }

    fn sense(&mut self, hardware: &mut H, now: Instant) {
        let on_time = self.acted.replace(now).is_some_and(|acted| now.since(acted).0 == self.period);
        let navigator = &mut self.navigator;
        if !on_time {
            navigator.withdraw();
        }
        navigator.charge = hardware.charge();
        navigator.locate(hardware.locate());
        for hazard in (0..MAX_HAZARDS).map_while(|_| hardware.scan()) {
            navigator.notice(hazard);
        }
    }

    fn tick(&mut self, peers: Peers<'_, PathMessage>, now: Instant) -> tree::Status {
        let map = self.navigator.orders().map;
        for hazard in peers.iter().flat_map(|peer| peer.message().hazards.iter().copied()) {
            self.navigator.notice(hazard);
        }
        self.navigator.team = self.teammates(&map, peers);
        let mut hands = Hands { navigator: &mut self.navigator };
        self.status = self.tree.tick(&mut self.memory, &mut hands, now).status;
        self.status
    }

    fn act(&mut self, hardware: &mut H) {
        if let Some(step) = self.navigator.release(self.status) {
            hardware.go(step);
        }
    }

    fn message(&self) -> Option<PathMessage> {
        let navigator = &self.navigator;
        let newest = navigator.hazards.len().saturating_sub(MAX_HAZARDS);
        Some(PathMessage {
            stage: navigator.stage,
            goal: navigator.goal,
            path: navigator.path,
            step: navigator.step.min(navigator.path.len()) as u8,
            hazards: navigator.hazards.iter().skip(newest).copied().collect(),
        })
    }
}

/// The skills as the leaves of the tree.
struct Hands<'n, const S: usize, const W: usize> {
    navigator: &'n mut ConventionalNavigator<S, W>,
}

impl<const S: usize, const W: usize> Leaves<ConventionalLeaf> for Hands<'_, S, W> {
    fn condition(&mut self, leaf: &ConventionalLeaf, _: Instant) -> bool {
        self.navigator.holds(*leaf)
    }

    fn on_start(&mut self, leaf: &ConventionalLeaf, _: Instant) -> tree::Status {
        self.navigator.perform(*leaf)
    }

    fn on_running(&mut self, leaf: &ConventionalLeaf, now: Instant) -> tree::Status {
        self.on_start(leaf, now)
    }

    fn on_halted(&mut self, _: &ConventionalLeaf, _: Instant) -> Halt {
        Halt::Done
    }
}

impl<const S: usize, const W: usize> AnyRobot for Controller<ConventionalRobot<S, W>, Body> {
    fn tick(&mut self) -> tree::Status {
        let is_due = self.hardware().clock.now.is_multiple_of(self.robot().period);
        if is_due { Controller::tick(self) } else { tree::Status::Running }
    }

    fn report(&self) -> Report {
        let navigator = &self.robot().navigator;
        Report {
            stage: navigator.stage,
            round: 0,
            members: View::EMPTY,
            goal: navigator.goal,
            path: navigator.path,
            step: navigator.step,
            policy: None,
            probability: 1.0,
            cell: navigator.position.last(),
            confidence: self.belief(navigator.position.last()),
            surprise: Some(0.0),
            waypoint: navigator.waypoints.first().copied(),
            obstructed: None,
            put_off: None,
            left_behind: None,
            look_out: None,
            cause: None,
            waiting: None,
            failure: None,
            short_by: 0,
        }
    }

    fn link_report(&self) -> LinkReport {
        Controller::link_report(self)
    }

    fn activity(&self) -> Option<&'static str> {
        self.robot().navigator.last.map(|skill| skill.name())
    }

    fn visit(&mut self, cell: Cell) -> bool {
        let navigator = &mut self.robot_mut().navigator;
        let is_free = navigator.orders().map.is_free(cell) && !navigator.hazards.contains(&cell);
        is_free && navigator.waypoints.push(cell).is_ok()
    }

    fn waypoints(&self) -> &[Cell] {
        &self.robot().navigator.waypoints
    }

    /// Returns the probability of a cell: of one, or of two equally while a move is under way.
    fn belief(&self, cell: Cell) -> f32 {
        let position = &self.robot().navigator.position;
        let is_likely = position.last() == cell;
        match position.here() {
            Some(_) => f32::from(u8::from(is_likely)),
            None => f32::from(u8::from(is_likely)) / 2.0,
        }
    }

    fn body(&mut self) -> &mut Body {
        self.hardware_mut()
    }
}
