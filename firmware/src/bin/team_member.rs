//! A robot of a navigating team on a board: `cargo fw` builds it for the STM32F405.
//!
//! Which robot it is, and its mission, its page says: see docs/page.md.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "This image runs on a robot: `cargo fw` builds it, `cargo fw-run team_member` starts it in QEMU."
    );
}

#[cfg(target_os = "none")]
mod image {
    use firmware::board::{self, Board, Gauge, Milliseconds, Motors, TeamLink};
    use firmware::team_member::{CHASSIS, Memory};

    static MEMORY: Memory<TeamLink, Milliseconds, Motors, Gauge> = Memory::new();

    #[board::entry]
    fn main() -> ! {
        let Some(Board { link, clock, drive, battery, mut storage, watchdog, .. }) = Board::take(CHASSIS)
        else {
            board::restart()
        };
        let drive = |chassis| drive.with_chassis(chassis);
        let started = MEMORY.start(link, clock, drive, battery, &mut storage);
        board::run(started, watchdog, || clock.cycles())
    }
}
