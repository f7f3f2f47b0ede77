//! The robot of the image `team_member` as a task of RTIC, on the STM32F405.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This example runs on a robot: build it with `--target thumbv7em-none-eabihf`.");
}

#[cfg(target_os = "none")]
#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true, dispatchers = [EXTI0])]
mod image {
    use firmware::board::{self, Board, ChipWatchdog, Gauge, Guard, LATEST, Milliseconds, Motors, TeamLink};
    use firmware::team_member::{CHASSIS, Memory, Program};

    static MEMORY: Memory<TeamLink, Milliseconds, Motors, Gauge> = Memory::new();

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        program: Program<TeamLink, Milliseconds, Motors, Gauge>,
        clock: Milliseconds,
        guard: Guard<ChipWatchdog>,
    }

    #[init]
    fn init(context: init::Context) -> (Shared, Local) {
        let Some(board) = Board::new(context.core, context.device, CHASSIS) else { board::restart() };
        let Board { link, clock, drive, battery, mut storage, watchdog, .. } = board;
        let drive = |chassis| drive.with_chassis(chassis);
        let started = MEMORY.start(link, clock, drive, battery, &mut storage);
        let started = match started {
            Ok(started) => started,
            Err(reason) => board::stand(&reason, watchdog),
        };
        let guard = Guard::start(watchdog, LATEST);
        // The queue of a task has room for it.
        let _ = control::spawn();
        (Shared {}, Local { program: Program::new(started), clock, guard })
    }

    /// Tasks of higher priority may interrupt it anywhere.
    #[task(local = [program, clock, guard], priority = 1)]
    async fn control(context: control::Context) {
        while !context.local.program.needs_restart() {
            context.local.guard.feed();
            context.local.program.poll(|| context.local.clock.cycles());
            board::next_millisecond().await;
        }
        board::restart()
    }
}
