//! A robot of the paper's section 6.2 on the STM32F405: it brings a bottle and a plate together
//! with its teammate. Its sensors and actuators sit on a base behind USART3, and it ticks when the
//! base's readings arrive.
//!
//! The tables of both roles are those that `host-sim export bottle-and-plate` writes. Which robot
//! it is and its behavior tree, the page says that `host-sim provision bottle-and-plate` writes.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This image runs on a robot: `cargo run --release -- hil bottle-and-plate` starts it in QEMU.");
}

#[cfg(target_os = "none")]
#[rustfmt::skip]
#[allow(dead_code, unreachable_pub, reason = "as it is written for other crates")]
#[path = "../tasks/bottle_and_plate.rs"]
mod bottle_and_plate;

#[cfg(target_os = "none")]
mod image {
    use super::bottle_and_plate::TABLES;
    use cortex_m::singleton;
    use firmware::adapters::base::{BaseAnswer, Decision, Event, SILENCE};
    use firmware::adapters::{Base, Chassis};
    use firmware::board::{self, BasePort, Board, ChipWatchdog, Guard, Milliseconds, TeamLink};
    use firmware::hardware::Clock;
    use firmware::missions::TREE_NODES;
    use firmware::page::{self, PageTree};
    use firmware::team_member::configure_task;
    use firmware::{Controller, Finished, table_robot};
    use iibt_core::time::Duration;

    /// The ticks for which a precondition may stay unmet.
    const TIMEOUT: Duration = Duration(50);

    type Hardware = Base<TeamLink, BasePort>;

    /// Without a mission: no map, no paths.
    type Page = page::Page<1, 1, 0>;

    type TableRobot = table_robot!(TABLES, Hardware, Finished, page TREE_NODES);

    type Robot = Controller<TableRobot, Hardware>;

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
        let page = singleton!(: Page = Page::EMPTY)?;
        let tree = singleton!(: PageTree<(), TREE_NODES> = PageTree::EMPTY)?;
        let configured = configure_task(page, &mut tree.of(&TABLES, &[()]), &mut board.storage);
        let (page, epoch) = match configured {
            Ok(configured) => configured,
            Err(reason) => board::stand(&reason, board.watchdog),
        };
        let base = Base::new(board.link, board.base, SILENCE, board.clock.now());
        let settings = page.settings(epoch).ok()?;
        let (memory, tree) = (tree.memory(), tree.by_ref()?);
        let built = TableRobot::with_memory(&TABLES, &settings, tree, memory, Finished::default(), TIMEOUT);
        let mut robot = match built {
            Ok(robot) => robot,
            Err(reason) => board::stand(&reason, board.watchdog),
        };
        if let Some(units) = page.budget() {
            robot = robot.with_budget(units.get());
        }
        defmt::info!("boot: robot {=u8} of {=usize}, epoch {=u32}", page.robot().0, TABLES.robots(), epoch);
        let robot = singleton!(: Robot = Controller::new(robot, settings, base))?;
        Some((robot, board.clock, board.watchdog))
    }

    fn run(robot: &'static mut Robot, mut clock: Milliseconds, mut guard: Guard<ChipWatchdog>) -> ! {
        robot.hardware_mut().answer(BaseAnswer::Ready);
        loop {
            guard.feed();
            match robot.hardware_mut().poll(clock.now()) {
                Some(Event::Sensed) => tick(robot),
                Some(Event::Tick) => defmt::warn!("a tick for a robot that drives is passed over"),
                Some(Event::Waiting) => {
                    robot.hardware_mut().answer_waiting();
                }
                Some(Event::Silent) => defmt::error!("no readings from the base: it was told to stop"),
                None => board::sleep(),
            }
        }
    }

    /// Ticks with the readings that have come, and tells the base what to do.
    fn tick(robot: &mut Robot) {
        robot.tick();
        if let Some(decision) = robot.robot().task().decision() {
            let decision = Decision::new(0, decision.choice.into(), &decision.posterior);
            robot.hardware_mut().answer(BaseAnswer::Decided(decision));
        }
        robot.hardware_mut().end_operation();
    }
}
