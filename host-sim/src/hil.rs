//! A team of emulated microcontrollers, each with the image that is flashed, in the simulated
//! world.
//!
//! Beside every emulated robot the same robot runs in process, with the same readings and frames:
//! what they decide, send and do is compared in every tick, bit by bit.

mod difference;
mod image;
mod machine;
mod robot;
mod task;

pub use difference::Difference;
pub use image::{build_image, build_task_image};
pub use task::{HilFlown, fly_emulated_task};

use self::difference::Done;
use self::machine::{EMULATOR, Machine, Setup};
use self::robot::{CELLS, Emulated, InProcess, WORDS};
use crate::body::body;
use crate::fly::{Conditions, Interventions, Observer, fly_team};
use crate::provision::Provision;
use crate::radio::KEY;
use crate::record::Record;
use crate::robot::AnyRobot;
use crate::scenario::Scenario;
use crate::task::TaskError;
use crate::team::{Boot, Pilot, TeamError, UNLIMITED, on_mission};
use firmware::page::Slots;
use firmware::{Controller, Navigator, Settings};
use iibt_core::navigation::Mission;
use iibt_core::team::{Keys, Member, RobotId};
use serde::Serialize;
use std::cell::RefCell;
use std::io::{self, ErrorKind};
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::rc::Rc;
use thiserror::Error;

/// Where the flash begins in the memory of the microcontroller.
const FLASH: u32 = 0x0800_0000;

/// How a team is emulated.
#[derive(Clone, Debug, Default)]
pub struct Bench {
    /// The ELF file of the image; see [`build_image`].
    pub image: PathBuf,
    /// The restarts: the robot, by its index, and the tick before which its machine is reset.
    pub restarts: Vec<(usize, u32)>,
    /// The starts of the robots before this flight: the first epoch is the one after.
    pub starts: u32,
    /// Frames of another flight that the robots hear beside those of this one, as many in a tick as
    /// there are robots; see [`FrameRecording`](crate::FrameRecording).
    pub replay: Vec<u8>,
    /// The folder for the robots' logs, as defmt frames.
    pub logs: Option<PathBuf>,
    /// A fault that is put in to see it found: the robot, the tick, and what goes wrong.
    pub sabotage: Option<(usize, u32, Sabotage)>,
}

/// A fault between the world and an emulated robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sabotage {
    /// One bit of the first frame that it hears is wrong.
    Bit,
    /// It reads a neighbour's cell.
    Reading,
}

/// The flight of an emulated team.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HilRecord {
    /// What was compared.
    pub compared: Compared,
    /// The first difference, at which the flight ended.
    pub difference: Option<Difference>,
    /// The flight.
    #[serde(flatten)]
    pub record: Record,
}

/// What emulated robots and robots in process have done alike, as far as they did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Compared {
    /// The ticks of all robots.
    pub ticks: u32,
    /// The joint decisions, with their posteriors.
    pub decisions: u32,
    /// The bytes of frames.
    pub bytes: u32,
    /// The moves, or the operators of a table task.
    pub moves: u32,
}

/// Why a team is not emulated to the end.
#[derive(Debug, Error)]
pub enum HilError {
    /// There is no QEMU.
    #[error(
        "{EMULATOR} does not start ({0}): install the package qemu-system-arm (Debian, Ubuntu, Fedora, Arch) or qemu (Homebrew)"
    )]
    NoEmulator(io::Error),
    /// The image does not build.
    #[error("the image does not build: {0}")]
    Build(String),
    /// The image is no file that can be read.
    #[error("{0}: {1}")]
    Image(String, io::Error),
    /// The team or its mission is refused.
    #[error(transparent)]
    Team(#[from] TeamError),
    /// The task is refused.
    #[error(transparent)]
    Task(TaskError),
    /// The scenario asks for more than the image has.
    #[error("{0}")]
    Scenario(String),
    /// A machine has failed.
    #[error("the machine of {robot} {error}")]
    Machine {
        /// The robot's name.
        robot: String,
        /// What has happened.
        error: String,
    },
}

/// Why a flight ends before its time.
#[derive(Debug)]
enum Halt {
    Difference(Difference),
    Error(HilError),
}

/// What the emulated robots of a flight share.
struct Watch {
    names: Vec<String>,
    sabotage: Option<(usize, u32, Sabotage)>,
    halt: RefCell<Option<Halt>>,
    compared: RefCell<Compared>,
}

impl Watch {
    fn new(names: Vec<String>, sabotage: Option<(usize, u32, Sabotage)>) -> Self {
        Self { names, sabotage, halt: RefCell::new(None), compared: RefCell::default() }
    }

    /// The first difference, if one has ended the flight.
    fn difference(&self) -> Result<Option<Difference>, HilError> {
        match self.halt.take() {
            Some(Halt::Error(error)) => Err(error),
            Some(Halt::Difference(difference)) => Ok(Some(difference)),
            None => Ok(None),
        }
    }

    fn name(&self, robot: usize) -> String {
        self.names.get(robot).cloned().unwrap_or_default()
    }

    fn sabotage(&self, robot: usize, tick: u32) -> Option<Sabotage> {
        self.sabotage.filter(|&(who, when, _)| (who, when) == (robot, tick)).map(|(_, _, what)| what)
    }

    fn has_halted(&self) -> bool {
        self.halt.borrow().is_some()
    }

    /// Ends the flight; the first reason counts.
    fn halt(&self, reason: Halt) {
        self.halt.borrow_mut().get_or_insert(reason);
    }

    fn fail(&self, robot: usize, error: &io::Error) {
        self.halt(Halt::Error(HilError::Machine { robot: self.name(robot), error: error.to_string() }));
    }

