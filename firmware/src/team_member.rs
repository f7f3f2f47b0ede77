//! The program of the image `team_member`, for any board: a robot of a navigating team.
//!
//! Which robot of which team it is, and the mission, the page in its flash says. It decides with
//! its teammates, whose intentions arrive as frames, goes where they decided that it goes, and logs
//! what it does. Without a positioning system it reckons its place from its own moves, and after a
//! restart stands until it is placed again.

#[cfg(feature = "reduced")]
#[path = "team_member/no_log.rs"]
mod tick_log;
#[cfg(not(feature = "reduced"))]
mod tick_log;

use crate::adapters::{Absent, Body, Chassis, Counted, DeadReckoning, OutsideMap};
use crate::hardware::{Battery, Clock, Drive, Link};
#[cfg(feature = "reduced")]
use crate::missions::reduced::{ALL_PATHS, CELLS, LAYERS, NODES, POLICIES, WORDS};
#[cfg(not(feature = "reduced"))]
use crate::missions::{ALL_PATHS, CELLS, LAYERS, NODES, POLICIES, WORDS};
use crate::page::{Origin, Page, Refused, TreeReader};
use crate::{Controller, EpochError, Navigator, Storage};
use embedded_storage::nor_flash::NorFlash;
use heapless::Vec;
use iibt_core::grid::{Cell, Path};
use iibt_core::navigation::{Mission, MissionError};
use iibt_core::team::MAX_TEAM;
use iibt_core::time::{Duration, Instant};
use static_cell::StaticCell;
use tick_log::TickLog;

/// The measures of the robot, unless its page has others.
pub const CHASSIS: Chassis = Chassis { cell: 0.5, track: 0.1, speed: 0.25, duty: 60 };

type Agent = Navigator<'static, CELLS, WORDS, LAYERS, NODES, POLICIES>;

type Hardware<L, C, D, B> = Body<L, C, Counted<'static, D, WORDS>, &'static DeadReckoning<WORDS>, Absent, B>;

/// The robot with the link, clock, drive and battery gauge of a board.
pub type TeamMember<L, C, D, B> = Controller<Agent, Hardware<L, C, D, B>>;

/// A mission whose lists lie in a page.
type OwnMission = Mission<'static, WORDS>;

/// The page of the robot.
type OwnPage = Page<CELLS, WORDS, ALL_PATHS>;

/// The lists of paths in a page.
type PathLists = Vec<&'static [Path], MAX_TEAM>;

/// A robot that has started.
pub struct Started<L: Link + 'static, C: Clock + 'static, D: Drive + 'static, B: Battery + 'static> {
    robot: &'static mut TeamMember<L, C, D, B>,
    position: &'static DeadReckoning<WORDS>,
    mission: &'static OwnMission,
    period: Duration,
}

/// Why a robot does not take part, and stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum Standing {
    /// It has no page that it can use.
    NoPage(Refused),
    /// It has no epoch.
    NoEpoch(EpochError),
    /// Its mission cannot be flown.
    NoMission(MissionError),
    /// It was started already.
    Started,
}

/// Reads the page of a robot and takes the epoch of this start. A copy of the page that is not
/// whole is logged.
///
/// # Errors
/// [`Standing`]: the robot must not take part.
pub fn configure<const S: usize, const W: usize, const P: usize>(
    page: &'static mut Page<S, W, P>,
    storage: &mut Storage<impl NorFlash>,
) -> Result<(&'static Page<S, W, P>, u32), Standing> {
    let origin = storage.load(page).map_err(Standing::NoPage)?;
    take_epoch(page, storage, origin)
}

/// The same for a robot with a table task, whose page has a tree in place of a mission.
///
/// # Errors
/// As [`configure`].
pub fn configure_task<const S: usize, const W: usize, const P: usize, L: Copy, const T: usize>(
    page: &'static mut Page<S, W, P>,
    tree: &mut TreeReader<'_, L, T>,
    storage: &mut Storage<impl NorFlash>,
) -> Result<(&'static Page<S, W, P>, u32), Standing> {
    let origin = storage.load_task(page, tree).map_err(Standing::NoPage)?;
    take_epoch(page, storage, origin)
}

/// Takes the epoch of this start, once the page is read.
fn take_epoch<const S: usize, const W: usize, const P: usize>(
    page: &'static Page<S, W, P>,
    storage: &mut Storage<impl NorFlash>,
    origin: Origin,
) -> Result<(&'static Page<S, W, P>, u32), Standing> {
    if let Some(other) = origin.other {
        defmt::warn!("page {=u32} is the {} copy; the other: {}", origin.generation, origin.which, other);
    }
    let epoch = storage.epoch(page.epoch()).map_err(Standing::NoEpoch)?;
    Ok((page, epoch))
}

/// The memory of the robot, for a `static`.
pub struct Memory<L: Link, C: Clock, D: Drive, B: Battery> {
    robot: StaticCell<TeamMember<L, C, D, B>>,
    position: StaticCell<DeadReckoning<WORDS>>,
    page: StaticCell<OwnPage>,
    paths: StaticCell<PathLists>,
    mission: StaticCell<OwnMission>,
}

