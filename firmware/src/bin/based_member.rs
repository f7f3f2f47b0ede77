//! A robot of a navigating team on the STM32F405, whose motors and sensors sit on a base behind
//! USART3. It ticks when the base's readings arrive.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This image runs on a robot: `cargo run --release -- hil` starts a team of it in QEMU.");
}

#[cfg(target_os = "none")]
mod image {
    use firmware::adapters::base::{BaseAnswer, Decision, Event, MAX_WATCHED, SILENCE, first};
    use firmware::adapters::{Base, Chassis};
    use firmware::board::{self, BasePort, Board, ChipWatchdog, Guard, Milliseconds, TeamLink};
    use firmware::hardware::Clock;
    use firmware::missions::{ALL_PATHS, LAYERS, NODES, POLICIES};
    use firmware::page;
    use firmware::team_member::configure;
    use firmware::{Controller, Navigator};
    use heapless::Vec;
    use iibt_core::grid::{Path, words};
    use iibt_core::navigation::Mission;
    use iibt_core::team::MAX_TEAM;
    use static_cell::StaticCell;

    /// The most cells of a map.
    const CELLS: usize = 64;

    /// The words of such a map.
    const WORDS: usize = words(CELLS, 1);

    type Page = page::Page<CELLS, WORDS, ALL_PATHS>;

    type Robot =
        Controller<Navigator<'static, CELLS, WORDS, LAYERS, NODES, POLICIES>, Base<TeamLink, BasePort>>;

    static PAGE: StaticCell<Page> = StaticCell::new();
    static PATHS: StaticCell<Vec<&'static [Path], MAX_TEAM>> = StaticCell::new();
    static MISSION: StaticCell<Mission<'static, WORDS>> = StaticCell::new();
    static ROBOT: StaticCell<Robot> = StaticCell::new();

    #[board::entry]
    fn main() -> ! {
        match start() {
            Some((robot, clock, watchdog)) => run(robot, clock, Guard::start(watchdog, SILENCE)),
            None => board::restart(),
        }
    }

    /// `None` when a part is taken already: that cannot happen after a reset. A robot without a
    /// page that it can use stands until the board is reset.
    #[inline(never)]
    fn start() -> Option<(&'static mut Robot, Milliseconds, ChipWatchdog)> {
        let mut board = Board::take(Chassis::STANDING)?;
        let configured = configure(PAGE.try_init_with(|| Page::EMPTY)?, &mut board.storage);
        let (page, epoch) = match configured {
            Ok(configured) => configured,
            Err(reason) => board::stand(&reason, board.watchdog),
        };
        let paths = PATHS.try_init(page.path_lists())?;
        let mission = &*MISSION.try_init(page.mission(paths))?;
        let base = Base::new(board.link, board.base, SILENCE, board.clock.now());
        let settings = page.settings(epoch).ok()?;
        let robot = ROBOT.try_init_with(|| Controller::idle(Navigator::idle(), settings.clone(), base))?;
        robot.start(|navigator| navigator.start(mission, &settings)).ok()?;
        page.tune(robot.robot_mut());
        defmt::info!(
            "boot: robot {=u8} of {=usize}, epoch {=u32}",
            page.robot().0,
            mission.starts.len(),
            epoch
        );
        Some((robot, board.clock, board.watchdog))
    }

    fn run(robot: &'static mut Robot, mut clock: Milliseconds, mut guard: Guard<ChipWatchdog>) -> ! {
        let mut decided = None;
        robot.hardware_mut().answer(BaseAnswer::Ready);
        loop {
            guard.feed();
            match robot.hardware_mut().poll(clock.now()) {
                Some(Event::Tick) => tick(robot, &mut decided),
                Some(Event::Waiting) => {
                    robot.hardware_mut().answer_waiting();
                }
                Some(Event::Sensed) => defmt::warn!("a tick for a table task is passed over"),
                Some(Event::Silent) => defmt::error!("no readings from the base: it was told to stop"),
                None => board::sleep(),
            }
        }
    }

    /// Ticks with the readings that have come, and tells the base what to do.
    fn tick(robot: &mut Robot, decided: &mut Option<(u32, usize)>) {
        for index in 0..robot.hardware().visits().len() {
            let Some(&cell) = robot.hardware().visits().get(index) else { break };
            if robot.robot_mut().navigation_mut().visit(cell).is_err() {
                defmt::warn!("way-point p{=u16} is refused", cell.0);
            }
        }
        robot.tick();
        let report = robot.robot().navigation().report();
        let decision = report.policy.map(|policy| (report.round, policy));
        if decision != core::mem::replace(decided, decision)
            && let Some((round, policy)) = decision
        {
            let decision = Decision::new(round, policy, robot.robot().navigation().weighed().posterior());
            robot.hardware_mut().answer(BaseAnswer::Decided(decision));
        }
        let watched: Vec<_, MAX_WATCHED> = first(robot.robot().navigation().watched());
        robot.hardware_mut().end_tick(watched.iter().copied());
    }
}