    /// Compares a tick of a robot with the same tick in process.
    fn compare(&self, robot: usize, tick: u32, done: &Done, in_process: &Done) {
        if let Some(what) = done.differs_from(in_process) {
            self.halt(Halt::Difference(Difference { robot: self.name(robot), tick, what }));
            return;
        }
        let mut compared = self.compared.borrow_mut();
        compared.ticks += 1;
        compared.decisions += u32::from(done.decision.is_some());
        compared.moves += u32::from(done.step.is_some() || done.operation.is_some());
        compared.bytes += done.sent.len() as u32;
    }
}

/// Flies a scenario with a team of emulated robots.
///
/// # Errors
/// [`HilError`] when QEMU is missing, a machine fails, or the scenario does not fit the image. A
/// difference is no error: it ends the flight, and is in the record.
pub fn fly_emulated(
    scenario: &Scenario,
    conditions: Conditions,
    bench: &Bench,
    observer: &mut dyn Observer,
) -> Result<HilRecord, HilError> {
    has_emulator()?;
    is_readable(&bench.image)?;
    fits(scenario)?;
    let names = scenario.robots.iter().map(|robot| robot.name.clone()).collect();
    let watch = Rc::new(Watch::new(names, bench.sabotage));
    let conditions = Conditions { tree: Pilot::Image, ..conditions };
    let record = on_mission::<WORDS, _>(scenario, |mission| {
        let boot = boot(mission, scenario, bench, &watch);
        let interventions = Interventions {
            restarts: &bench.restarts,
            replay: &bench.replay,
            has_halted: &|| watch.has_halted(),
        };
        fly_team(scenario, conditions, &interventions, boot, observer)
    });
    let difference = watch.difference()?;
    Ok(HilRecord { compared: watch.compared.take(), difference, record: record? })
}

fn has_emulator() -> Result<(), HilError> {
    let version = Command::new(EMULATOR).arg("--version").stdin(Stdio::null()).output();
    match version {
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => Err(HilError::NoEmulator(io::Error::other(output.status.to_string()))),
        Err(error) => Err(HilError::NoEmulator(error)),
    }
}

fn is_readable(image: &Path) -> Result<(), HilError> {
    let opened = std::fs::File::open(image).map(drop);
    opened.map_err(|error| HilError::Image(image.display().to_string(), error))
}

/// Whether the image has room for a scenario.
fn fits(scenario: &Scenario) -> Result<(), HilError> {
    let (cells, missions) = (scenario.map.len(), scenario.missions);
    if cells > CELLS {
        let reason = format!("{}: a map of {cells} cells, but the image has room for {CELLS}", scenario.name);
        return Err(HilError::Scenario(reason));
    }
    if missions > 1 {
        let reason = format!("{}: a series of {missions} missions, but `hil` flies one", scenario.name);
        return Err(HilError::Scenario(reason));
    }
    Ok(())
}

/// Starts a machine for each robot. Where that fails, the flight has halted.
fn boot<'m>(
    mission: &'m Mission<'m, WORDS>,
    scenario: &'m Scenario,
    bench: &'m Bench,
    watch: &Rc<Watch>,
) -> Boot<'m, dyn AnyRobot + 'm> {
    let watch = Rc::clone(watch);
    Box::new(move |robot, epoch| {
        let budget = NonZero::new(scenario.inference.budget.unwrap_or(UNLIMITED));
        let epoch = bench.starts.saturating_add(epoch);
        let provision =
            Provision { budget, tick: NonZero::<u16>::MIN, epoch, ..Provision::new(RobotId(robot), KEY) };
        let in_process = in_process(mission, &provision)?;
        let number = usize::from(robot);
        match start(bench, &watch.name(number), mission, &provision) {
            Ok(machine) => Ok(Box::new(Emulated::new(number, in_process, machine, Rc::clone(&watch)))),
            Err(error) => {
                watch.fail(number, &error);
                Ok(Box::new(in_process))
            }
        }
    })
}

/// The robot that the image makes of such a page.
fn in_process<'m>(
    mission: &'m Mission<'m, WORDS>,
    provision: &Provision,
) -> Result<InProcess<'m>, TeamError> {
    let keys = Keys::of_team(&provision.key, provision.channel, provision.rotation);
    let member = Member::new(provision.robot, mission.starts.len())?;
    let settings = Settings::with_keys(member, keys, provision.epoch, provision.tick);
    let mut navigator = Navigator::new(mission, &settings)?;
    navigator.set_thresholds(provision.thresholds);
    navigator.navigation_mut().set_budget(provision.budget.map_or(UNLIMITED, NonZero::get));
    Ok(Controller::new(navigator, settings, body()))
}

fn start(
    bench: &Bench,
    name: &str,
    mission: &Mission<'_, WORDS>,
    provision: &Provision,
) -> io::Result<Machine> {
    let page = provision.page_of(mission).map_err(io::Error::other)?;
    start_with(bench, name, provision.epoch, page)
}

fn start_with(bench: &Bench, name: &str, epoch: u32, page: Vec<u8>) -> io::Result<Machine> {
    let log = bench.logs.as_deref().map(|folder| log(folder, name, epoch)).transpose()?;
    Machine::start(&Setup { image: &bench.image, page: (FLASH + Slots::STM32F405.first, page), log })
}

/// The file for the log of a robot's life.
fn log(folder: &Path, name: &str, epoch: u32) -> io::Result<PathBuf> {
    match std::fs::create_dir(folder) {
        Err(error) if error.kind() != ErrorKind::AlreadyExists => Err(error),
        _ => Ok(folder.join(format!("{name}-{epoch}.defmt"))),
    }
}
