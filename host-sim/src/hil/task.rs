//! Emulated robots that work on a table task, with the same robots in process beside them.

use super::difference::{Difference, Done};
use super::machine::Machine;
use super::{Bench, Compared, HilError, Watch, has_emulator, is_readable, start_with};
use crate::provision::Provision;
use crate::radio::KEY;
use crate::task::{Beside, Flown, HostRobot, Station, TableMission, TaskError, TaskShadow, Trouble, Worker};
use crate::testbed::Shadow;
use firmware::Finished;
use firmware::adapters::base::{BaseRequest, Decision, Operation, Sensed, first};
use firmware::missions::TREE_NODES;
use iibt_core::team::{Keys, RobotId};
use serde::Serialize;
use std::collections::VecDeque;
use std::io;
use std::num::NonZero;
use std::rc::Rc;

/// The task whose tables the image has.
const TASK: &str = "bottle-and-plate";

/// The flight of an emulated team that works on a task.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HilFlown {
    /// What was compared.
    pub compared: Compared,
    /// The first difference, at which the flight ended.
    pub difference: Option<Difference>,
    /// The flight.
    #[serde(flatten)]
    pub flown: Flown,
}

/// Flies a task with a team of emulated robots.
///
/// # Errors
/// [`HilError`] when QEMU is missing, a machine fails, or the image has other tables.
pub fn fly_emulated_task(
    mission: &TableMission<'_>,
    seed: u64,
    trouble: Trouble,
    bench: &Bench,
) -> Result<HilFlown, HilError> {
    has_emulator()?;
    is_readable(&bench.image)?;
    if mission.name != TASK {
        return Err(HilError::Scenario(format!("{}: the image has the tables of {TASK}", mission.name)));
    }
    let names = mission.tables.roles().iter().map(|role| role.name.to_owned()).collect();
    for robot in 0..mission.tables.robots() {
        let nodes = mission.tree(robot).map_err(HilError::Task)?.len();
        if nodes > TREE_NODES {
            let reason =
                format!("{}: a tree of {nodes} nodes, but the image has room for {TREE_NODES}", mission.name);
            return Err(HilError::Scenario(reason));
        }
    }
    let watch = Rc::new(Watch::new(names, None));
    let keys = Keys::of_team(&KEY, 0, 0);
    let flown = Machines::start(mission, bench, &watch).ok_or(TaskError::Halted).and_then(|shadow| {
        let (shadow, has_halted) = (Some(Box::new(shadow) as TaskShadow), || watch.has_halted());
        let beside = Beside { keys, shadow, has_halted: &has_halted, record: &mut |_| () };
        mission.fly_with(seed, trouble, beside)
    });
    let difference = watch.difference()?;
    Ok(HilFlown { compared: watch.compared.take(), difference, flown: flown.map_err(HilError::Task)? })
}

/// The machines of a team.
struct Machines {
    machines: Vec<Machine>,
    watch: Rc<Watch>,
    tick: u32,
}

impl Machines {
    /// `None` where the flight has halted because one does not start.
    fn start(mission: &TableMission<'_>, bench: &Bench, watch: &Rc<Watch>) -> Option<Self> {
        let machine = |robot: usize| {
            let provision = Provision {
                tick: NonZero::<u16>::MIN,
                epoch: 1,
                ..Provision::new(RobotId(robot as u8), KEY)
            };
            let page = provision.page_of_task(mission).map_err(io::Error::other);
            let machine = page.and_then(|page| start_with(bench, &watch.name(robot), 1, page));
            machine.inspect_err(|error| watch.fail(robot, error)).ok()
        };
        let machines = (0..mission.tables.robots()).map(machine).collect::<Option<_>>()?;
        Some(Self { machines, watch: Rc::clone(watch), tick: 0 })
    }

    fn begin(&mut self, robot: usize, parts: &Station, received: &VecDeque<u8>) -> io::Result<()> {
        let heard: Vec<u8> = received.iter().copied().collect();
        let percept = &parts.percept;
        let readings = first(percept.readings);
        let sensed = Sensed { time: self.tick, busy: percept.busy, readings };
        let machine = &mut self.machines[robot];
        if !heard.is_empty() {
            machine.deliver(&heard, heard.len())?;
        }
        machine.request(BaseRequest::Sense(sensed))
    }
}

impl<'t> Shadow<HostRobot<'t, Finished>, Station> for Machines {
    fn prepare(&mut self, robot: usize, tick: u32, parts: &Station, received: &VecDeque<u8>) {
        self.tick = tick;
        if let Err(error) = self.begin(robot, parts, received) {
            self.watch.fail(robot, &error);
        }
    }

    fn compare(&mut self, robot: usize, own: &HostRobot<'t, Finished>, parts: &Station, sent: &[Vec<u8>]) {
        if self.watch.has_halted() {
            return;
        }
        let decision = Worker::task(own).and_then(|task| task.decision());
        let in_process = Done {
            operation: parts.command.map(Operation::from),
            decision: decision.map(|made| Decision::new(0, made.choice.into(), &made.posterior)),
            sent: sent.concat(),
            ..Done::default()
        };
        match self.machines[robot].done() {
            Ok(done) => self.watch.compare(robot, self.tick, &done, &in_process),
            Err(error) => self.watch.fail(robot, &error),
        }
    }
}
