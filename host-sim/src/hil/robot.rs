//! An emulated robot, with the same robot in process beside it.

use super::difference::Done;
use super::machine::Machine;
use super::{Sabotage, Watch};
use crate::body::Body;
use crate::phases::WeighedPolicy;
use crate::robot::AnyRobot;
use crate::team::Navigating;
use firmware::adapters::base::{Act, BaseRequest, Decision, Readings, first};
use firmware::hardware::Scanner as _;
use firmware::{LinkReport, missions};
use iibt_core::grid::{Cell, words};
use iibt_core::navigation::{MAX_GOALS, Report};
use iibt_core::tree::{Status, TickEntry};
use std::io;
use std::rc::Rc;

/// The most cells of a map that the image has room for.
pub(super) const CELLS: usize = 64;

/// The words of such a map.
pub(super) const WORDS: usize = words(CELLS, 1);

/// The robot of the image, in process.
pub(super) type InProcess<'m> =
    Navigating<'m, CELLS, WORDS, { missions::LAYERS }, { missions::NODES }, { missions::POLICIES }>;

/// An emulated robot: it gets what the same robot in process gets, and moves its body.
///
/// The first time that it does something else is a [`Difference`], which ends the flight.
pub(super) struct Emulated<'m> {
    number: usize,
    in_process: Box<InProcess<'m>>,
    machine: Machine,
    watch: Rc<Watch>,
    /// The bytes that were not read in the last tick.
    unread: usize,
    visits: Vec<Cell>,
    decided: Option<(u32, usize)>,
}

impl<'m> Emulated<'m> {
    pub(super) fn new(number: usize, in_process: InProcess<'m>, machine: Machine, watch: Rc<Watch>) -> Self {
        Self {
            number,
            in_process: Box::new(in_process),
            machine,
            watch,
            unread: 0,
            visits: Vec::new(),
            decided: None,
        }
    }

    /// What the base reads in this tick.
    fn readings(&mut self) -> Readings {
        let watched: Vec<Cell> = self.in_process.robot().navigation().watched().collect();
        let body = self.in_process.hardware_mut();
        Readings {
            time: body.clock.now,
            cell: body.localiser.reading,
            moving: body.drive.moving,
            charge: body.battery.charge,
            hazards: first(body.scanner.to_report()),
            clear: first(watched.into_iter().filter(|&cell| body.scanner.is_clear(cell))),
            visits: first(std::mem::take(&mut self.visits)),
        }
    }

    /// Gives the machine what the robot in process gets in this tick.
    fn begin(&mut self) -> io::Result<()> {
        let mut readings = self.readings();
        let received = &self.in_process.hardware().link.received;
        let waiting = received.len();
        let mut heard: Vec<u8> = received.iter().skip(self.unread).copied().collect();
        match self.watch.sabotage(self.number, readings.time) {
            Some(Sabotage::Bit) => heard.iter_mut().skip(1).take(1).for_each(|byte| *byte ^= 1 << 3),
            Some(Sabotage::Reading) => readings.cell = readings.cell.map(|cell| Cell(cell.0 ^ 1)),
            None => {}
        }
        if !heard.is_empty() {
            self.machine.deliver(&heard, waiting)?;
        }
        self.machine.request(BaseRequest::Tick(readings))
    }

    /// What the robot in process has done in this tick.
    fn in_process(&mut self) -> Done {
        let navigation = self.in_process.robot().navigation();
        let report = navigation.report();
        let decided = report.policy.map(|policy| (report.round, policy));
        let is_new = std::mem::replace(&mut self.decided, decided) != decided;
        let decision = decided.filter(|_| is_new);
        let posterior = navigation.weighed().posterior();
        let decision = decision.map(|(round, policy)| Decision::new(round, policy, posterior));
        let watched = Act::new(None, navigation.watched()).watched.to_vec();
        let body = self.in_process.hardware();
        let (step, sent) = (body.drive.command, body.link.sent.concat());
        Done { step, operation: None, decision, sent, watched }
    }

    /// Compares what the machine has done, and has the body do that.
    fn compare(&mut self, done: Done) {
        let (in_process, tick) = (self.in_process(), self.in_process.hardware().clock.now);
        self.watch.compare(self.number, tick, &done, &in_process);
        let body = self.in_process.hardware_mut();
        body.drive.command = done.step;
        body.link.sent = vec![done.sent];
        body.link.sent.retain(|frame| !frame.is_empty());
    }
}

impl AnyRobot for Emulated<'_> {
    fn prepare(&mut self) {
        if let Err(error) = self.begin() {
            self.watch.fail(self.number, &error);
        }
    }

    fn tick(&mut self) -> Status {
        let status = self.in_process.tick();
        self.unread = self.in_process.hardware().link.received.len();
        if self.watch.has_halted() {
            return status;
        }
        match self.machine.done() {
            Ok(done) => self.compare(done),
            Err(error) => self.watch.fail(self.number, &error),
        }
        status
    }

    fn report(&self) -> Report {
        AnyRobot::report(&*self.in_process)
    }

    fn link_report(&self) -> LinkReport {
        AnyRobot::link_report(&*self.in_process)
    }

    fn activity(&self) -> Option<&'static str> {
        self.in_process.activity()
    }

    fn tree_entry(&self) -> Option<TickEntry<'_>> {
        self.in_process.tree_entry()
    }

    fn visit(&mut self, cell: Cell) -> bool {
        self.visits.push(cell);
        self.in_process.visit(cell)
    }

    fn set_goal_preferences(&mut self, values: &[f32; MAX_GOALS]) {
        self.in_process.set_goal_preferences(values);
    }

    fn waypoints(&self) -> &[Cell] {
        self.in_process.waypoints()
    }

    fn belief(&self, cell: Cell) -> f32 {
        self.in_process.belief(cell)
    }

    fn worlds(&self) -> Vec<f32> {
        self.in_process.worlds()
    }

    fn weighed(&self) -> Vec<WeighedPolicy> {
        self.in_process.weighed()
    }

    fn body(&mut self) -> &mut Body {
        self.in_process.body()
    }
}
