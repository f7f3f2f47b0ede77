//! A robot of the paper's section 6.2 on the STM32F405: it brings a bottle and a plate together
//! with its teammate. Its sensors and actuators sit on a base behind USART3, and it ticks when the
//! base's readings arrive.
//!
//! The tables of both roles are those that `host-sim export bottle-and-plate` writes. Which robot
//! it is, its page says; of the page's mission it needs no more than the size of the team.
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
    use firmware::missions::{ALL_PATHS, CELLS, WORDS};
    use firmware::page::Page;
    use firmware::team_member::configure;
    use firmware::{Controller, Finished, TaskLeaf, table_robot};
    use iibt_core::time::Duration;
    use iibt_core::tree;
    use iibt_core::tree::Tree;

    /// The ticks for which a precondition may stay unmet.
    const TIMEOUT: Duration = Duration(50);

    type Hardware = Base<TeamLink, BasePort>;

    type Robot = Controller<table_robot!(TABLES, Hardware, Finished, 6), Hardware>;

    /// Both roles have two aims.
    static TREE: Tree<TaskLeaf<()>, 6> = tree! {
        Fallback {
            Condition(TaskLeaf::Own(())),
            Sequence {
                Inference(TaskLeaf::Aim(0)),
                Inference(TaskLeaf::Aim(1)),
                Action(TaskLeaf::Own(())),
            },
        }
    };

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
        let page = singleton!(: Page<CELLS, WORDS, ALL_PATHS> = Page::EMPTY)?;
        let configured = configure(page, &mut board.storage);
        let (page, epoch) = match configured {
            Ok(configured) => configured,
            Err(reason) => board::stand(&reason, board.watchdog),
        };
        let base = Base::new(board.link, board.base, SILENCE, board.clock.now());
        let settings = page.settings(epoch).ok()?;
        let robot = <table_robot!(TABLES, Hardware, Finished, 6)>::new(
            &TABLES,
            &settings,
            &TREE,
            Finished::default(),
            TIMEOUT,
        );
        let robot = robot.ok()?;
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
