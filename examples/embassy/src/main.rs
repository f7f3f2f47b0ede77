//! The robot of the image `team_member` as a task of embassy's executor, on the STM32F405.
//!
//! The robot lies in a `static`, so its task holds no more than a reference to it. Two more tasks
//! serve its link: they would do so with the halves of any asynchronous serial port.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("This example runs on a robot: build it with `--target thumbv7em-none-eabihf`.");
}

#[cfg(target_os = "none")]
mod image {
    use embassy_executor::Spawner;
    use firmware::adapters::AsyncLink;
    use firmware::board::{self, Board, ChipWatchdog, Gauge, Guard, LATEST, Milliseconds, Motors, TeamLink};
    use firmware::team_member::{CHASSIS, Memory, Program};

    type Link = &'static AsyncLink;

    static LINK: AsyncLink = AsyncLink::new();
    static MEMORY: Memory<Link, Milliseconds, Motors, Gauge> = Memory::new();

    #[embassy_executor::main]
    async fn main(spawner: Spawner) {
        let Some(board) = Board::take(CHASSIS) else { board::restart() };
        let Board { link: port, clock, drive, battery, mut storage, watchdog, .. } = board;
        let drive = |chassis| drive.with_chassis(chassis);
        let started = MEMORY.start(&LINK, clock, drive, battery, &mut storage);
        let started = match started {
            Ok(started) => started,
            Err(reason) => board::stand(&reason, watchdog),
        };
        let guard = Guard::start(watchdog, LATEST);
        let (Ok(receiver), Ok(sender), Ok(robot)) =
            (listen(port), speak(port), control(Program::new(started), clock, guard))
        else {
            board::restart()
        };
        spawner.spawn(receiver);
        spawner.spawn(sender);
        spawner.spawn(robot);
    }

    #[embassy_executor::task]
    async fn listen(port: TeamLink) {
        LINK.receive_from(port).await
    }

    #[embassy_executor::task]
    async fn speak(port: TeamLink) {
        LINK.send_to(port).await
    }

    /// Other tasks run between two milliseconds.
    #[embassy_executor::task]
    async fn control(
        mut program: Program<Link, Milliseconds, Motors, Gauge>,
        clock: Milliseconds,
        mut guard: Guard<ChipWatchdog>,
    ) {
        while !program.needs_restart() {
            guard.feed();
            program.poll(|| clock.cycles());
            board::next_millisecond().await;
        }
        board::restart()
    }
}
