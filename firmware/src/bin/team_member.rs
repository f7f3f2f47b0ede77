//! Robot 1 of the paper's section 5.1 on the STM32F405: `cargo fw` builds it.
//!
//! It decides with robot 2, whose intentions arrive as frames on USART2, goes where it decided to
//! go, and logs on USART1. Without a positioning system it reckons its place from its own moves.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "This image runs on a robot: `cargo fw` builds it, `cargo fw-run team_member` starts it in QEMU."
    );
}

#[cfg(target_os = "none")]
mod image {
    use core::num::NonZero;
    use cortex_m::singleton;
    use firmware::adapters::{Body, Chassis, Counted, DeadReckoning};
    use firmware::board::{self, Board, Milliseconds, Motors, TeamLink};
    use firmware::hardware::{Clock, Drive};
    use firmware::missions::{CELLS, LAYERS, NODES, POLICIES, SECTION_5_1, WORDS};
    use firmware::{Controller, LinkReport, Navigator, Settings};
    use heapless::Vec;
    use iibt_core::actions::HORIZON;
    use iibt_core::navigation::{Report, Stage};
    use iibt_core::team::{Key, Member, RobotId};
    use iibt_core::time::Duration;

    const CHASSIS: Chassis = Chassis { cell: 0.5, track: 0.1, speed: 0.25, duty: 60 };

    /// Between two ticks of the controller, in milliseconds.
    const TICK: NonZero<u16> = NonZero::new(100).unwrap();

    /// For the bench only: a team in the field has a key of its own.
    const KEY: Key = Key::new(*b"section 5.1 demo");

    type Hardware =
        Body<TeamLink, Milliseconds, Counted<'static, Motors, WORDS>, &'static DeadReckoning<WORDS>>;

    type Robot = Controller<Navigator<'static, CELLS, WORDS, LAYERS, NODES, POLICIES>, Hardware>;

    #[board::entry]
    fn main() -> ! {
        match start() {
            Some(robot) => run(robot),
            None => board::restart(),
        }
    }

    /// `None` when a part is taken already or the mission does not fit: neither can happen after a
    /// reset.
    ///
    /// On a stack of its own, which the ticks use again: the robot is made there.
    #[inline(never)]
    fn start() -> Option<&'static mut Robot> {
        let mut board = Board::take(CHASSIS)?;
        board.led.set_high();
        let start = *SECTION_5_1.starts.first()?;
        let reckoning: &'static DeadReckoning<WORDS> =
            singleton!(: DeadReckoning<WORDS> = DeadReckoning::new(SECTION_5_1.map, start))?;
        let drive = reckoning.count(board.drive);
        let body = Body::new(board.link, board.clock).driving(drive, reckoning);
        // The epoch belongs into memory that outlives a restart; this board has none wired up.
        let member = Member::new(RobotId(0), SECTION_5_1.starts.len()).ok()?;
        let settings = Settings::new(member, KEY, 1, TICK);
        let robot = Controller::new(Navigator::new(&SECTION_5_1, &settings).ok()?, settings, body);
        defmt::info!("boot: robot 1 of {=usize} on p{=u16}", SECTION_5_1.starts.len(), start.0);
        singleton!(: Robot = robot)
    }

    fn run(robot: &'static mut Robot) -> ! {
        let mut due = robot.hardware_mut().now();
        let (mut ticks, mut longest) = (0_u32, 0);
        let mut before = tell_of(robot);
        loop {
            // Asking the drive is what ends a turn or a move, so it is asked at every millisecond.
            robot.hardware_mut().is_moving();
            let now = robot.hardware_mut().now();
            if now.has_reached(due) {
                due = now.after(Duration(TICK.get().into()));
                ticks = ticks.wrapping_add(1);
                let clock = robot.hardware_mut().clock;
                let started = clock.cycles();
                robot.tick();
                let cycles = clock.cycles().wrapping_sub(started);
                let report = tell_of(robot);
                tell(robot, ticks, &before, &report);
                if cycles > longest || report.0.stage != before.0.stage {
                    defmt::info!("tick {=u32}: took {=u32} cycles", ticks, cycles);
                    longest = longest.max(cycles);
                }
                before = report;
            }
            board::sleep();
        }
    }

    /// Logs the state of the robot and its link.
    fn tell_of(robot: &Robot) -> (Report, LinkReport) {
        (robot.robot().navigation().report(), robot.link_report())
    }

    /// Logs what has changed in a tick.
    fn tell(robot: &Robot, tick: u32, before: &(Report, LinkReport), now: &(Report, LinkReport)) {
        let ((before, heard_before), (now, heard)) = (before, now);
        if heard.received.accepted > 0 && heard_before.received.accepted == 0 {
            defmt::info!("tick {=u32}: heard the team", tick);
        }
        if now.step != before.step {
            defmt::info!("tick {=u32}: step {=usize} done, on p{=u16}", tick, now.step, now.cell.0);
        }
        if now.stage != before.stage {
            if now.stage == Stage::Agreed {
                tell_decision(robot, tick, now);
            }
            defmt::info!("tick {=u32}: {} in round {=u32}", tick, now.stage, now.round);
        }
    }

    /// Logs the posterior over the joint policies, bit by bit, and the choice.
    fn tell_decision(robot: &Robot, tick: u32, now: &Report) {
        let weighed = robot.robot().navigation().weighed();
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
}
