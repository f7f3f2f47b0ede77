//! The program of the image `team_member`, for any board: robot 1 of the paper's section 5.1.
//!
//! It decides with robot 2, whose intentions arrive as frames, goes where it decided to go, and
//! logs what it does. Without a positioning system it reckons its place from its own moves.

use crate::adapters::{Absent, Body, Chassis, Counted, DeadReckoning};
use crate::hardware::{Battery, Clock, Drive, Link};
use crate::missions::{CELLS, LAYERS, NODES, POLICIES, SECTION_5_1, WORDS};
use crate::{Controller, LinkReport, Navigator, Settings};
use core::num::NonZero;
use heapless::Vec;
use iibt_core::actions::HORIZON;
use iibt_core::navigation::{Report, Stage};
use iibt_core::team::{Key, Member, RobotId};
use iibt_core::time::{Duration, Instant};
use static_cell::StaticCell;

/// The measures of the robot.
pub const CHASSIS: Chassis = Chassis { cell: 0.5, track: 0.1, speed: 0.25, duty: 60 };

/// Between two ticks of the controller, in milliseconds.
const TICK: NonZero<u16> = NonZero::new(100).unwrap();

/// For the bench only: a team in the field has a key of its own.
const KEY: Key = Key::new(*b"section 5.1 demo");

type Agent = Navigator<'static, CELLS, WORDS, LAYERS, NODES, POLICIES>;

type Hardware<L, C, D, B> = Body<L, C, Counted<'static, D, WORDS>, &'static DeadReckoning<WORDS>, Absent, B>;

/// The robot with the link, clock, drive and battery gauge of a board.
pub type TeamMember<L, C, D, B> = Controller<Agent, Hardware<L, C, D, B>>;

/// The memory of the robot, for a `static`.
pub struct Memory<L: Link, C: Clock, D: Drive, B: Battery> {
    robot: StaticCell<TeamMember<L, C, D, B>>,
    position: StaticCell<DeadReckoning<WORDS>>,
}

impl<L: Link, C: Clock, D: Drive, B: Battery> Memory<L, C, D, B> {
    /// Memory without a robot.
    #[must_use]
    pub const fn new() -> Self {
        Self { robot: StaticCell::new(), position: StaticCell::new() }
    }

    /// Builds the robot in place. `None` the second time.
    #[inline(never)] // on a stack of its own, which the ticks use again
    #[expect(clippy::mut_from_ref, reason = "the cells hand out what is in them once")]
    pub fn start(
        &'static self,
        link: L,
        clock: C,
        drive: D,
        battery: B,
    ) -> Option<&'static mut TeamMember<L, C, D, B>> {
        let start = *SECTION_5_1.starts.first()?;
        let position = &*self.position.try_init(DeadReckoning::new(SECTION_5_1.map, start))?;
        let body = Body::new(link, clock).driving(position.count(drive), position).powered(battery);
        // The epoch belongs into memory that outlives a restart; none is wired up yet.
        let member = Member::new(RobotId(0), SECTION_5_1.starts.len()).ok()?;
        let settings = Settings::new(member, KEY, 1, TICK);
        let robot = self.robot.try_init_with(|| Controller::idle(Agent::idle(), settings.clone(), body))?;
        robot.start(|agent| agent.start(&SECTION_5_1, &settings)).ok()?;
        defmt::info!("boot: robot 1 of {=usize} on p{=u16}", SECTION_5_1.starts.len(), start.0);
        Some(robot)
    }
}

impl<L: Link, C: Clock, D: Drive, B: Battery> Default for Memory<L, C, D, B> {
    fn default() -> Self {
        Self::new()
    }
}