impl<L: Link, C: Clock, D: Drive, B: Battery> Memory<L, C, D, B> {
    /// Memory without a robot.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            robot: StaticCell::new(),
            position: StaticCell::new(),
            page: StaticCell::new(),
            paths: StaticCell::new(),
            mission: StaticCell::new(),
        }
    }

    /// Reads the page, counts the start and builds the robot in place. `drive` makes the drive for
    /// the measures of the page, or for [`CHASSIS`].
    ///
    /// # Errors
    /// [`Standing`]: the robot must not take part.
    #[inline(never)] // on a stack of its own, which the ticks use again
    pub fn start(
        &'static self,
        link: L,
        clock: C,
        drive: impl FnOnce(Chassis) -> D,
        battery: B,
        storage: &mut Storage<impl NorFlash>,
    ) -> Result<Started<L, C, D, B>, Standing> {
        let page = self.page.try_init_with(|| OwnPage::EMPTY).ok_or(Standing::Started)?;
        let (page, epoch) = configure(page, storage)?;
        let mission = self.mission_of(page).ok_or(Standing::Started)?;
        let no_robot = Standing::NoMission(MissionError::NoSuchRobot);
        let settings = page.settings(epoch).map_err(|_| no_robot)?;
        let number = settings.member().robot();
        let start = *mission.starts.get(number.index()).ok_or(no_robot)?;
        let is_first = page.is_first_start(epoch);
        let position = self.position.try_init(DeadReckoning::at_boot(mission.map, start, is_first));
        let position = &*position.ok_or(Standing::Started)?;
        let drive = position.count(drive(page.chassis().unwrap_or(CHASSIS)));
        let body = Body::new(link, clock).driving(drive, position).powered(battery);
        let robot = self.robot.try_init_with(|| Controller::idle(Agent::idle(), settings.clone(), body));
        let robot = robot.ok_or(Standing::Started)?;
        robot.start(|agent| agent.start(mission, &settings)).map_err(Standing::NoMission)?;
        page.tune(robot.robot_mut());
        let team = mission.starts.len();
        let named = number.0.saturating_add(1);
        if is_first {
            defmt::info!("boot: robot {=u8} of {=usize} on p{=u16}", named, team, start.0);
        } else {
            defmt::warn!("boot: robot {=u8} of {=usize}, place unknown: waiting to be placed", named, team);
        }
        defmt::info!("boot: epoch {=u32}", epoch);
        Ok(Started { robot, position, mission, period: settings.tick() })
    }

    fn mission_of(&'static self, page: &'static OwnPage) -> Option<&'static OwnMission> {
        let paths = self.paths.try_init(page.path_lists())?;
        self.mission.try_init(page.mission(paths)).map(|mission| &*mission)
    }
}

impl<L: Link, C: Clock, D: Drive, B: Battery> Default for Memory<L, C, D, B> {
    fn default() -> Self {
        Self::new()
    }
}

/// Runs a robot until it [needs a restart](Program::needs_restart), and logs what it does. `cycles`
/// counts those of the core, to measure ticks; `sleep` is called whenever the loop comes round, and
/// returns at the next interrupt, after a millisecond at the latest.
pub fn run<L: Link, C: Clock, D: Drive, B: Battery>(
    started: Started<L, C, D, B>,
    cycles: impl Fn() -> u32,
    mut sleep: impl FnMut(),
) {
    let mut program = Program::new(started);
    while !program.needs_restart() {
        program.poll(&cycles);
        sleep();
    }
}

/// The program of a robot, for loops of one's own.
pub struct Program<L: Link + 'static, C: Clock + 'static, D: Drive + 'static, B: Battery + 'static> {
    started: Started<L, C, D, B>,
    due: Instant,
    log: TickLog,
}

impl<L: Link, C: Clock, D: Drive, B: Battery> Program<L, C, D, B> {
    /// The program of a robot that was started.
    pub fn new(started: Started<L, C, D, B>) -> Self {
        let (due, log) = (started.robot.hardware_mut().now(), TickLog::of(started.robot));
        Self { started, due, log }
    }

    /// Whether the numbers of this epoch's frames are used up and the robot stands: restart it, and
    /// it takes the next epoch like at any other start.
    pub fn needs_restart(&mut self) -> bool {
        let robot = &mut self.started.robot;
        robot.needs_new_epoch() && !robot.hardware_mut().is_moving()
    }

    /// Places the robot, which stands, on the cell where an operator sees it: a robot that has
    /// restarted does not know, and stands until then.
    ///
    /// # Errors
    /// [`OutsideMap`]; the robot is as it was.
    pub fn place(&self, cell: Cell) -> Result<(), OutsideMap> {
        self.started.position.place(cell)
    }

    /// Ticks the robot if it is time. Call it every millisecond: asking the drive is what ends a
    /// turn or a move. `cycles` counts those of the core.
    pub fn poll(&mut self, cycles: impl Fn() -> u32) {
        let Self { started: Started { robot, mission, period, .. }, due, log } = self;
        robot.hardware_mut().is_moving();
        let now = robot.hardware_mut().now();
        if !now.has_reached(*due) {
            return;
        }
        *due = now.after(*period);
        let started = cycles();
        robot.tick();
        log.tell(robot, mission, cycles().wrapping_sub(started));
    }
}