/// Runs a robot for ever, and logs what it does. `cycles` counts those of the core, to measure
/// ticks; `sleep` returns at the next interrupt, after a millisecond at the latest.
pub fn run<L: Link, C: Clock, D: Drive, B: Battery>(
    robot: &'static mut TeamMember<L, C, D, B>,
    cycles: impl Fn() -> u32,
    sleep: impl Fn(),
) -> ! {
    let mut program = Program::new(robot);
    loop {
        program.poll(&cycles);
        sleep();
    }
}

/// The program of a robot, for loops of one's own.
pub struct Program<L: Link + 'static, C: Clock + 'static, D: Drive + 'static, B: Battery + 'static> {
    robot: &'static mut TeamMember<L, C, D, B>,
    due: Instant,
    ticks: u32,
    longest: u32,
    before: (Report, LinkReport),
}

impl<L: Link, C: Clock, D: Drive, B: Battery> Program<L, C, D, B> {
    /// The program of a robot that was started.
    pub fn new(robot: &'static mut TeamMember<L, C, D, B>) -> Self {
        let (due, before) = (robot.hardware_mut().now(), state_of(robot));
        Self { robot, due, ticks: 0, longest: 0, before }
    }

    /// Ticks the robot if it is time. Call it every millisecond: asking the drive is what ends a
    /// turn or a move. `cycles` counts those of the core.
    pub fn poll(&mut self, cycles: impl Fn() -> u32) {
        let Self { robot, due, ticks, longest, before } = self;
        robot.hardware_mut().is_moving();
        let now = robot.hardware_mut().now();
        if !now.has_reached(*due) {
            return;
        }
        *due = now.after(Duration(TICK.get().into()));
        *ticks = ticks.wrapping_add(1);
        let started = cycles();
        robot.tick();
        let took = cycles().wrapping_sub(started);
        let state = state_of(robot);
        tell(robot.robot(), *ticks, before, &state);
        if took > *longest || state.0.stage != before.0.stage {
            defmt::info!("tick {=u32}: took {=u32} cycles", *ticks, took);
            *longest = took.max(*longest);
        }
        *before = state;
    }
}

/// The state of the robot and of its link.
fn state_of<L: Link, C: Clock, D: Drive, B: Battery>(robot: &TeamMember<L, C, D, B>) -> (Report, LinkReport) {
    (robot.robot().navigation().report(), robot.link_report())
}

/// Logs what has changed in a tick.
fn tell(navigator: &Agent, tick: u32, before: &(Report, LinkReport), now: &(Report, LinkReport)) {
    let ((before, heard_before), (now, heard)) = (before, now);
    if heard.received.accepted > 0 && heard_before.received.accepted == 0 {
        defmt::info!("tick {=u32}: heard the team", tick);
    }
    if now.step != before.step {
        defmt::info!("tick {=u32}: step {=usize} done, on p{=u16}", tick, now.step, now.cell.0);
    }
    if now.stage != before.stage {
        if now.stage == Stage::Agreed {
            tell_decision(navigator, tick, now);
        }
        defmt::info!("tick {=u32}: {} in round {=u32}", tick, now.stage, now.round);
    }
}

/// Logs the posterior over the joint policies, bit by bit, and the choice.
fn tell_decision(navigator: &Agent, tick: u32, now: &Report) {
    let weighed = navigator.navigation().weighed();
    for (policy, (p, cost)) in weighed.posterior().iter().zip(weighed.costs()).enumerate() {
        defmt::info!(
            "tick {=u32}: posterior of {=usize}: {=u32:08x}, cost {=u32}",
            tick,
            policy,
            p.to_bits(),
            cost.total()
        );
    }
    let mut cells = Vec::<u16, { HORIZON + 1 }>::new();
    for cell in now.path.cells(&SECTION_5_1.map) {
        // There is room for every cell of the longest path.
        let _ = cells.push(cell.0);
    }
    let goal = now.goal.map_or(0, |goal| goal.0);
    defmt::info!(
        "tick {=u32}: chose p{=u16} with {=f32} by {}",
        tick,
        goal,
        now.probability,
        cells.as_slice()
    );
}
